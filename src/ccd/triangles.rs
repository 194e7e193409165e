//! Safe times for triangles of two clusters, eight pairs at a time. They are in single precision and determine which
//! pairs need double precision.
//!
//! The bounds are those of [`nodes`](super::nodes), along the first body's axes and the normals of both triangles.

use super::nodes::{TINY, rounded_down};
use super::relative::Rounded;
use crate::simd::lanes::{Rows, cross, dot, each, lane_of, max, min, splat, sub};
use crate::state::mesh_arena::{Cluster, Points};
use glam::{Mat3, Vec3};
use wide::f32x8;

/// Eight triangles of one body, relative to its centre of mass, along the first body's axes, in the pair's unit of
/// length.
pub struct Triangles {
    corners: [Points; 3],
    min: Points,
    max: Points,
    /// Of length one, or shorter for degenerate triangles: a vector of length zero gives no bound.
    normal: Points,
    /// Extent along the normal. It is not 0, because the normals of slivers are inaccurate.
    along_normal: Range,
    /// For each body, the largest speed along the normal of a point at unit distance from the axis of rotation.
    spins: [f32x8; 2],
    /// Upper bound for the distance of any point from the axis of rotation.
    axis_distance: f32x8,
    /// Upper bound for the distance of any point from the centre of mass.
    radius: f32x8,
    /// Lanes that hold a triangle.
    pub lanes: u32,
}

/// Minimum and maximum.
type Range = [f32x8; 2];

impl Triangles {
    /// Triangles of the first body or of the second. `matrix` rotates and scales from the mesh to the pair, and
    /// `origin` is the cluster's origin in the pair.
    pub fn new(side: usize, cluster: &Cluster, matrix: Mat3, origin: Vec3, relative: &Rounded) -> Self {
        let rows = Rows::new(matrix);
        let [p, q, r] = each(|k| rows.times(cluster.corners[k]));
        let normal = cross(sub(q, p), sub(r, p));
        let shrink = f32x8::ONE / dot(normal, normal).sqrt().fast_max(f32x8::splat(TINY));
        let normal = each(|i| normal[i] * shrink);
        let (axis, at) = (splat(relative.turns[side].normalize_or_zero()), splat(origin));
        let corners = [p, q, r].map(|corner| each(|i| corner[i] + at[i]));
        let longest = |lengths: [f32x8; 3]| lengths[0].fast_max(lengths[1]).fast_max(lengths[2]).sqrt();
        let [p, q, r] = corners;
        Self {
            corners,
            min: min(p, min(q, r)),
            max: max(p, max(q, r)),
            normal,
            along_normal: range(normal, corners),
            spins: relative.turns.map(|turn| {
                let across = cross(normal, splat(turn));
                dot(across, across).sqrt() * f32x8::splat(1.0 + 1.0e-5)
            }),
            axis_distance: longest(corners.map(|corner| {
                let from_axis = cross(corner, axis);
                dot(from_axis, from_axis)
            })),
            radius: longest(corners.map(|corner| dot(corner, corner))),
            lanes: cluster.lanes,
        }
    }

    /// The safe times of triangle `i` of these, which are the first body's, and each of `others`, which are the
    /// second's, as fractions of the collision substep.
    pub fn safe_times(&self, i: usize, others: &Self, relative: &Rounded) -> [f32; 8] {
        let zero = f32x8::ZERO;
        let (pad, speed_pad) = (f32x8::splat(relative.pad), f32x8::splat(relative.speed_pad));
        let tiny = f32x8::splat(TINY);
        let own = |value: f32x8| f32x8::splat(value.as_array()[i]);
        let axis_distances = [own(self.axis_distance), others.axis_distance];
        let radii = [own(self.radius), others.radius];
        // Along a direction, `apart` is the offset from the first centre of mass to the second, which approach at
        // `speed`.
        let safe_time = |apart: f32x8, speed: f32x8, a: Range, b: Range, spins: [f32x8; 2]| {
            let (low, high) = (apart + b[0] - a[1], apart + b[1] - a[0]);
            let above = low.simd_ge(-high);
            let gap = above.bitselect(low, -high) - pad;
            let speed = above.bitselect(speed, -speed) + speed_pad;
            let [spin_a, spin_b] = [spins[0] * axis_distances[0], spins[1] * axis_distances[1]];
            // As for nodes, every point stays on its sphere.
            let max_a = radii[0] - above.bitselect(a[1], -a[0]);
            let max_b = radii[1] - above.bitselect(-b[0], b[1]);
            let max_rotation = max_a.fast_max(zero).fast_min(spin_a) + max_b.fast_max(zero).fast_min(spin_b);
            let rotating = gap / (speed + spin_a + spin_b).fast_max(tiny);
            rotating.fast_max((gap - max_rotation) / speed.fast_max(tiny))
        };

        let mut time = zero;
        let frame = &relative.frames[0];
        let spins = frame.spins();
        let (own_min, own_max) = (lane_of(&self.min, i), lane_of(&self.max, i));
        for k in 0..3 {
            let apart = f32x8::splat(frame.translation[k]);
            let speed = f32x8::splat(frame.velocity[k]);
            let a = [f32x8::splat(own_min[k]), f32x8::splat(own_max[k])];
            let spins = spins.map(|spin| f32x8::splat(spin[k]));
            time = time.fast_max(safe_time(apart, speed, a, [others.min[k], others.max[k]], spins));
        }

        let (translation, velocity) = (splat(frame.translation), splat(frame.velocity));
        let normal = splat(lane_of(&self.normal, i));
        let (apart, speed) = (dot(normal, translation), dot(normal, velocity));
        let (a, b) = (self.along_normal.map(own), range(normal, others.corners));
        time = time.fast_max(safe_time(apart, speed, a, b, self.spins.map(own)));

        let corners = self.corners.map(|corner| splat(lane_of(&corner, i)));
        let normal = others.normal;
        let (apart, speed) = (dot(normal, translation), dot(normal, velocity));
        let (a, b) = (range(normal, corners), others.along_normal);
        time = time.fast_max(safe_time(apart, speed, a, b, others.spins));
        rounded_down(time)
    }
}

/// The extent of eight triangles along a direction.
#[inline(always)]
fn range(direction: Points, corners: [Points; 3]) -> Range {
    let [p, q, r] = corners.map(|corner| dot(direction, corner));
    [p.fast_min(q).fast_min(r), p.fast_max(q).fast_max(r)]
}
