//! T-junctions: a vertex that lies on an edge of a face without being its corner. The face is split there.

use super::Work;
use super::surface::{CountedEdges, Surface};
use crate::geometry::Aabb;
use crate::geometry::box_tree::BoxTree;
use glam::Vec3;
use std::collections::HashMap;

/// A split moves the two halves of an edge by the tolerance at most, so that vertices that were just too far may be
/// near enough then. More rounds than this are never needed for exact T-junctions.
const MAX_ROUNDS: usize = 8;
/// A vertex this close to an edge lies on it, whatever the tolerance, because rounding moves it as much. Relative to
/// the diagonal of the mesh's bounding box.
const ROUNDING: f64 = 1.0e-9;

/// A vertex on an edge: the part of the edge before it, and its number.
type OnEdge = (f64, u32);

impl Surface {
    /// Splits the boundary edges of faces at the boundary vertices that lie on them. Returns the number of splits.
    pub fn split(&mut self, work: &mut Work) -> usize {
        let before = work.split_edges;
        for _ in 0..MAX_ROUNDS {
            let splits = self.split_once();
            if splits == 0 {
                break;
            }
            work.split_edges += splits;
        }
        work.split_edges - before
    }

    fn split_once(&mut self) -> usize {
        let welded = self.welded();
        let corners = self.welded_faces(&welded);
        let counted = CountedEdges::of(&corners, self.vertices.len());
        let mut on_edges = self.vertices_on_edges(&counted);
        if on_edges.is_empty() {
            return 0;
        }
        let mut splits = 0;
        let mut faces = Vec::with_capacity(self.faces.len() + 2 * on_edges.len());
        for on_edge in on_edges.values_mut() {
            on_edge.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        }
        for (number, (&own, &face)) in corners.iter().zip(&self.faces).enumerate() {
            let start = faces.len();
            faces.push(face);
            for (side, (edge, direction)) in counted.of_face(number, own).enumerate() {
                let Some(on_edge) = on_edges.get(&edge) else {
                    continue;
                };
                // A corner of the face itself may lie on its edge if the face is thin.
                let mut between: Vec<u32> = on_edge.iter().map(|at| at.1).filter(|v| !own.contains(v)).collect();
                if direction < 0 {
                    between.reverse();
                }
                splits += between.len();
                split_side(&mut faces, start, [face[side], face[(side + 1) % 3]], &between);
            }
        }
        self.faces = faces;
        splits
    }

    /// For each boundary edge, the vertices of the boundary that lie on it.
    fn vertices_on_edges(&self, counted: &CountedEdges) -> HashMap<u32, Vec<OnEdge>> {
        let ends = &counted.edges.ends;
        let boundary: Vec<u32> = (0..)
            .zip(&counted.uses)
            .filter(|(_, uses)| uses.is_odd())
            .map(|(edge, _)| edge)
            .collect();
        let mut on_edges: HashMap<u32, Vec<OnEdge>> = HashMap::new();
        if boundary.is_empty() {
            return on_edges;
        }
        let tolerance = self.distance().max(ROUNDING * self.size());
        let place = |v: u32| self.vertices[v as usize];
        let middle = |edge: u32| ends[edge as usize].map(place).iter().map(|p| *p * 0.5).sum();
        let middles: Vec<Vec3> = boundary.iter().map(|&edge| middle(edge)).collect();
        let tree = BoxTree::of_scattered(&middles, |i| Aabb::around(ends[boundary[i] as usize].map(place)));
        let mut vertices: Vec<u32> = boundary.iter().flat_map(|&edge| ends[edge as usize]).collect();
        vertices.sort_unstable();
        vertices.dedup();
        for vertex in vertices {
            let p = place(vertex).as_dvec3();
            let is_near = |_: &_, b: &Aabb| {
                let outside = (b.min.as_dvec3() - p).max(p - b.max.as_dvec3());
                outside.max_element() <= tolerance
            };
            tree.visit(&mut on_edges, is_near, |on_edges, i| {
                let edge = boundary[i];
                let [u, v] = ends[edge as usize];
                if u == vertex || v == vertex {
                    return;
                }
                let (u, v) = (place(u).as_dvec3(), place(v).as_dvec3());
                let along = v - u;
                let at = (p - u).dot(along) / along.length_squared();
                if at > 0.0 && at < 1.0 && (u + along * at).distance(p) <= tolerance {
                    on_edges.entry(edge).or_default().push((at, vertex));
                }
            });
        }
        on_edges
    }
}

/// Splits one side of a face at the vertices on it, given in the order in which the face runs along them. The faces
/// from `start` on are the parts of the face so far; one of them has the whole side.
pub(super) fn split_side(faces: &mut Vec<[u32; 3]>, start: usize, [from, to]: [u32; 2], between: &[u32]) {
    let sides = |face: &[u32; 3]| (0..3).find(|&k| face[k] == from && face[(k + 1) % 3] == to);
    let found = (start..faces.len()).find_map(|i| sides(&faces[i]).map(|k| (i, k)));
    let Some((i, side)) = found else { return };
    let tip = faces[i][(side + 2) % 3];
    // A vertex in the narrow corner of a face may lie on two of its sides.
    let mut between = between.iter().copied().filter(|&vertex| vertex != tip).peekable();
    let Some(&first) = between.peek() else { return };
    faces[i] = [from, first, tip];
    while let Some(vertex) = between.next() {
        faces.push([vertex, between.peek().copied().unwrap_or(to), tip]);
    }
}
