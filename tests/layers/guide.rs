//! The guide names files of this repository. They must exist, and each row of the comparison must name what shows it.

use std::path::Path;

/// Folders whose files the guide names. Files of other crates begin with the name of the crate.
const FOLDERS: [&str; 6] = ["benches/", "docs/", "examples/", "shaders/", "src/", "tests/"];

/// The paths in backticks.
fn paths(text: &str) -> impl Iterator<Item = &str> {
    let quoted = text.split('`').skip(1).step_by(2);
    quoted.filter(|quoted| FOLDERS.iter().any(|folder| quoted.starts_with(folder)))
}

/// The cells of each row of the tables in a file of documentation, without heads and rules.
fn rows(text: &str) -> impl Iterator<Item = Vec<&str>> {
    let lines = text.lines().filter_map(|line| line.strip_prefix("//! | "));
    let rows = lines.map(|line| line.trim_end_matches('|').split('|').map(str::trim).collect());
    rows.filter(|cells: &Vec<&str>| !cells[0].is_empty())
}

/// Why a row of the comparison is not complete.
fn flaw(cells: &[&str]) -> Option<&'static str> {
    let &[_, here, avian, rapier, shown_by] = cells else {
        return Some("it has not five cells");
    };
    if [here, avian, rapier].contains(&"") {
        return Some("a cell is empty");
    }
    let is_missing = here.starts_with("**no**");
    (!is_missing && paths(shown_by).next().is_none()).then_some("it names no test and no program that shows it")
}

#[test]
fn the_guide_names_files_that_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let guide = std::fs::read_dir(root.join("src/guide")).unwrap();
    let files = guide.map(|entry| entry.unwrap().path()).filter(|path| path.is_file());
    let mut count = 0;
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap();
        // Code of examples is between three backticks, which leave the pairs of single ones as they are.
        for path in paths(&text.replace("```", "")) {
            assert!(root.join(path).exists(), "{}: there is no `{path}`", file.display());
            count += 1;
        }
    }
    assert!(count > 60, "only {count} paths were found");
}

#[test]
fn each_row_of_the_comparison_names_what_shows_it() {
    let text = include_str!("../../src/guide/comparison.rs");
    let mut count = 0;
    for cells in rows(text) {
        assert_eq!(flaw(&cells), None, "{cells:?}");
        count += 1;
    }
    assert!(count > 40, "only {count} rows were found");
}

#[test]
fn an_incomplete_row_is_noticed() {
    let row =
        "//! | rays | yes | yes | yes | `tests/layers.rs` |\n//! |---|---|---|---|---|\n//! | | here | a | b | c |";
    assert_eq!(rows(row).map(|cells| flaw(&cells)).collect::<Vec<_>>(), [None]);
    assert!(flaw(&["rays", "yes", "yes", "yes", "in the README"]).is_some());
    assert!(flaw(&["rays", "yes", "", "yes", "`tests/layers.rs`"]).is_some());
    assert!(flaw(&["joints", "**no**", "yes", "yes", ""]).is_none());
    assert!(flaw(&["rays", "yes"]).is_some());
}
