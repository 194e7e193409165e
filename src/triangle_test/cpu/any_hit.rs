//! Any-hit search: whether two bodies touch. It stops at the first certain intersection.
//!
//! Both trees are traversed depth-first, the pair of nodes with the nearest centres first: where bodies overlap, their
//! surfaces probably cross. Pairs of triangles that single precision cannot decide are kept for the end.

use super::candidates::any_triangles_hit;
use super::pair_setup::PairSetup;
use super::placed::{PlacedCluster, PlacedClusters};
use crate::geometry::cluster::CLUSTER;
use crate::simd::lanes::{Simd, bits};
use crate::simd::tree::{Group, Tree};

/// Memory kept between pairs.
#[derive(Default)]
pub struct Search {
    caches: [TreeCache; 2],
    /// Pairs of nodes that may touch, the most promising one last.
    stack: Vec<[NodeRef; 2]>,
    /// Pairs of triangles that single precision cannot decide.
    unsure: Vec<[u32; 2]>,
}

/// In place of a group index: the root, which belongs to no group.
const ROOT: u32 = u32::MAX;

/// A node of a tree: a lane of an opened group, or the root.
#[derive(Clone, Copy)]
struct NodeRef {
    group: u32,
    lane: u8,
    /// Height above the clusters, which are on level 0.
    level: u8,
}

/// The opened groups and placed clusters of one tree, each stored once.
#[derive(Default)]
struct TreeCache {
    groups: Vec<OpenedGroup>,
    placed: PlacedClusters,
    /// Index of each group in `groups`. Entries of earlier pairs are detected by comparing the group's id, so nothing
    /// needs clearing.
    group_at: Vec<u32>,
    /// Index of each cluster in `placed`, checked alike.
    cluster_at: Vec<u32>,
    /// For each level, the number of groups on the levels below.
    below: Vec<u32>,
}

struct OpenedGroup {
    /// Index among the groups of all levels.
    id: u32,
    parent: u32,
    group: Group,
}

impl Search {
    /// Whether two triangles intersect. Pairs that single precision cannot decide are passed to `sure`, until it
    /// returns true.
    #[inline(always)]
    pub fn any<S: Simd>(&mut self, setup: &PairSetup<S>, sure: impl FnMut(&[u32; 2]) -> bool) -> bool {
        let trees = setup.trees();
        let [a, b] = &mut self.caches;
        a.start(&trees[0], setup.a.lanes.clusters.len());
        b.start(&trees[1], setup.b.lanes.clusters.len());
        self.stack.clear();
        self.unsure.clear();
        self.stack.push([0, 1].map(|end| NodeRef {
            group: ROOT,
            lane: 0,
            level: trees[end].height() as u8,
        }));
        while let Some(at) = self.stack.pop() {
            if at.iter().all(|at| at.level == 0) {
                if self.any_clusters_hit(setup, at) {
                    return true;
                }
            } else {
                self.open(&trees, at);
            }
        }
        self.unsure.iter().any(sure)
    }

    #[inline(always)]
    fn open<S: Simd>(&mut self, trees: &[Tree<S>; 2], at: [NodeRef; 2]) {
        let larger = trees[0].size(at[0].level.into()) >= trees[1].size(at[1].level.into());
        let end = usize::from(at[1].level > 0 && (at[0].level == 0 || !larger));
        let other = match self.caches[1 - end].groups.get(at[1 - end].group as usize) {
            Some(OpenedGroup { parent, group, .. }) => group.node(*parent, at[1 - end].lane.into()),
            None => trees[1 - end].root(),
        };
        let group = self.caches[end].children(&trees[end], at[end]);
        let opened = &self.caches[end].groups[group as usize].group;
        let meet = trees[end].met_by(&other, opened);
        if meet == 0 {
            return;
        }
        let distances = trees[end].distances(&other, opened);
        let mut nearest = [(f32::INFINITY, 0); CLUSTER];
        let mut count = 0;
        for lane in bits(meet) {
            // Insertion sort, farthest first.
            let mut i = count;
            while i > 0 && nearest[i - 1].0 < distances[lane] {
                nearest[i] = nearest[i - 1];
                i -= 1;
            }
            nearest[i] = (distances[lane], lane as u8);
            count += 1;
        }
        for &(_, lane) in &nearest[..count] {
            let mut next = at;
            next[end] = NodeRef {
                group,
                lane,
                level: at[end].level - 1,
            };
            self.stack.push(next);
        }
    }

    /// Whether triangles of two clusters certainly intersect. Undecided pairs are kept.
    #[inline(always)]
    fn any_clusters_hit<S: Simd>(&mut self, setup: &PairSetup<S>, at: [NodeRef; 2]) -> bool {
        let [a, b] = &mut self.caches;
        let (a, new) = a.cluster(at[0]);
        if let Some(cluster) = new {
            setup.place_a(a, cluster, setup.a.filter.lanes(cluster));
        }
        let (b, new) = b.cluster(at[1]);
        if let Some(cluster) = new {
            setup.place_b(b, cluster, setup.b.filter.lanes(cluster));
        }
        any_triangles_hit(setup.simd, [a, b], &setup.pair_scale, &mut self.unsure)
    }
}

impl TreeCache {
    fn start<S: Simd>(&mut self, tree: &Tree<S>, clusters: usize) {
        self.groups.clear();
        self.placed.clear();
        self.below.clear();
        let mut groups = 0;
        for level in 0..tree.height() {
            self.below.push(groups);
            groups += tree.groups(level) as u32;
        }
        if self.group_at.len() < groups as usize {
            self.group_at.resize(groups as usize, 0);
        }
        if self.cluster_at.len() < clusters {
            self.cluster_at.resize(clusters, 0);
        }
    }

    fn number(&self, at: NodeRef) -> u32 {
        let group = self.groups.get(at.group as usize);
        group.map_or(0, |group| group.parent * CLUSTER as u32) + u32::from(at.lane)
    }

    /// Index of a node's children in `groups`.
    #[inline(always)]
    fn children<S: Simd>(&mut self, tree: &Tree<S>, at: NodeRef) -> u32 {
        let (number, level) = (self.number(at), usize::from(at.level) - 1);
        let id = self.below[level] + number;
        let place = &mut self.group_at[id as usize];
        if self.groups.get(*place as usize).is_none_or(|opened| opened.id != id) {
            *place = self.groups.len() as u32;
            self.groups.push(OpenedGroup {
                id,
                parent: number,
                group: tree.children(level, number),
            });
        }
        *place
    }

    /// The slot of a placed cluster, and the cluster's number if it has not been placed yet.
    fn cluster(&mut self, at: NodeRef) -> (&mut PlacedCluster, Option<u32>) {
        let number = self.number(at);
        let known = &mut self.cluster_at[number as usize];
        let first = number * CLUSTER as u32;
        let placed = self.placed.get(*known as usize);
        if placed.is_none_or(|placed| placed.first != first) {
            *known = self.placed.len() as u32;
            (self.placed.push(), Some(number))
        } else {
            (&mut self.placed[*known as usize], None)
        }
    }
}
