//! Tests of the reader and of the rules, on small crates in memory.

use super::graph::Graph;
use super::rules::Rules;

type Files<'f> = &'f [(&'f str, &'f str)];

fn read(files: Files, strict: bool) -> Graph {
    let text = |path: &str| {
        files
            .iter()
            .find(|(name, _)| *name == path)
            .map(|(_, text)| (*text).to_owned())
    };
    Graph::read(&text, strict)
}

/// Each use as `from -> to: path, line`, in order.
fn uses(files: Files) -> Vec<String> {
    let graph = read(files, false);
    assert_eq!(graph.errors, Vec::<String>::new());
    described(&graph)
}

fn described(graph: &Graph) -> Vec<String> {
    let describe = |(&(from, to), uses): (&(usize, usize), &Vec<super::graph::Use>)| {
        let (from, to) = (graph.files[from].clone(), graph.files[to].clone());
        uses.iter()
            .map(|used| format!("{from} -> {to}: {}, {}", used.path, used.line))
            .collect::<Vec<_>>()
    };
    let mut uses: Vec<String> = graph.uses.iter().flat_map(describe).collect();
    uses.sort();
    uses
}

const LIB: &str = "mod a; pub mod shapes;";

/// A folder that re-exports its files' items.
const SHAPES: Files = &[
    ("lib.rs", LIB),
    (
        "shapes/mod.rs",
        "mod ball;\nmod cube;\npub use ball::{Ball, Kind as BallKind, bounce};\npub use {cube::*, ball::Kind::*};",
    ),
    (
        "shapes/ball.rs",
        "pub struct Ball; pub enum Kind { Soft, Hard } pub fn bounce() {}",
    ),
    (
        "shapes/cube.rs",
        "pub struct Cube; pub const CORNERS: usize = 8; pub trait Roll { fn roll(); }",
    ),
];

fn shapes_used_by(a: &str) -> Vec<String> {
    let files: Vec<_> = SHAPES.iter().copied().chain([("a.rs", a)]).collect();
    uses(&files)
}

#[test]
fn modules_and_reexports_from_below_use_nothing() {
    assert_eq!(shapes_used_by(""), [""; 0]);
}

#[test]
fn imports_lead_through_reexports_globs_and_renames_to_the_definition() {
    assert_eq!(
        shapes_used_by("use crate::{shapes::{Ball as B, Cube}};\nuse super::shapes::BallKind;\nfn f(_: B, _: Cube) {}"),
        [
            "a.rs -> shapes/ball.rs: crate::shapes::Ball, 1",
            "a.rs -> shapes/ball.rs: super::shapes::BallKind, 2",
            "a.rs -> shapes/cube.rs: crate::shapes::Cube, 1",
        ]
    );
    assert_eq!(
        shapes_used_by("use crate::shapes::{Hard, bounce as _};"),
        [
            "a.rs -> shapes/ball.rs: crate::shapes::Hard, 1",
            "a.rs -> shapes/ball.rs: crate::shapes::bounce, 1"
        ]
    );
}

#[test]
fn paths_in_code_are_followed() {
    for code in [
        "fn f() { crate::shapes::bounce() }",
        "fn f() { super::shapes::bounce(); }",
        "fn f() { self::super::shapes::bounce(); }",
    ] {
        let [only] = &shapes_used_by(code)[..] else {
            panic!("{code}")
        };
        assert!(
            only.starts_with("a.rs -> shapes/ball.rs: ") && only.ends_with("shapes::bounce, 1"),
            "{only}"
        );
    }
    assert_eq!(
        shapes_used_by(
            "use crate::shapes;\nfn f() -> [u8; shapes::CORNERS] { match shapes::BallKind::Hard { _ => [0; 8] } }"
        ),
        [
            "a.rs -> shapes/ball.rs: shapes::BallKind::Hard, 2",
            "a.rs -> shapes/cube.rs: shapes::CORNERS, 2",
        ]
    );
    assert_eq!(
        shapes_used_by("use crate::shapes as s;\nimpl s::Roll for u8 { fn roll() { <Self as s::Roll>::roll() } }"),
        ["a.rs -> shapes/cube.rs: s::Roll, 2"]
    );
    for code in [
        "struct S(Vec<Option<crate::shapes::Ball>>);",
        "fn f() { <crate::shapes::Ball as Default>::default(); }",
        "fn f() { f::<crate::shapes::Ball>(); }",
        "fn f() { match 1 { crate::shapes::Ball => {} } }",
        "fn f<T: Into<crate::shapes::Ball>>() {}",
    ] {
        assert_eq!(shapes_used_by(code), ["a.rs -> shapes/ball.rs: crate::shapes::Ball, 1"]);
    }
}

