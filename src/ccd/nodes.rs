//! How long nodes of two trees of boxes stay apart.
//!
//! Points of a body that are `n . x` along a fixed direction `n` reach `n . x + d (n . v + |n x w| r)` at most after a time
//! `d`, where `v` is the velocity of the centre of mass, `w` the angular velocity and `r` the distance from the axis of the turn
//! (Mirtich, "Impulse-based dynamic simulation of rigid body systems", 1996; with the direction: Zhang, Lee and Kim,
//! "Interactive continuous collision detection for non-convex polyhedra", 2006). A gap along `n` between two nodes lasts
//! until such ways have closed it. Any direction will do; tried are the axes of both bodies, along which boxes are known.

use super::relative::Rounded;
use crate::simd::lanes::{Rows, cross, dot, each, lane_of, mul, splat};
use crate::state::mesh_arena::{BoxGroup, Points};
use glam::Vec3;
use wide::f32x8;

/// What stands for zero in a denominator: a gap over it is longer than any interval.
pub const TINY: f32 = 1.0e-30;

/// Eight nodes of one tree, in the pair's unit, about their body's centre of mass.
pub struct Nodes {
    /// Along the first body's axes and along the second's.
    center: [Points; 2],
    half: [Points; 2],
    /// No point is farther from the axis of the turn,
    arm: f32x8,
    /// nor from the centre of mass.
    radius: f32x8,
    /// Half the diagonal.
    size: f32x8,
    /// Lanes that hold a node.
    pub lanes: u32,
}

/// How long eight pairs of nodes stay apart.
pub struct Stay {
    /// At least so long, in intervals; not negative.
    pub time: [f32; 8],
    /// Whether their gap is wide beside the nodes: then it is worth more to look again later than to look into them.
    pub far: u32,
}

/// Brings boxes of a body into the pair, at one time.
pub struct Placing {
    scale: Points,
    /// Which body.
    end: usize,
    /// To the other body's axes.
    rotation: Rows,
    rotation_abs: Rows,
    /// Direction of the axis of the turn in the body's own axes; zero for none.
    axis: Points,
    /// Of the body's bounding sphere.
    radius: f32x8,
}

impl Placing {
    /// Of the first body or of the second; `scale` and the bounding sphere's `radius` in the pair's unit.
    pub fn new(end: usize, scale: Vec3, radius: f32, relative: &Rounded) -> Self {
        let rotation = if end == 0 { relative.back } else { relative.rotation };
        Self {
            scale: splat(scale),
            end,
            rotation: Rows::new(rotation),
            rotation_abs: Rows::new(rotation.abs()),
            axis: splat(relative.frames[end].turns[end].normalize_or_zero()),
            radius: f32x8::splat(radius),
        }
    }

    /// Places eight boxes.
    pub fn nodes(&self, boxes: &BoxGroup) -> Nodes {
        let lanes = boxes.half[0].simd_ge(f32x8::ZERO).to_bitmask();
        let center = mul(boxes.center, self.scale);
        let half = each(|i| boxes.half[i] * self.scale[i].abs());
        let own = (center, half);
        let other = (self.rotation.times(center), self.rotation_abs.times(half));
        let (first, second) = if self.end == 0 { (own, other) } else { (other, own) };
        let size = dot(half, half).sqrt();
        let from_axis = cross(center, self.axis);
        Nodes {
            center: [first.0, second.0],
            half: [first.1, second.1],
            arm: (dot(from_axis, from_axis).sqrt() + size).fast_min(self.radius),
            radius: (dot(center, center).sqrt() + size).fast_min(self.radius),
            size,
            lanes,
        }
    }
}

impl Nodes {
    /// One of them, in all lanes.
    pub fn single(&self, lane: usize) -> Self {
        let point = |p: &Points| splat(lane_of(p, lane));
        let value = |v: f32x8| f32x8::splat(v.as_array()[lane]);
        Self {
            center: [point(&self.center[0]), point(&self.center[1])],
            half: [point(&self.half[0]), point(&self.half[1])],
            arm: value(self.arm),
            radius: value(self.radius),
            size: value(self.size),
            lanes: u32::MAX,
        }
    }
}

/// How long nodes of the first body's and of the second's tree, lane by lane, stay apart.
pub fn stay(a: &Nodes, b: &Nodes, relative: &Rounded) -> Stay {
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
            let spin_a = f32x8::splat(spins_a[i]) * a.arm;
            let spin_b = f32x8::splat(spins_b[i]) * b.arm;
            // However long it turns, no point leaves the sphere about the centre of mass on which it is.
            let most_a = (a.radius - sign * center_a - a.half[k][i])
                .fast_max(zero)
                .fast_min(spin_a);
            let most_b = (b.radius + sign * center_b - b.half[k][i])
                .fast_max(zero)
                .fast_min(spin_b);
            let turning = gap / (speed + spin_a + spin_b).fast_max(tiny);
            let turned = (gap - most_a - most_b) / speed.fast_max(tiny);
            time = time.fast_max(turning).fast_max(turned);
            widest = widest.fast_max(gap);
        }
    }
    Stay {
        time: rounded_down(time),
        far: widest.simd_gt(a.size.fast_max(b.size)).to_bitmask(),
    }
}

/// Times, less what single precision may have added.
pub fn rounded_down(time: f32x8) -> [f32; 8] {
    (time * f32x8::splat(1.0 - 1.0e-5)).to_array()
}
