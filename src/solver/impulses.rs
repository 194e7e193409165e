//! External impulses, which change velocities at the beginning of a step.
//!
//! Margins, collision substeps and the pairs for continuous collision detection follow from the velocities of bodies.
//! So impulses act before all of them: a bullet that an impulse fires is as fast for these stages as one with a
//! velocity.

use super::adapter::{motion_of, properties_of};
use super::motion::velocity_after;
use crate::state::Bodies;
use crate::state::bodies::MAX_ACCELERATION;
use crate::types::body::ExternalForces;
use glam::Vec3;

/// Applies the external impulses of all bodies, and clears them.
pub fn apply_impulses(bodies: &mut Bodies) {
    bodies.for_each_mover(|bodies, i| _ = apply_impulses_of(bodies, i, true));
}

/// Applies and clears the external impulses of body `i`. The angular impulse stays for the solver unless the rotation
/// is known. Returns the changes of linear and angular velocity; `None` if there are none, and for colliders that are
/// no body.
pub(crate) fn apply_impulses_of(bodies: &mut Bodies, i: usize, knows_rotation: bool) -> Option<[Vec3; 2]> {
    let forces = bodies.params[i].forces;
    if (forces.impulse, forces.angular_impulse) == (Vec3::ZERO, Vec3::ZERO) || !bodies.is_body(i) {
        return None;
    }
    let angular_impulse = if knows_rotation {
        forces.angular_impulse
    } else {
        Vec3::ZERO
    };
    let impulses = ExternalForces {
        impulse: forces.impulse,
        angular_impulse,
        ..ExternalForces::default()
    };
    let (properties, motion) = (properties_of(bodies, i), motion_of(bodies, i));
    let impulses = impulses.bounded(properties.inverse_mass, &properties.inverse_inertia, MAX_ACCELERATION);
    let after = velocity_after(&properties, &motion, &impulses)?;
    let left = &mut bodies.params[i].forces;
    left.impulse = Vec3::ZERO;
    left.angular_impulse -= angular_impulse;
    bodies.set_velocity(i, after);
    Some([after[0] - motion.linear_velocity, after[1] - motion.angular_velocity])
}
