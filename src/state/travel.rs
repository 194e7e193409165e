//! The free motion of colliders as far as the contact solver looks ahead: to the end of the collision substep and one
//! solver substep beyond. After the last move, relax passes limit velocities to what a gap leaves for the next one.

use crate::state::{Bodies, StepConfig};
use crate::types::body::RigidBody;
use glam::{DVec3, Vec3};

/// The motion of a collider.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Travel {
    /// Displacement of its centre of mass at its present velocity, metres.
    pub linear: DVec3,
    /// Rotation vector, radians.
    pub turn: DVec3,
    /// What gravity and the external force add to it, unless something supports the body.
    pub fall: DVec3,
}

impl Travel {
    /// The motion of collider `i`.
    pub fn of(bodies: &Bodies, config: &StepConfig, i: usize) -> Self {
        Self::with_velocities(
            bodies,
            config,
            i,
            [bodies.linear_velocity[i], bodies.angular_velocity[i]],
        )
    }

    /// The motion of the body of collider `i`, about its own centre of mass.
    pub fn of_body(bodies: &Bodies, config: &StepConfig, i: usize) -> Self {
        let velocities = match bodies.compound_of(i as u32) {
            Some(compound) => [compound.motion.linear_velocity, compound.motion.angular_velocity],
            None => [bodies.linear_velocity[i], bodies.angular_velocity[i]],
        };
        Self::with_velocities(bodies, config, i, velocities)
    }

    fn with_velocities(bodies: &Bodies, config: &StepConfig, i: usize, [linear, angular]: [Vec3; 2]) -> Self {
        let dt = bodies.travel_time[i];
        if bodies.kind[i] == RigidBody::Static || dt == 0.0 {
            return Self::default();
        }
        let count = (config.dt / dt).round();
        let substeps = config.solver.substeps_per_collision_substep(count as u32) as f32;
        let (h, steps) = (dt / substeps, substeps + 1.0);
        // Each substep changes the velocity before it moves the body.
        let fall = bodies.acceleration(i, config.gravity) * (0.5 * h * h * steps * (steps + 1.0));
        let time = steps * h;
        Self {
            linear: (linear * time).as_dvec3(),
            turn: (angular * time).as_dvec3(),
            fall: fall.as_dvec3(),
        }
    }
}
