//! The box trees of the two meshes of a pair, and the test whether two nodes may touch.

use super::lanes::{Rows, dot, each, lane_of, mul, splat, sub};
use crate::geometry::lanes::{MeshLanes, Points, SlabGroup};
use glam::{Mat3, Vec3};
use wide::f32x8;

/// Eight nodes of one of the trees: their boxes in the axes of the first body and in those of the second, and their
/// slabs in the axes of the first. All is in the pair's unit of length and relative to the first body's centre, except
/// that boxes in the second body's axes are relative to the second body's centre.
pub struct Group {
    center: [Points; 2],
    half: [Points; 2],
    slabs: Option<SlabGroup>,
    /// One bit per lane whose box passes the support-axis cull.
    lanes: u32,
}

/// One node.
#[derive(Clone, Copy)]
pub struct Node {
    /// Number within its level; 0 for the root.
    pub number: u32,
    center: [Vec3; 2],
    half: [Vec3; 2],
    /// Used only if the other tree has slabs too.
    slab: Slab,
}

/// One lane of a [`SlabGroup`].
#[derive(Clone, Copy, Default)]
struct Slab {
    center: Vec3,
    normal: Vec3,
    half_thickness: f32,
    radius: f32,
}

/// The pose of a body relative to the other one, in the pair's unit of length, and the support axis.
pub struct RelativePose {
    /// The rotation from this body's axes to the other's.
    pub rotation: Mat3,
    /// The translation from this body's axes to the other's, applied after the rotation.
    pub translation: Vec3,
    /// The support axis in this body's axes, pointing to the other body.
    pub axis: Vec3,
    /// Nodes whose largest height along `axis` is below this cannot touch the other body.
    pub min_height: f32,
}

/// The tree of one body of a pair.
pub struct Tree<'a> {
    lanes: &'a MeshLanes,
    second: bool,
    scale: Points,
    scale_abs: Points,
    largest: f32,
    /// The inverse scale times `smallest`; it transforms normals.
    inverse: Points,
    smallest: f32,
    /// From the body's own axes to the other's.
    rotation: Rows,
    rotation_abs: Rows,
    translation: Points,
    /// The support axis in the body's own axes, pointing to the other body.
    axis: Points,
    axis_abs: Points,
    min_height: f32x8,
    pad: f32,
    /// Whether slabs are tested as well as boxes.
    slabs: bool,
}

impl<'a> Tree<'a> {
    /// The tree of `lanes` scaled by `scale`, in the pair's unit of length.
    ///
    /// `second` says whether it belongs to the pair's second body. `pad` is the rounding allowance of a test of two
    /// nodes. `slabs` says whether to test slabs and must be the same for both trees.
    pub fn new(lanes: &'a MeshLanes, second: bool, scale: Vec3, relative: RelativePose, pad: f32, slabs: bool) -> Self {
        let smallest = scale.abs().min_element();
        Self {
            lanes,
            second,
            scale: splat(scale),
            scale_abs: splat(scale.abs()),
            largest: scale.abs().max_element(),
            inverse: splat(smallest / scale),
            smallest,
            rotation: Rows::new(relative.rotation),
            rotation_abs: Rows::new(relative.rotation.abs()),
            translation: splat(relative.translation),
            axis: splat(relative.axis),
            axis_abs: splat(relative.axis.abs()),
            min_height: f32x8::splat(relative.min_height - pad),
            slabs,
            // Each of the two nodes of a test contributes half.
            pad: 0.5 * pad,
        }
    }

    /// The number of levels below the root. The nodes of level 0 are clusters.
    pub fn height(&self) -> usize {
        self.lanes.levels.len()
    }

    /// The typical size of the nodes of a level, in the pair's unit of length.
    pub fn size(&self, level: usize) -> f32 {
        self.largest
            * match self.lanes.sizes.get(level) {
                Some(size) => *size,
                None => self.lanes.aabb.half_size().length(),
            }
    }

    /// The number of groups of a level.
    pub fn groups(&self, level: usize) -> usize {
        self.lanes.levels[level].len()
    }

