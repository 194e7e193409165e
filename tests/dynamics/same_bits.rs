//! A scene gives the same bits, run after run and with any number of threads.

use crate::world::{World, any_turn};
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::types::body::RigidBody;
use glam::Vec3;

/// Twenty bodies that fall onto each other.
pub fn pile() -> World {
    let mut world = World::new();
    world.state.input.config.solver.sleeping = true;
    let cube = world.mesh(&shapes::cube(1.0));
    let meshes = [
        cube,
        world.mesh(&shapes::torus_240()),
        world.mesh(&shapes::knot_1120()),
        world.mesh(&shapes::ring()),
        world.mesh(&shapes::ball_320()),
    ];
    world.floor(cube);
    let mut random = fastrand::Rng::with_seed(21);
    for i in 0..20 {
        let scale = Vec3::splat(if i % 5 == 0 { 0.6 } else { 0.8 + 0.4 * random.f32() });
        let at = Vec3::new(0.6 * (i % 2) as f32, 0.8 + 0.8 * i as f32, 0.6 * (i / 2 % 2) as f32);
        let body = world.add(RigidBody::Dynamic, meshes[i % 5], scale, at, any_turn(&mut random));
        world.state.input.bodies.restitution[body] = 0.3;
    }
    world
}

/// The bits of all motions over so many steps, with so many threads. Requires more than `least_pairs` near pairs.
pub fn bits(threads: usize, steps: usize, least_pairs: usize) -> Vec<u32> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let mut world = pile();
    let (mut bits, mut pairs) = (vec![], 0);
    for _ in 0..steps {
        pool.install(|| world.step());
        let bodies = &world.state.input.bodies;
        for i in 0..bodies.len() {
            let vectors = [
                bodies.position[i],
                bodies.linear_velocity[i],
                bodies.angular_velocity[i],
            ];
            bits.extend(vectors.iter().flat_map(Vec3::to_array).map(f32::to_bits));
            bits.extend(bodies.rotation[i].to_array().map(f32::to_bits));
        }
        pairs = pairs.max(world.state.results.manifolds.pairs.len());
    }
    assert!(pairs > least_pairs, "{pairs} pairs at most: no pile");
    bits
}

#[test]
fn a_pile_of_twenty_moves_by_the_same_bits() {
    let first = bits(1, 200, 15);
    for threads in [1, 2, 2] {
        let again = bits(threads, 200, 15);
        let differing = first.iter().zip(&again).position(|(a, b)| a != b);
        println!(
            "{threads} threads: {} numbers, first that differs: {differing:?}",
            again.len()
        );
        assert!(first == again, "{threads} threads");
    }
}
