//! Open meshes whose rims have got into other meshes.

use super::compare::agreement;
use super::nearest_pairs::{At, all_shapes};
use crate::support::Random;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::manifolds::MarginPair;
use bevy_faceoff::state::Body;
use bevy_faceoff::step::StepState;
use glam::Vec3;

/// As the CPU pushes them out.
pub fn are_pushed_out(gpu: &Gpu) {
    let shapes = all_shapes();
    let mut random = Random::new(37);
    let mut state = StepState::default();
    let meshes: Vec<u32> = shapes
        .iter()
        .map(|shape| state.input.meshes.add(shape.baked.clone()))
        .collect();
    let mut pairs = Vec::new();
    for i in 0..600 {
        let at = [0, 1].map(|k| At {
            translation: random.direction() * (f64::from(k) * 0.9),
            rotation: random.rotation(),
        });
        for (k, at) in at.into_iter().enumerate() {
            // The first four are solid.
            let number = if k == 0 {
                random.0.usize(4..meshes.len())
            } else {
                random.0.usize(..meshes.len())
            };
            let body = Body::at_rest(
                meshes[number],
                at.translation.as_vec3(),
                at.rotation.normalize().as_quat(),
                Vec3::ONE,
            );
            state.input.bodies.push(&body, &state.input.meshes).unwrap();
        }
        pairs.push(MarginPair {
            bodies: [2 * i, 2 * i + 1],
            margin: 0.01,
        });
    }
    let result = agreement("rims", gpu, &state, &pairs);
    assert!(result.pairs > 200 && result.missed == 0, "{result:?}");
    assert!(result.shifted <= 2 && result.unmatched_share() < 0.02, "{result:?}");
}
