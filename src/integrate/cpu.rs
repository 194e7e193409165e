//! Integrate on the CPU.

use crate::state::StepState;
use crate::types::body::RigidBody;
use glam::{DQuat, Vec3};
use rayon::prelude::*;

/// Moves every body of `state.bodies` by one step. What is derived from poses is stale afterwards.
pub fn run(state: &mut StepState) {
    let StepState {
        bodies,
        impulses,
        config,
        meshes,
        ..
    } = state;
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
        &*impulses,
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