    /// The root node, which contains the whole mesh.
    pub fn root(&self) -> Node {
        let (center, half) = (self.lanes.aabb.center(), self.lanes.aabb.half_size());
        // A slab with a zero normal contains everything.
        let everything = || SlabGroup {
            center: splat(center),
            normal: splat(Vec3::ZERO),
            half_thickness: f32x8::ZERO,
            radius: f32x8::splat(half.length()),
        };
        let group = Group {
            slabs: self.slabs.then(|| self.placed(&everything())),
            ..self.boxes(splat(center), splat(half))
        };
        group.node(0, 0)
    }

    /// The children, on `level`, of node `number` of the level above.
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
        let height = dot(center, self.axis) + dot(half, self.axis_abs);
        let own = (center, each(|i| half[i] + pad));
        let other = (self.to_other(center), each(|i| around[i] + pad));
        let (first, second) = if self.second { (other, own) } else { (own, other) };
        Group {
            center: [first.0, second.0],
            half: [first.1, second.1],
            slabs: None,
            lanes: height.simd_ge(self.min_height).to_bitmask(),
        }
    }

    /// Slabs of the mesh after scaling and rotation. A scaled slab is a slab again; its normal is scaled by the
    /// inverse.
    #[inline(always)]
    fn placed(&self, slab: &SlabGroup) -> SlabGroup {
        let normal = mul(slab.normal, self.inverse);
        let length = dot(normal, normal).sqrt().fast_max(f32x8::splat(1.0e-9));
        let shrink = f32x8::ONE / length;
        let normal = each(|i| normal[i] * shrink);
        let center = mul(slab.center, self.scale);
        let (center, normal) = if self.second {
            (self.to_other(center), self.rotation.times(normal))
        } else {
            (center, normal)
        };
        SlabGroup {
            center,
            normal,
            half_thickness: slab.half_thickness * shrink * f32x8::splat(self.smallest) + f32x8::splat(self.pad),
            radius: slab.radius * f32x8::splat(self.largest),
        }
    }

    /// Transforms points from the body's own axes to the other's.
    #[inline(always)]
    fn to_other(&self, p: Points) -> Points {
        let p = self.rotation.times(p);
        each(|i| p[i] + self.translation[i])
    }
}

impl Group {
    /// The node in `lane`; `parent` is the number of its parent.
    #[inline]
    pub fn node(&self, parent: u32, lane: usize) -> Node {
        let slab = |slabs: &SlabGroup| Slab {
            center: lane_of(&slabs.center, lane),
            normal: lane_of(&slabs.normal, lane),
            half_thickness: slabs.half_thickness.as_array()[lane],
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
    /// The lanes of a group of the other tree that this node may touch, as bits.
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

    /// The squared distances between the centres of this node's box and of the group's boxes.
    #[inline]
    pub fn distances(&self, group: &Group) -> [f32; 8] {
        let apart = sub(splat(self.center[0]), group.center[0]);
        dot(apart, apart).to_array()
    }
}

impl Slab {
    /// A mask of the slabs that may have a point in common with this one.
    ///
    /// Let `x` be a common point of slabs with centres `s` and `t` and normals `n` and `m`. Then `|n . (x - s)|` is at
    /// most the half thickness of the first. And `n . (x - t) = m . (x - t) + (n - m) . (x - t)` is at most the half
    /// thickness of the second plus its radius times `|n - m|`. The same holds with `-m`, because a slab is symmetric.
    /// So `|n . (s - t)|` is at most the sum of both bounds, and likewise for `m`.
    #[inline]
    fn meets(&self, other: &SlabGroup) -> f32x8 {
        let normal = splat(self.normal);
        let (less, more) = (sub(normal, other.normal), each(|i| normal[i] + other.normal[i]));
        let normal_difference = dot(less, less).fast_min(dot(more, more)).sqrt();
        let offset = sub(splat(self.center), other.center);
        let thickness = f32x8::splat(self.half_thickness) + other.half_thickness;
        let along_own = dot(offset, normal)
            .abs()
            .simd_le(thickness + normal_difference * other.radius);
        let along_other = dot(offset, other.normal)
            .abs()
            .simd_le(thickness + normal_difference * f32x8::splat(self.radius));
        along_own & along_other
    }
}
