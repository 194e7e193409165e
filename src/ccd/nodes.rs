//! Safe times for nodes of two bounding volume trees: for how long two boxes certainly stay apart.
//!
//! The points of a body whose coordinate along a fixed direction `n` is `n . x` reach at most `n . x + d (n . v + |n x
//! w| r)` after a time `d`. Here `v` is the velocity of the centre of mass, `w` the angular velocity and `r` the
//! distance from the axis of rotation (Mirtich, "Impulse-based dynamic simulation of rigid body systems", 1996; with
//! the direction: Zhang, Lee and Kim, "Interactive continuous collision detection for non-convex polyhedra", 2006). A
//! gap along `n` between two nodes lasts until these motions have closed it. Any direction gives a valid bound. Used
//! are the axes of both bodies, along which the extents of boxes are known.

use super::relative::Rounded;
use crate::simd::lanes::{
    Points, Rows, Select, Simd, SimdBase, SimdFloat, abs, add, bitmask, broadcast, broadcast_point, cross, dot, f32x8,
    load_points, mul, splat, splat_point,
};
use crate::state::mesh_arena::BoxGroup;
use glam::Vec3;

/// Replaces zero in a denominator: a gap divided by it is longer than any collision substep.
pub const TINY: f32 = 1.0e-30;

/// Eight nodes of one tree, relative to their body's centre of mass, in the pair's unit of length.
pub struct Nodes<S: Simd> {
    /// Along the first body's axes and along the second's.
    center: [Points<S>; 2],
    half: [Points<S>; 2],
    /// Upper bound for the distance of any point from the axis of rotation.
    axis_distance: f32x8<S>,
    /// Upper bound for the distance of any point from the centre of mass.
    radius: f32x8<S>,
    /// Half the diagonal.
    size: f32x8<S>,
    /// Lanes that hold a node.
    pub lanes: u32,
}

/// Safe times of eight pairs of nodes.
pub struct SafeTimes {
    /// As fractions of the collision substep; not negative.
    pub times: [f32; 8],
    /// Bit mask of the pairs whose gap is larger than the nodes: it is cheaper to advance them than to open them.
    pub far: u32,
}

/// Transforms boxes of a body into the axes of both bodies, at one time.
pub struct NodePlacer<S: Simd> {
    scale: Points<S>,
    /// From the body's centre of mass to the collider's.
    offset: Points<S>,
    /// 0 for the first body, 1 for the second.
    side: usize,
    /// To the other body's axes.
    rotation: Rows<S>,
    rotation_abs: Rows<S>,
    /// Axis of rotation in the body's own axes; zero if it does not rotate.
    axis: Points<S>,
    /// Radius of the bounding sphere around the body's centre of mass.
    radius: f32x8<S>,
}

impl<S: Simd> NodePlacer<S> {
    /// For the first body or the second. `scale`, `offset` and the `radius` of the bounding sphere are in the pair's
    /// unit of length.
    #[inline(always)]
    pub fn new(simd: S, side: usize, scale: Vec3, offset: Vec3, radius: f32, relative: &Rounded) -> Self {
        let rotation = if side == 0 { relative.back } else { relative.rotation };
        Self {
            scale: splat_point(simd, scale),
            offset: splat_point(simd, offset),
            side,
            rotation: Rows::new(simd, rotation),
            rotation_abs: Rows::new(simd, rotation.abs()),
            axis: splat_point(simd, relative.frames[side].turns[side].normalize_or_zero()),
            radius: splat(simd, radius),
        }
    }

    /// Transforms eight boxes.
    #[inline(always)]
    pub fn nodes(&self, boxes: &BoxGroup) -> Nodes<S> {
        let simd = self.radius.simd;
        let half = load_points(simd, &boxes.half);
        let lanes = bitmask(half[0].simd_ge(splat(simd, 0.0)));
        let center = add(mul(load_points(simd, &boxes.center), self.scale), self.offset);
        let half = mul(half, abs(self.scale));
        let own = (center, half);
        let other = (self.rotation.times(center), self.rotation_abs.times(half));
        let (first, second) = if self.side == 0 { (own, other) } else { (other, own) };
        let size = dot(half, half).sqrt();
        let from_axis = cross(center, self.axis);
        Nodes {
            center: [first.0, second.0],
            half: [first.1, second.1],
            axis_distance: (dot(from_axis, from_axis).sqrt() + size).min(self.radius),
            radius: (dot(center, center).sqrt() + size).min(self.radius),
            size,
            lanes,
        }
    }
}

impl<S: Simd> Nodes<S> {
    /// The node of one lane, in all lanes.
    #[inline(always)]
    pub fn single(&self, lane: usize) -> Self {
        Self {
            center: [
                broadcast_point(&self.center[0], lane),
                broadcast_point(&self.center[1], lane),
            ],
            half: [
                broadcast_point(&self.half[0], lane),
                broadcast_point(&self.half[1], lane),
            ],
            axis_distance: broadcast(&self.axis_distance, lane),
            radius: broadcast(&self.radius, lane),
            size: broadcast(&self.size, lane),
            lanes: u32::MAX,
        }
    }
}

/// The safe times of nodes of the first body's tree and of the second's, lane by lane.
#[inline(always)]
pub fn safe_times<S: Simd>(a: &Nodes<S>, b: &Nodes<S>, relative: &Rounded) -> SafeTimes {
    let simd = a.size.simd;
    let zero = splat(simd, 0.0);
    let (pad, speed_pad) = (splat(simd, relative.pad), splat(simd, relative.speed_pad));
    let (one, tiny) = (splat(simd, 1.0), splat(simd, TINY));
    let (mut time, mut widest) = (zero, zero);
    for (k, frame) in relative.frames.iter().enumerate() {
        let [spins_a, spins_b] = frame.spins();
        for i in 0..3 {
            let (center_a, center_b) = (a.center[k][i], b.center[k][i]);
            let apart = splat(simd, frame.translation[i]) + center_b - center_a;
            // 1 if the second is farther along the axis, else -1.
            let sign = apart.simd_ge(zero).select(one, -one);
            let gap = apart.abs() - a.half[k][i] - b.half[k][i] - pad;
            let speed = sign * splat(simd, frame.velocity[i]) + speed_pad;
            let spin_a = splat(simd, spins_a[i]) * a.axis_distance;
            let spin_b = splat(simd, spins_b[i]) * b.axis_distance;
            // A rotation of any length keeps every point on its sphere about the centre of mass.
            let max_a = a.radius - sign * center_a - a.half[k][i];
            let max_b = b.radius + sign * center_b - b.half[k][i];
            let (max_a, max_b) = (max_a.max(zero).min(spin_a), max_b.max(zero).min(spin_b));
            let rotating = gap / (speed + spin_a + spin_b).max(tiny);
            let rotated = (gap - max_a - max_b) / speed.max(tiny);
            time = time.max(rotating).max(rotated);
            widest = widest.max(gap);
        }
    }
    SafeTimes {
        times: rounded_down(time),
        far: bitmask(widest.simd_gt(a.size.max(b.size))),
    }
}

/// Times, reduced by the largest rounding error of single precision.
#[inline(always)]
pub fn rounded_down<S: Simd>(time: f32x8<S>) -> [f32; 8] {
    (time * splat(time.simd, 1.0 - 1.0e-5)).into()
}
