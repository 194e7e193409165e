//! Loops: a boundary taken apart into openings, each a round of edges that visits no vertex twice.
//!
//! Openings may have vertices in common, as cracks that meet at a corner of a mesh. A cone over all their edges
//! together would span the faces between them.

use super::boundary::Chain;
use glam::{DVec3, Vec3};

/// At a vertex where more edges than this begin, the next one is taken without comparing. To compare all for each edge
/// that ends there would take time without bound.
const MAX_BRANCHES: usize = 64;

/// Not on the path.
const NONE: u32 = u32::MAX;

/// The loops of a boundary, each as its directed edges. Every edge is in one loop. Edges at which a boundary ends, as
/// that of faces that disagree may, are left as an open run.
///
/// At a vertex of several loops, an edge is followed by the one that turns back most sharply. So each loop is as thin
/// as possible, such as the two sides of a crack.
pub(super) fn loops(chain: &Chain, place: &impl Fn(u32) -> Vec3) -> Vec<Vec<[u32; 2]>> {
    let mut edges: Vec<[u32; 2]> = Vec::new();
    for (edge, times) in chain.edges() {
        edges.extend(std::iter::repeat_n(edge, times.unsigned_abs() as usize));
    }
    edges.sort_unstable();
    let mut vertices = edges.as_flattened().to_vec();
    vertices.sort_unstable();
    vertices.dedup();
    // From here on vertices are numbered as they are listed.
    for vertex in edges.as_flattened_mut() {
        *vertex = vertices.partition_point(|other| other < vertex) as u32;
    }
    let places: Vec<DVec3> = vertices.iter().map(|v| place(*v).as_dvec3()).collect();
    let mut left = Left::new(&edges, places);
    let mut on_path = vec![NONE; vertices.len()];
    let mut path: Vec<u32> = Vec::new();
    let mut found: Vec<Vec<[u32; 2]>> = Vec::new();
    let mut add = |path: &[u32], last: Option<u32>| {
        let ends = path.iter().skip(1).copied().chain(last);
        let pairs = path.iter().copied().zip(ends);
        let run: Vec<[u32; 2]> = pairs.map(|(u, v)| [u, v].map(|v| vertices[v as usize])).collect();
        if !run.is_empty() {
            found.push(run);
        }
    };
    for start in 0..vertices.len() as u32 {
        let mut at = start;
        while let Some(next) = left.take(at, path.last().copied()) {
            on_path[at as usize] = path.len() as u32;
            path.push(at);
            at = next;
            if on_path[at as usize] != NONE {
                let round = path.split_off(on_path[at as usize] as usize);
                round.iter().for_each(|v| on_path[*v as usize] = NONE);
                add(&round, Some(at));
            }
        }
        // What is left of the path has no way back.
        path.iter().for_each(|v| on_path[*v as usize] = NONE);
        add(&path, Some(at));
        path.clear();
    }
    found
}

/// The edges that are in no loop yet.
struct Left {
    /// For each vertex, the start of the edges that begin there; one more entry marks the end.
    starts: Vec<usize>,
    /// How many of them are left.
    counts: Vec<usize>,
    /// The ends of the edges, grouped by vertex; those that are left come first.
    ends: Vec<u32>,
    places: Vec<DVec3>,
}

impl Left {
    /// Edges sorted by the vertices where they begin.
    fn new(edges: &[[u32; 2]], places: Vec<DVec3>) -> Self {
        let mut counts = vec![0; places.len()];
        edges.iter().for_each(|[from, _]| counts[*from as usize] += 1);
        let mut starts = vec![0; places.len() + 1];
        for (i, count) in counts.iter().enumerate() {
            starts[i + 1] = starts[i] + count;
        }
        Self {
            starts,
            counts,
            ends: edges.iter().map(|[_, to]| *to).collect(),
            places,
        }
    }

    /// Takes an edge that begins at a vertex, and returns its end: the one that leads most nearly back to `from`.
    fn take(&mut self, at: u32, from: Option<u32>) -> Option<u32> {
        let at = at as usize;
        let count = self.counts[at];
        let ends = &mut self.ends[self.starts[at]..self.starts[at] + count];
        let last = count.checked_sub(1)?;
        let mut chosen = last;
        if let Some(from) = from.filter(|_| (2..=MAX_BRANCHES).contains(&count)) {
            let towards = |end: u32| (self.places[end as usize] - self.places[at]).normalize_or_zero();
            let back = towards(from);
            let turn = |i: &usize| back.dot(towards(ends[*i]));
            chosen = (0..count).max_by(|i, j| turn(i).total_cmp(&turn(j))).unwrap_or(last);
        }
        ends.swap(chosen, last);
        self.counts[at] = last;
        Some(ends[last])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(edges: &[[u32; 2]], places: &[Vec3]) -> Vec<Vec<[u32; 2]>> {
        let mut chain = Chain::default();
        edges.iter().for_each(|edge| chain.add(*edge, 1));
        let mut found = loops(&chain, &|v| places[v as usize]);
        found.iter_mut().for_each(|edges| edges.sort_unstable());
        found.sort_unstable();
        found
    }

    #[test]
    fn cracks_all_around_a_face_are_one_loop_each() {
        // A square, and the middles of its sides, which belong to the faces around it.
        let mut places = vec![Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y];
        for i in 0..4 {
            places.push(0.5 * (places[i] + places[(i + 1) % 4]) + Vec3::Z * 1e-3);
        }
        let sides = (0..4u32).flat_map(|i| {
            let (a, b, middle) = (i, (i + 1) % 4, 4 + i);
            [[a, b], [b, middle], [middle, a]]
        });
        let found = of(&sides.collect::<Vec<_>>(), &places);
        assert_eq!(found.len(), 4);
        for edges in &found {
            let middle = edges.iter().flatten().find(|v| **v >= 4).unwrap();
            assert!(edges.len() == 3 && edges.iter().flatten().filter(|v| *v == middle).count() == 2);
        }
    }

    #[test]
    fn holes_that_share_a_vertex_are_one_loop_each_and_no_vertex_is_there_twice() {
        let places: Vec<Vec3> = (0..5).map(|i| Vec3::new((i % 3) as f32, (i / 3) as f32, 0.0)).collect();
        let found = of(&[[0, 1], [1, 2], [2, 0], [0, 3], [3, 4], [4, 0]], &places);
        assert_eq!(found, [vec![[0, 1], [1, 2], [2, 0]], vec![[0, 3], [3, 4], [4, 0]]]);
    }

    #[test]
    fn a_boundary_without_a_way_back_stays_an_open_run() {
        let places: Vec<Vec3> = (0..4).map(|i| Vec3::X * i as f32).collect();
        let found = of(&[[0, 1], [1, 2], [2, 3]], &places);
        assert_eq!(found, [vec![[0, 1], [1, 2], [2, 3]]]);
    }

    #[test]
    fn many_edges_at_one_vertex_take_little_time() {
        let count = 200_000u32;
        let places: Vec<Vec3> = (0..=count).map(|i| Vec3::new(i as f32, (i % 7) as f32, 0.0)).collect();
        let edges: Vec<[u32; 2]> = (0..count / 2)
            .flat_map(|i| [[0, 2 * i + 1], [2 * i + 1, 2 * i + 2], [2 * i + 2, 0]])
            .collect();
        assert_eq!(of(&edges, &places).len(), count as usize / 2);
    }
}
