//! Safe times for triangles of two clusters, eight pairs at a time. They are in single precision and determine which
//! pairs need double precision.
//!
//! The bounds are those of [`nodes`](super::nodes), along the first body's axes and the normals of both triangles.

use super::nodes::{TINY, rounded_down};
use super::relative::Rounded;
use crate::simd::lanes::{
    Points, Rows, Select, Simd, SimdBase, SimdFloat, add, broadcast, broadcast_point, cross, dot, f32x8, largest,
    least, load_points, max, min, scale, splat, splat_point, sub,
};
use crate::state::mesh_arena::Cluster;
use glam::{Mat3, Vec3};

/// Eight triangles of one body, relative to its centre of mass, along the first body's axes, in the pair's unit of
/// length.
pub struct Triangles<S: Simd> {
    corners: [Points<S>; 3],
    min: Points<S>,
    max: Points<S>,
    /// A unit vector, or a shorter one for degenerate triangles: a vector of length zero gives no bound.
    normal: Points<S>,
    /// Extent along the normal. It is not 0, because the normals of slivers are inaccurate.
    along_normal: Range<S>,
    /// For each body, the largest speed along the normal of a point at unit distance from the axis of rotation.
    spins: [f32x8<S>; 2],
    /// Upper bound for the distance of any point from the axis of rotation.
    axis_distance: f32x8<S>,
    /// Upper bound for the distance of any point from the centre of mass.
    radius: f32x8<S>,
    /// Lanes that hold a triangle.
    pub lanes: u32,
}

/// Minimum and maximum.
type Range<S> = [f32x8<S>; 2];

impl<S: Simd> Triangles<S> {
    /// Triangles of the first body or of the second. `matrix` rotates and scales from the mesh to the pair, and
    /// `origin` is the cluster's origin in the pair.
    #[inline(always)]
    pub fn new(simd: S, side: usize, cluster: &Cluster, matrix: Mat3, origin: Vec3, relative: &Rounded) -> Self {
        let rows = Rows::new(simd, matrix);
        let p = rows.times(load_points(simd, &cluster.corners[0]));
        let q = rows.times(load_points(simd, &cluster.corners[1]));
        let r = rows.times(load_points(simd, &cluster.corners[2]));
        let normal = cross(sub(q, p), sub(r, p));
        let shrink = splat(simd, 1.0) / length(normal).max(splat(simd, TINY));
        let normal = scale(normal, shrink);
        let axis = splat_point(simd, relative.turns[side].normalize_or_zero());
        let at = splat_point(simd, origin);
        let (p, q, r) = (add(p, at), add(q, at), add(r, at));
        let [turn_a, turn_b] = relative.turns;
        let (from_axis_p, from_axis_q, from_axis_r) = (cross(p, axis), cross(q, axis), cross(r, axis));
        Self {
            corners: [p, q, r],
            min: min(p, min(q, r)),
            max: max(p, max(q, r)),
            normal,
            along_normal: range(normal, [p, q, r]),
            spins: [spin(normal, turn_a), spin(normal, turn_b)],
            axis_distance: longest([from_axis_p, from_axis_q, from_axis_r]),
            radius: longest([p, q, r]),
            lanes: cluster.lanes,
        }
    }

