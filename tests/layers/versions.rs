//! The documents name the versions that the manifest has.

const MANIFEST: &str = include_str!("../../Cargo.toml");
const CONTRIBUTING: &str = include_str!("../../CONTRIBUTING.md");
const README: &str = include_str!("../../README.md");
const CHANGELOG: &str = include_str!("../../CHANGELOG.md");

/// The version in the first line of the manifest that begins with `key = `, plain or in a table.
fn version(key: &str) -> &'static str {
    let line = MANIFEST
        .lines()
        .find_map(|line| line.strip_prefix(key)?.strip_prefix(" = "));
    let line = line.unwrap_or_else(|| panic!("Cargo.toml has no `{key}`"));
    let quoted = line.strip_prefix("{ version = ").unwrap_or(line);
    quoted.split('"').nth(1).expect("a version in quotes")
}

/// The first numbers of a version.
fn minor(version: &str) -> String {
    version.split('.').take(2).collect::<Vec<_>>().join(".")
}

#[test]
fn the_table_of_versions_is_that_of_the_manifest() {
    let [own, bevy] = ["version", "bevy"].map(|key| minor(version(key)));
    let row = format!("| {own} | {bevy} | {} | {} |", version("wgpu"), version("rust-version"));
    let first = CONTRIBUTING
        .lines()
        .skip_while(|line| !line.starts_with("| bevy_faceoff | Bevy |"))
        .nth(2);
    assert_eq!(first, Some(&*row), "the table in CONTRIBUTING.md, \"Publishing\"");
}

#[test]
fn the_readme_names_the_versions_of_the_manifest() {
    let (bevy, rust) = (version("bevy"), version("rust-version"));
    let claims = [
        format!("[Bevy](https://bevy.org) {}", minor(bevy)),
        format!("[Rust](https://rustup.rs) {rust}"),
        format!("bevy = {{ version = \"{bevy}\""),
    ];
    for claim in claims {
        assert!(README.contains(&claim), "the README does not say {claim}");
    }
}

#[test]
fn the_changelog_begins_with_what_is_not_released() {
    let heading = CHANGELOG.lines().find(|line| line.starts_with("## "));
    assert_eq!(heading, Some("## [Unreleased]"));
    let kinds = CHANGELOG.lines().filter_map(|line| line.strip_prefix("### "));
    for kind in kinds {
        let known = ["Added", "Changed", "Deprecated", "Removed", "Fixed", "Security"];
        assert!(known.contains(&kind), "Keep a Changelog has no section {kind}");
    }
}
