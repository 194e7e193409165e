//! Cycles in a graph.

use std::collections::{BTreeSet, HashMap, VecDeque};

/// The edges of a graph whose nodes are numbers.
pub type Edges = BTreeSet<(usize, usize)>;

/// The strongly connected components of more than one node, the largest first (Tarjan, "Depth-First Search and Linear
/// Graph Algorithms", 1972).
pub fn components(nodes: usize, edges: &Edges) -> Vec<Vec<usize>> {
    let mut search = Search {
        edges,
        index: vec![None; nodes],
        lowest: vec![0; nodes],
        on_stack: vec![false; nodes],
        stack: Vec::new(),
        visited: 0,
        found: Vec::new(),
    };
    for node in 0..nodes {
        if search.index[node].is_none() {
            search.visit(node);
        }
    }
    search.found.sort_by_key(|component| std::cmp::Reverse(component.len()));
    search.found
}

struct Search<'e> {
    edges: &'e Edges,
    /// When each node was visited.
    index: Vec<Option<usize>>,
    /// The earliest node on the stack that each one is known to reach.
    lowest: Vec<usize>,
    on_stack: Vec<bool>,
    stack: Vec<usize>,
    visited: usize,
    found: Vec<Vec<usize>>,
}

impl Search<'_> {
    fn visit(&mut self, node: usize) {
        let index = self.visited;
        self.visited += 1;
        self.index[node] = Some(index);
        self.lowest[node] = index;
        self.stack.push(node);
        self.on_stack[node] = true;
        for next in from(self.edges, node) {
            match self.index[next] {
                None => {
                    self.visit(next);
                    self.lowest[node] = self.lowest[node].min(self.lowest[next]);
                }
                Some(index) if self.on_stack[next] => self.lowest[node] = self.lowest[node].min(index),
                Some(_) => {}
            }
        }
        if self.lowest[node] == index {
            let start = self
                .stack
                .iter()
                .rposition(|&n| n == node)
                .expect("its component is on the stack");
            let component = self.stack.split_off(start);
            component.iter().for_each(|&n| self.on_stack[n] = false);
            if component.len() > 1 {
                self.found.push(component);
            }
        }
    }
}

/// Where the edges of a node lead.
fn from(edges: &Edges, node: usize) -> impl Iterator<Item = usize> {
    edges.range((node, 0)..=(node, usize::MAX)).map(|&(_, to)| to)
}

/// The shortest path from one node to another, or the shortest cycle if they are the same, with both ends.
pub fn shortest(edges: &Edges, start: usize, end: usize) -> Option<Vec<usize>> {
    let mut before = HashMap::new();
    let mut queue = VecDeque::from([start]);
    while let Some(node) = queue.pop_front() {
        for next in from(edges, node) {
            if before.contains_key(&next) {
                continue;
            }
            before.insert(next, node);
            queue.push_back(next);
            if next == end {
                let mut path = vec![end];
                let mut at = node;
                while at != start {
                    path.push(at);
                    at = before[&at];
                }
                path.push(start);
                path.reverse();
                return Some(path);
            }
        }
    }
    None
}

/// The shortest cycle through a node of `some` and one of `others`.
pub fn shortest_cycle(edges: &Edges, some: &[usize], others: &[usize]) -> Option<Vec<usize>> {
    let ends = some.iter().flat_map(|&a| others.iter().map(move |&b| (a, b)));
    let cycles = ends.filter_map(|(a, b)| {
        let mut cycle = shortest(edges, a, b)?;
        if a != b {
            cycle.extend(shortest(edges, b, a)?.into_iter().skip(1));
        }
        Some(cycle)
    });
    cycles.min_by_key(Vec::len)
}