#[test]
fn names_in_blocks_hold_in_these_blocks() {
    assert_eq!(
        shapes_used_by("fn f() { use crate::shapes as std; { std::bounce(); } }\nfn g() { std::mem::take(&mut 1); }"),
        ["a.rs -> shapes/ball.rs: std::bounce, 1"]
    );
}

#[test]
fn blocks_look_around_themselves() {
    for code in [
        "fn f() { use std::mem; { use super::shapes::bounce; fn g() { mem::drop(bounce()); } } }",
        "fn f() { mod inner { pub fn g() { super::super::shapes::bounce() } } }",
        "use crate::shapes as s; fn f() { const C: u8 = 1; s::bounce(); }",
    ] {
        let found = shapes_used_by(code);
        assert!(
            found.len() == 1 && found[0].starts_with("a.rs -> shapes/ball.rs: "),
            "{found:?}"
        );
    }
}

#[test]
fn a_module_and_a_function_may_have_one_name() {
    let files: Files = &[
        ("lib.rs", "mod a; mod bake;"),
        ("bake/mod.rs", "mod mesh; pub mod plane; pub use mesh::plane;"),
        ("bake/mesh.rs", "pub fn plane() {}"),
        ("bake/plane.rs", "pub fn lift() {}"),
        ("a.rs", "use crate::bake::plane;\nfn f() { plane(); plane::lift(); }"),
    ];
    assert_eq!(
        uses(files),
        [
            "a.rs -> bake/mesh.rs: crate::bake::plane, 1",
            "a.rs -> bake/plane.rs: plane::lift, 2",
        ]
    );
    let only_the_module = [
        files[0],
        files[1],
        files[2],
        files[3],
        ("a.rs", "use crate::bake::plane::{self};"),
    ];
    assert_eq!(uses(&only_the_module), [""; 0]);
}

#[test]
fn globs_use_their_module_and_what_is_named_through_them() {
    assert_eq!(
        shapes_used_by("use crate::shapes::*;\nfn f(bounce: u8) -> u8 { bounce }\nfn g() { let _ = Cube; }"),
        [
            "a.rs -> shapes/cube.rs: Cube, 3",
            "a.rs -> shapes/mod.rs: crate::shapes, 1"
        ]
    );
    assert_eq!(
        shapes_used_by("use crate::shapes::BallKind::*;\nfn f() { let _ = Hard; }"),
        ["a.rs -> shapes/ball.rs: crate::shapes::BallKind, 1"]
    );
}

#[test]
fn paths_in_calls_of_macros_count() {
    assert_eq!(
        shapes_used_by("fn f() { assert!(crate::shapes::CORNERS == 8, \"{}\", 1); }"),
        ["a.rs -> shapes/cube.rs: crate::shapes::CORNERS, 1"]
    );
    assert_eq!(
        shapes_used_by("odd! { a => [crate::shapes::bounce; ] }\n#[require(crate::shapes::Cube)]\nstruct S;"),
        [
            "a.rs -> shapes/ball.rs: crate::shapes::bounce, 1",
            "a.rs -> shapes/cube.rs: crate::shapes::Cube, 2",
        ]
    );
}

