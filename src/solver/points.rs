//! How contact points move with their bodies: separations, normals, and the rows that follow from them.

use super::batch::{Batch, PointLanes, RowLanes, gather};
use super::motion::{Mass, PoseChange, StatesMut};
use crate::geometry::lanes::Stored;
use crate::simd::lanes::{
    Points, Select, Simd, SimdBase, SimdFloat, add, cross, dot, f32x8, lanes, load, load_points, pick, scale, splat,
    store, store_points, sub,
};

/// Updates separations, anchors and effective masses of the points of a batch to the present poses.
///
/// Runs whenever the bodies have moved: impulses at outdated positions would not conserve angular momentum.
#[inline(always)]
pub(super) fn update_points<S: Simd>(simd: S, batch: &Batch, points: &mut [PointLanes], states: &StatesMut) {
    let changes = [
        PoseChanges::load(simd, batch, 0, states.pose_changes),
        PoseChanges::load(simd, batch, 1, states.pose_changes),
    ];
    let masses = Masses {
        inverse_inertias: [
            inverse_inertias(batch, 0, states.masses),
            inverse_inertias(batch, 1, states.masses),
        ],
        inverse_mass: load_points(simd, &batch.inverse_mass),
    };
    let translation = sub(changes[1].translation, changes[0].translation);
    let depenetrating = lanes(simd, batch.depenetrating);
    let zero = [splat(simd, 0.0); 3];
    for point in points.iter_mut().filter(|point| point.valid != 0) {
        let turned = [
            changes[0].rotation_displacement(load_points(simd, &point.curvature_centers[0])),
            changes[1].rotation_displacement(load_points(simd, &point.curvature_centers[1])),
        ];
        let displacement = sub(add(translation, turned[1]), turned[0]);
        if point.curved & !point.touched != 0 {
            point.rotate_normals(simd, displacement);
        }
        point.separation = store(point.separation_after(simd, displacement));
        // Both impulses act at one position. Otherwise they would exert a moment on the pair.
        let offset = add(load_points(simd, &point.anchor_offset), displacement);
        let fraction = load(simd, &point.contact_fraction);
        let [a, b] = &point.anchors;
        let a = add(add(load_points(simd, a), turned[0]), scale(offset, fraction));
        let b = sub(
            add(load_points(simd, b), turned[1]),
            scale(offset, splat(simd, 1.0) - fraction),
        );
        // In deep penetration they act at the centres of mass.
        point.set_anchors(
            simd,
            [pick(depenetrating, zero, a), pick(depenetrating, zero, b)],
            &masses,
        );
    }
}

impl PointLanes {
    /// Rotates the normals of curved surfaces that have not touched yet, such as two balls that pass each other: the
    /// impulse acts along the normal at the moment of contact. `displacement` is the motion of the second centres of
    /// curvature relative to the first.
    #[inline(always)]
    fn rotate_normals<S: Simd>(&mut self, simd: S, displacement: Points<S>) {
        let rotates = lanes(simd, self.curved & !self.touched);
        let initial = load_points(simd, &self.initial_normal);
        let normal = add(initial, scale(displacement, load(simd, &self.normal_rotation)));
        let square = dot(normal, normal);
        let (least, most) = (splat(simd, f32::MIN_POSITIVE), splat(simd, f32::INFINITY));
        let is_vector = square.simd_gt(least) & square.simd_lt(most);
        let unit = scale(normal, splat(simd, 1.0) / square.sqrt());
        let frame = frame(simd, pick(is_vector, unit, initial));
        for (row, direction) in self.rows.iter_mut().zip(frame) {
            let before = load_points(simd, &row.direction);
            row.direction = store_points(pick(rotates, direction, before));
        }
    }

    /// The separations beyond the rest offset after such displacements.
    #[inline(always)]
    fn separation_after<S: Simd>(&self, simd: S, displacement: Points<S>) -> f32x8<S> {
        let normal = load_points(simd, &self.rows[0].direction);
        let along = load(simd, &self.initial_separation) + dot(normal, displacement);
        if self.curved == 0 {
            return along;
        }
        // The distance between the centres of curvature is shorter along the rotated normal.
        let turned = sub(normal, load_points(simd, &self.initial_normal));
        let shorter = along - splat(simd, 0.5) * dot(turned, turned) / load(simd, &self.normal_rotation);
        lanes(simd, self.curved).select(shorter, along)
    }

