//! Coins that fall onto a thin shelf, with a single collision substep a step. They may pass each other and the shelf,
//! but nothing throws them.

use super::fly_past::prism;
use crate::world::{World, any_turn};
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::state::{Body, BodyParams};
use bevy_faceoff::types::body::RigidBody;
use glam::{DVec3, Quat, Vec3};
use std::f32::consts::TAU;

const GRAVITY: f64 = 9.81;
const SHELF: Vec3 = Vec3::new(3.0, 0.02, 3.0);

/// A coin of radius 0.1 and thickness 0.02, with 24 corners.
fn coin() -> TriMesh {
    let outline: Vec<[f32; 2]> = (0..24)
        .map(|i| (i as f32 / 24.0 * TAU).sin_cos())
        .map(|(y, x)| [0.1 * x, 0.1 * y])
        .collect();
    prism(&outline, 0.01)
}

/// What became of coins.
#[derive(Debug, Default)]
struct Outcome {
    /// The most energy of a coin, J/kg, over what the highest one had at the start.
    gain: f64,
    /// How many went through the shelf.
    through: usize,
}

/// Lets 120 coins fall, in layers so far apart that none touch at first.
fn pour(substeps: u32, seed: u64, spread: f32, continuous: bool) -> Outcome {
    let mut world = World::new();
    world.state.input.config.solver.max_collision_substeps = substeps;
    let [shelf, coin] = [shapes::cube(1.0), coin()].map(|mesh| world.mesh(&mesh));
    world.add(RigidBody::Static, shelf, SHELF, Vec3::ZERO, Quat::IDENTITY);
    let mut random = fastrand::Rng::with_seed(seed);
    let coins: Vec<usize> = (0..120)
        .map(|i| {
            let column = Vec3::new((i % 3) as f32 - 1.0, 0.0, (i / 3 % 3) as f32 - 1.0);
            let at = 0.22 * column + Vec3::Y * (0.3 + spread * (i / 9) as f32);
            let params = BodyParams {
                continuous,
                ..BodyParams::default()
            };
            world.put(&Body {
                params,
                ..Body::at_rest(coin, at, any_turn(&mut random), Vec3::ONE)
            })
        })
        .collect();
    let top = world.center(coins[119]).y;
    let mut outcome = Outcome::default();
    let mut before: Vec<DVec3> = coins.iter().map(|&i| world.center(i)).collect();
    // The highest ones arrive after 60 steps, with the wider spread after 83.
    for _ in 0..120 {
        world.step();
        for (&i, before) in coins.iter().zip(&mut before) {
            let at = world.center(i);
            let energy = 0.5 * world.velocity(i).as_dvec3().length_squared() + GRAVITY * (at.y - top);
            outcome.gain = outcome.gain.max(energy);
            let inside = at.abs().max(before.abs()).cmplt(0.5 * SHELF.as_dvec3());
            outcome.through += usize::from(before.y > 0.0 && at.y <= 0.0 && inside.x && inside.z);
            *before = at;
        }
    }
    outcome
}

#[test]
fn a_single_collision_substep_throws_no_coins() {
    for (seed, spread) in [(1, 0.3), (2, 0.6)] {
        let few = pour(1, seed, spread, false);
        assert!(few.gain < 0.1, "seed {seed}: {few:?}");
    }
    let many = pour(8, 2, 0.6, false);
    assert!(many.gain < 0.1 && many.through == 0, "{many:?}");
}

/// They are stopped on their way, where gravity must not go on accelerating them.
#[test]
fn flagged_coins_are_not_thrown() {
    let flagged = pour(8, 1, 0.3, true);
    assert!(flagged.gain < 0.1, "{flagged:?}");
}
