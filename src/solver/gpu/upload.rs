//! Conversion of the solver's bodies and contacts between host and device.

use super::layout;
use super::layout::{FRICTION_RULE, LOCKED_AXES, RESTITUTION_RULE};
use crate::gpu::layout::{ContactPair, ContactPoint, DYNAMIC, FLAT_RADIUS, KINEMATIC, SENSOR, STATIC};
use crate::manifolds::{Manifold, ManifoldPoint};
use crate::solver::bodies::Way;
use crate::solver::softness::Softness;
use crate::solver::{Pace, SleepState, SolverBodies, SolverBody, SolverMotion};
use crate::types::body::{ExternalForces, RigidBody};
use crate::types::material::CombineRule;
use crate::types::solver_settings::SolverSettings;
use glam::{DQuat, DVec3, DVec4, Vec3};
use std::f32::consts::TAU;

/// The square of a speed limit must be finite.
const FASTEST: f32 = 1.0e18;

/// The coarse parts of rotations, and of centres below one metre, are multiples of this.
pub(super) const COARSE_DIGIT: f64 = 1.0 / (1 << 21) as f64;

/// The parameters of a collision substep with this number of paces. `old_bodies` is the number of bodies in the last
/// one.
pub fn collision_substep(
    settings: &SolverSettings,
    gravity: Vec3,
    paces: u32,
    [bodies, old_bodies]: [u32; 2],
    capacity: super::SolverCapacity,
) -> layout::CollisionSubstep {
    layout::CollisionSubstep {
        gravity: gravity.to_array(),
        paces,
        bodies,
        old_bodies,
        pair_capacity: capacity.pairs,
        point_capacity: capacity.points,
        max_depenetration_speed: settings.max_depenetration_speed,
        deep_depenetration_speed: settings.deep_depenetration_speed,
        deep_penetration: settings.deep_penetration,
        rest_offset: settings.rest_offset,
        restitution_threshold: settings.restitution_threshold,
        match_distance: settings.match_distance,
        match_normal: settings.match_normal,
        convergence_speed: settings.convergence_speed,
        bias_iterations: settings.bias_iterations,
        relax_iterations: settings.relax_iterations,
        restitution_iterations: settings.restitution_iterations,
        max_iterations: settings.max_iterations,
        sleep_speed: settings.sleep_speed,
        sleep_time: settings.sleep_time,
        ..Default::default()
    }
}

/// A pace, with the contact springs of its substeps.
pub fn pace(settings: &SolverSettings, pace: Pace) -> layout::Pace {
    let h = pace.h();
    let (softness, few) = (Softness::new(settings, h), Softness::of_few_passes(settings, h));
    layout::Pace {
        h,
        dt: pace.dt,
        substeps: pace.substeps,
        bias_rate: softness.bias_rate,
        mass_scale: softness.mass_scale,
        impulse_scale: softness.impulse_scale,
        few_bias_rate: few.bias_rate,
        few_mass_scale: few.mass_scale,
        few_impulse_scale: few.impulse_scale,
        stiffness: (TAU * settings.frequency / h).powi(2),
        ..Default::default()
    }
}

/// The properties of all colliders and their bodies, and of planes.
pub fn bodies(bodies: &SolverBodies) -> Vec<layout::SolverBody> {
    let mut packed: Vec<_> = (0..).zip(&bodies.bodies).map(|(i, own)| body(i, own)).collect();
    for part in &bodies.parts {
        let collider = &mut packed[part.collider as usize];
        collider.body = part.body;
        collider.offset = part.offset.as_vec3().to_array();
    }
    packed
}

fn body(number: u32, body: &SolverBody) -> layout::SolverBody {
    let inertia = body.inverse_inertia;
    let limit = |limit: f32| if limit >= 0.0 { limit.min(FASTEST) } else { FASTEST };
    // `max` returns the other operand for NaN.
    let positive = |value: f32| value.max(0.0);
    layout::SolverBody {
        inverse_inertia: [inertia.x_axis.x, inertia.y_axis.y, inertia.z_axis.z],
        inverse_mass: body.inverse_mass,
        inverse_inertia_off_diagonal: [inertia.y_axis.x, inertia.z_axis.x, inertia.z_axis.y],
        flags: flags(body),
        radius: length(body.radius),
        restitution: positive(body.restitution),
        friction: positive(body.friction),
        gravity_scale: body.gravity_scale,
        linear_damping: positive(body.linear_damping),
        angular_damping: positive(body.angular_damping),
        max_linear_speed: limit(body.max_linear_speed),
        max_angular_speed: limit(body.max_angular_speed),
        body: number,
        extent: length(body.extent),
        own_inverse_mass: positive(body.own_inverse_mass),
        ..Default::default()
    }
}