    /// The safe times of triangle `i` of these, of the first body, and each of `others`, of the second, as fractions of
    /// the collision substep.
    #[inline(always)]
    pub fn safe_times(&self, i: usize, others: &Self, relative: &Rounded) -> [f32; 8] {
        let simd = self.radius.simd;
        let params = SafeTimeParams {
            pad: splat(simd, relative.pad),
            speed_pad: splat(simd, relative.speed_pad),
            axis_distances: [broadcast(&self.axis_distance, i), others.axis_distance],
            radii: [broadcast(&self.radius, i), others.radius],
        };

        let mut time = splat(simd, 0.0);
        let frame = &relative.frames[0];
        let [spins_a, spins_b] = frame.spins();
        let (own_min, own_max) = (broadcast_point(&self.min, i), broadcast_point(&self.max, i));
        for k in 0..3 {
            let apart = splat(simd, frame.translation[k]);
            let speed = splat(simd, frame.velocity[k]);
            let (a, b) = ([own_min[k], own_max[k]], [others.min[k], others.max[k]]);
            let spins = [splat(simd, spins_a[k]), splat(simd, spins_b[k])];
            time = time.max(params.safe_time(apart, speed, a, b, spins));
        }

        let translation = splat_point(simd, frame.translation);
        let velocity = splat_point(simd, frame.velocity);
        let normal = broadcast_point(&self.normal, i);
        let (apart, speed) = (dot(normal, translation), dot(normal, velocity));
        let a = [broadcast(&self.along_normal[0], i), broadcast(&self.along_normal[1], i)];
        let spins = [broadcast(&self.spins[0], i), broadcast(&self.spins[1], i)];
        let b = range(normal, others.corners);
        time = time.max(params.safe_time(apart, speed, a, b, spins));

        let [p, q, r] = &self.corners;
        let corners = [broadcast_point(p, i), broadcast_point(q, i), broadcast_point(r, i)];
        let normal = others.normal;
        let (apart, speed) = (dot(normal, translation), dot(normal, velocity));
        let (a, b) = (range(normal, corners), others.along_normal);
        time = time.max(params.safe_time(apart, speed, a, b, others.spins));
        rounded_down(time)
    }
}

/// What safe times along all directions have in common.
struct SafeTimeParams<S: Simd> {
    pad: f32x8<S>,
    speed_pad: f32x8<S>,
    axis_distances: [f32x8<S>; 2],
    radii: [f32x8<S>; 2],
}

impl<S: Simd> SafeTimeParams<S> {
    /// The safe time along a direction. `apart` is the offset from the first centre of mass to the second, which
    /// approach at `speed`.
    #[inline(always)]
    fn safe_time(&self, apart: f32x8<S>, speed: f32x8<S>, a: Range<S>, b: Range<S>, spins: [f32x8<S>; 2]) -> f32x8<S> {
        let (zero, tiny) = (splat(apart.simd, 0.0), splat(apart.simd, TINY));
        let (low, high) = (apart + b[0] - a[1], apart + b[1] - a[0]);
        let above = low.simd_ge(-high);
        let gap = above.select(low, -high) - self.pad;
        let speed = above.select(speed, -speed) + self.speed_pad;
        let spin_a = spins[0] * self.axis_distances[0];
        let spin_b = spins[1] * self.axis_distances[1];
        // As for nodes, every point stays on its sphere.
        let max_a = self.radii[0] - above.select(a[1], -a[0]);
        let max_b = self.radii[1] - above.select(-b[0], b[1]);
        let max_rotation = max_a.max(zero).min(spin_a) + max_b.max(zero).min(spin_b);
        let rotating = gap / (speed + spin_a + spin_b).max(tiny);
        rotating.max((gap - max_rotation) / speed.max(tiny))
    }
}

/// The largest speed along the normal of a point at unit distance from the axis of rotation, rounded up.
#[inline(always)]
fn spin<S: Simd>(normal: Points<S>, turn: Vec3) -> f32x8<S> {
    let simd = normal[0].simd;
    length(cross(normal, splat_point(simd, turn))) * splat(simd, 1.0 + 1.0e-5)
}

#[inline(always)]
fn length<S: Simd>(p: Points<S>) -> f32x8<S> {
    dot(p, p).sqrt()
}

/// The length of the longest of three vectors.
#[inline(always)]
fn longest<S: Simd>([p, q, r]: [Points<S>; 3]) -> f32x8<S> {
    largest([dot(p, p), dot(q, q), dot(r, r)]).sqrt()
}

/// The extent of eight triangles along a direction.
#[inline(always)]
fn range<S: Simd>(direction: Points<S>, [p, q, r]: [Points<S>; 3]) -> Range<S> {
    let along = [dot(direction, p), dot(direction, q), dot(direction, r)];
    [least(along), largest(along)]
}
