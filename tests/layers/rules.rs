//! The rules that a crate's files must keep.

use super::cycles::{Edges, components, shortest_cycle};
use super::graph::Graph;
use std::fmt::Write;

/// Files are named by prefixes, relative to the folder of sources: `a/b` stands for `a/b.rs` and all files below
/// `a/b/`, `a/mod.rs` for that file alone. If several prefixes fit a file, the longest counts.
pub struct Rules<'r> {
    /// From bottom to top. A file may use files of its own prefix and of lower layers.
    pub layers: &'r [&'r [&'r str]],
    /// No cycle joins two of these.
    pub apart: &'r [&'r str],
    /// The most files in one strongly connected component.
    pub largest_cycle: usize,
}

impl Rules<'_> {
    /// Describes every violation.
    pub fn violations(&self, graph: &Graph) -> Vec<String> {
        let mut violations = graph.errors.clone();
        self.check_order(graph, &mut violations);
        self.check_cycles(graph, &mut violations);
        violations
    }

    fn check_order(&self, graph: &Graph, violations: &mut Vec<String>) {
        let table = self.layers.iter().enumerate();
        let prefixes: Vec<(usize, &str)> = table
            .flat_map(|(i, layer)| layer.iter().map(move |&p| (i, p)))
            .collect();
        let place = |file: &str| {
            let fitting = prefixes.iter().filter(|(_, prefix)| fits(prefix, file));
            fitting.max_by_key(|(_, prefix)| prefix.len()).copied()
        };
        let places: Vec<Option<(usize, &str)>> = graph.files.iter().map(|file| place(file)).collect();
        for (file, place) in graph.files.iter().zip(&places) {
            if place.is_none() {
                violations.push(format!("{file}: not in the table of layers"));
            }
        }
        for prefix in &prefixes {
            if !places.contains(&Some(*prefix)) {
                violations.push(format!("`{}` in the table of layers: there is no such file", prefix.1));
            }
        }
        for (from, to) in graph.edges() {
            if let (Some((above, own)), Some((below, other))) = (places[from], places[to])
                && own != other
                && above <= below
            {
                let which = if above == below {
                    "the same layer as"
                } else {
                    "a higher layer than"
                };
                violations.push(format!(
                    "`{other}` is in {which} `{own}`:\n{}",
                    describe(graph, from, to)
                ));
            }
        }
    }

    fn check_cycles(&self, graph: &Graph, violations: &mut Vec<String>) {
        let edges: Edges = graph.edges().collect();
        for component in components(graph.files.len(), &edges) {
            if component.len() > self.largest_cycle {
                let mut files: Vec<&str> = component.iter().map(|&file| graph.files[file].as_str()).collect();
                files.sort_unstable();
                let cycle = describe_cycle(graph, &cycle(&edges, &component, &component));
                let (count, files) = (files.len(), files.join(" "));
                violations.push(format!("{count} files in one cycle: {files}; the shortest:\n{cycle}"));
            }
            let parts = self
                .apart
                .iter()
                .map(|prefix| (*prefix, part(graph, prefix, &component)));
            let parts: Vec<(&str, Vec<usize>)> = parts.filter(|(_, files)| !files.is_empty()).collect();
            let pairs = parts
                .iter()
                .enumerate()
                .flat_map(|(i, a)| parts[..i].iter().map(move |b| (a, b)));
            let cycles = pairs.map(|((_, some), (_, others))| cycle(&edges, some, others));
            if let Some(cycle) = cycles.min_by_key(Vec::len) {
                let names: Vec<&str> = parts.iter().map(|(prefix, _)| *prefix).collect();
                let (names, cycle) = (names.join(", "), describe_cycle(graph, &cycle));
                violations.push(format!("joined by cycles: {names}; the shortest:\n{cycle}"));
            }
        }
    }
}

/// The files of `component` that are of a prefix.
fn part(graph: &Graph, prefix: &str, component: &[usize]) -> Vec<usize> {
    component
        .iter()
        .copied()
        .filter(|&file| fits(prefix, &graph.files[file]))
        .collect()
}

/// Whether a prefix stands for a file.
fn fits(prefix: &str, file: &str) -> bool {
    let rest = file.strip_prefix(prefix);
    rest.is_some_and(|rest| rest.is_empty() || rest == ".rs" || rest.starts_with('/'))
}

/// `from -> to (item, line)`.
pub fn describe(graph: &Graph, from: usize, to: usize) -> String {
    let mut text = format!("  {} -> {}", graph.files[from], graph.files[to]);
    for used in &graph.uses[&(from, to)] {
        write!(text, " ({}, {})", used.path, used.line).expect("a string takes any text");
    }
    text
}

fn cycle(edges: &Edges, some: &[usize], others: &[usize]) -> Vec<usize> {
    shortest_cycle(edges, some, others).expect("a component has a path between any two of its files")
}

fn describe_cycle(graph: &Graph, cycle: &[usize]) -> String {
    let lines: Vec<String> = cycle.windows(2).map(|ends| describe(graph, ends[0], ends[1])).collect();
    lines.join("\n")
}
