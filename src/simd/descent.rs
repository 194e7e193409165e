//! Down the trees of both meshes at once, to the pairs of clusters that may touch.
//!
//! Level by level, and on whichever side the nodes are larger: for each node of the first tree a list of nodes of the
//! second that it may touch. What is visited grows with the contact, and with the height of the trees.

use super::lanes::bits;
use super::tree::{Group, Node, Tree};

/// Memory kept between pairs, and the result.
#[derive(Default)]
pub struct Descent {
    /// Nodes of the first tree, ascending, each with its part of `list`.
    entries: Vec<Entry>,
    /// Places in `nodes`; those of an entry ascend by the node's number.
    list: Vec<u32>,
    /// Nodes of the second tree, each once.
    nodes: Vec<Node>,
    // The same one level below.
    next_entries: Vec<Entry>,
    next_list: Vec<u32>,
    next_nodes: Vec<Node>,
    masks: Vec<u32>,
    /// For each of `nodes` its place in `groups`.
    placed: Vec<u32>,
    /// Children, and where each lies in `next_nodes`.
    groups: Vec<(Group, [u32; 8])>,
}

struct Entry {
    node: Node,
    first: u32,
    end: u32,
}

/// No place.
const NONE: u32 = u32::MAX;

impl Descent {
    /// Fills the lists, and tells how often a node was compared with eight others.
    pub fn run(&mut self, a: &Tree, b: &Tree) -> u64 {
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

    /// The clusters of the first mesh, ascending, each with the places in [`Self::second`] of those of the second mesh that
    /// it may touch.
    pub fn pairs(&self) -> impl Iterator<Item = (u32, &[u32])> {
        self.entries
            .iter()
            .map(|entry| (entry.node.number, &self.list[entry.first as usize..entry.end as usize]))
    }

    /// Clusters of the second mesh, each once.
    pub fn second(&self) -> impl Iterator<Item = u32> {
        self.nodes.iter().map(|node| node.number)
    }

    fn open_first(&mut self, tree: &Tree, level: usize) {
        for entry in &self.entries {
            let list = &self.list[entry.first as usize..entry.end as usize];
            let group = tree.children(level, entry.node.number);
            self.masks.clear();
            self.masks
                .extend(list.iter().map(|&at| self.nodes[at as usize].meets(&group)));
            let any = self.masks.iter().fold(0, |any, mask| any | mask);
            for lane in bits(any) {
                let first = self.next_list.len() as u32;
                let met = list.iter().zip(&self.masks).filter(|(_, mask)| *mask >> lane & 1 == 1);
                self.next_list.extend(met.map(|(at, _)| *at));
                self.next_entries.push(Entry {
                    node: group.node(entry.node.number, lane),
                    first,
                    end: self.next_list.len() as u32,
                });
            }
        }
    }

    fn open_second(&mut self, tree: &Tree, level: usize) {
        self.next_nodes.clear();
        self.groups.clear();
        self.placed.clear();
        self.placed.resize(self.nodes.len(), NONE);
        for entry in &self.entries {
            let first = self.next_list.len() as u32;
            for &at in &self.list[entry.first as usize..entry.end as usize] {
                let number = self.nodes[at as usize].number;
                let place = &mut self.placed[at as usize];
                if *place == NONE {
                    *place = self.groups.len() as u32;
                    self.groups.push((tree.children(level, number), [NONE; 8]));
                }
                let (group, children) = &mut self.groups[*place as usize];
                for lane in bits(entry.node.meets(group)) {
                    let child = &mut children[lane];
                    if *child == NONE {
                        *child = self.next_nodes.len() as u32;
                        self.next_nodes.push(group.node(number, lane));
                    }
                    self.next_list.push(*child);
                }
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
    use super::super::tree::Way;
    use super::*;
    use crate::asset::CollisionMesh;
    use crate::geometry::{TriMesh, shapes};
    use glam::{Mat3, Quat, Vec3};

    /// Tests of nodes, and pairs of clusters left, of two bodies `apart` from centre to centre, summed over some poses.
    fn cost(mesh: &TriMesh, apart: f32, slabs: bool) -> [u64; 2] {
        let baked = CollisionMesh::new(mesh);
        let lanes = baked.lanes();
        let mut descent = Descent::default();
        let mut cost = [0; 2];
        for pose in 0..20 {
            let angle = pose as f32;
            let rotation = Mat3::from_quat(Quat::from_axis_angle(Vec3::new(0.6, 0.8, 0.0), angle));
            let way = Quat::from_axis_angle(Vec3::new(0.0, 0.6, 0.8), 2.0 * angle) * Vec3::X * apart;
            let back = rotation.transpose();
            let [a, b] =
                [(false, back, -(back * way)), (true, rotation, way)].map(|(second, rotation, translation)| {
                    let way = Way {
                        rotation,
                        translation,
                        axis: Vec3::ZERO,
                        least: 0.0,
                    };
                    Tree::new(lanes, second, Vec3::ONE, way, 4.0e-6, slabs)
                });
            cost[0] += descent.run(&a, &b);
            cost[1] += descent.pairs().map(|(_, others)| others.len() as u64).sum::<u64>();
        }
        cost
    }

    /// Balls of radius 0.5 that overlap by a height at which the rim is as many triangles long, whatever their size.
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
