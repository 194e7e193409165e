//! Contact points of the same pairs in other numbers of batches: the same bits.

use super::same_bits::{bits, heap};
use crate::oracle::rng::Rng;
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::manifolds::gpu::ContactCapacity;
use bevy_faceoff::manifolds::{Manifolds, MarginPair};
use bevy_faceoff::state::Body;
use bevy_faceoff::step::StepState;
use bevy_faceoff::testing::gpu_manifolds::GpuManifolds;
use glam::Vec3;

/// In so many batches, with lists that have no room at first.
fn run(gpu: &Gpu, state: &StepState, pairs: &[MarginPair], batches: u32) -> (Manifolds, ContactCapacity) {
    let capacity = ContactCapacity {
        batches,
        ..ContactCapacity::default()
    };
    let mut run = GpuManifolds::with_capacity(gpu, capacity).unwrap();
    let found = run.run(&state.input, pairs).unwrap();
    assert_eq!(run.capacity().batches, batches);
    (found, run.capacity())
}

pub fn of_a_heap(gpu: &Gpu) {
    let (state, pairs) = heap();
    let (at_once, longest) = run(gpu, &state, &pairs, 1);
    assert!(at_once.pairs.len() > 100);
    // The last is more than there are pairs.
    for batches in [3, 1000] {
        let (found, lists) = run(gpu, &state, &pairs, batches);
        assert_eq!(bits(&found), bits(&at_once), "{batches} batches");
        assert!(lists.near_triangles < longest.near_triangles, "{batches} batches");
        assert!(lists.features < longest.features && lists.segments < longest.segments);
        assert_eq!(lists.batch_pairs(), longest.margin_pairs.div_ceil(batches));
    }
}

/// Pairs that are split into pieces, among those that are not.
pub fn of_large_meshes(gpu: &Gpu) {
    let mut state = StepState::default();
    let slots =
        [shapes::ball(0.5, 4), shapes::torus_240()].map(|mesh| state.input.meshes.add(CollisionMesh::new(&mesh)));
    let mut rng = Rng::new(17, 0);
    for i in 0..6 {
        let at = rng.in_ball(0.5).as_vec3();
        let body = Body::at_rest(slots[usize::from(i >= 3)], at, rng.rotation(), Vec3::ONE);
        state.input.bodies.push(&body, &state.input.meshes).unwrap();
    }
    let all = (0..6).flat_map(|a| (a + 1..6).map(move |b| [a, b]));
    let pairs: Vec<_> = all.map(|bodies| MarginPair { bodies, margin: 0.01 }).collect();
    let (at_once, longest) = run(gpu, &state, &pairs, 1);
    assert!(at_once.pairs.len() > 10 && longest.pieces > 100, "{longest:?}");
    let (found, lists) = run(gpu, &state, &pairs, 3);
    assert_eq!(bits(&found), bits(&at_once));
    assert!(lists.pieces < longest.pieces);
}