fn flags(body: &SolverBody) -> u32 {
    let kind = match body.kind {
        RigidBody::Dynamic => DYNAMIC,
        RigidBody::Kinematic => KINEMATIC,
        RigidBody::Static => STATIC,
    };
    kind | if body.solid { 0 } else { SENSOR }
        | rule(body.restitution_combine) << RESTITUTION_RULE
        | rule(body.friction_combine) << FRICTION_RULE
        | u32::from(body.locked_axes.bits()) << LOCKED_AXES
}

/// The precedence of a rule: of two rules the one with the larger number is used.
fn rule(rule: CombineRule) -> u32 {
    match rule {
        CombineRule::Average => 0,
        CombineRule::GeometricMean => 1,
        CombineRule::Min => 2,
        CombineRule::Multiply => 3,
        CombineRule::Max => 4,
    }
}

/// The length, or 0 if it is negative or NaN.
fn length(value: f32) -> f32 {
    if value > 0.0 { value.min(FLAT_RADIUS) } else { 0.0 }
}

/// Pose, velocity and sleep state of a body. `key` identifies it.
pub fn state(motion: &SolverMotion, sleep: &SleepState, key: u32) -> layout::MotionState {
    let center = motion.center.as_vec3();
    let rotation = DVec4::from(motion.rotation);
    let coarse = (rotation / COARSE_DIGIT).round() * COARSE_DIGIT;
    layout::MotionState {
        center: center.to_array(),
        center_low: (motion.center - center.as_dvec3()).as_vec3().to_array(),
        rotation: coarse.as_vec4().to_array(),
        rotation_low: (rotation - coarse).as_vec4().to_array(),
        linear_velocity: motion.linear_velocity.to_array(),
        angular_velocity: motion.angular_velocity.to_array(),
        asleep: u32::from(sleep.asleep),
        rest_time: sleep.rest_time,
        neighbours: sleep.neighbours,
        key,
        moved: sleep.way.moved.to_array(),
        turned: sleep.way.turned.to_array(),
        last_moved: sleep.last_way.moved.to_array(),
        last_turned: sleep.last_way.turned.to_array(),
        ..Default::default()
    }
}

impl From<&layout::MotionState> for SolverMotion {
    fn from(state: &layout::MotionState) -> Self {
        let sum = |high: [f32; 4], low: [f32; 4]| DVec4::from(high.map(f64::from)) + DVec4::from(low.map(f64::from));
        let rotation = DQuat::from_vec4(sum(state.rotation, state.rotation_low));
        let [x, y, z] = [0, 1, 2].map(|axis| f64::from(state.center[axis]) + f64::from(state.center_low[axis]));
        Self {
            center: DVec3::new(x, y, z),
            rotation,
            linear_velocity: Vec3::from(state.linear_velocity),
            angular_velocity: Vec3::from(state.angular_velocity),
        }
    }
}

impl From<&layout::MotionState> for SleepState {
    fn from(state: &layout::MotionState) -> Self {
        Self {
            asleep: state.asleep != 0,
            rest_time: state.rest_time,
            neighbours: state.neighbours,
            way: Way {
                moved: Vec3::from(state.moved),
                turned: Vec3::from(state.turned),
            },
            last_way: Way {
                moved: Vec3::from(state.last_moved),
                turned: Vec3::from(state.last_turned),
            },
        }
    }
}

/// External forces on a body.
pub fn forces(forces: &ExternalForces) -> layout::BodyForces {
    layout::BodyForces {
        force: forces.force.to_array(),
        torque: forces.torque.to_array(),
        impulse: forces.impulse.to_array(),
        angular_impulse: forces.angular_impulse.to_array(),
        ..Default::default()
    }
}

/// A touching pair.
pub fn contact_pair(manifold: &Manifold) -> ContactPair {
    ContactPair {
        a: manifold.bodies[0],
        b: manifold.bodies[1],
        first_point: manifold.first_point,
        point_count: manifold.point_count,
    }
}

/// A contact point.
pub fn contact_point(point: &ManifoldPoint) -> ContactPoint {
    ContactPoint {
        anchor_a: point.anchors[0].to_array(),
        separation: point.separation,
        bulge: point.bulge,
        anchor_b: point.anchors[1].to_array(),
        curvature_radius_a: length(point.curvature_radii[0]),
        normal: point.normal.to_array(),
        curvature_radius_b: length(point.curvature_radii[1]),
        face_a: point.faces[0],
        face_b: point.faces[1],
        normal_rotation: point.normal_rotation,
    }
}
