//! The box trees of the two meshes of a pair, and the test whether two nodes may touch.

use super::lanes::{
    Points, Rows, Simd, SimdBase, SimdFloat, abs, add, all_le, bitmask, boxes_meet, dot, f32x8, lane_of, load,
    load_points, mask32x8, mul, scale, splat, splat_point, store, store_points, sub, widen,
};
use crate::geometry::Aabb;
use crate::geometry::lanes::{MeshLanes, SlabGroup, Stored, StoredPoints, points};
use glam::{Mat3, Vec3};

/// Eight nodes of one of the trees: their boxes in the axes of the first body and in those of the second, and their
/// slabs in the axes of the first. All is in the pair's unit of length and relative to the first body's centre, except
/// that boxes in the second body's axes are relative to the second body's centre.
pub struct Group {
    center: [StoredPoints; 2],
    half: [StoredPoints; 2],
    slabs: Option<SlabGroup>,
    /// One bit per lane whose box passes the support-axis cull, and meets a box of [`Tree::within`].
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
pub struct Tree<'a, S: Simd> {
    simd: S,
    lanes: &'a MeshLanes,
    second: bool,
    scale: Points<S>,
    scale_abs: Points<S>,
    largest: f32,
    /// The inverse scale times `smallest`; it transforms normals.
    inverse: Points<S>,
    smallest: f32,
    /// From the body's own axes to the other's.
    rotation: Rows<S>,
    rotation_abs: Rows<S>,
    translation: Points<S>,
    /// The support axis in the body's own axes, pointing to the other body.
    axis: Points<S>,
    axis_abs: Points<S>,
    min_height: f32x8<S>,
    pad: f32,
    /// Whether slabs are tested as well as boxes.
    slabs: bool,
    /// Nodes outside all of these boxes count as apart from the other body; without any, none does.
    within: &'a [Aabb],
}

impl<'a, S: Simd> Tree<'a, S> {
    /// The tree of `lanes` scaled by `scale`, in the pair's unit of length.
    ///
    /// `second` says whether it belongs to the pair's second body. `pad` is the rounding allowance of a test of two
    /// nodes. `slabs` says whether to test slabs and must be the same for both trees.
    #[inline(always)]
    pub fn new(
        simd: S,
        lanes: &'a MeshLanes,
        second: bool,
        scale: Vec3,
        relative: RelativePose,
        pad: f32,
        slabs: bool,
    ) -> Self {
        let smallest = scale.abs().min_element();
        Self {
            simd,
            lanes,
            second,
            scale: splat_point(simd, scale),
            scale_abs: splat_point(simd, scale.abs()),
            largest: scale.abs().max_element(),
            inverse: splat_point(simd, smallest / scale),
            smallest,
            rotation: Rows::new(simd, relative.rotation),
            rotation_abs: Rows::new(simd, relative.rotation.abs()),
            translation: splat_point(simd, relative.translation),
            axis: splat_point(simd, relative.axis),
            axis_abs: splat_point(simd, relative.axis.abs()),
            min_height: splat(simd, relative.min_height - pad),
            slabs,
            // Each of the two nodes of a test contributes half.
            pad: 0.5 * pad,
            within: &[],
        }
    }

