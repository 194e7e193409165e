//! A box on a turntable. Theory: friction of 0.5 holds what needs 0.1; seen from the table, the box rests.

use crate::game::{Game, body, check};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;

pub fn a_box_rests_on_a_turntable(backend: Backend) {
    let mut game = Game::new(backend);
    let cube = game.mesh(&shapes::cube(1.0));
    let table = game.spawn((
        RigidBody::Kinematic,
        cube.clone(),
        Transform::from_xyz(0.0, -0.5, 0.0).with_scale(Vec3::new(6.0, 1.0, 6.0)),
        AngularVelocity(Vec3::Y),
    ));
    let edge = 0.5;
    let pose = Transform::from_xyz(1.0, 0.5 * edge, 0.0).with_scale(Vec3::splat(edge));
    let rider = game.spawn((body(&cube, pose), LinearVelocity(Vec3::NEG_Z), AngularVelocity(Vec3::Y)));
    let seen = |game: &Game| game.get::<Transform>(table).rotation.inverse() * game.position(rider);
    game.seconds(1.0);
    let start = seen(&game);
    game.seconds(10.0);
    let crept = (seen(&game) - start).length();
    check("metres in 10 s", crept, 0.0..=1.0e-3);
}
