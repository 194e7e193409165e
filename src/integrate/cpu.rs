//! Integrate on the CPU.

use crate::ccd::stage::Ccd;
use crate::force_scan::touches::Touches;
use crate::parallel::loops;
use crate::solver::SolverBodies;
use crate::state::fault::MAX_SPEED;
use crate::state::mesh_arena::MeshArena;
use crate::state::{Bodies, Impulse, Manifolds, Plane, StepConfig};
use crate::types::body::RigidBody;
use glam::{DQuat, Vec3};
use rayon::prelude::*;

/// Moves every body by one step, with the sum of its impulses. Data derived from poses is stale afterwards.
pub(crate) fn apply_impulses(config: &StepConfig, meshes: &MeshArena, impulses: &[Impulse], bodies: &mut Bodies) {
    let dt = config.dt;
    apply_to_compounds(config, impulses, bodies);
    let items = (
        &mut bodies.position,
        &mut bodies.rotation,
        &mut bodies.linear_velocity,
        &mut bodies.angular_velocity,
        &bodies.kind,
        &bodies.gravity_scale,
        &bodies.frame,
        &bodies.mesh,
        impulses,
    );
    let parts = &bodies.parts;
    let is_part = |i: usize| {
        let i = i as u32;
        !parts.is_empty() && parts.binary_search_by_key(&i, |part| part.collider).is_ok()
    };
    loops::for_each(
        items.into_par_iter().enumerate(),
        256,
        |(i, (position, rotation, velocity, spin, &kind, &gravity_scale, frame, &mesh, impulse))| {
            if kind == RigidBody::Static || is_part(i) {
                return;
            }
            if kind == RigidBody::Dynamic {
                *velocity = pushed(*velocity, config.gravity * (gravity_scale * dt) + impulse.linear);
                *spin = pushed(*spin, impulse.angular);
            }
            // The centre of mass moves along a line, and the mesh rotates about it.
            let center = frame.center + (*velocity * dt).as_dvec3();
            let rotated = DQuat::from_scaled_axis((*spin * dt).as_dvec3()) * rotation.as_dquat();
            let rotated = rotated.normalize();
            if *spin != Vec3::ZERO {
                *rotation = rotated.as_quat();
            }
            let local_center = frame.scale * meshes[mesh].mesh.mass.center.as_dvec3();
            *position = (center - rotated * local_center).as_vec3();
        },
    );
}

/// Moves bodies of several colliders by one step.
fn apply_to_compounds(config: &StepConfig, impulses: &[Impulse], bodies: &mut Bodies) {
    let dt = config.dt;
    for compound in &mut bodies.compounds {
        let i = compound.number as usize;
        let (mut velocity, mut spin) = (compound.motion.linear_velocity, compound.motion.angular_velocity);
        if bodies.kind[i] == RigidBody::Dynamic {
            velocity = pushed(
                velocity,
                config.gravity * (bodies.gravity_scale[i] * dt) + impulses[i].linear,
            );
            spin = pushed(spin, impulses[i].angular);
        }
        let center = compound.center + (velocity * dt).as_dvec3();
        let rotation = if spin == Vec3::ZERO {
            compound.rotation
        } else {
            (DQuat::from_scaled_axis((spin * dt).as_dvec3()) * compound.rotation).normalize()
        };
        compound.set(center, rotation, velocity, spin);
    }
    bodies.place_parts(0..bodies.parts.len());
}

/// A velocity after a change, no larger than bodies may have. A change that is no number, from contacts of huge bodies
/// that rotate fast, has no effect.
fn pushed(velocity: Vec3, change: Vec3) -> Vec3 {
    let after = velocity + change;
    if after.is_nan() {
        velocity
    } else {
        after.clamp(Vec3::splat(-MAX_SPEED), Vec3::splat(MAX_SPEED))
    }
}

/// Stops bodies with continuous collision detection at their first impact, and records the sensors on their paths.
/// `bodies` have the poses from the start of the collision substep, `solver_bodies` those from its end. Pairs that are
/// `dropped` do not stop each other.
pub(crate) fn stop_fast_bodies(
    config: &StepConfig,
    bodies: &Bodies,
    meshes: &MeshArena,
    planes: &[Plane],
    sphere_pairs: &[[u32; 2]],
    manifolds: &Manifolds,
    dropped: impl Fn([u32; 2]) -> bool,
    ccd: &mut Ccd,
    solver_bodies: &mut SolverBodies,
    touches: &mut Touches,
) {
    let on_sensor_touch = |pair, contact| touches.record_sensor(pair, contact);
    ccd.run(
        solver_bodies,
        manifolds,
        bodies,
        meshes,
        planes,
        sphere_pairs,
        dropped,
        config,
        on_sensor_touch,
    );
}

/// Copies poses and velocities from the solver's bodies.
pub(crate) fn move_bodies(solver_bodies: &SolverBodies, meshes: &MeshArena, bodies: &mut Bodies) {
    solver_bodies.write(bodies, meshes);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_velocity_stays_a_number_below_the_limit() {
        let before = Vec3::new(1.0, -2.0, 3.0);
        assert_eq!(pushed(before, Vec3::X), Vec3::new(2.0, -2.0, 3.0));
        let huge = Vec3::new(f32::INFINITY, f32::NEG_INFINITY, 1.0);
        assert_eq!(pushed(before, huge), Vec3::new(MAX_SPEED, -MAX_SPEED, 4.0));
        assert_eq!(pushed(before, Vec3::new(0.0, f32::NAN, 0.0)), before);
    }
}
