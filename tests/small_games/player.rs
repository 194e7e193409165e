//! A player that looks around while it walks, and one that fell and is put back, wherever the steps run and whenever
//! their results are read. Theory: turning changes no velocity, and what is put back falls as from rest.

use crate::game::{Game, body, check};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::plugin::settings::LATENCY;
use bevy_faceoff::prelude::*;

#[derive(Component)]
struct Player;

/// Sets nothing but the rotation, in every step.
fn look_around(mut players: Query<&mut Transform, With<Player>>, mut angle: Local<f32>) {
    *angle += 0.1;
    for mut transform in &mut players {
        transform.rotation = Quat::from_rotation_y(*angle);
    }
}

pub fn walks_and_respawns_as_told(backend: Backend) {
    play(backend, Readback::Lockstep);
}

pub fn walks_and_respawns_as_told_with_latent_results(backend: Backend) {
    play(backend, Readback::Latent);
}

pub fn walks_and_respawns_as_told_with_resident_bodies(backend: Backend) {
    play(backend, Readback::Resident);
}

fn play(backend: Backend, readback: Readback) {
    let mut game = Game::with_readback(backend, readback).in_frames();
    game.app.add_systems(FixedUpdate, look_around);

    let cube = game.mesh(&shapes::cube(1.0));
    game.plane();
    let walking = game.spawn((
        body(&cube, Transform::from_xyz(0.0, 0.51, 0.0)),
        Player,
        LockedAxes::ROTATION,
        Friction::new(0.0).with_combine(CombineRule::Min),
        LinearVelocity(Vec3::X * 2.0),
    ));
    let home = Transform::from_xyz(0.0, 50.0, 9.0);
    let falling = game.spawn(body(&cube, home));
    game.steps(32);
    game.set(falling, (home, LinearVelocity::default(), AngularVelocity::default()));
    game.steps(32);
    if readback == Readback::Latent {
        game.steps(LATENCY);
    }
    let snapshot = Snapshot::take(game.world());
    let at = |entity| match readback {
        // Only then components do not say where bodies are.
        Readback::Resident => {
            let mut bodies = snapshot.bodies();
            bodies.find(|&(body, _)| body == entity).unwrap().1.position
        }
        _ => game.position(entity),
    };
    check("walked at 2 m/s for a second, m", at(walking).x, 1.99..=2.01);
    check("height of the walking one, m", at(walking).y, 0.49..=0.52);
    // Half a second in 8 substeps of 32 steps.
    let fallen = 9.81 * 0.125 * (1.0 + 1.0 / 256.0);
    check(
        "fell for half a second, m",
        home.translation.y - at(falling).y,
        fallen - 1.0e-3..=fallen + 1.0e-3,
    );
}
