//! A fast body that flies past, comes and goes. Theory: those it does not touch do not notice.

use crate::game::{Game, body, check};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;

/// 60 steps with a bullet that flies past, and 60 after it has gone. `look` sees the game after each.
fn fly_past(game: &mut Game, mut look: impl FnMut(&Game)) {
    let ball = game.mesh(&shapes::ball(0.05, 2));
    let bullet = game.spawn((
        body(&ball, Transform::from_xyz(-20.0, 10.0, 0.0)),
        LinearVelocity(Vec3::X * 100.0),
        ContinuousCollision,
    ));
    for there in [true, false] {
        for _ in 0..60 {
            game.steps(1);
            look(game);
        }
        if there {
            assert!(game.position(bullet).x > 60.0, "it flew past");
            game.world().despawn(bullet);
        }
    }
}

pub fn sleepers_sleep_on_beside_a_bullet(backend: Backend) {
    sleep_on(Game::new(backend));
}

pub fn sleepers_sleep_on_beside_a_bullet_with_latent_results(backend: Backend) {
    sleep_on(Game::with_readback(backend, Readback::Latent).in_frames());
}

fn sleep_on(mut game: Game) {
    let cube = game.mesh(&shapes::cube(1.0));
    game.slab(&cube, 1.0);
    let sleepers: Vec<Entity> = (0..4)
        .map(|i| game.spawn(body(&cube, Transform::from_xyz(3.0 * i as f32, 0.51, 0.0))))
        .collect();
    game.seconds(2.0);
    assert!(sleepers.iter().all(|&cube| game.sleeps(cube)), "they sleep");
    let places: Vec<Vec3> = sleepers.iter().map(|&cube| game.position(cube)).collect();
    let mut asleep = 0;
    fly_past(&mut game, |game| {
        asleep += sleepers.iter().filter(|&&cube| game.sleeps(cube)).count();
    });
    assert_eq!(asleep, 120 * 4, "looks at a sleeper that found it asleep");
    let now: Vec<Vec3> = sleepers.iter().map(|&cube| game.position(cube)).collect();
    assert_eq!(places, now, "they have not moved");
}

/// Awake, so that it stands by its saved impulses. The two solvers press it together by less than a millimetre.
pub fn a_stack_stands_beside_a_bullet(backend: Backend) {
    let mut game = Game::new(backend);
    let cube = game.mesh(&shapes::cube(1.0));
    game.slab(&cube, 1.0);
    let stack: Vec<Entity> = (0..4)
        .map(|i| {
            let place = Transform::from_xyz(0.0, 0.5005 + 1.0005 * i as f32, 0.0);
            game.spawn((body(&cube, place), SleepingDisabled))
        })
        .collect();
    game.seconds(2.0);
    let height = game.position(stack[3]).y;
    let mut moved = 0.0f32;
    fly_past(&mut game, |game| {
        moved = moved.max((game.position(stack[3]).y - height).abs())
    });
    check("the top moves, metres", moved, 0.0..=1.0e-3);
}
