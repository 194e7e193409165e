//! The boundary of an open mesh: its openings, and what closes them.

use super::loops::loops;
use super::{Count, Faces, Topology};
use crate::geometry::Aabb;
use crate::geometry::box_tree::BoxTree;
use crate::geometry::cluster::compact_order;
use crate::geometry::edges::Edges;
use crate::geometry::weld::size;
use glam::{DVec3, Vec3};
use std::collections::{BTreeMap, HashMap};
use std::f64::consts::PI;

/// The largest opening of a nearly closed mesh, relative to the area of the mesh.
///
/// A few missing faces of a fine mesh take less, and so does the neck of a bottle. The mouth of a glass takes a tenth,
/// and the end of a pipe ten times as long as wide a fortieth: what lies in those must not be pushed out through the
/// wall.
pub const MAX_OPENING: f64 = 0.02;

/// The largest area of all openings of a nearly closed mesh together, relative to the area of the mesh. A face that
/// hangs together with no other is an opening of its own size.
const MAX_OPENINGS: f64 = 0.2;

/// What closes an open mesh.
pub struct Closure {
    /// Triangles that close it.
    pub caps: Vec<[Vec3; 3]>,
    /// The area of all openings, relative to the area of the mesh.
    pub share: f64,
    /// How far the volume may be off: that of a half ball over each opening.
    pub uncertain_volume: f64,
}

/// The boundary of a mesh.
#[derive(Default)]
pub(super) struct Boundary {
    /// Triangles that close the mesh, in cluster order.
    caps: Vec<[Vec3; 3]>,
    /// The vertices of the caps that close T-junctions.
    slivers: Vec<[u32; 3]>,
    /// The openings, in the order of their smallest vertex.
    pub openings: Vec<Opening>,
    /// The edges of the openings, directed as their faces run.
    pub open_edges: Vec<[u32; 2]>,
    /// The vertices that lie on an edge of a face without being one of its corners.
    pub t_junctions: Vec<u32>,
    /// Whether faces disagree about an edge that is no boundary edge. Caps would not close such a mesh.
    disagrees: bool,
}

/// A loop of boundary edges that are no T-junctions.
#[derive(Clone, Copy)]
pub(super) struct Opening {
    /// The first of its vertices.
    pub vertex: u32,
    /// The area of the cone that closes it, squared mesh units.
    pub area: f64,
}

/// Directed edges, each with the number of caps that have to run backward along it. Opposite edges cancel.
#[derive(Default)]
pub(super) struct Chain(BTreeMap<[u32; 2], i32>);

impl Chain {
    pub fn add(&mut self, [from, to]: [u32; 2], times: i32) {
        let (edge, times) = if from < to {
            ([from, to], times)
        } else {
            ([to, from], -times)
        };
        *self.0.entry(edge).or_default() += times;
    }

    /// The edges that do not cancel, and how often each is there.
    pub fn edges(&self) -> impl Iterator<Item = ([u32; 2], i32)> + '_ {
        let open = self.0.iter().filter(|(_, times)| **times != 0);
        open.map(|(&[u, v], &times)| if times > 0 { ([u, v], times) } else { ([v, u], -times) })
    }
}

impl Boundary {
    /// The area of the largest opening.
    pub fn largest(&self) -> f64 {
        self.openings.iter().map(|opening| opening.area).fold(0.0, f64::max)
    }

    /// The caps of a nearly closed mesh of this area, and the vertices of the caps in T-junctions; none for other
    /// meshes.
    pub fn caps_if_nearly_closed(self, area: f64) -> (Vec<[Vec3; 3]>, Vec<[u32; 3]>) {
        let all: f64 = self.openings.iter().map(|opening| opening.area).sum();
        if self.disagrees || self.largest() > MAX_OPENING * area || all > MAX_OPENINGS * area {
            return Default::default();
        }
        (self.caps, self.slivers)
    }
}

impl Faces<'_> {
    /// The boundary of the mesh; empty if it is closed.
    ///
    /// The faces' own boundary is a sum of directed edges in which as many end at each vertex as begin. It is closed in
    /// two steps. Where vertices of the boundary lie on one of its edges, slivers split the edge there: then the two
    /// sides of a T-junction cancel. What is left is taken apart into loops. Each is an opening, closed by a cone from
    /// the mean of its vertices.
    pub(super) fn boundary(&self, edges: &Edges, counts: &[Count], welded: &[u32], tolerance: f32) -> Boundary {
        let mut chain = Vec::new();
        let mut disagrees = false;
        for (&ends, count) in edges.ends.iter().zip(counts) {
            if count.is_boundary() {
                chain.push((ends, count.balance));
            } else {
                disagrees |= count.balance != 0;
            }
        }
        if chain.is_empty() {
            return Boundary {
                disagrees,
                ..Boundary::default()
            };
        }
        let place = |v: u32| self.vertices[welded[v as usize] as usize];
        let tolerance = f64::from(tolerance) * size(self.aabb());
        let Split {
            open,
            t_junctions,
            slivers,
            mut caps,
        } = split_at_vertices(&chain, &place, tolerance);
        let openings = close(&open, &place, &mut caps);
        let centroids: Vec<Vec3> = caps.iter().map(|cap| cap.iter().map(|p| *p / 3.0).sum()).collect();
        Boundary {
            caps: compact_order(&centroids)
                .into_iter()
                .map(|i| caps[i as usize])
                .collect(),
            slivers,
            openings,
            open_edges: open.edges().map(|(edge, _)| edge).collect(),
            t_junctions,
            disagrees,
        }
    }

    /// What closes an open mesh of consistent winding, however large its openings are; `None` for other meshes.
    pub fn closure(&self, topology: &Topology) -> Option<Closure> {
        let (edges, counts) = self.edges(&topology.welded);
        let boundary = self.boundary(&edges, &counts, &topology.welded, topology.tolerance);
        if boundary.disagrees || boundary.caps.is_empty() {
            return None;
        }
        let half_ball = |area: f64| 2.0 / 3.0 * PI * (area / PI).powf(1.5);
        let areas = || boundary.openings.iter().map(|opening| opening.area);
        let caps = || {
            boundary
                .caps
                .iter()
                .copied()
                .chain(self.reversed_twins(&topology.welded))
        };
        Some(Closure {
            share: areas().sum::<f64>() / self.area(),
            uncertain_volume: areas().map(half_ball).sum(),
            caps: caps().collect(),
        })
    }
}

