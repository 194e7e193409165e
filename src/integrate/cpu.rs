//! Integrate on the CPU.

use crate::ccd::stage::Ccd;
use crate::force_scan::touches::Touches;
use crate::parallel::loops;
use crate::solver::SolverBodies;
use crate::state::mesh_arena::MeshArena;
use crate::state::{Bodies, Impulse, Manifolds, Plane, StepConfig};
use crate::types::body::RigidBody;
use glam::{DQuat, Vec3};
use rayon::prelude::*;

/// Moves every body by one step, with the sum of its impulses. Data derived from poses is stale afterwards.
pub(crate) fn apply_impulses(config: &StepConfig, meshes: &MeshArena, impulses: &[Impulse], bodies: &mut Bodies) {
    let dt = config.dt;
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
    loops::for_each(
        items.into_par_iter(),
        256,
        |(position, rotation, velocity, spin, &kind, &gravity_scale, frame, &mesh, impulse)| {
            if kind == RigidBody::Static {
                return;
            }
            if kind == RigidBody::Dynamic {
                *velocity += config.gravity * (gravity_scale * dt) + impulse.linear;
                *spin += impulse.angular;
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

/// Stops bodies with continuous collision detection at their first impact, and records the sensors on their paths.
/// `bodies` have the poses from the start of the collision substep, `solver_bodies` those from its end.
pub(crate) fn stop_fast_bodies(
    config: &StepConfig,
    bodies: &Bodies,
    meshes: &MeshArena,
    planes: &[Plane],
    sphere_pairs: &[[u32; 2]],
    manifolds: &Manifolds,
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
        config,
        on_sensor_touch,
    );
}

/// Copies poses and velocities from the solver's bodies.
pub(crate) fn move_bodies(solver_bodies: &SolverBodies, meshes: &MeshArena, bodies: &mut Bodies) {
    solver_bodies.write(bodies, meshes);
}
