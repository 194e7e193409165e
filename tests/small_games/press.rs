//! A body in a press that closes more than the body is wide. No theory holds, but neither wall may get all of it, and
//! no impulse may be without measure.

use crate::game::{Game, body, check};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;

/// A body of 1 m, and of 1 kg, between two walls of these kinds, the second of which comes 0.2 m too near at 0.25 m/s.
fn squeeze(backend: Backend, mesh: &TriMesh, wall: RigidBody) {
    let mut game = Game::new(backend);
    let cube = game.mesh(&shapes::cube(1.0));
    let mesh = game.mesh(mesh);
    game.slab(&cube, 1.0);
    let size = Vec3::new(1.0, 2.0, 3.0);
    let at = |x: f32| Transform::from_xyz(x, 1.05, 0.0).with_scale(size);
    let wall = game.spawn((wall, cube.clone(), at(-1.0)));
    let ram = game.spawn((RigidBody::Kinematic, cube, at(1.05)));
    game.set(ram, LinearVelocity(Vec3::NEG_X * 0.25));
    let squeezed = game.spawn((body(&mesh, Transform::from_xyz(0.0, 0.5, 0.0)), Mass(1.0)));
    let mut largest = 0.0f32;
    let mut overlaps = |game: &Game| {
        let collisions = game.app.world().resource::<Collisions>();
        let impulse = |wall| collisions.get(wall, squeezed).map_or(0.0, |it| it.impulse);
        largest = largest.max(impulse(wall)).max(impulse(ram));
        let x = game.position(squeezed).x;
        [-0.5 - (x - 0.5), x + 0.5 - (game.position(ram).x - 0.5)]
    };
    for _ in 0..64 {
        game.steps(1);
        overlaps(&game);
    }
    let moving = overlaps(&game);
    game.set(ram, LinearVelocity(Vec3::ZERO));
    for _ in 0..64 {
        game.steps(1);
        overlaps(&game);
    }
    for [one, other] in [moving, overlaps(&game)] {
        check("overlap with both walls, metres", one + other, 0.19..=0.21);
        check("overlap with one of them, metres", one, 0.05..=0.15);
    }
    // A contact spring that is 0.1 m deep pushes with 1,000 Ns in a step, and with more in shorter substeps.
    check("largest impulse in a step, Ns", largest, 0.0..=100_000.0);
    check("speed at the end, m/s", game.velocity(squeezed).length(), 0.0..=0.05);
}

pub fn a_ball_is_squeezed_evenly(backend: Backend) {
    squeeze(backend, &shapes::ball(0.5, 3), RigidBody::Static);
}

pub fn a_cube_is_squeezed_evenly(backend: Backend) {
    squeeze(backend, &shapes::cube(1.0), RigidBody::Static);
    squeeze(backend, &shapes::cube(1.0), RigidBody::Kinematic);
}
