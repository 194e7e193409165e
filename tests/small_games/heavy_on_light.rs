//! What is heavy on what is light. Theory: nothing is pressed into what is static, and stacks stand with their surfaces
//! touching; 1 % of an edge is allowed.

use crate::game::{GAP, Game, body, check};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;

/// Cubes of edge 1 and these masses, the first at the bottom, each at rest over the one below.
fn stack(game: &mut Game, cube: &MeshCollider, masses: &[f32]) -> Vec<Entity> {
    let cubes = masses.iter().enumerate().map(|(i, &mass)| {
        let pose = Transform::from_xyz(0.0, rest(i), 0.0);
        game.spawn((body(cube, pose), Mass(mass)))
    });
    cubes.collect()
}

/// The height at which cube `i` of a stack rests: surfaces at rest keep a gap.
fn rest(i: usize) -> f32 {
    let gap = GAP * 3.0f32.sqrt();
    0.5 + gap + (1.0 + gap) * i as f32
}

pub fn a_large_cube_does_not_press_a_small_one_through_a_mesh(backend: Backend) {
    let mut game = Game::new(backend);
    let cube = game.mesh(&shapes::cube(1.0));
    game.slab(&cube, 1.0);
    let edge = 0.1;
    let small = game.spawn(body(
        &cube,
        Transform::from_xyz(0.0, 0.5 * edge, 0.0).with_scale(Vec3::splat(edge)),
    ));
    let large = game.spawn(body(&cube, Transform::from_xyz(0.0, edge + 0.5, 0.0)));
    game.seconds(5.0);
    // In edges of the small one.
    let [low, high] = [small, large].map(|cube| game.position(cube).y / edge);
    check("height of the small one", low, 0.49..=0.52);
    check("height of the large one", high, 5.98..=6.05);
}

pub fn ten_times_the_mass_sinks_less_than_a_hundredth(backend: Backend) {
    holds(backend, 10.0, 3.0);
}

pub fn a_hundred_times_the_mass_sinks_less_than_a_hundredth(backend: Backend) {
    holds(backend, 100.0, 30.0);
}

pub fn five_hundred_times_the_mass_sinks_less_than_a_hundredth(backend: Backend) {
    holds(backend, 500.0, 30.0);
}

pub fn a_thousand_times_the_mass_sinks_less_than_a_hundredth(backend: Backend) {
    holds(backend, 1000.0, 30.0);
}

/// A cube on another of equal size.
fn holds(backend: Backend, ratio: f32, seconds: f32) {
    let mut game = Game::new(backend);
    let cube = game.mesh(&shapes::cube(1.0));
    game.slab(&cube, 1.0);
    let cubes = stack(&mut game, &cube, &[1.0, ratio]);
    game.seconds(seconds);
    for (i, &cube) in cubes.iter().enumerate() {
        let at = game.position(cube);
        check(format!("1:{ratio}, cube {i} sank by, m"), rest(i) - at.y, -0.001..=0.01);
        check(
            format!("1:{ratio}, cube {i} moved aside by, m"),
            at.xz().length(),
            0.0..=0.01,
        );
    }
}

pub fn ten_cubes_one_to_hundred_in_turn_stand(backend: Backend) {
    let mut game = Game::new(backend);
    let cube = game.mesh(&shapes::cube(1.0));
    game.slab(&cube, 1.0);
    let masses: Vec<f32> = (0..10).map(|i| if i % 2 == 0 { 1.0 } else { 100.0 }).collect();
    let cubes = stack(&mut game, &cube, &masses);
    game.seconds(30.0);
    let mut below = -0.5;
    for (i, &cube) in cubes.iter().enumerate() {
        let at = game.position(cube);
        check(format!("cube {i} is over what is below by"), at.y - below, 0.99..=1.02);
        check(format!("cube {i} moved aside by"), at.xz().length(), 0.0..=0.02);
        below = at.y;
    }
}

pub fn ten_thousand_times_the_mass_presses_nothing_through_a_plane(backend: Backend) {
    let mut game = Game::new(backend);
    let cube = game.mesh(&shapes::cube(1.0));
    game.plane();
    let [light, _] = stack(&mut game, &cube, &[1.0, 1.0e4])[..] else {
        unreachable!()
    };
    let mut lowest = f32::INFINITY;
    for _ in 0..64 * 10 {
        game.steps(1);
        // The depth of its lowest corner, whatever way it is turned.
        let pose = game.get::<Transform>(light);
        let reach = Mat3::from_quat(pose.rotation).row(1).abs().element_sum() * 0.5;
        lowest = lowest.min(pose.translation.y - reach);
    }
    check("lowest point of the light one", lowest, -0.01..=0.01);
}
