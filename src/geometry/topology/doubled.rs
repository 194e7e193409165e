//! Doubled faces have the corners of another face. Some programs write each face twice, once for each side, or export
//! what was pasted over itself.
//!
//! Doubled faces collide as they are. But if the mesh is closed without them, they count neither for what it encloses
//! nor for which way its faces point.

use super::boundary::MAX_OPENING;
use super::{Faces, Topology};
use crate::geometry::edges::is_collapsed;
use glam::Vec3;
use std::collections::HashMap;

impl Faces<'_> {
    /// Pairs of a triangle and the first one of the input with the same corners, in any order of corners. Pairs are in
    /// the order of the input.
    pub fn doubled(&self, welded: &[u32]) -> Vec<[usize; 2]> {
        // The first face with these corners in the input, by its number here.
        let mut order: Vec<usize> = (0..self.triangles.len()).collect();
        order.sort_unstable_by_key(|&t| self.face_ids[t]);
        let mut known: HashMap<[u32; 3], usize> = HashMap::with_capacity(order.len());
        let mut doubled = Vec::new();
        for t in order {
            let mut corners = self.triangles[t].map(|v| welded[v as usize]);
            corners.sort_unstable();
            let first = *known.entry(corners).or_insert(t);
            if first != t && !is_collapsed(corners) {
                doubled.push([t, first]);
            }
        }
        doubled
    }

    /// The doubled faces of a mesh that is closed or nearly so without them, by their indices in the input; none of
    /// another mesh, such as a sheet with two sides, which encloses nothing without the second.
    pub(super) fn find_twins(&self, topology: &Topology) -> Vec<[u32; 2]> {
        let welded = &topology.welded;
        let doubled = self.doubled(welded);
        let twins: Vec<[u32; 2]> = doubled.iter().map(|pair| pair.map(|t| self.face_ids[t])).collect();
        if twins.is_empty() {
            return twins;
        }
        let counted = Faces { twins: &twins, ..*self };
        let (edges, counts) = counted.edges(welded);
        let is_closed = !counts.iter().any(|count| count.is_boundary());
        let is_nearly = || {
            let boundary = counted.boundary(&edges, &counts, welded, topology.tolerance);
            boundary.openings.iter().map(|opening| opening.area).sum::<f64>() <= MAX_OPENING * counted.area()
        };
        if is_closed || is_nearly() { twins } else { Vec::new() }
    }

    /// Whether a triangle counts.
    pub(super) fn counts(&self, t: usize) -> bool {
        self.twins.is_empty() || self.first_of(self.face_ids[t]).is_none()
    }

    /// The triangles that count.
    pub(super) fn counted(&self) -> impl Iterator<Item = usize> {
        (0..self.triangles.len()).filter(|&t| self.counts(t))
    }

    /// The face with which a face counts, if it does not count itself; both by their indices in the input.
    fn first_of(&self, face: u32) -> Option<u32> {
        let at = self.twins.binary_search_by_key(&face, |twin| twin[0]);
        at.ok().map(|at| self.twins[at][1])
    }

    /// Pairs of a triangle that does not count and the one with which it does.
    pub fn twin_triangles(&self) -> Vec<[usize; 2]> {
        if self.twins.is_empty() {
            return Vec::new();
        }
        let triangle_of: HashMap<u32, usize> = self.face_ids.iter().copied().zip(0..).collect();
        let pairs = self.twins.iter().map(|twin| twin.map(|face| triangle_of[&face]));
        pairs.collect()
    }

    /// The reverse of each triangle that does not count. The two cancel in every sum over the surface.
    pub fn reversed_twins(&self, welded: &[u32]) -> Vec<[Vec3; 3]> {
        let reversed = |[t, _]: [usize; 2]| {
            let [a, b, c] = self.placed(t, welded);
            [a, c, b]
        };
        self.twin_triangles().into_iter().map(reversed).collect()
    }

    /// Turns each triangle that does not count, so that it is wound as the one with which it does.
    pub(super) fn turn_twins(&self, welded: &[u32], turn: &mut [bool]) {
        for [t, first] in self.twin_triangles() {
            let [own, other] = [t, first].map(|t| self.triangles[t].map(|v| welded[v as usize]));
            let [a, b, c] = own;
            let is_alike = [[a, b, c], [b, c, a], [c, a, b]].contains(&other);
            turn[t] = turn[first] ^ !is_alike;
        }
    }
}
