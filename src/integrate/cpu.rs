//! Integrate on the CPU.

use crate::ccd::stops::Stops;
use crate::force_scan::touches::Touches;
use crate::solver::SolverBodies;
use crate::state::mesh_arena::MeshArena;
use crate::state::{Bodies, Impulse, Manifolds, Plane, StepConfig};
use crate::types::body::RigidBody;
use glam::{DQuat, Vec3};
use rayon::prelude::*;

/// Moves every body by one step, with the sum of its impulses. What is derived from poses is stale afterwards.
pub(crate) fn apply_impulses(config: &StepConfig, meshes: &MeshArena, impulses: &[Impulse], bodies: &mut Bodies) {
    let dt = config.dt;
    (
        &mut bodies.position,
        &mut bodies.rotation,
        &mut bodies.linear_velocity,
        &mut bodies.angular_velocity,
        &bodies.kind,
        &bodies.gravity_scale,
        &bodies.frame,
        &bodies.mesh,
        impulses,
    )
        .into_par_iter()
        .with_min_len(256)
        .for_each(
            |(position, rotation, velocity, spin, &kind, &gravity_scale, frame, &mesh, impulse)| {
                if kind == RigidBody::Static {
                    return;
                }
                if kind == RigidBody::Dynamic {
                    *velocity += config.gravity * (gravity_scale * dt) + impulse.linear;
                    *spin += impulse.angular;
                }
                // The centre of mass moves along a line and the mesh's origin turns about it.
                let center = frame.center + (*velocity * dt).as_dvec3();
                let turned = DQuat::from_scaled_axis((*spin * dt).as_dvec3()) * rotation.as_dquat();
                let turned = turned.normalize();
                if *spin != Vec3::ZERO {
                    *rotation = turned.as_quat();
                }
                let arm = frame.scale * meshes[mesh].mesh.mass.center.as_dvec3();
                *position = (center - turned * arm).as_vec3();
            },
        );
}

/// Stops bodies with continuous collision where they first meet others, and notes which sensors they pass. `bodies` are where they
/// were as the interval began, `moved` where the solver has taken them.
pub(crate) fn stop_fast_bodies(
    interval: &StepConfig,
    bodies: &Bodies,
    meshes: &MeshArena,
    planes: &[Plane],
    sphere_pairs: &[[u32; 2]],
    manifolds: &Manifolds,
    stops: &mut Stops,
    moved: &mut SolverBodies,
    touches: &mut Touches,
) {
    let pass = |pair, contact| touches.pass(pair, contact);
    stops.stop(moved, manifolds, bodies, meshes, planes, sphere_pairs, interval, pass);
}

/// Puts the bodies where the solver has moved them.
pub(crate) fn move_bodies(moved: &SolverBodies, meshes: &MeshArena, bodies: &mut Bodies) {
    moved.write(bodies, meshes);
}
