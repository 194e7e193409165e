//! Equal inputs give the same bits, whatever else is true.

use crate::oracle::rng::Rng;
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::manifolds::gpu::ContactCapacity;
use bevy_faceoff::manifolds::{Manifolds, MarginPair};
use bevy_faceoff::state::{Body, Plane};
use bevy_faceoff::step::StepState;
use bevy_faceoff::testing::gpu_manifolds::GpuManifolds;
use glam::Vec3;

/// Eighty bodies in a heap, and all pairs of them.
pub fn heap() -> (StepState, Vec<MarginPair>) {
    let mut state = StepState::default();
    let slots = [shapes::torus_240(), shapes::cube(0.6), shapes::ball_320()]
        .map(|mesh| state.input.meshes.add(CollisionMesh::new(&mesh)));
    let mut rng = Rng::new(16, 0);
    for i in 0..40 {
        let at = rng.in_ball(1.4).as_vec3();
        let body = Body::at_rest(slots[i % 3], at, rng.rotation(), Vec3::ONE);
        state.input.bodies.push(&body, &state.input.meshes).unwrap();
    }
    state.input.planes.push(Plane {
        normal: Vec3::Y,
        distance: -1.0,
        restitution: 0.0,
        ..Plane::default()
    });
    let all = (0..40).flat_map(|a| (a + 1..40).map(move |b| [a, b]));
    let pairs = all.map(|bodies| MarginPair { bodies, margin: 0.01 });
    (state, pairs.collect())
}

pub fn bits(manifolds: &Manifolds) -> String {
    format!("{manifolds:?}")
}

pub fn twice_and_with_little_room(gpu: &Gpu) {
    let (state, pairs) = heap();
    let mut run = GpuManifolds::new(gpu).unwrap();
    let first = run.run(&state.input, &pairs).unwrap();
    assert!(first.pairs.len() > 100, "{}", first.pairs.len());
    for _ in 0..3 {
        let again = run.run(&state.input, &pairs).unwrap();
        assert_eq!(bits(&again), bits(&first));
    }
    let mut small = GpuManifolds::with_capacity(gpu, ContactCapacity::default()).unwrap();
    let grown = small.run(&state.input, &pairs).unwrap();
    assert_eq!(bits(&grown), bits(&first));
    assert!(small.repeats() > 2, "{}", small.repeats());
    // What is left from a larger run does not matter.
    let few = run.run(&state.input, &pairs[..100]).unwrap();
    let alone = GpuManifolds::new(gpu)
        .unwrap()
        .run(&state.input, &pairs[..100])
        .unwrap();
    assert_eq!(bits(&few), bits(&alone));
}
