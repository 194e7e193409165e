//! Slivers: faces of zero area, which are no triangles of a mesh but keep it closed. They fill T-junctions, where the edge
//! of one triangle lies along the edges of several others.

use std::collections::HashMap;

/// The triangles that meet across slivers.
#[derive(Default)]
pub struct AcrossSlivers {
    /// For each edge beside slivers, its group.
    groups: HashMap<[u32; 2], usize>,
    /// For each group, the triangles at the edges beside its slivers.
    triangles: Vec<Vec<usize>>,
}

impl AcrossSlivers {
    /// Groups of slivers that have edges in common. `slivers` are given by their vertices.
    pub fn new(slivers: impl Iterator<Item = [u32; 3]>) -> Self {
        let mut groups: HashMap<[u32; 2], usize> = HashMap::new();
        // The group with which a group has been joined, or itself.
        let mut joined: Vec<usize> = Vec::new();
        fn first(joined: &[usize], mut group: usize) -> usize {
            while joined[group] != group {
                group = joined[group];
            }
            group
        }
        for [a, b, c] in slivers {
            let own = joined.len();
            joined.push(own);
            for edge in [sorted([a, b]), sorted([b, c]), sorted([c, a])] {
                let group = *groups.entry(edge).or_insert(own);
                let (p, q) = (first(&joined, group), first(&joined, own));
                joined[p.max(q)] = p.min(q);
            }
        }
        for group in groups.values_mut() {
            *group = first(&joined, *group);
        }
        Self {
            groups,
            triangles: vec![Vec::new(); joined.len()],
        }
    }

    /// Tells that a triangle has this edge. Nothing happens if the edge is not beside slivers.
    pub fn add(&mut self, edge: [u32; 2], triangle: usize) {
        if let Some(&group) = self.groups.get(&sorted(edge)) {
            self.triangles[group].push(triangle);
        }
    }

    /// The triangles that meet at an edge, itself among them; empty if it is not beside slivers.
    pub fn at(&self, edge: [u32; 2]) -> &[usize] {
        match self.groups.get(&sorted(edge)) {
            Some(&group) => &self.triangles[group],
            None => &[],
        }
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
        let mut across = AcrossSlivers::new([[7, 8, 9], [0, 1, 2], [3, 2, 1]].into_iter());
        for (edge, triangle) in [([1, 0], 10), ([3, 1], 11), ([2, 3], 12), ([8, 7], 13), ([4, 5], 14)] {
            across.add(edge, triangle);
        }
        assert_eq!(across.at([0, 1]), [10, 11, 12]);
        assert_eq!(across.at([2, 3]), [10, 11, 12]);
        assert_eq!(across.at([7, 8]), [13]);
        assert!(across.at([4, 5]).is_empty());
    }
}
