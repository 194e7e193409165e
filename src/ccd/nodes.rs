//! Safe times for nodes of two bounding volume trees: for how long two boxes certainly stay apart.
//!
//! The points of a body whose coordinate along a fixed direction `n` is `n . x` reach at most `n . x + d (n . v + |n x
//! w| r)` after a time `d`. Here `v` is the velocity of the centre of mass, `w` the angular velocity and `r` the
//! distance from the axis of rotation (Mirtich, "Impulse-based dynamic simulation of rigid body systems", 1996; with
//! the direction: Zhang, Lee and Kim, "Interactive continuous collision detection for non-convex polyhedra", 2006). A
//! gap along `n` between two nodes lasts until these motions have closed it. Any direction gives a valid bound. Used
//! are the axes of both bodies, along which the extents of boxes are known.

use super::relative::Rounded;
use crate::simd::lanes::{Rows, cross, dot, each, lane_of, mul, splat};
use crate::state::mesh_arena::{BoxGroup, Points};
use glam::Vec3;
use wide::f32x8;

/// Replaces zero in a denominator: a gap divided by it is longer than any collision substep.
pub const TINY: f32 = 1.0e-30;

/// Eight nodes of one tree, relative to their body's centre of mass, in the pair's unit of length.
pub struct Nodes {
    /// Along the first body's axes and along the second's.
    center: [Points; 2],
    half: [Points; 2],
    /// Upper bound for the distance of any point from the axis of rotation.
    axis_distance: f32x8,
    /// Upper bound for the distance of any point from the centre of mass.
    radius: f32x8,
    /// Half the diagonal.
    size: f32x8,
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
pub struct NodePlacer {
    scale: Points,
    /// 0 for the first body, 1 for the second.
    side: usize,
    /// To the other body's axes.
    rotation: Rows,
    rotation_abs: Rows,
    /// Axis of rotation in the body's own axes; zero if it does not rotate.
    axis: Points,
    /// Radius of the body's bounding sphere.
    radius: f32x8,
}

impl NodePlacer {
    /// For the first body or the second. `scale` and the `radius` of the bounding sphere are in the pair's unit of
    /// length.
    pub fn new(side: usize, scale: Vec3, radius: f32, relative: &Rounded) -> Self {
        let rotation = if side == 0 { relative.back } else { relative.rotation };
        Self {
            scale: splat(scale),
            side,
            rotation: Rows::new(rotation),
            rotation_abs: Rows::new(rotation.abs()),
            axis: splat(relative.frames[side].turns[side].normalize_or_zero()),
            radius: f32x8::splat(radius),
        }
    }

    /// Transforms eight boxes.
    pub fn nodes(&self, boxes: &BoxGroup) -> Nodes {
        let lanes = boxes.half[0].simd_ge(f32x8::ZERO).to_bitmask();
        let center = mul(boxes.center, self.scale);
        let half = each(|i| boxes.half[i] * self.scale[i].abs());
        let own = (center, half);
        let other = (self.rotation.times(center), self.rotation_abs.times(half));
        let (first, second) = if self.side == 0 { (own, other) } else { (other, own) };
        let size = dot(half, half).sqrt();
        let from_axis = cross(center, self.axis);
        Nodes {
            center: [first.0, second.0],
            half: [first.1, second.1],
            axis_distance: (dot(from_axis, from_axis).sqrt() + size).fast_min(self.radius),
            radius: (dot(center, center).sqrt() + size).fast_min(self.radius),
            size,
            lanes,
        }
    }
}

impl Nodes {
    /// The node of one lane, in all lanes.
    pub fn single(&self, lane: usize) -> Self {
        let point = |p: &Points| splat(lane_of(p, lane));
        let value = |v: f32x8| f32x8::splat(v.as_array()[lane]);
        Self {
            center: [point(&self.center[0]), point(&self.center[1])],
            half: [point(&self.half[0]), point(&self.half[1])],
            axis_distance: value(self.axis_distance),
            radius: value(self.radius),
            size: value(self.size),
            lanes: u32::MAX,
        }
    }
}

/// The safe times of nodes of the first body's tree and of the second's, lane by lane.
pub fn safe_times(a: &Nodes, b: &Nodes, relative: &Rounded) -> SafeTimes {
    let zero = f32x8::ZERO;
    let (pad, speed_pad) = (f32x8::splat(relative.pad), f32x8::splat(relative.speed_pad));
    let tiny = f32x8::splat(TINY);
    let (mut time, mut widest) = (zero, zero);
    for (k, frame) in relative.frames.iter().enumerate() {
        let [spins_a, spins_b] = frame.spins();
        for i in 0..3 {
            let (center_a, center_b) = (a.center[k][i], b.center[k][i]);
            let apart = f32x8::splat(frame.translation[i]) + center_b - center_a;
            // 1 if the second is farther along the axis, else -1.
            let sign = apart.simd_ge(zero).bitselect(f32x8::ONE, -f32x8::ONE);
            let gap = apart.abs() - a.half[k][i] - b.half[k][i] - pad;
            let speed = sign * f32x8::splat(frame.velocity[i]) + speed_pad;
            let spin_a = f32x8::splat(spins_a[i]) * a.axis_distance;
            let spin_b = f32x8::splat(spins_b[i]) * b.axis_distance;
            // A rotation of any length keeps every point on its sphere about the centre of mass.
            let max_a = (a.radius - sign * center_a - a.half[k][i])
                .fast_max(zero)
                .fast_min(spin_a);
            let max_b = (b.radius + sign * center_b - b.half[k][i])
                .fast_max(zero)
                .fast_min(spin_b);
            let rotating = gap / (speed + spin_a + spin_b).fast_max(tiny);
            let rotated = (gap - max_a - max_b) / speed.fast_max(tiny);
            time = time.fast_max(rotating).fast_max(rotated);
            widest = widest.fast_max(gap);
        }
    }
    SafeTimes {
        times: rounded_down(time),
        far: widest.simd_gt(a.size.fast_max(b.size)).to_bitmask(),
    }
}

/// Times, reduced by the largest rounding error of single precision.
pub fn rounded_down(time: f32x8) -> [f32; 8] {
    (time * f32x8::splat(1.0 - 1.0e-5)).to_array()
}
