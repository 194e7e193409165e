//! The layers of the crate: which file may use which other.
//!
//! This test reads the sources. A file uses another if it names something that is defined there: in a `use` item, or in
//! a path such as `crate::geometry::TriMesh`, `super::cpu::run` or, after `use crate::step`, `step::cpu::run`. Names
//! are followed through imports, globs and re-exports to the file that defines them. That file is used; the files that
//! only pass the name on are not.
//!
//! * `mod child;` is no use.
//! * `pub use child::Item` is no use, whatever its visibility: whoever imports the item from there uses the child. But
//!   `pub use crate::elsewhere::Item`, of an item that is not below the file, is a use like any other.
//! * `use crate::module` is no use; the paths that begin with `module::` are. `use crate::module::*` is a use of the
//!   module, and each name that comes through it is a use of the file that defines the name.
//! * Paths in calls of macros count, even where only the call's tokens can be read. Names that a macro may define
//!   belong to the file that calls it.
//! * Comments and code for tests do not count.
//! * Methods and fields do not count: they are found through their type and need no import.

#[path = "layers/cycles.rs"]
mod cycles;
#[path = "layers/fixture.rs"]
mod fixture;
#[path = "layers/graph.rs"]
mod graph;
#[path = "layers/guide.rs"]
mod guide;
#[path = "layers/leaves.rs"]
mod leaves;
#[path = "layers/rules.rs"]
mod rules;
#[path = "layers/tree.rs"]
mod tree;
#[path = "layers/versions.rs"]
mod versions;

use graph::Graph;
use rules::Rules;
use std::path::Path;

/// From bottom to top. A file may use files of its own entry and of the layers before; entries in one layer do not use
/// each other. `a/b` stands for `a/b.rs` and all files below `a/b/`, `a/mod.rs` for that file alone. If several entries
/// fit a file, the longest counts.
const LAYERS: &[&[&str]] = &[
    &["types"],
    &["geometry"],
    &["simd"],
    &["projection"],
    &["asset"],
    &["parallel"],
    &["state"],
    &["gpu"],
    &["broad_phase"],
    &["angles"],
    &["triangle_test"],
    &["manifolds"],
    &["solver"],
    &["sleep"],
    &["ccd"],
    &["force_scan"],
    &["integrate"],
    &["step"],
    &["queries"],
    &["testing"],
    &["plugin"],
    &["guide"],
    &["lib"],
];

/// No cycle joins two of these: the folders of the stages, and what their kernels share.
const APART: &[&str] = &[
    "angles",
    "broad_phase",
    "ccd",
    "force_scan",
    "gpu",
    "integrate",
    "manifolds",
    "sleep",
    "solver",
    "triangle_test",
];

/// The most files in one cycle, or in several that share files.
const LARGEST_CYCLE: usize = 9;

/// Whether imports of modules and re-exports of items below the file are uses as well.
const STRICT: bool = false;

#[test]
fn files_use_lower_layers_only() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let graph = Graph::read(&|path| std::fs::read_to_string(source.join(path)).ok(), STRICT);
    let rules = Rules {
        layers: LAYERS,
        apart: APART,
        largest_cycle: LARGEST_CYCLE,
    };
    let violations = rules.violations(&graph);
    assert!(
        violations.is_empty(),
        "{} violations:\n\n{}\n",
        violations.len(),
        violations.join("\n")
    );
}
