//! Balls that meet balls, as a spawner makes them: copies of one mesh, not turned. Theory: energy is conserved, and of
//! a central impact everything goes over.

use crate::game::{Game, any_rotation, body, check, elastic};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;

/// Kinetic and potential energy of bodies of equal mass that do not spin, per mass.
fn energy(game: &Game, balls: &[Entity]) -> f32 {
    let of = |&ball: &Entity| 0.5 * game.velocity(ball).length_squared() + 9.81 * game.position(ball).y;
    balls.iter().map(of).sum()
}

pub fn two_dropped_on_each_other_keep_their_energy(backend: Backend) {
    let mut game = Game::new(backend);
    let (ball, cube) = (game.mesh(&shapes::ball(0.5, 3)), game.mesh(&shapes::cube(1.0)));
    game.slab(&cube, 1.0);
    let balls = [2.0, 3.2].map(|y| game.spawn((body(&ball, Transform::from_xyz(0.0, y, 0.0)), elastic())));
    let start = energy(&game, &balls);
    for step in 0..64 * 2 {
        game.steps(1);
        let part = energy(&game, &balls) / start;
        check(format!("energy after step {step}"), part, 0.95..=1.01);
    }
}

/// One of a pair flies down at the other, which rests; ten pairs, each a little further off the centre.
pub fn offset_impacts_keep_their_energy(backend: Backend) {
    let speed = 10.0;
    let mut game = Game::new(backend).without_gravity();
    let ball = game.mesh(&shapes::ball(0.5, 3));
    let pairs: Vec<[Entity; 2]> = (0..10)
        .map(|k| {
            let home = Vec3::X * 20.0 * k as f32;
            let aside = Vec3::new(0.02, 0.04, 0.0) * k as f32;
            let target = game.spawn((body(&ball, Transform::from_translation(home)), elastic()));
            let above = Transform::from_translation(home + aside + Vec3::Y * 2.0);
            let flying = game.spawn((body(&ball, above), elastic(), LinearVelocity(Vec3::NEG_Y * speed)));
            [target, flying]
        })
        .collect();
    game.seconds(0.25);
    for (k, pair) in pairs.into_iter().enumerate() {
        let kept = pair.map(|b| game.velocity(b).length_squared()).iter().sum::<f32>() / (speed * speed);
        check(format!("energy of pair {k}"), kept, 0.99..=1.01);
        let goes_over = game.velocity(pair[0]).length() / speed;
        check(format!("speed of the target of pair {k}"), goes_over, 0.5..=1.01);
    }
}

pub fn two_that_meet_head_on_exchange_their_velocities(backend: Backend) {
    let mut game = Game::new(backend).without_gravity();
    let ball = game.mesh(&shapes::ball(0.5, 3));
    let balls = [1.0, -1.0].map(|y| {
        let pose = Transform::from_xyz(0.0, y, 0.0);
        game.spawn((body(&ball, pose), elastic(), LinearVelocity(Vec3::NEG_Y * 7.0 * y)))
    });
    game.seconds(0.5);
    for (found, wanted) in balls.map(|b| game.velocity(b).y).into_iter().zip([7.0, -7.0]) {
        check("outgoing over incoming speed", found / wanted, 0.99..=1.01);
    }
}

/// Fifteen pairs, each in an app of its own so that they do not meet in the same part of a step.
pub fn turned_balls_at_forty_metres_per_second_keep_their_energy(backend: Backend) {
    let mut random = fastrand::Rng::with_seed(3);
    let mesh = shapes::ball(0.5, 3);
    for k in 0..15 {
        let mut game = Game::new(backend).without_gravity();
        let ball = game.mesh(&mesh);
        let balls = [1.0, -1.0].map(|side| {
            let aside = Vec3::new(random.f32(), random.f32(), 0.0) * 0.3;
            let pose = Transform::from_translation(aside + Vec3::Y * side * (2.0 + random.f32()))
                .with_rotation(any_rotation(&mut random));
            let velocity = LinearVelocity(Vec3::NEG_Y * 20.0 * side);
            game.spawn((body(&ball, pose), elastic(), velocity))
        });
        game.seconds(0.5);
        let kept = balls.map(|b| game.velocity(b).length_squared()).iter().sum::<f32>() / 800.0;
        check(format!("energy of pair {k}"), kept, 0.99..=1.01);
    }
}
