//! One pass over one pair: impulses that change the velocities of its two bodies.

use super::body_constants::rotation_displacement;
use super::contact::{Pair, Point, Row};
use super::friction::friction_impulse;
use super::motion::{Mass, StatesMut, Velocity};
use super::softness::Softness;
use crate::types::solver_settings::SolverSettings;
use glam::Vec3A;

/// A point is active in a substep if the gap beyond the rest offset will be less than this many rest offsets.
pub(super) const ACTIVATION_DISTANCE: f32 = 5.0;
/// An error is too large if it moves a body by this fraction of D within a substep, however slow that is.
pub(super) const MAX_STEP_ERROR: f32 = 1.0e-4;

/// What a pass is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Purpose {
    /// Overlapping bodies get a bias velocity that pushes them apart.
    Bias,
    /// Removes the velocity that the bias added.
    Relax,
    /// Points with an impact separate as Newton's law of restitution tells.
    Restitution,
}

/// Parameters of a pass, the same for all pairs of an island.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pass {
    /// Length of the substep, seconds.
    h: f32,
    softness: Softness,
    max_depenetration_speed: f32,
    deep_depenetration_speed: f32,
    purpose: Purpose,
    /// See [`SolverSettings::convergence_speed`].
    convergence_speed: f32,
}

impl Pass {
    /// A pass with bias velocity in a substep of `h` seconds.
    pub fn new(settings: &SolverSettings, h: f32) -> Self {
        Self {
            h,
            softness: Softness::new(settings, h),
            max_depenetration_speed: settings.max_depenetration_speed,
            deep_depenetration_speed: settings.deep_depenetration_speed,
            purpose: Purpose::Bias,
            convergence_speed: settings.convergence_speed,
        }
    }

    /// The same pass without bias velocity.
    pub fn relaxing(self) -> Self {
        Self {
            purpose: Purpose::Relax,
            ..self
        }
    }

    /// The same pass with restitution, until no velocity changes by more than `convergence_speed`.
    pub fn with_restitution(self, convergence_speed: f32) -> Self {
        Self {
            convergence_speed,
            purpose: Purpose::Restitution,
            ..self
        }
    }

    /// The change of a normal velocity below which a pair has converged, m/s. A light body passes on only a small part
    /// of what a heavy one needs, so it must be more exact.
    fn convergence_speed(&self, pair: &Pair) -> f32 {
        self.convergence_speed.min(MAX_STEP_ERROR * pair.diameter / self.h) / pair.mass_ratio
    }

