//! Many pairs in parallel.

use super::scene::require_sane;
use crate::oracle::rng::Rng;
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::manifolds::{Manifolds, MarginPair, cpu};
use bevy_faceoff::state::Body as StageBody;
use bevy_faceoff::step::StepState;
use bevy_faceoff::testing::scenes::Shape;
use glam::{Quat, Vec3};

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let mut state = StepState::default();
    let slots = [shapes::torus_240(), shapes::cube(0.6), shapes::ball_320()]
        .map(|mesh| state.input.meshes.add(CollisionMesh::new(&mesh)));
    let mut rng = Rng::new(16, 0);
    for i in 0..80 {
        let at = rng.in_ball(1.6).as_vec3();
        let body = StageBody::at_rest(slots[i % 3], at, rng.rotation(), Vec3::ONE);
        state.input.bodies.push(&body, &state.input.meshes).unwrap();
    }
    let pairs: Vec<MarginPair> = (0..80)
        .flat_map(|a| (a + 1..80).map(move |b| [a, b]))
        .map(|bodies| MarginPair { bodies, margin: 0.01 })
        .collect();
    let mut scratch = cpu::Scratch::default();
    let mut runs = [1, 1, 2, 5].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut manifolds = Manifolds::default();
        pool.install(|| {
            cpu::run(
                &state.input.bodies,
                &state.input.meshes,
                &pairs,
                &mut scratch,
                &mut manifolds,
            )
        });
        require_sane(&manifolds);
        manifolds
    });
    assert!(runs[0].pairs.len() > 300, "{}", runs[0].pairs.len());
    assert!(runs[0].pairs.is_sorted_by(|p, q| p.bodies < q.bodies));
    let bits = |m: &Manifolds| format!("{m:?}");
    let first = bits(&runs[0]);
    for run in &mut runs[1..] {
        assert_eq!(bits(run), first);
    }
    let pair = runs[0].pairs[100];
    let alone = cpu::of_pair(
        &state.input.bodies,
        &state.input.meshes,
        MarginPair {
            bodies: pair.bodies,
            margin: 0.01,
        },
    );
    assert_eq!(alone.points, runs[0].points_of(&pair));
}

/// A nut on a bolt, beside it by `aside`: a pair that is large enough to be shared out over threads.
fn nut_on_bolt(aside: f32) -> StepState {
    let mut state = StepState::default();
    let [bolt, nut] = [Shape::Bolt, Shape::Nut].map(|shape| state.input.meshes.add(shape.mesh().clone()));
    for (slot, at) in [(bolt, Vec3::ZERO), (nut, Vec3::X * aside)] {
        let body = StageBody::at_rest(slot, at, Quat::IDENTITY, Vec3::ONE);
        state.input.bodies.push(&body, &state.input.meshes).unwrap();
    }
    state
}

#[test]
fn one_large_pair_has_the_same_bits_on_any_number_of_threads() {
    // Apart, and with deep overlaps.
    for aside in [0.0, 0.08] {
        let state = nut_on_bolt(aside);
        let pair = MarginPair {
            bodies: [0, 1],
            margin: 0.05,
        };
        let alone = format!("{:?}", cpu::of_pair(&state.input.bodies, &state.input.meshes, pair));
        for threads in [1, 2, 5] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let (mut scratch, mut manifolds) = (cpu::Scratch::default(), Manifolds::default());
            for call in ["afresh", "kept"] {
                pool.install(|| {
                    cpu::run(
                        &state.input.bodies,
                        &state.input.meshes,
                        &[pair],
                        &mut scratch,
                        &mut manifolds,
                    )
                });
                require_sane(&manifolds);
                assert_eq!(
                    format!("{manifolds:?}"),
                    alone,
                    "{aside} aside, {threads} threads, {call}"
                );
            }
        }
    }
}