    /// Sets the places at which impulses act, from each centre of mass.
    #[inline(always)]
    fn set_anchors<S: Simd>(&mut self, simd: S, anchors: [Points<S>; 2], masses: &Masses<S>) {
        let offset = load_points(simd, &self.friction_offset);
        let friction_anchors = [add(anchors[0], offset), add(anchors[1], offset)];
        let [normal, t, u] = &mut self.rows;
        let k = normal.set_anchors(simd, anchors, masses);
        // Both tangents use the same value. Otherwise friction would not point against the sliding direction.
        let k_t = t.set_anchors(simd, friction_anchors, masses);
        let k_u = u.set_anchors(simd, friction_anchors, masses);
        self.inverse_effective_mass = [store(k), store(k_t.max(k_u))];
    }
}

impl RowLanes {
    /// Sets the Jacobian for these anchors, and returns the change of relative velocity by a unit impulse.
    #[inline(always)]
    fn set_anchors<S: Simd>(&mut self, simd: S, anchors: [Points<S>; 2], masses: &Masses<S>) -> f32x8<S> {
        let direction = load_points(simd, &self.direction);
        let [a, b] = &masses.inverse_inertias;
        let moments = [cross(anchors[0], direction), cross(anchors[1], direction)];
        let responses = [times(simd, a, moments[0]), times(simd, b, moments[1])];
        self.moments = [store_points(moments[0]), store_points(moments[1])];
        self.angular_responses = [store_points(responses[0]), store_points(responses[1])];
        let [x, y, z] = direction;
        dot(masses.inverse_mass, [x * x, y * y, z * z])
            + (dot(moments[0], responses[0]) + dot(moments[1], responses[1]))
    }
}

/// How impulses change the velocities of the bodies of a batch.
struct Masses<S: Simd> {
    /// Inverse inertia of each side, by columns.
    inverse_inertias: [[Stored; 9]; 2],
    /// The sum of both sides' inverse masses, along each axis.
    inverse_mass: Points<S>,
}

#[inline(always)]
fn inverse_inertias(batch: &Batch, side: usize, masses: &[Mass]) -> [Stored; 9] {
    gather(batch, side, |slot| masses[slot].inverse_inertia.to_cols_array())
}

/// A matrix, by columns, times a vector.
#[inline(always)]
fn times<S: Simd>(simd: S, m: &[Stored; 9], [x, y, z]: Points<S>) -> Points<S> {
    [
        load(simd, &m[0]) * x + load(simd, &m[3]) * y + load(simd, &m[6]) * z,
        load(simd, &m[1]) * x + load(simd, &m[4]) * y + load(simd, &m[7]) * z,
        load(simd, &m[2]) * x + load(simd, &m[5]) * y + load(simd, &m[8]) * z,
    ]
}

/// The changes of the poses of the bodies on one side of a batch.
struct PoseChanges<S: Simd> {
    translation: Points<S>,
    /// The vector part of the rotations, and the scalar part.
    axis: Points<S>,
    w: f32x8<S>,
}

impl<S: Simd> PoseChanges<S> {
    #[inline(always)]
    fn load(simd: S, batch: &Batch, side: usize, changes: &[PoseChange]) -> Self {
        let [a, b, c, x, y, z, w] = gather(batch, side, |slot| {
            let [a, b, c] = changes[slot].translation.to_array();
            let [x, y, z, w] = changes[slot].rotation.to_array();
            [a, b, c, x, y, z, w]
        });
        Self {
            translation: load_points(simd, &[a, b, c]),
            axis: load_points(simd, &[x, y, z]),
            w: load(simd, &w),
        }
    }

    /// By how far the rotations move vectors, without cancellation.
    #[inline(always)]
    fn rotation_displacement(&self, v: Points<S>) -> Points<S> {
        let t = scale(cross(self.axis, v), splat(self.w.simd, 2.0));
        add(scale(t, self.w), cross(self.axis, t))
    }
}

/// Normals and two tangents of each; see [`frame`](super::contact::frame).
#[inline(always)]
fn frame<S: Simd>(simd: S, normal: Points<S>) -> [Points<S>; 3] {
    let [x, y, z] = normal;
    // Duff et al., "Building an Orthonormal Basis, Revisited", 2017.
    let sign = splat(simd, 1.0).copysign(z);
    let a = splat(simd, -1.0) / (sign + z);
    let b = x * y * a;
    let t = [splat(simd, 1.0) + sign * x * x * a, sign * b, -sign * x];
    let u = [b, sign + y * y * a, -y];
    [normal, t, u]
}
