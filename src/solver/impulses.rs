//! External impulses, which change velocities at the beginning of a step.
//!
//! Margins, collision substeps and the pairs for continuous collision detection follow from the velocities of bodies. So
//! impulses act before all of them: a bullet that an impulse fires is as fast for these stages as one with a velocity.

use super::adapter::{motion_of, properties_of};
use super::motion::velocity_after;
use crate::state::Bodies;
use crate::types::body::ExternalForces;
use glam::Vec3;

/// Applies the external impulses of bodies, and clears them. The angular impulse of a body stays for the solver unless
/// its rotation is known. `changed` gets each body, and how much its linear and angular velocities have changed.
pub fn apply_impulses(
    bodies: &mut Bodies,
    knows_rotation: impl Fn(&Bodies, usize) -> bool,
    mut changed: impl FnMut(&Bodies, usize, [Vec3; 2]),
) {
    for i in 0..bodies.len() {
        let ExternalForces {
            impulse,
            angular_impulse,
            ..
        } = bodies.params[i].forces;
        if (impulse, angular_impulse) == (Vec3::ZERO, Vec3::ZERO) || !bodies.is_body(i) {
            continue;
        }
        let mut impulses = ExternalForces {
            impulse,
            angular_impulse,
            ..ExternalForces::default()
        };
        if !knows_rotation(bodies, i) {
            impulses.angular_impulse = Vec3::ZERO;
        }
        let (properties, motion) = (properties_of(bodies, i), motion_of(bodies, i));
        let before = [motion.linear_velocity, motion.angular_velocity];
        let Some(after) = velocity_after(&properties, &motion, &impulses) else {
            continue;
        };
        let forces = &mut bodies.params[i].forces;
        forces.impulse = Vec3::ZERO;
        forces.angular_impulse -= impulses.angular_impulse;
        bodies.set_velocity(i, after);
        changed(bodies, i, [after[0] - before[0], after[1] - before[1]]);
    }
}
