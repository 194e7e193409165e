//! Stacks and rows without restitution that are hit. Theory: what is pushed takes the velocity of what pushes, and no
//! more.

use crate::game::{GAP, Game, body, check};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;

/// Five cubes asleep on a kinematic slab that suddenly rises at 5 m/s.
pub fn a_stack_rises_with_its_lift(backend: Backend) {
    let mut game = Game::new(backend);
    let cube = game.mesh(&shapes::cube(1.0));
    let slab = game.slab(&cube, 1.0);
    game.set(slab, RigidBody::Kinematic);
    let cubes: Vec<Entity> = (0..5)
        .map(|i| game.spawn(body(&cube, Transform::from_xyz(0.0, 0.5 + i as f32, 0.0))))
        .collect();
    game.seconds(4.0);
    assert!(cubes.iter().all(|&cube| game.sleeps(cube)), "the stack sleeps");
    let start: Vec<f32> = cubes.iter().map(|&cube| game.position(cube).y).collect();

    let lift = Vec3::Y * 5.0;
    game.set(slab, LinearVelocity(lift));
    let (mut fastest, mut highest) = ([0.0f32; 5], 0.0f32);
    for _ in 0..32 {
        game.steps(1);
        let risen = game.position(slab).y + 0.5;
        for (i, &cube) in cubes.iter().enumerate() {
            fastest[i] = fastest[i].max(game.velocity(cube).y);
            highest = highest.max(game.position(cube).y - start[i] - risen);
        }
    }
    for (i, fastest) in fastest.into_iter().enumerate() {
        check(format!("largest speed of cube {i}, m/s"), fastest, 4.95..=5.05);
    }
    // The tolerance is about one gap between cubes at rest.
    check("rises over the slab, m", highest, 0.0..=0.01);
}

/// A mass of 1000 at 5 m/s into five cubes of 1, without gravity.
pub fn a_row_leaves_with_what_hits_it(backend: Backend) {
    let mut game = Game::new(backend).without_gravity();
    let cube = game.mesh(&shapes::cube(1.0));
    let heavy = game.spawn((
        body(&cube, Transform::from_xyz(-2.0, 0.0, 0.0)),
        Mass(1000.0),
        LinearVelocity(Vec3::X * 5.0),
    ));
    // Out of each other's contact margin, so that the row rests until it is hit.
    let between = 1.0 + 2.5 * GAP * 3.0f32.sqrt();
    let row: Vec<Entity> = (0..5)
        .map(|i| {
            game.spawn((
                body(&cube, Transform::from_xyz(between * i as f32, 0.0, 0.0)),
                Mass(1.0),
            ))
        })
        .collect();
    game.seconds(1.0);
    let wanted = 5.0 * 1000.0 / 1005.0;
    check(
        "speed of the heavy one, m/s",
        game.velocity(heavy).x,
        wanted * 0.99..=wanted * 1.01,
    );
    for (i, &cube) in row.iter().enumerate() {
        check(
            format!("speed of cube {i}, m/s"),
            game.velocity(cube).x,
            wanted * 0.99..=wanted * 1.01,
        );
    }
}
