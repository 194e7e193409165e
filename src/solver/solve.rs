//! One pass over one pair: from the velocities of its two bodies to an impulse for each.

use super::constraints::{Impulse, Pair, Point, Row};
use super::friction::friction_impulse;
use super::motion::{BodyStates, Mass, Velocity, rotation_displacement};
use super::softness::Softness;
use crate::types::solver_settings::SolverSettings;
use glam::Vec3A;

/// Points are active in a substep if they come nearer than this fraction of the rest offset, beyond the rest offset.
pub(super) const ACTIVATION_DISTANCE: f32 = 0.5;

/// Parameters of a pass, the same for all pairs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pass {
    /// Length of the substep, seconds.
    h: f32,
    softness: Softness,
    /// Fraction of a correction that one sweep applies.
    relaxation: f32,
    sweeps: u32,
    max_depenetration_speed: f32,
    deep_depenetration_speed: f32,
    /// Overlapping bodies get a bias velocity that pushes them apart.
    biased: bool,
}

impl Pass {
    pub fn new(settings: &SolverSettings, h: f32) -> Self {
        Self {
            h,
            softness: Softness::new(settings, h),
            relaxation: settings.relaxation,
            sweeps: settings.sweeps,
            max_depenetration_speed: settings.max_depenetration_speed,
            deep_depenetration_speed: settings.deep_depenetration_speed,
            biased: true,
        }
    }

    /// The same pass without bias velocity.
    pub fn relaxing(self) -> Self {
        Self { biased: false, ..self }
    }

    /// Bias velocity, mass scale and impulse scale of a point.
    fn bias(&self, pair: &Pair, separation: f32) -> (f32, f32, f32) {
        if separation > 0.0 {
            // Speculative contact: the gap may close by the end of the substep, and no sooner.
            (separation / self.h, 1.0, 0.0)
        } else if !self.biased {
            (0.0, 1.0, 0.0)
        } else if pair.depenetrating {
            // Near the surface the bias falls below the maximum, to that of the contact spring of other pairs.
            let speed = (self.softness.bias_rate * separation).max(-self.deep_depenetration_speed);
            (speed, 1.0, 0.0)
        } else {
            let speed = (self.softness.bias_rate * separation).max(-self.max_depenetration_speed);
            (speed, self.softness.mass_scale, self.softness.impulse_scale)
        }
    }
}

/// Updates separations, anchors and effective masses of a pair's points to the present poses.
pub(super) fn update_points(pair: &Pair, points: &mut [Point], states: &BodyStates) {
    if pair.frozen {
        return;
    }
    let [a, b] = pair.bodies.map(|i| states.pose_changes[i as usize]);
    let masses = pair.bodies.map(|i| states.masses[i as usize]);
    let translation = b.translation - a.translation;
    for point in points.iter_mut().filter(|p| p.valid) {
        let mut anchors = [Vec3A::ZERO; 2];
        if pair.depenetrating {
            point.separation = point.initial_separation + point.normal().dot(translation);
        } else {
            let changes = [
                rotation_displacement(a.rotation, point.curvature_centers[0]),
                rotation_displacement(b.rotation, point.curvature_centers[1]),
            ];
            let displacement = translation + changes[1] - changes[0];
            point.rotate_normal(displacement);
            point.separation = point.separation_after(displacement);
            // Both impulses act at one position. Otherwise they would exert a moment on the pair.
            let offset = point.anchor_offset + displacement;
            anchors = [
                point.anchors[0] + changes[0] + point.contact_fraction * offset,
                point.anchors[1] + changes[1] - (1.0 - point.contact_fraction) * offset,
            ];
        }
        let mut inverse_effective_mass = [[0.0; 3]; 2];
        for (i, row) in point.rows.iter_mut().enumerate() {
            let d = row.direction;
            row.moments = anchors.map(|anchor| anchor.cross(d));
            row.angular_responses = [0, 1].map(|side| masses[side].inverse_inertia * row.moments[side]);
            for (side, k) in inverse_effective_mass.iter_mut().enumerate() {
                k[i] = (masses[side].inverse_mass * d).dot(d) + row.moments[side].dot(row.angular_responses[side]);
            }
        }
        // Both tangents use the same value. Otherwise friction would not point against the sliding direction.
        point.inverse_effective_mass = inverse_effective_mass.map(|[normal, t, u]| [normal, t.max(u)]);
    }
}

/// Updates the points, decides which of them are active in this substep, and warm starts these with the impulses of the
/// last substep.
pub(super) fn begin_substep(pair: &mut Pair, points: &mut [Point], states: &BodyStates, pass: &Pass) -> [Impulse; 2] {
    pair.active = false;
    if pair.frozen {
        return [Impulse::default(); 2];
    }
    update_points(pair, points, states);
    let mut velocities = PairVelocities::new(pair, states);
    for point in points.iter_mut().filter(|p| p.valid) {
        // All points are judged by the velocities before the warm start: its impulses change them only after this pass.
        let normal_velocity = velocities.along(&point.rows[0]);
        point.total_normal_impulse += point.normal_impulse;
        if point.max_normal_impulse == 0.0 {
            point.impact_velocity = normal_velocity;
        }
        point.active = point.normal_impulse > 0.0
            || point.separation + normal_velocity * pass.h < ACTIVATION_DISTANCE * pair.rest_offset;
        if !point.active {
            point.normal_impulse = 0.0;
            point.friction_impulse = [0.0; 2];
            continue;
        }
        pair.active = true;
        velocities.accumulate(&point.rows[0], point.normal_impulse);
        velocities.accumulate(&point.rows[1], point.friction_impulse[0]);
        velocities.accumulate(&point.rows[2], point.friction_impulse[1]);
    }
    velocities.impulses()
}