/// A boundary without its T-junctions.
#[derive(Default)]
struct Split {
    /// What is left of the boundary.
    open: Chain,
    /// The vertices on edges.
    t_junctions: Vec<u32>,
    /// The vertices of the triangles that split the edges there.
    slivers: Vec<[u32; 3]>,
    /// The corners of these triangles, wound so that they close the mesh.
    caps: Vec<[Vec3; 3]>,
}

/// Splits edges of the boundary where its vertices lie on them.
fn split_at_vertices(edges: &[([u32; 2], i32)], place: &impl Fn(u32) -> Vec3, tolerance: f64) -> Split {
    let ends = |edge: [u32; 2]| edge.map(place);
    let middles: Vec<Vec3> = edges
        .iter()
        .map(|(edge, _)| ends(*edge).iter().map(|p| *p * 0.5).sum())
        .collect();
    let tree = BoxTree::of_scattered(&middles, |i| Aabb::around(ends(edges[i].0)));
    let mut vertices: Vec<u32> = edges.iter().flat_map(|(edge, _)| *edge).collect();
    vertices.sort_unstable();
    vertices.dedup();
    // For each edge, the vertices on it and where along it they are.
    let mut on_edges: HashMap<usize, Vec<(f64, u32)>> = HashMap::new();
    let mut split = Split::default();
    for &vertex in &vertices {
        let p = place(vertex).as_dvec3();
        let is_near = |_: &_, b: &Aabb| {
            let outside = (b.min.as_dvec3() - p).max(p - b.max.as_dvec3());
            outside.max_element() <= tolerance
        };
        let mut found = false;
        tree.visit(&mut found, is_near, |found, number| {
            let edge = edges[number].0;
            if edge.contains(&vertex) {
                return;
            }
            let [u, v] = ends(edge).map(|end| end.as_dvec3());
            let along = v - u;
            let at = (p - u).dot(along) / along.length_squared();
            if at > 0.0 && at < 1.0 && (u + along * at).distance(p) <= tolerance {
                on_edges.entry(number).or_default().push((at, vertex));
                *found = true;
            }
        });
        if found {
            split.t_junctions.push(vertex);
        }
    }
    for (number, &([u, v], times)) in (0..).zip(edges) {
        let mut on_edge = on_edges.remove(&number).unwrap_or_default();
        on_edge.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut from = u;
        for (_, vertex) in on_edge {
            // The sliver runs backward along the rest of the edge, and forward along its two parts.
            split.slivers.push([v, from, vertex]);
            add_cap(&mut split.caps, [v, from, vertex].map(place), times);
            split.open.add([from, vertex], times);
            from = vertex;
        }
        split.open.add([from, v], times);
    }
    split
}

/// Closes each loop of the boundary with a cone from the mean of its vertices.
fn close(open: &Chain, place: &impl Fn(u32) -> Vec3, caps: &mut Vec<[Vec3; 3]>) -> Vec<Opening> {
    let mut openings = Vec::new();
    for edges in loops(open, place) {
        let sum: DVec3 = edges.iter().map(|[u, _]| place(*u).as_dvec3()).sum();
        let middle = (sum / edges.len() as f64).as_vec3();
        let mut area = 0.0;
        for &[u, v] in &edges {
            let cap = [place(v), place(u), middle];
            let [a, b, c] = cap.map(|p| p.as_dvec3());
            area += (b - a).cross(c - a).length() * 0.5;
            caps.push(cap);
        }
        let vertex = edges.iter().map(|[u, _]| *u).min().unwrap_or(0);
        openings.push(Opening { vertex, area });
    }
    openings.sort_by_key(|opening| opening.vertex);
    openings
}

/// Adds a triangle `times` times, or its reverse if `times` is negative.
fn add_cap(caps: &mut Vec<[Vec3; 3]>, [a, b, c]: [Vec3; 3], times: i32) {
    let cap = if times > 0 { [a, b, c] } else { [a, c, b] };
    caps.extend(std::iter::repeat_n(cap, times.unsigned_abs() as usize));
}
