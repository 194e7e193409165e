//! Slivers: faces of zero area, which are no triangles of a mesh but keep it closed. They fill T-junctions, where the
//! edge of one triangle lies along the edges of several others.

use super::union_find::UnionFind;
use std::collections::HashMap;

/// The triangles that meet across slivers.
#[derive(Default)]
pub struct AcrossSlivers {
    /// For each edge beside slivers, its group.
    groups: HashMap<[u32; 2], u32>,
    /// For each group, the triangles at the edges beside its slivers.
    triangles: HashMap<u32, Vec<usize>>,
}

impl AcrossSlivers {
    /// Groups of slivers that have edges in common. `slivers` are given by their vertices.
    pub fn new(slivers: &[[u32; 3]]) -> Self {
        let mut groups: HashMap<[u32; 2], u32> = HashMap::new();
        let mut joined = UnionFind::new(slivers.len());
        for (own, &[a, b, c]) in (0..).zip(slivers) {
            for edge in [[a, b], [b, c], [c, a]] {
                joined.join(own, *groups.entry(sorted(edge)).or_insert(own));
            }
        }
        for group in groups.values_mut() {
            *group = joined.root(*group);
        }
        Self {
            groups,
            triangles: HashMap::new(),
        }
    }

    /// Tells that a triangle has this edge. Nothing happens if the edge is not beside slivers.
    pub fn add(&mut self, edge: [u32; 2], triangle: usize) {
        if let Some(&group) = self.groups.get(&sorted(edge)) {
            self.triangles.entry(group).or_default().push(triangle);
        }
    }

    /// The triangles that meet at an edge, the edge's own among them; empty if the edge is not beside slivers.
    pub fn at(&self, edge: [u32; 2]) -> &[usize] {
        let group = self.groups.get(&sorted(edge));
        let triangles = group.and_then(|group| self.triangles.get(group));
        triangles.map_or(&[], Vec::as_slice)
    }
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_meet_across_all_slivers_of_a_group() {
        // Two slivers side by side, and one elsewhere.
        let mut across = AcrossSlivers::new(&[[7, 8, 9], [0, 1, 2], [3, 2, 1]]);
        for (edge, triangle) in [([1, 0], 10), ([3, 1], 11), ([2, 3], 12), ([8, 7], 13), ([4, 5], 14)] {
            across.add(edge, triangle);
        }
        assert_eq!(across.at([0, 1]), [10, 11, 12]);
        assert_eq!(across.at([2, 3]), [10, 11, 12]);
        assert_eq!(across.at([7, 8]), [13]);
        assert!(across.at([4, 5]).is_empty());
    }
}