    /// Restricts the tree: only nodes that meet one of these boxes touch the other body. The boxes are in the axes of
    /// the first body and in the pair's unit of length, relative to the first body's centre.
    #[inline(always)]
    pub fn within(self, within: &'a [Aabb]) -> Self {
        Self { within, ..self }
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
    #[inline(always)]
    pub fn root(&self) -> Node {
        let (center, half) = (self.lanes.aabb.center(), self.lanes.aabb.half_size());
        // A slab with a zero normal contains everything.
        let everything = SlabGroup {
            center: points(|_| center),
            normal: StoredPoints::default(),
            half_thickness: Stored::default(),
            radius: Stored([half.length(); 8]),
        };
        let slabs = if self.slabs {
            Some(self.placed(&everything))
        } else {
            None
        };
        self.group(&points(|_| center), &points(|_| half), slabs).node(0, 0)
    }

    /// The children, on `level`, of node `number` of the level above.
    #[inline(always)]
    pub fn children(&self, level: usize, number: u32) -> Group {
        let boxes = &self.lanes.levels[level][number as usize];
        let slabs = if self.slabs {
            Some(self.placed(&self.lanes.slabs[level][number as usize]))
        } else {
            None
        };
        self.group(&boxes.center, &boxes.half, slabs)
    }

    /// A group with these boxes, which are transformed, and with these slabs.
    #[inline(always)]
    fn group(&self, center: &StoredPoints, half: &StoredPoints, slabs: Option<SlabGroup>) -> Group {
        let pad = splat(self.simd, self.pad);
        let center = mul(load_points(self.simd, center), self.scale);
        let half = mul(load_points(self.simd, half), self.scale_abs);
        let around = self.rotation_abs.times(half);
        let height = dot(center, self.axis) + dot(half, self.axis_abs);
        let own = (center, widen(half, pad));
        let other = (self.to_other(center), widen(around, pad));
        let (first, second) = if self.second { (other, own) } else { (own, other) };
        let mut lanes = bitmask(height.simd_ge(self.min_height));
        if !self.within.is_empty() {
            lanes &= self.lanes_within(first);
        }
        Group {
            center: [store_points(first.0), store_points(second.0)],
            half: [store_points(first.1), store_points(second.1)],
            slabs,
            lanes,
        }
    }

    /// Boxes, by centres and half sizes in the axes of the first body, that meet one of those of [`Tree::within`].
    #[inline(always)]
    fn lanes_within(&self, (center, half): (Points<S>, Points<S>)) -> u32 {
        let (low, high) = (sub(center, half), add(center, half));
        let mut lanes = 0;
        for aabb in self.within {
            let (min, max) = (splat_point(self.simd, aabb.min), splat_point(self.simd, aabb.max));
            lanes |= bitmask(boxes_meet(low, high, min, max));
        }
        lanes
    }

    /// Slabs of the mesh after scaling and rotation. A scaled slab is a slab again; its normal is scaled by the
    /// inverse.
    #[inline(always)]
    fn placed(&self, slab: &SlabGroup) -> SlabGroup {
        let simd = self.simd;
        let normal = mul(load_points(simd, &slab.normal), self.inverse);
        let length = dot(normal, normal).sqrt().max(splat(simd, 1.0e-9));
        let shrink = splat(simd, 1.0) / length;
        let normal = scale(normal, shrink);
        let center = mul(load_points(simd, &slab.center), self.scale);
        let (center, normal) = if self.second {
            (self.to_other(center), self.rotation.times(normal))
        } else {
            (center, normal)
        };
        let half_thickness = load(simd, &slab.half_thickness) * shrink * splat(simd, self.smallest);
        SlabGroup {
            center: store_points(center),
            normal: store_points(normal),
            half_thickness: store(half_thickness + splat(simd, self.pad)),
            radius: store(load(simd, &slab.radius) * splat(simd, self.largest)),
        }
    }

    /// Transforms points from the body's own axes to the other's.
    #[inline(always)]
    fn to_other(&self, p: Points<S>) -> Points<S> {
        add(self.rotation.times(p), self.translation)
    }

    /// The lanes of a group of this tree that a node of the other may touch, as bits.
    #[inline(always)]
    pub fn met_by(&self, node: &Node, group: &Group) -> u32 {
        let boxes = self.boxes_met(node, group, 0) & self.boxes_met(node, group, 1);
        let boxes = bitmask(boxes) & group.lanes;
        match &group.slabs {
            Some(slabs) if boxes != 0 => boxes & bitmask(node.slab.meets(self.simd, slabs)),
            _ => boxes,
        }
    }

    /// The lanes whose boxes meet that of the node, in the axes of one body.
    #[inline(always)]
    fn boxes_met(&self, node: &Node, group: &Group, axes: usize) -> mask32x8<S> {
        let simd = self.simd;
        let center = splat_point(simd, node.center[axes]);
        let half = splat_point(simd, node.half[axes]);
        let apart = sub(center, load_points(simd, &group.center[axes]));
        all_le(abs(apart), add(half, load_points(simd, &group.half[axes])))
    }

    /// The squared distances between the centres of a node's box and of the group's boxes.
    #[inline(always)]
    pub fn distances(&self, node: &Node, group: &Group) -> [f32; 8] {
        let center = load_points(self.simd, &group.center[0]);
        let apart = sub(splat_point(self.simd, node.center[0]), center);
        dot(apart, apart).to_array()
    }
}

impl Group {
    /// The node in `lane`; `parent` is the number of its parent.
    #[inline]
    pub fn node(&self, parent: u32, lane: usize) -> Node {
        let slab = |slabs: &SlabGroup| Slab {
            center: lane_of(&slabs.center, lane),
            normal: lane_of(&slabs.normal, lane),
            half_thickness: slabs.half_thickness.0[lane],
            radius: slabs.radius.0[lane],
        };
        Node {
            number: 8 * parent + lane as u32,
            center: [lane_of(&self.center[0], lane), lane_of(&self.center[1], lane)],
            half: [lane_of(&self.half[0], lane), lane_of(&self.half[1], lane)],
            slab: self.slabs.as_ref().map(slab).unwrap_or_default(),
        }
    }
}

impl Slab {
    /// A mask of the slabs that may have a point in common with this one.
    ///
    /// Let `x` be a common point of slabs with centres `s` and `t` and normals `n` and `m`. Then `|n . (x - s)|` is at
    /// most the half thickness of the first. And `n . (x - t) = m . (x - t) + (n - m) . (x - t)` is at most the half
    /// thickness of the second plus its radius times `|n - m|`. The same holds with `-m`, because a slab is symmetric.
    /// So `|n . (s - t)|` is at most the sum of both bounds, and likewise for `m`.
    #[inline(always)]
    fn meets<S: Simd>(&self, simd: S, other: &SlabGroup) -> mask32x8<S> {
        let (own_normal, other_normal) = (splat_point(simd, self.normal), load_points(simd, &other.normal));
        let (less, more) = (sub(own_normal, other_normal), add(own_normal, other_normal));
        let normal_difference = dot(less, less).min(dot(more, more)).sqrt();
        let offset = sub(splat_point(simd, self.center), load_points(simd, &other.center));
        let thickness = splat(simd, self.half_thickness) + load(simd, &other.half_thickness);
        let along_own = dot(offset, own_normal).abs();
        let along_other = dot(offset, other_normal).abs();
        along_own.simd_le(thickness + normal_difference * load(simd, &other.radius))
            & along_other.simd_le(thickness + normal_difference * splat(simd, self.radius))
    }
}
