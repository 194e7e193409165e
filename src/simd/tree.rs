//! Nodes of the trees of two meshes, and whether they may touch.

use super::lanes::{Rows, dot, each, lane_of, mul, splat, sub};
use crate::state::mesh_arena::{MeshLanes, Points, SlabGroup};
use glam::{Mat3, Vec3};
use wide::f32x8;

/// Eight nodes of either tree: their boxes along the first body's axes and along the second's, their slabs in the
/// first's. Everything is in the pair's unit and about the first body's centre, but boxes along the second body's axes
/// are about its own.
pub struct Group {
    center: [Points; 2],
    half: [Points; 2],
    slabs: Option<SlabGroup>,
    /// Lanes that reach the other body's half of the support axis.
    lanes: u32,
}

/// One node.
#[derive(Clone, Copy)]
pub struct Node {
    /// Number within its level; of the root 0.
    pub number: u32,
    center: [Vec3; 2],
    half: [Vec3; 2],
    /// Only looked at if the other tree has slabs too.
    slab: Slab,
}

/// See [`SlabGroup`].
#[derive(Clone, Copy, Default)]
struct Slab {
    center: Vec3,
    normal: Vec3,
    thickness: f32,
    radius: f32,
}

/// How the other body lies, in the pair's unit.
pub struct Way {
    /// From this body's axes to the other's.
    pub rotation: Mat3,
    /// The same.
    pub translation: Vec3,
    /// The support axis in this body's axes, towards the other.
    pub axis: Vec3,
    /// What does not reach this far along it is out of the other's reach.
    pub least: f32,
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
    /// The support axis in the body's own axes, towards the other.
    axis: Points,
    axis_abs: Points,
    least: f32x8,
    pad: f32,
    /// Whether slabs are compared beside boxes.
    slabs: bool,
}

impl<'a> Tree<'a> {
    /// `scale` in the pair's unit; `second` is whether this is the second body's. `pad` is the rounding allowance of a test of two
    /// nodes; `slabs` is whether slabs are compared, for both trees.
    pub fn new(lanes: &'a MeshLanes, second: bool, scale: Vec3, way: Way, pad: f32, slabs: bool) -> Self {
        let smallest = scale.abs().min_element();
        Self {
            lanes,
            second,
            scale: splat(scale),
            scale_abs: splat(scale.abs()),
            largest: scale.abs().max_element(),
            inverse: splat(smallest / scale),
            smallest,
            rotation: Rows::new(way.rotation),
            rotation_abs: Rows::new(way.rotation.abs()),
            translation: splat(way.translation),
            axis: splat(way.axis),
            axis_abs: splat(way.axis.abs()),
            least: f32x8::splat(way.least - pad),
            slabs,
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

    /// How many groups a level has.
    pub fn groups(&self, level: usize) -> usize {
        self.lanes.levels[level].len()
    }

    /// The node around everything.
    pub fn root(&self) -> Node {
        let (center, half) = (self.lanes.aabb.center(), self.lanes.aabb.half_size());
        // A normal of no length makes a slab that holds everything.
        let everything = || SlabGroup {
            center: splat(center),
            normal: splat(Vec3::ZERO),
            thickness: f32x8::ZERO,
            radius: f32x8::splat(half.length()),
        };
        let group = Group {
            slabs: self.slabs.then(|| self.placed(&everything())),
            ..self.boxes(splat(center), splat(half))
        };
        group.node(0, 0)
    }

    /// The children of node `number`, which are on `level`.
    #[inline]
    pub fn children(&self, level: usize, number: u32) -> Group {
        let boxes = &self.lanes.levels[level][number as usize];
        Group {
            slabs: self
                .slabs
                .then(|| self.placed(&self.lanes.slabs[level][number as usize])),
            ..self.boxes(boxes.center, boxes.half)
        }
    }

    #[inline(always)]
    fn boxes(&self, center: Points, half: Points) -> Group {
        let pad = f32x8::splat(self.pad);
        let (center, half) = (mul(center, self.scale), mul(half, self.scale_abs));
        let around = self.rotation_abs.times(half);
        let reach = dot(center, self.axis) + dot(half, self.axis_abs);
        let own = (center, each(|i| half[i] + pad));
        let other = (self.turned(center), each(|i| around[i] + pad));
        let (first, second) = if self.second { (other, own) } else { (own, other) };
        Group {
            center: [first.0, second.0],
            half: [first.1, second.1],
            slabs: None,
            lanes: reach.simd_ge(self.least).to_bitmask(),
        }
    }

    /// What lies within a slab of a mesh lies, scaled, within one whose normal is scaled inversely.
    #[inline(always)]
    fn placed(&self, slab: &SlabGroup) -> SlabGroup {
        let normal = mul(slab.normal, self.inverse);
        let length = dot(normal, normal).sqrt().fast_max(f32x8::splat(1.0e-9));
        let shrink = f32x8::ONE / length;
        let normal = each(|i| normal[i] * shrink);
        let center = mul(slab.center, self.scale);
        let (center, normal) = if self.second {
            (self.turned(center), self.rotation.times(normal))
        } else {
            (center, normal)
        };
        SlabGroup {
            center,
            normal,
            thickness: slab.thickness * shrink * f32x8::splat(self.smallest) + f32x8::splat(self.pad),
            radius: slab.radius * f32x8::splat(self.largest),
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
        let slab = |slabs: &SlabGroup| Slab {
            center: lane_of(&slabs.center, lane),
            normal: lane_of(&slabs.normal, lane),
            thickness: slabs.thickness.as_array()[lane],
            radius: slabs.radius.as_array()[lane],
        };
        Node {
            number: 8 * parent + lane as u32,
            center: [lane_of(&self.center[0], lane), lane_of(&self.center[1], lane)],
            half: [lane_of(&self.half[0], lane), lane_of(&self.half[1], lane)],
            slab: self.slabs.as_ref().map(slab).unwrap_or_default(),
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
        let boxes = (meet(0) & meet(1)).to_bitmask() & group.lanes;
        match &group.slabs {
            Some(slabs) if boxes != 0 => boxes & self.slab.meets(slabs).to_bitmask(),
            _ => boxes,
        }
    }

    /// How far the boxes' centres are, squared.
    #[inline]
    pub fn distances(&self, group: &Group) -> [f32; 8] {
        let apart = sub(splat(self.center[0]), group.center[0]);
        dot(apart, apart).to_array()
    }
}

impl Slab {
    /// Let `x` be a common point of slabs `s` and `t`, and `n` and `m` their normals: then `n . (x - s)` is at most `s`'s
    /// thickness, and `n . (x - t) = m . (x - t) + (n - m) . (x - t)` at most `t`'s and its radius times `|n - m|`; and the
    /// same with `-m`, as a slab has two sides.
    #[inline]
    fn meets(&self, other: &SlabGroup) -> f32x8 {
        let normal = splat(self.normal);
        let (less, more) = (sub(normal, other.normal), each(|i| normal[i] + other.normal[i]));
        let turn = dot(less, less).fast_min(dot(more, more)).sqrt();
        let way = sub(splat(self.center), other.center);
        let thickness = f32x8::splat(self.thickness) + other.thickness;
        let along_own = dot(way, normal).abs().simd_le(thickness + turn * other.radius);
        let along_other = dot(way, other.normal)
            .abs()
            .simd_le(thickness + turn * f32x8::splat(self.radius));
        along_own & along_other
    }
}
