//! The triangle test of bodies that move and touch, where contact generation has shown which pairs are apart.

use crate::world::{World, any_turn};
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::state::PairContact;
use bevy_faceoff::step::{StepState, cpu};
use bevy_faceoff::types::body::RigidBody;
use bevy_faceoff::types::stage::Stage;
use glam::{Quat, Vec3};

/// Knots and tori that fall onto each other, and balls inside a ball.
fn heap() -> World {
    let mut world = World::new();
    let mut random = fastrand::Rng::with_seed(11);
    let [knot, torus, ball, cube] = [
        shapes::knot_1120(),
        shapes::torus_240(),
        shapes::ball(0.5, 2),
        shapes::cube(1.0),
    ]
    .map(|shape| world.mesh(&shape));
    world.floor(cube);
    for i in 0..16 {
        let at = Vec3::new(0.3 * (i % 3) as f32, 0.8 + 0.5 * i as f32, 0.2 * (i % 4) as f32);
        let mesh = [knot, torus][i % 2];
        world.add(RigidBody::Dynamic, mesh, Vec3::ONE, at, any_turn(&mut random));
    }
    for (scale, kind) in [
        (1.0, RigidBody::Static),
        (0.2, RigidBody::Dynamic),
        (0.1, RigidBody::Dynamic),
    ] {
        let at = Vec3::new(20.0, 2.0 + 0.3 * (1.0 - scale), 0.0);
        world.add(kind, ball, Vec3::splat(scale), at, Quat::IDENTITY);
    }
    world
}

/// Runs the stages up to the triangle test, and returns its result.
fn test(state: &mut StepState) -> (Vec<PairContact>, u64) {
    for stage in [Stage::BroadPhase, Stage::Angles, Stage::TriangleTest] {
        cpu::run(stage, state);
    }
    let contacts = &state.results.contacts;
    (contacts.pairs.clone(), contacts.triangle_tests)
}

#[test]
fn pairs_that_are_known_to_be_apart_do_not_touch() {
    let mut world = heap();
    world.state.input.config.solver.sleeping = false;
    let (mut tests, mut tests_afresh) = (0, 0);
    let (mut touching, mut contained) = (0, 0);
    for step in 0..384 {
        let mut afresh = StepState::default();
        afresh.input.config = world.state.input.config;
        afresh.input.meshes = world.state.input.meshes.clone();
        afresh.input.bodies = world.state.input.bodies.clone();
        let (wanted, all) = test(&mut afresh);
        let (found, done) = test(&mut world.state);
        assert_eq!(found, wanted, "step {step}");
        touching += found.len();
        contained += found.iter().filter(|pair| pair.contained).count();
        if step >= 256 {
            tests += done;
            tests_afresh += all;
        }
        for stage in [Stage::Manifolds, Stage::ForceScan, Stage::Integrate] {
            cpu::run(stage, &mut world.state);
        }
    }
    println!("{touching} touching, {contained} contained, {tests} of {tests_afresh} tests of triangles at rest");
    assert!(touching > 100 && contained > 0);
    assert!(2 * tests < tests_afresh, "{tests} of {tests_afresh}");
}