    /// Bias velocity, mass scale and impulse scale of a point.
    fn bias(&self, pair: &Pair, point: &Point) -> (f32, f32, f32) {
        let separation = point.separation;
        if self.purpose == Purpose::Restitution && point.rebounds {
            (pair.restitution * point.impact_velocity, 1.0, 0.0)
        } else if separation > 0.0 {
            // Speculative contact: the gap may close by the end of the substep, and no sooner.
            (separation / self.h, 1.0, 0.0)
        } else if self.purpose != Purpose::Bias {
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

/// Decides which of a pair's points are active in this substep. They are up to date with the poses.
pub(super) fn begin_substep(pair: &mut Pair, points: &mut [Point], states: &StatesMut, pass: &Pass) {
    pair.active = false;
    let velocities = PairVelocities::new(pair, states);
    let spins = pair.slots.map(|slot| states.velocities[slot as usize].angular);
    for point in points.iter_mut().filter(|p| p.valid) {
        point.set_drift(spins, pair.tangent_velocity, pass.h);
        // All points are judged by the velocities before the warm start.
        let normal_velocity = velocities.along(&point.rows[0]);
        point.total_normal_impulse += point.normal_impulse;
        point.may_impact = point.normal_impulse == 0.0;
        point.has_impact = false;
        point.rebounds = false;
        point.touched |= point.normal_impulse > 0.0;
        point.active = point.normal_impulse > 0.0
            || point.separation + normal_velocity * pass.h < ACTIVATION_DISTANCE * pair.rest_offset;
        if !point.active {
            point.friction_impulse = [0.0; 2];
        }
        pair.active |= point.active;
    }
}

/// Updates separations, anchors and effective masses of a pair's points to the present poses.
///
/// Runs whenever the bodies have moved: impulses at outdated positions would not conserve angular momentum.
pub(super) fn update_points(pair: &Pair, points: &mut [Point], states: &StatesMut) {
    let [a, b] = pair.slots.map(|slot| states.pose_changes[slot as usize]);
    let masses = pair.slots.map(|slot| states.masses[slot as usize]);
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
        point.set_anchors(anchors, masses);
    }
}

/// Applies the impulses of a pair's points, times `factor`.
pub(super) fn apply_impulses(pair: &Pair, points: &[Point], states: &mut StatesMut, factor: f32) {
    if !pair.active {
        return;
    }
    let mut velocities = PairVelocities::new(pair, states);
    for point in points.iter().filter(|p| p.active) {
        velocities.apply(&point.rows[0], factor * point.normal_impulse);
        velocities.apply(&point.rows[1], factor * point.friction_impulse[0]);
        velocities.apply(&point.rows[2], factor * point.friction_impulse[1]);
    }
    velocities.store(pair, states);
}

/// How far a pass changed the impulses.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Residual {
    /// The largest change of a normal velocity, over that below which its pair has converged.
    velocity: f32,
    /// The sum of the squared changes of impulses, each over its effective mass, joules.
    pub energy: f32,
}

impl Residual {
    pub fn has_converged(&self) -> bool {
        self.velocity <= 1.0
    }
}

/// One pass over a pair's active points: first the normals, then friction.
pub(super) fn solve(pair: &Pair, points: &mut [Point], states: &mut StatesMut, pass: &Pass, residual: &mut Residual) {
    if !pair.active {
        return;
    }
    let mut velocities = PairVelocities::new(pair, states);
    let mut largest_change = 0.0f32;
    for point in points.iter_mut().filter(|p| p.active) {
        let [k, _] = point.inverse_effective_mass;
        if k <= 0.0 {
            continue;
        }
        let (bias, mass_scale, impulse_scale) = pass.bias(pair, point);
        let velocity_error = velocities.along(&point.rows[0]) + bias;
        let change = -mass_scale * velocity_error / k - impulse_scale * point.normal_impulse;
        let impulse = (point.normal_impulse + change).max(0.0);
        let change = impulse - point.normal_impulse;
        velocities.apply(&point.rows[0], change);
        largest_change = largest_change.max((change * k).abs());
        residual.energy += change * change * k;
        point.change[0] = change;
        point.normal_impulse = impulse;
        point.touched |= impulse > 0.0;
    }
    let friction = if pair.depenetrating { 0.0 } else { pair.friction };
    let keeps_place = pass.purpose == Purpose::Bias;
    for point in points.iter_mut().filter(|p| p.active) {
        let [_, k] = point.inverse_effective_mass;
        let impulses = friction_impulse(&velocities, point, friction * point.normal_impulse, keeps_place);
        for (i, impulse) in impulses.into_iter().enumerate() {
            let change = impulse - point.friction_impulse[i];
            velocities.apply(&point.rows[i + 1], change);
            residual.energy += change * change * k;
            point.change[i + 1] = change;
        }
        point.friction_impulse = impulses;
    }
    residual.velocity = residual.velocity.max(largest_change / pass.convergence_speed(pair));
    velocities.store(pair, states);
}

/// Moves the impulses on along the search direction. `keep` is the part of the last direction that the new one keeps.
pub(super) fn extrapolate(pair: &Pair, points: &mut [Point], states: &mut StatesMut, keep: f32) {
    if !pair.active {
        return;
    }
    let mut velocities = PairVelocities::new(pair, states);
    for point in points.iter_mut().filter(|p| p.active) {
        let [normal, t, u] = point.search.map(|direction| keep * direction);
        let impulse = (point.normal_impulse + normal).max(0.0);
        velocities.apply(&point.rows[0], impulse - point.normal_impulse);
        velocities.apply(&point.rows[1], t);
        velocities.apply(&point.rows[2], u);
        point.normal_impulse = impulse;
        point.friction_impulse[0] += t;
        point.friction_impulse[1] += u;
        point.search = [normal + point.change[0], t + point.change[1], u + point.change[2]];
    }
    velocities.store(pair, states);
}

/// The velocities of a pair's bodies during a pass.
pub(super) struct PairVelocities {
    velocities: [Velocity; 2],
    inverse_masses: [Vec3A; 2],
}

impl PairVelocities {
    pub fn new(pair: &Pair, states: &StatesMut) -> Self {
        Self::at(pair, states, states.velocities)
    }

    /// Those before the impulses of this substep.
    pub fn before(pair: &Pair, states: &StatesMut) -> Self {
        Self::at(pair, states, states.initial_velocities)
    }

    fn at(pair: &Pair, states: &StatesMut, velocities: &[Velocity]) -> Self {
        let masses: [&Mass; 2] = pair.slots.map(|slot| &states.masses[slot as usize]);
        Self {
            velocities: pair.slots.map(|slot| velocities[slot as usize]),
            inverse_masses: masses.map(|mass| mass.inverse_mass),
        }
    }

    /// Velocity of the second body relative to the first along a row's direction. Along the normal it is positive when
    /// the bodies separate.
    pub fn along(&self, row: &Row) -> f32 {
        let [a, b] = &self.velocities;
        let sum = row.direction * (b.linear - a.linear) + row.moments[1] * b.angular - row.moments[0] * a.angular;
        sum.element_sum()
    }

    /// Applies an impulse to the second body, and its opposite to the first.
    pub fn apply(&mut self, row: &Row, impulse: f32) {
        let linear = row.direction * impulse;
        let [a, b] = &mut self.velocities;
        a.linear -= self.inverse_masses[0] * linear;
        a.angular -= row.angular_responses[0] * impulse;
        b.linear += self.inverse_masses[1] * linear;
        b.angular += row.angular_responses[1] * impulse;
    }

    /// Stores the velocities of the bodies. Numbers that are not finite are dropped.
    pub fn store(&self, pair: &Pair, states: &mut StatesMut) {
        for (&slot, velocity) in pair.slots.iter().zip(&self.velocities) {
            if velocity.is_finite() {
                states.velocities[slot as usize] = *velocity;
            }
        }
    }
}
