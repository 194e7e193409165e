//! The guide names files of this repository. They must exist, and each row of the comparison must name what shows it.

use std::path::{Path, PathBuf};

/// How the names of this repository's files begin.
const FOLDERS: [&str; 6] = ["benches/", "docs/", "examples/", "shaders/", "src/", "tests/"];

/// What is between single backticks.
fn quoted(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

/// The cells of each row of the tables in a file of documentation, without heads and rules.
fn rows(text: &str) -> impl Iterator<Item = Vec<&str>> {
    let lines = text.lines().filter_map(|line| line.strip_prefix("//! | "));
    let rows = lines.map(|line| line.trim_end_matches('|').split('|').map(str::trim).collect());
    rows.filter(|cells: &Vec<&str>| !cells[0].is_empty())
}

/// The file that a name in the last column of the comparison stands for.
fn shown_by(name: &str) -> PathBuf {
    let file = match name.split_once(' ') {
        Some(("--example", name)) => format!("examples/{name}.rs"),
        Some(("--bench", name)) => format!("benches/{name}.rs"),
        _ if name.ends_with(".md") || name.starts_with('.') => name.to_owned(),
        _ => format!("tests/{name}.rs"),
    };
    Path::new(env!("CARGO_MANIFEST_DIR")).join(file)
}

/// Why a row of the comparison is not complete.
fn flaw(cells: &[&str]) -> Option<String> {
    let &[_, here, avian, rapier, last] = cells else {
        return Some("it has not five cells".to_owned());
    };
    if [here, avian, rapier].contains(&"") {
        return Some("a cell is empty".to_owned());
    }
    if quoted(last).next().is_none() && !here.starts_with("**no**") {
        return Some("it names no test and no program that shows it".to_owned());
    }
    let missing = quoted(last).find(|name| !shown_by(name).is_file())?;
    Some(format!("there is no `{missing}`"))
}

#[test]
fn the_guide_names_files_that_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let guide = std::fs::read_dir(root.join("src/guide")).unwrap();
    let mut count = 0;
    for file in guide.map(|entry| entry.unwrap().path()).filter(|path| path.is_file()) {
        let text = std::fs::read_to_string(&file).unwrap();
        // Without the fences of programs, which are three backticks.
        for name in
            quoted(&text.replace("```", "")).filter(|name| FOLDERS.iter().any(|folder| name.starts_with(folder)))
        {
            assert!(root.join(name).exists(), "{}: there is no `{name}`", file.display());
            count += 1;
        }
    }
    assert!(count > 2, "only {count} names were found");
}

#[test]
fn each_row_of_the_comparison_names_what_shows_it() {
    let mut count = 0;
    for cells in rows(include_str!("../../src/guide/comparison.rs")) {
        assert_eq!(flaw(&cells), None, "{cells:?}");
        count += 1;
    }
    assert!(count > 50, "only {count} rows were found");
}

#[test]
fn an_incomplete_row_is_noticed() {
    let table =
        "//! | | here | a | b | c |\n//! |---|---|---|---|---|\n//! | rays | yes | yes | yes | `plugin/hooks` |";
    assert_eq!(rows(table).map(|cells| flaw(&cells)).collect::<Vec<_>>(), [None]);
    assert_eq!(flaw(&["joints", "**no**", "yes", "yes", ""]), None);
    for wrong in [
        &["rays", "yes", "yes", "yes", "in the README"][..],
        &["rays", "yes", "", "yes", "`plugin/hooks`"],
        &["rays", "yes", "yes", "yes", "`plugin/no_such_test`"],
        &["rays", "yes", "yes", "yes", "`--example no_such_example`"],
        &["rays", "yes"],
    ] {
        assert!(flaw(wrong).is_some(), "{wrong:?}");
    }
}
