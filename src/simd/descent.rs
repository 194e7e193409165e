//! Simultaneous traversal of the trees of two meshes, to find the pairs of clusters that may touch.
//!
//! The traversal goes level by level, and each time descends in the tree with the larger nodes. It keeps, for each node
//! of the first tree, a list of the nodes of the second tree that may touch it. The number of visited nodes grows with
//! the size of the contact and with the height of the trees.

use super::lanes::{Simd, bits, each_lane, push_some, set_lanes};
use super::tree::{Group, Node, Tree};

/// The result of a traversal. It is reused from pair to pair to avoid allocations.
#[derive(Default)]
pub struct Descent {
    /// Nodes of the first tree, ascending, each with a range of `list`.
    entries: Vec<Entry>,
    /// Indices into `nodes`. Those of an entry are in ascending order of the node's number.
    list: Vec<u32>,
    /// The unique nodes of the second tree.
    nodes: Vec<Node>,
    // Entries, list and nodes of the level below.
    next_entries: Vec<Entry>,
    next_list: Vec<u32>,
    next_nodes: Vec<Node>,
    masks: Vec<u32>,
    /// For each of `nodes`, its index in `groups`.
    group_of_node: Vec<u32>,
    groups: Vec<Opened>,
}

/// The children of a node of the second tree.
struct Opened {
    group: Group,
    /// Lanes of the children that are in `next_nodes`, and their indices there.
    listed: u32,
    children: [u32; 8],
}

struct Entry {
    node: Node,
    first: u32,
    end: u32,
}

/// No index.
const NONE: u32 = u32::MAX;

impl Descent {
    /// Traverses both trees. Returns the number of tests of one node against eight others.
    #[inline(always)]
    pub fn run<S: Simd>(&mut self, a: &Tree<S>, b: &Tree<S>) -> u64 {
        self.entries.clear();
        self.entries.push(Entry {
            node: a.root(),
            first: 0,
            end: 1,
        });
        self.list.clear();
        self.list.push(0);
        self.nodes.clear();
        self.nodes.push(b.root());
        let (mut level_a, mut level_b) = (a.height(), b.height());
        let mut tests = 0;
        while (level_a, level_b) != (0, 0) && !self.entries.is_empty() {
            tests += self.list.len() as u64;
            self.next_list.clear();
            self.next_entries.clear();
            if level_b == 0 || (level_a > 0 && a.size(level_a) >= b.size(level_b)) {
                level_a -= 1;
                self.open_first(a, level_a);
            } else {
                level_b -= 1;
                self.open_second(b, level_b);
                std::mem::swap(&mut self.nodes, &mut self.next_nodes);
            }
            std::mem::swap(&mut self.entries, &mut self.next_entries);
            std::mem::swap(&mut self.list, &mut self.next_list);
        }
        tests
    }

    /// The clusters of the first mesh, ascending. Each comes with the clusters of the second mesh that may touch it, as
    /// indices into [`Self::second`].
    pub fn pairs(&self) -> impl Iterator<Item = (u32, &[u32])> {
        self.entries
            .iter()
            .map(|entry| (entry.node.number, &self.list[entry.first as usize..entry.end as usize]))
    }

    /// The clusters of the second mesh that occur in [`Self::pairs`].
    pub fn second(&self) -> impl Iterator<Item = u32> {
        self.nodes.iter().map(|node| node.number)
    }

    #[inline(always)]
    fn open_first<S: Simd>(&mut self, tree: &Tree<S>, level: usize) {
        for entry in &self.entries {
            let list = &self.list[entry.first as usize..entry.end as usize];
            let group = tree.children(level, entry.node.number);
            self.masks.clear();
            let mut any = 0;
            for &at in list {
                let mask = tree.met_by(&self.nodes[at as usize], &group);
                self.masks.push(mask);
                any |= mask;
            }
            for lane in bits(any) {
                // Written without branches, which processors would mispredict.
                let first = self.next_list.len();
                self.next_list.resize(first + list.len(), 0);
                let (met, mut count) = (&mut self.next_list[first..], 0);
                for (at, mask) in list.iter().zip(&self.masks) {
                    met[count] = *at;
                    count += (mask >> lane & 1) as usize;
                }
                self.next_list.truncate(first + count);
                self.next_entries.push(Entry {
                    node: group.node(entry.node.number, lane),
                    first: first as u32,
                    end: self.next_list.len() as u32,
                });
            }
        }
    }

