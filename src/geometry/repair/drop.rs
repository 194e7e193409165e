//! Faces that add nothing: those of zero area, and those that are there twice.

use super::Work;
use super::surface::{CountedEdges, Surface, Uses};
use crate::geometry::edges::is_collapsed;
use crate::geometry::mesh::is_degenerate;
use crate::geometry::union_find::UnionFind;
use std::collections::{BTreeMap, HashMap};

impl Surface {
    /// Drops faces of zero area and duplicates. `split` tells that T-junctions are closed afterwards.
    pub fn drop_faces(&mut self, split: bool, work: &mut Work) {
        (work.kept_zero_area, work.kept_back_to_back) = (0, 0);
        self.drop_zero_area(split, work);
        self.drop_duplicates(work);
    }

    /// A face of zero area that collapsed adds nothing. One with three different corners is a sliver, which may fill a
    /// T-junction: it is dropped if that opens no edge, or if edges are split afterwards.
    fn drop_zero_area(&mut self, split: bool, work: &mut Work) {
        let welded = self.welded();
        let corners = self.welded_faces(&welded);
        let mut counted = CountedEdges::of(&corners, self.vertices.len());
        let mut is_dropped = vec![false; self.faces.len()];
        for (number, (&own, &face)) in corners.iter().zip(&self.faces).enumerate() {
            let has_area = |corners: [u32; 3]| !is_degenerate(corners.map(|v| self.vertices[v as usize]));
            if has_area(own) && has_area(face) {
                continue;
            }
            let odd = |(edge, _): &(u32, i32)| counted.uses[*edge as usize].is_odd();
            is_dropped[number] = is_collapsed(own) || split || counted.of_face(number, own).filter(odd).count() >= 2;
            if !is_dropped[number] {
                work.kept_zero_area += 1;
                continue;
            }
            let sides: Vec<(u32, i32)> = counted.of_face(number, own).collect();
            for (edge, balance) in sides {
                counted.uses[edge as usize].faces -= 1;
                counted.uses[edge as usize].balance -= balance;
            }
        }
        work.dropped_zero_area += self.drop_where(&is_dropped);
    }

    /// Keeps one of several faces with the same corners, unless that opens the mesh: then keeps two, back to back.
    fn drop_duplicates(&mut self, work: &mut Work) {
        let welded = self.welded();
        let corners = self.welded_faces(&welded);
        let mut first: HashMap<[u32; 3], usize> = HashMap::with_capacity(corners.len());
        // The faces of each group, in their order; groups in the order of their first faces.
        let mut groups: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (number, &face) in corners.iter().enumerate().filter(|(_, face)| !is_collapsed(**face)) {
            let mut sorted = face;
            sorted.sort_unstable();
            let first = *first.entry(sorted).or_insert(number);
            if first != number {
                groups.entry(first).or_insert_with(|| vec![first]).push(number);
            }
        }
        if groups.is_empty() {
            return;
        }
        let counted = CountedEdges::of(&corners, self.vertices.len());
        let mut is_dropped = vec![false; self.faces.len()];
        let groups: Vec<Group> = groups
            .into_values()
            .map(|faces| Group::of(faces, &corners, &counted))
            .collect();
        for patch in patches(&groups, &counted) {
            // An edge is sound if its faces close the surface there, and agree.
            let is_sound = |uses: Uses| !uses.is_odd() && uses.balance == 0;
            let mut left: BTreeMap<u32, Uses> = BTreeMap::new();
            for group in patch.iter().map(|&own| &groups[own]) {
                for &face in group.faces.iter().filter(|&&face| face != group.kept) {
                    for (edge, balance) in counted.of_face(face, corners[face]) {
                        let uses = left.entry(edge).or_insert(counted.uses[edge as usize]);
                        uses.faces -= 1;
                        uses.balance -= balance;
                    }
                }
            }
            let faults_before = left.keys().filter(|&&edge| !is_sound(counted.uses[edge as usize]));
            let faults_after = left.values().filter(|&&uses| !is_sound(uses));
            let drop_all = faults_after.count() <= faults_before.count();
            for group in patch.iter().map(|&own| &groups[own]) {
                let keep_two = !drop_all && group.is_even();
                work.kept_back_to_back += usize::from(keep_two);
                for &face in &group.faces {
                    is_dropped[face] = face != group.kept && !(keep_two && face == group.second);
                }
            }
        }
        work.dropped_duplicates += self.drop_where(&is_dropped);
    }

    /// Drops faces and returns how many.
    fn drop_where(&mut self, is_dropped: &[bool]) -> usize {
        let before = self.faces.len();
        let mut dropped = is_dropped.iter();
        self.faces.retain(|_| dropped.next() != Some(&true));
        before - self.faces.len()
    }
}

/// Faces with the same corners.
struct Group {
    faces: Vec<usize>,
    /// The one to keep: the first that is wound like most of them.
    kept: usize,
    /// The one to keep besides: the first that is wound oppositely, or else the second.
    second: usize,
    edges: [u32; 3],
}

impl Group {
    fn of(faces: Vec<usize>, corners: &[[u32; 3]], counted: &CountedEdges) -> Self {
        let edges = counted.edges.of_triangles[faces[0]];
        let winding = |face: usize| {
            let mut sides = counted.of_face(face, corners[face]);
            sides
                .find(|(edge, _)| *edge == edges[0])
                .map_or(0, |(_, balance)| balance)
        };
        let sum: i32 = faces.iter().map(|&face| winding(face)).sum();
        let is_of_most = |face: &usize| sum == 0 || winding(*face) * sum > 0;
        let kept = faces.iter().copied().find(is_of_most).unwrap_or(faces[0]);
        let mut others = faces.iter().copied().filter(|&face| face != kept);
        let opposite = others.clone().find(|&face| winding(face) != winding(kept));
        let second = opposite.or_else(|| others.next()).unwrap_or(kept);
        Self {
            faces,
            kept,
            second,
            edges,
        }
    }

    fn is_even(&self) -> bool {
        self.faces.len().is_multiple_of(2)
    }
}

/// Groups that hang together across edges.
fn patches(groups: &[Group], counted: &CountedEdges) -> Vec<Vec<usize>> {
    let mut of_edges = vec![u32::MAX; counted.uses.len()];
    let mut joined = UnionFind::new(groups.len());
    for (own, group) in (0..).zip(groups) {
        for edge in group.edges {
            let other = &mut of_edges[edge as usize];
            if *other == u32::MAX {
                *other = own;
            }
            joined.join(own, *other);
        }
    }
    let mut patches: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for own in 0..groups.len() {
        patches.entry(joined.root(own as u32)).or_default().push(own);
    }
    patches.into_values().collect()
}
