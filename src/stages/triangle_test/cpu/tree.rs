//! Nodes of the trees of two meshes, and whether they may touch.

use super::lanes::{Rows, dot, each, lane_of, mul, splat, sub};
use crate::stages::mesh_arena::{MeshLanes, Points};
use glam::{Mat3, Vec3};
use wide::f32x8;

/// Eight nodes of either tree: their boxes along the first body's axes and along the second's, their slabs in the
/// first's. Everything is in the pair's unit and about the first body's centre, but boxes along the second body's axes
/// are about its own.
pub struct Group {
    center: [Points; 2],
    half: [Points; 2],
    slab: Slabs,
}

/// See [`SlabGroup`](crate::stages::mesh_arena::SlabGroup).
struct Slabs {
    center: Points,
    normal: Points,
    thickness: f32x8,
    radius: f32x8,
}

/// One node.
#[derive(Clone, Copy)]
pub struct Node {
    /// Number within its level; of the root 0.
    pub number: u32,
    center: [Vec3; 2],
    half: [Vec3; 2],
    slab_center: Vec3,
    normal: Vec3,
    thickness: f32,
    radius: f32,
}

/// The tree of one body of a pair.
pub struct Tree<'a> {
    lanes: &'a MeshLanes,
    second: bool,
    scale: Points,
    scale_abs: Points,
    largest: f32,
    /// The scale's inverse, times `smallest`: turns normals.
    inverse: Points,
    smallest: f32,
    /// From the body's own axes to the other's.
    rotation: Rows,
    rotation_abs: Rows,
    translation: Points,
    pad: f32,
}

impl<'a> Tree<'a> {
    /// `scale` and `translation` in the pair's unit, `rotation` and `translation` from this body's axes to the other's.
    /// `pad` is the rounding allowance of a test of two nodes.
    pub fn new(lanes: &'a MeshLanes, second: bool, scale: Vec3, rotation: Mat3, translation: Vec3, pad: f32) -> Self {
        let smallest = scale.abs().min_element();
        Self {
            lanes,
            second,
            scale: splat(scale),
            scale_abs: splat(scale.abs()),
            largest: scale.abs().max_element(),
            inverse: splat(smallest / scale),
            smallest,
            rotation: Rows::new(rotation),
            rotation_abs: Rows::new(rotation.abs()),
            translation: splat(translation),
            // Half for each node of a test.
            pad: 0.5 * pad,
        }
    }

    /// Levels below the root. On the lowest nodes are clusters.
    pub fn height(&self) -> usize {
        self.lanes.levels.len()
    }

    /// How large the nodes of a level are, about; clusters are on level 0.
    pub fn size(&self, level: usize) -> f32 {
        self.largest
            * match self.lanes.sizes.get(level) {
                Some(size) => *size,
                None => self.lanes.aabb.half_size().length(),
            }
    }

    /// The node around everything.
    pub fn root(&self) -> Node {
        let half = self.lanes.aabb.half_size();
        let radius = f32x8::splat(half.length());
        // A normal of no length makes a slab that holds everything.
        let everything = Slabs {
            center: splat(self.lanes.aabb.center()),
            normal: splat(Vec3::ZERO),
            thickness: f32x8::ZERO,
            radius,
        };
        self.group(splat(self.lanes.aabb.center()), splat(half), everything)
            .node(0, 0)
    }

    /// The children of node `number`, which are on `level`.
    #[inline]
    pub fn children(&self, level: usize, number: u32) -> Group {
        let boxes = &self.lanes.levels[level][number as usize];
        let slabs = &self.lanes.slabs[level][number as usize];
        self.group(
            boxes.center,
            boxes.half,
            Slabs {
                center: slabs.center,
                normal: slabs.normal,
                thickness: slabs.thickness,
                radius: slabs.radius,
            },
        )
    }

    #[inline(always)]
    fn group(&self, center: Points, half: Points, slab: Slabs) -> Group {
        let pad = f32x8::splat(self.pad);
        let own = (mul(center, self.scale), mul(half, self.scale_abs));
        let around = self.rotation_abs.times(own.1);
        let other = (self.turned(own.0), each(|i| around[i] + pad));
        let own = (own.0, each(|i| own.1[i] + pad));

        // What lies within a slab of a mesh lies, scaled, within one whose normal is scaled inversely.
        let normal = mul(slab.normal, self.inverse);
        let length = dot(normal, normal).sqrt().fast_max(f32x8::splat(1.0e-9));
        let shrink = f32x8::ONE / length;
        let normal = each(|i| normal[i] * shrink);
        let slab_center = mul(slab.center, self.scale);
        let (first, second, slab_center, normal) = if self.second {
            (other, own, self.turned(slab_center), self.rotation.times(normal))
        } else {
            (own, other, slab_center, normal)
        };
        Group {
            center: [first.0, second.0],
            half: [first.1, second.1],
            slab: Slabs {
                center: slab_center,
                normal,
                thickness: slab.thickness * shrink * f32x8::splat(self.smallest) + pad,
                radius: slab.radius * f32x8::splat(self.largest),
            },
        }
    }

    #[inline(always)]
    fn turned(&self, p: Points) -> Points {
        let p = self.rotation.times(p);
        each(|i| p[i] + self.translation[i])
    }
}

impl Group {
    /// The node in a lane; its parent's number is `parent`.
    #[inline]
    pub fn node(&self, parent: u32, lane: usize) -> Node {
        let at = |x: &f32x8| x.as_array()[lane];
        Node {
            number: 8 * parent + lane as u32,
            center: [lane_of(&self.center[0], lane), lane_of(&self.center[1], lane)],
            half: [lane_of(&self.half[0], lane), lane_of(&self.half[1], lane)],
            slab_center: lane_of(&self.slab.center, lane),
            normal: lane_of(&self.slab.normal, lane),
            thickness: at(&self.slab.thickness),
            radius: at(&self.slab.radius),
        }
    }
}

impl Node {
    /// Lanes of a group of the other tree that this node may touch.
    #[inline]
    pub fn meets(&self, group: &Group) -> u32 {
        let meet = |axes: usize| {
            let (center, half) = (splat(self.center[axes]), splat(self.half[axes]));
            let apart = sub(center, group.center[axes]);
            let ok = |i: usize| apart[i].abs().simd_le(half[i] + group.half[axes][i]);
            ok(0) & ok(1) & ok(2)
        };
        let boxes = (meet(0) & meet(1)).to_bitmask();
        if boxes == 0 {
            return 0;
        }
        boxes & self.slab_meets(&group.slab).to_bitmask()
    }

    /// Let `x` be a common point of slabs `s` and `t`, and `n` and `m` their normals: then `n . (x - s)` is at most `s`'s
    /// thickness, and `n . (x - t) = m . (x - t) + (n - m) . (x - t)` at most `t`'s and its radius times `|n - m|`; and the
    /// same with `-m`, as a slab has two sides.
    #[inline]
    fn slab_meets(&self, other: &Slabs) -> f32x8 {
        let normal = splat(self.normal);
        let (less, more) = (sub(normal, other.normal), each(|i| normal[i] + other.normal[i]));
        let turn = dot(less, less).fast_min(dot(more, more)).sqrt();
        let way = sub(splat(self.slab_center), other.center);
        let thickness = f32x8::splat(self.thickness) + other.thickness;
        let along_own = dot(way, normal).abs().simd_le(thickness + turn * other.radius);
        let along_other = dot(way, other.normal)
            .abs()
            .simd_le(thickness + turn * f32x8::splat(self.radius));
        along_own & along_other
    }
}
