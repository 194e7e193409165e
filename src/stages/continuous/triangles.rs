//! How long triangles of two clusters stay apart, eight pairs at a time; in single precision, to find out which pairs are worth
//! double precision.
//!
//! As for [`nodes`](super::nodes), but along the first body's axes and the normals of both triangles.

use super::nodes::{TINY, rounded_down};
use super::relative::Rounded;
use crate::stages::mesh_arena::{Cluster, Points};
use crate::stages::triangle_test::cpu::lanes::{Rows, cross, dot, each, lane_of, max, min, splat, sub};
use glam::{Mat3, Vec3};
use wide::f32x8;

/// Eight triangles of one body in the first body's axes, about its centre of mass, in the pair's unit.
pub struct Triangles {
    corners: [Points; 3],
    min: Points,
    max: Points,
    /// Of length one, or shorter: a direction of no length parts nothing.
    normal: Points,
    /// How far corners are off the plane through the first one: slivers have normals of few digits.
    bump: f32x8,
    /// For each body, the speed along the normal that its turn gives a point at a distance of one from its axis, at most.
    spins: [f32x8; 2],
    /// No point is farther from the axis of the turn.
    arm: f32x8,
    /// Lanes that hold a triangle.
    pub lanes: u32,
}

impl Triangles {
    /// Of the first body or of the second. `matrix` turns and scales the mesh into the pair, in which the cluster's origin is
    /// at `origin` from the body's centre of mass, and that one at `center`.
    pub fn new(end: usize, cluster: &Cluster, matrix: Mat3, origin: Vec3, center: Vec3, relative: &Rounded) -> Self {
        let rows = Rows::new(matrix);
        let [p, q, r] = each(|k| rows.times(cluster.corners[k]));
        let normal = cross(sub(q, p), sub(r, p));
        let shrink = f32x8::ONE / dot(normal, normal).sqrt().fast_max(f32x8::splat(TINY));
        let normal = each(|i| normal[i] * shrink);
        let off_plane = |corner: Points| dot(normal, sub(corner, p)).abs();
        let bump = off_plane(q).fast_max(off_plane(r));
        let axis = splat(relative.turns[end].normalize_or_zero());
        let origin_lanes = splat(origin);
        let arm = [p, q, r].map(|corner| {
            let from_axis = cross(each(|i| corner[i] + origin_lanes[i]), axis);
            dot(from_axis, from_axis)
        });
        let at = splat(origin + center);
        let corners = [p, q, r].map(|corner| each(|i| corner[i] + at[i]));
        let [p, q, r] = corners;
        Self {
            corners,
            min: min(p, min(q, r)),
            max: max(p, max(q, r)),
            normal,
            bump,
            spins: relative.turns.map(|turn| {
                let across = cross(normal, splat(turn));
                dot(across, across).sqrt() * f32x8::splat(1.0 + 1.0e-5)
            }),
            arm: arm[0].fast_max(arm[1]).fast_max(arm[2]).sqrt(),
            lanes: cluster.lanes,
        }
    }

    /// How long triangle `i` of these, which are the first body's, stays apart from each of the second body's `others`, in
    /// intervals.
    pub fn stay(&self, i: usize, others: &Self, relative: &Rounded) -> [f32; 8] {
        let zero = f32x8::ZERO;
        let (pad, speed_pad) = (f32x8::splat(relative.pad), f32x8::splat(relative.speed_pad));
        let own = |value: f32x8| f32x8::splat(value.as_array()[i]);
        let arms = [own(self.arm), others.arm];
        let stay = |low: f32x8, high: f32x8, along: f32x8, spins: [f32x8; 2]| {
            // The second is from `low` to `high` above the first along a direction, or below.
            let above = low.simd_ge(-high);
            let gap = above.bitselect(low, -high) - pad;
            let speed = above.bitselect(along, -along) + speed_pad;
            let closing = speed + spins[0] * arms[0] + spins[1] * arms[1];
            gap / closing.fast_max(f32x8::splat(TINY))
        };

        let mut time = zero;
        let frame = &relative.frames[0];
        let spins = frame.spins();
        let (own_min, own_max) = (lane_of(&self.min, i), lane_of(&self.max, i));
        for k in 0..3 {
            let low = others.min[k] - f32x8::splat(own_max[k]);
            let high = others.max[k] - f32x8::splat(own_min[k]);
            let spins = spins.map(|spin| f32x8::splat(spin[k]));
            time = time.fast_max(stay(low, high, f32x8::splat(frame.velocity[k]), spins));
        }

        let corners = self.corners.map(|corner| splat(lane_of(&corner, i)));
        let velocity = splat(frame.velocity);
        let normal = splat(lane_of(&self.normal, i));
        let (low, high) = range(normal, others.corners, corners[0]);
        let bump = own(self.bump);
        time = time.fast_max(stay(
            low - bump,
            high + bump,
            dot(normal, velocity),
            self.spins.map(own),
        ));
        let normal = others.normal;
        // How the first is above the second, the other way round.
        let (low, high) = range(normal, corners, others.corners[0]);
        let bump = others.bump;
        time = time.fast_max(stay(-high - bump, bump - low, dot(normal, velocity), others.spins));
        rounded_down(time)
    }
}

/// From where to where corners are above a plane.
#[inline(always)]
fn range(normal: Points, corners: [Points; 3], on_plane: Points) -> (f32x8, f32x8) {
    let [p, q, r] = corners.map(|corner| dot(normal, sub(corner, on_plane)));
    (p.fast_min(q).fast_min(r), p.fast_max(q).fast_max(r))
}