/// One pass over a pair's active points.
pub(super) fn solve(pair: &Pair, points: &mut [Point], states: &BodyStates, pass: &Pass) -> [Impulse; 2] {
    if !pair.active {
        return [Impulse::default(); 2];
    }
    let mut velocities = PairVelocities::new(pair, states);
    for _ in 0..pass.sweeps {
        for point in points.iter_mut().filter(|p| p.active) {
            let Some([k_normal, k_tangent]) = velocities.inverse_effective_mass(point) else {
                continue;
            };
            let (bias, mass_scale, impulse_scale) = pass.bias(pair, point.separation);
            let velocity_error = velocities.along(&point.rows[0]) + bias;
            let change =
                -pass.relaxation * mass_scale * velocity_error / k_normal - impulse_scale * point.normal_impulse;
            let impulse = (point.normal_impulse + change).max(0.0);
            velocities.apply(&point.rows[0], impulse - point.normal_impulse);
            point.normal_impulse = impulse;
            point.max_normal_impulse = point.max_normal_impulse.max(impulse);

            let limit = if pair.depenetrating {
                0.0
            } else {
                pair.friction * impulse
            };
            let friction = friction_impulse(
                &velocities,
                point,
                k_tangent,
                point.friction_impulse,
                pass.relaxation,
                limit,
            );
            velocities.apply(&point.rows[1], friction[0] - point.friction_impulse[0]);
            velocities.apply(&point.rows[2], friction[1] - point.friction_impulse[1]);
            point.friction_impulse = friction;
        }
    }
    velocities.impulses()
}

/// The velocities of a pair's bodies during a pass, and the impulses it has applied so far. Each body has only this
/// pair's part of its mass.
pub(super) struct PairVelocities {
    velocities: [Velocity; 2],
    /// Of the part of the mass that belongs to this pair.
    inverse_masses: [Vec3A; 2],
    split_counts: [f32; 2],
    /// Linear impulse on the second body; the first body gets the opposite.
    linear: Vec3A,
    angular: [Vec3A; 2],
}

impl PairVelocities {
    pub fn new(pair: &Pair, states: &BodyStates) -> Self {
        let masses: [&Mass; 2] = pair.bodies.map(|i| &states.masses[i as usize]);
        Self {
            velocities: pair.bodies.map(|i| states.velocities[i as usize]),
            inverse_masses: masses.map(|m| m.split_count * m.inverse_mass),
            split_counts: masses.map(|m| m.split_count),
            linear: Vec3A::ZERO,
            angular: [Vec3A::ZERO; 2],
        }
    }

    /// The inverse effective mass of a point along the normal and along the tangents; `None` if no impulse can change
    /// the normal velocity.
    pub fn inverse_effective_mass(&self, point: &Point) -> Option<[f32; 2]> {
        let [a, b] = self.split_counts;
        let k = [0, 1].map(|d| a * point.inverse_effective_mass[0][d] + b * point.inverse_effective_mass[1][d]);
        (k[0] > 0.0).then_some(k)
    }

    /// Velocity of the second body relative to the first along a row's direction. Along the normal it is positive when
    /// the bodies separate.
    pub fn along(&self, row: &Row) -> f32 {
        let [a, b] = &self.velocities;
        let sum = row.direction * (b.linear - a.linear) + row.moments[1] * b.angular - row.moments[0] * a.angular;
        sum.element_sum()
    }

    /// Adds an impulse on the second body, and its opposite on the first, to the pair's impulses. Velocities stay the
    /// same.
    fn accumulate(&mut self, row: &Row, impulse: f32) {
        self.linear += row.direction * impulse;
        self.angular[0] -= row.moments[0] * impulse;
        self.angular[1] += row.moments[1] * impulse;
    }

    /// Applies an impulse to the second body, and its opposite to the first.
    pub fn apply(&mut self, row: &Row, impulse: f32) {
        self.accumulate(row, impulse);
        let linear = row.direction * impulse;
        let [a, b] = &mut self.velocities;
        a.linear -= self.inverse_masses[0] * linear;
        a.angular -= row.angular_responses[0] * (self.split_counts[0] * impulse);
        b.linear += self.inverse_masses[1] * linear;
        b.angular += row.angular_responses[1] * (self.split_counts[1] * impulse);
    }

    /// The sum of all impulses on each body.
    pub fn impulses(&self) -> [Impulse; 2] {
        let [first, second] = self.angular;
        [
            Impulse {
                linear: -self.linear,
                angular: first,
            },
            Impulse {
                linear: self.linear,
                angular: second,
            },
        ]
    }
}