    #[inline(always)]
    fn open_second<S: Simd>(&mut self, tree: &Tree<S>, level: usize) {
        self.next_nodes.clear();
        self.groups.clear();
        self.group_of_node.clear();
        self.group_of_node.resize(self.nodes.len(), NONE);
        for entry in &self.entries {
            let first = self.next_list.len() as u32;
            for &at in &self.list[entry.first as usize..entry.end as usize] {
                let number = self.nodes[at as usize].number;
                let index = &mut self.group_of_node[at as usize];
                if *index == NONE {
                    *index = self.groups.len() as u32;
                    self.groups.push(Opened {
                        group: tree.children(level, number),
                        listed: 0,
                        children: [NONE; 8],
                    });
                }
                let Opened {
                    group,
                    listed,
                    children,
                } = &mut self.groups[*index as usize];
                let met = tree.met_by(&entry.node, group);
                for lane in bits(met & !*listed) {
                    children[lane] = self.next_nodes.len() as u32;
                    self.next_nodes.push(group.node(number, lane));
                }
                *listed |= met;
                let lanes = set_lanes(met);
                push_some(&mut self.next_list, each_lane(|k| children[lanes[k] as usize]), met);
            }
            let end = self.next_list.len() as u32;
            if end > first {
                self.next_entries.push(Entry {
                    node: entry.node,
                    first,
                    end,
                });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::level::baseline;
    use super::super::tree::RelativePose;
    use super::*;
    use crate::asset::CollisionMesh;
    use crate::geometry::{TriMesh, shapes};
    use glam::{Mat3, Quat, Vec3};

    /// The number of node tests and the number of remaining cluster pairs, summed over 20 poses of two copies of a
    /// mesh. `distance` is that of their centres.
    fn cost(mesh: &TriMesh, distance: f32, slabs: bool) -> [u64; 2] {
        let baked = CollisionMesh::new(mesh);
        let lanes = baked.lanes();
        let mut descent = Descent::default();
        let mut cost = [0; 2];
        for pose in 0..20 {
            let angle = pose as f32;
            let rotation = Mat3::from_quat(Quat::from_axis_angle(Vec3::new(0.6, 0.8, 0.0), angle));
            let offset = Quat::from_axis_angle(Vec3::new(0.0, 0.6, 0.8), 2.0 * angle) * Vec3::X * distance;
            let back = rotation.transpose();
            let [a, b] =
                [(false, back, -(back * offset)), (true, rotation, offset)].map(|(second, rotation, translation)| {
                    let relative = RelativePose {
                        rotation,
                        translation,
                        axis: Vec3::ZERO,
                        min_height: 0.0,
                    };
                    Tree::new(baseline(), lanes, second, Vec3::ONE, relative, 4.0e-6, slabs)
                });
            cost[0] += descent.run(&a, &b);
            cost[1] += descent.pairs().map(|(_, others)| others.len() as u64).sum::<u64>();
        }
        cost
    }

    /// The cost of two balls of radius 0.5. Their overlap is such that the contact is the same number of triangles long
    /// for any subdivision.
    fn cost_of_balls(subdivisions: u32, slabs: bool) -> [u64; 2] {
        let overlap = 0.03 * 4f32.powi(4 - subdivisions as i32);
        cost(&shapes::ball(0.5, subdivisions), 1.0 - overlap, slabs)
    }

    #[test]
    fn sixteen_times_the_triangles_cost_less_than_twice_as_much() {
        let [coarse, fine] = [4, 6].map(|subdivisions| cost_of_balls(subdivisions, true));
        assert!(coarse[0] > 1000 && coarse[1] > 500, "{coarse:?}");
        for (coarse, fine) in coarse.into_iter().zip(fine) {
            assert!(fine < 2 * coarse, "{coarse} and {fine}");
        }
    }

    #[test]
    fn boxes_alone_would_cost_more_the_finer_the_meshes() {
        let [with, without] = [true, false].map(|slabs| cost_of_balls(6, slabs)[1]);
        assert!(without > 2 * with, "{with} {without}");
    }

    #[test]
    fn bodies_far_apart_cost_one_test() {
        assert_eq!(cost(&shapes::ball(0.5, 3), 5.0, true), [20, 0]);
    }
}