#[test]
fn tests_and_comments_use_nothing() {
    assert_eq!(
        shapes_used_by(
            "//! [`crate::shapes::Ball`]
             /// [`Cube`](crate::shapes::Cube)
             pub(in crate::a) struct S { #[cfg(test)] ball: crate::shapes::Ball }
             #[cfg(all(test, unix))] use crate::shapes::Ball;
             #[cfg(test)] mod tests { use super::*; use crate::shapes::*; fn f() { bounce(); } }"
        ),
        [""; 0]
    );
    assert_eq!(
        shapes_used_by("#[cfg(not(test))] use crate::shapes::Ball;"),
        ["a.rs -> shapes/ball.rs: crate::shapes::Ball, 1"]
    );
}

#[test]
fn what_is_defined_in_the_file_or_outside_is_no_use() {
    assert_eq!(
        shapes_used_by(
            "use std::fmt; use glam::*; use inner::Ball;
             mod inner { pub struct Ball; pub fn f() -> super::Ball { Ball } }
             fn f(x: Vec3) -> fmt::Result { let _ = Ball; inner::f(); Ok(()) }"
        ),
        [""; 0]
    );
}

#[test]
fn names_that_a_macro_may_define_belong_to_the_file_that_calls_it() {
    let files: Files = &[
        ("lib.rs", "mod low; mod table; mod user;"),
        (
            "low.rs",
            "macro_rules! list { ($($name:ident)*) => { $(pub struct $name;)* pub const COUNT: usize = 2; } }
             pub(crate) use list;",
        ),
        ("table.rs", "use crate::low::list; use glam::*;\nlist! { Row Column }"),
        ("user.rs", "use crate::table::{COUNT, Row};"),
    ];
    assert_eq!(
        uses(files),
        [
            "table.rs -> low.rs: crate::low::list, 1",
            "user.rs -> table.rs: crate::table::COUNT, 1",
            "user.rs -> table.rs: crate::table::Row, 1",
        ]
    );
}

#[test]
fn reexports_from_elsewhere_are_uses() {
    let files: Files = &[
        (
            "lib.rs",
            "mod settings; mod solver; mod user; pub mod prelude { pub use crate::solver::Rule; }",
        ),
        ("settings.rs", "pub use crate::solver::Rule;"),
        ("solver.rs", "pub enum Rule { Average }"),
        ("user.rs", "use crate::settings::Rule::Average;\nuse crate::prelude::*;"),
    ];
    assert_eq!(
        uses(files),
        [
            "settings.rs -> solver.rs: crate::solver::Rule, 1",
            "user.rs -> lib.rs: crate::prelude, 2",
            "user.rs -> solver.rs: crate::settings::Rule::Average, 1",
        ]
    );
}

#[test]
fn when_strict_every_import_and_reexport_counts() {
    let files: Vec<_> = SHAPES.iter().copied().chain([("a.rs", "use crate::shapes;")]).collect();
    let strict = described(&read(&files, true));
    assert!(
        strict.contains(&"a.rs -> shapes/mod.rs: crate::shapes, 1".to_owned()),
        "{strict:?}"
    );
    assert!(
        strict.contains(&"shapes/mod.rs -> shapes/ball.rs: ball::Ball, 3".to_owned()),
        "{strict:?}"
    );
}

#[test]
fn imports_in_a_cycle_end() {
    let files: Files = &[
        ("lib.rs", "mod a; mod b;"),
        ("a.rs", "pub use crate::b::*; pub use fastrand; pub struct A;"),
        ("b.rs", "pub use crate::a::*; fn f(_: A) { fastrand::u8(..); }"),
    ];
    assert_eq!(uses(files), ["b.rs -> a.rs: A, 1"]);
}

#[test]
fn what_cannot_be_read_or_followed_is_reported() {
    let files: Files = &[
        ("lib.rs", "mod a; mod gone; mod odd;"),
        (
            "a.rs",
            "use crate::b::C;\nfn f() { crate::a::g::h(); }\nodd! { => crate::c }",
        ),
        ("odd.rs", "fn {"),
    ];
    let mut errors = read(files, false).errors;
    errors.sort();
    assert_eq!(
        errors[..3],
        [
            "a.rs:1: cannot follow `crate::b::C`",
            "a.rs:2: cannot follow `crate::a::g::h`",
            "a.rs:3: cannot follow `crate::c`",
        ]
    );
    assert_eq!(errors[3], "gone/mod.rs: this file is missing");
    assert!(errors[4].starts_with("odd.rs:1: "), "{}", errors[4]);
}

/// A cycle of three files, closed by an inline path, and a file below them.
const CYCLE: Files = &[
    ("lib.rs", "mod low; mod one; mod two;"),
    ("low.rs", "pub struct Low;"),
    ("one/mod.rs", "pub mod cpu; pub mod gpu; pub use cpu::run;"),
    (
        "one/cpu.rs",
        "use crate::low::Low;\nuse super::gpu::Kernel;\npub fn run(_: Low, _: Kernel) {}",
    ),
    ("one/gpu.rs", "use crate::two::Two;\npub struct Kernel(Two);"),
    ("two.rs", "pub struct Two;\n\nfn f() { crate::one::run(); }"),
];

fn violations(layers: &[&[&str]], apart: &[&str], largest_cycle: usize) -> Vec<String> {
    let rules = Rules {
        layers,
        apart,
        largest_cycle,
    };
    rules.violations(&read(CYCLE, false))
}

#[test]
fn cycles_are_found() {
    let layers: &[&[&str]] = &[&["low", "one", "two", "lib"]];
    let order = violations(layers, &[], 3).len();
    let found = &violations(layers, &[], 2)[order..];
    let cycle = "the shortest cycle:
  one/cpu.rs -> one/gpu.rs (super::gpu::Kernel, 2)
  one/gpu.rs -> two.rs (crate::two::Two, 1)
  two.rs -> one/cpu.rs (crate::one::run, 3)";
    let [found] = found else { panic!("{found:?}") };
    let lines: Vec<&str> = found.lines().collect();
    assert_eq!(
        lines[0],
        "3 files in one cycle: one/cpu.rs one/gpu.rs two.rs; the shortest:"
    );
    for line in cycle.lines().skip(1) {
        assert!(lines.contains(&line), "{found}");
    }
    let found = &violations(layers, &["one", "two", "low"], 3)[order..];
    let [found] = found else { panic!("{found:?}") };
    assert!(
        found.starts_with("joined by cycles: one, two; the shortest:\n"),
        "{found}"
    );
    for line in cycle.lines().skip(1) {
        assert!(found.contains(line), "{found}");
    }
}

#[test]
fn the_order_of_layers_holds() {
    assert_eq!(
        violations(&[&["low"], &["one", "two"], &["lib"]], &[], 9),
        [
            "`two` is in the same layer as `one`:\n  one/gpu.rs -> two.rs (crate::two::Two, 1)",
            "`one` is in the same layer as `two`:\n  two.rs -> one/cpu.rs (crate::one::run, 3)",
        ]
    );
    assert_eq!(
        violations(&[&["low"], &["two"], &["one"], &["lib"]], &[], 9),
        ["`one` is in a higher layer than `two`:\n  two.rs -> one/cpu.rs (crate::one::run, 3)"]
    );
    // The longest entry holds: the kernels below, all else of the folder above.
    assert_eq!(
        violations(&[&["one/gpu.rs", "low"], &["one"], &["two"], &["lib"]], &[], 9),
        ["`two` is in a higher layer than `one/gpu.rs`:\n  one/gpu.rs -> two.rs (crate::two::Two, 1)"]
    );
}

#[test]
fn the_table_of_layers_is_complete_and_has_nothing_else() {
    assert_eq!(
        violations(&[&["low"], &["two"], &["on"], &["lib", "three"]], &[], 9),
        [
            "one/mod.rs: not in the table of layers",
            "one/cpu.rs: not in the table of layers",
            "one/gpu.rs: not in the table of layers",
            "`on` in the table of layers: there is no such file",
            "`three` in the table of layers: there is no such file",
        ]
    );
}
