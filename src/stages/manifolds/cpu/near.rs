//! Pairs of triangles that are near each other, down the trees of both meshes.

use super::side::{Side, Triangle};
use crate::geometry::Aabb;
use crate::geometry::cluster::CLUSTER;
use crate::stages::angles::PAD;
use crate::stages::mesh_arena::{Points, points};
use crate::stages::triangle_test::cpu::descent::Descent;
use crate::stages::triangle_test::cpu::lanes::{bits, boxes_meet, lane_of, splat};
use crate::stages::triangle_test::cpu::placed::unit_of;
use crate::stages::triangle_test::cpu::tree::{Tree, Way};
use glam::{Mat3, Vec3};

/// Meshes of so many clusters at most have nodes too round for slabs to be worth their time.
const COARSE: usize = 300;

/// How the bodies of a pair lie to each other, in single precision.
pub struct Setting {
    /// Turns the second body's axes into the first's.
    pub rotation: Mat3,
    /// From the first body's centre of mass to the second's, in the first's axes, metres.
    pub translation: Vec3,
    /// Sum of the bounding radii, metres.
    pub size: f32,
}

/// Memory kept between pairs.
#[derive(Default)]
pub struct Near {
    descent: Descent,
    /// Clusters of the second body, as the descent lists them.
    seconds: Vec<Placed>,
}

/// Eight triangles.
struct Placed {
    triangles: [Triangle; CLUSTER],
    min: Points,
    max: Points,
    /// Lanes that count.
    lanes: u32,
}

impl Near {
    /// Calls `found` for every pair of triangles whose boxes, of which some are a little large, are no farther apart than
    /// `reach` and both meet `region`.
    pub fn run(
        &mut self,
        sides: &[Side; 2],
        setting: &Setting,
        reach: f32,
        region: Option<Aabb>,
        mut found: impl FnMut(&Triangle, &Triangle),
    ) {
        let reach = reach + PAD * setting.size;
        let [tree_a, tree_b] = trees(sides, setting, reach);
        self.descent.run(&tree_a, &tree_b);
        let place = |side: &Side, cluster: u32| {
            let mut placed = Placed::new(side, cluster);
            if let Some(region) = region {
                let meet = boxes_meet(placed.min, placed.max, splat(region.min), splat(region.max));
                placed.lanes &= meet.to_bitmask();
            }
            placed
        };
        self.seconds.clear();
        self.seconds
            .extend(self.descent.second().map(|cluster| place(&sides[1], cluster)));
        for (cluster, others) in self.descent.pairs() {
            let a = place(&sides[0], cluster);
            for &other in others {
                let b = &self.seconds[other as usize];
                for i in bits(a.lanes) {
                    let (low, high) = (lane_of(&a.min, i) - reach, lane_of(&a.max, i) + reach);
                    let meet = boxes_meet(splat(low), splat(high), b.min, b.max).to_bitmask();
                    for j in bits(meet & b.lanes) {
                        found(&a.triangles[i], &b.triangles[j]);
                    }
                }
            }
        }
    }
}

impl Placed {
    fn new(side: &Side, cluster: u32) -> Self {
        let first = cluster as usize * CLUSTER;
        let count = side.features.triangles.len().min(first + CLUSTER) - first;
        let mut triangles = [Triangle::default(); CLUSTER];
        let mut boxes = [Aabb::EMPTY; CLUSTER];
        for (lane, (triangle, aabb)) in triangles.iter_mut().zip(&mut boxes).enumerate().take(count) {
            *triangle = side.triangle((first + lane) as u32);
            *aabb = Aabb::around(triangle.corners.map(|p| p.as_vec3()));
        }
        Self {
            triangles,
            min: points(|lane| boxes[lane].min),
            max: points(|lane| boxes[lane].max),
            lanes: (1u32 << count) - 1,
        }
    }
}

/// Both trees, whose nodes are found to touch if they are no farther apart than `reach`.
fn trees<'a>(sides: &[Side<'a>; 2], setting: &Setting, reach: f32) -> [Tree<'a>; 2] {
    let unit = unit_of(setting.size);
    let clusters = sides.each_ref().map(|side| side.slot.lanes.clusters.len());
    let slabs = clusters[0].max(clusters[1]) > COARSE;
    let back = setting.rotation.transpose();
    let ways = [
        (back, -(back * setting.translation)),
        (setting.rotation, setting.translation),
    ];
    [0, 1].map(|i| {
        let (rotation, translation) = ways[i];
        let way = Way {
            rotation,
            translation: unit * translation,
            // No support axis, and nothing beyond it.
            axis: Vec3::ZERO,
            least: f32::NEG_INFINITY,
        };
        Tree::new(
            &sides[i].slot.lanes,
            i == 1,
            unit * sides[i].scale,
            way,
            unit * reach,
            slabs,
        )
    })
}
