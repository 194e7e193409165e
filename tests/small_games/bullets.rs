//! A fast body that flies past, comes and goes. Theory: those it does not touch do not notice.

use crate::game::{Game, body};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;

pub fn sleepers_sleep_on_beside_a_bullet(backend: Backend) {
    let mut game = Game::new(backend);
    let (cube, ball) = (game.mesh(&shapes::cube(1.0)), game.mesh(&shapes::ball(0.05, 2)));
    game.slab(&cube, 1.0);
    let sleepers: Vec<Entity> = (0..4)
        .map(|i| game.spawn(body(&cube, Transform::from_xyz(3.0 * i as f32, 0.51, 0.0))))
        .collect();
    game.seconds(2.0);
    assert!(sleepers.iter().all(|&cube| game.sleeps(cube)), "they sleep");

    let looks = |game: &mut Game| {
        (0..60).fold(0, |asleep, _| {
            game.steps(1);
            asleep + sleepers.iter().filter(|&&cube| game.sleeps(cube)).count()
        })
    };
    let bullet = game.spawn((
        body(&ball, Transform::from_xyz(-20.0, 10.0, 0.0)),
        LinearVelocity(Vec3::X * 100.0),
        ContinuousCollision,
    ));
    let while_it_flies = looks(&mut game);
    assert!(game.position(bullet).x > 60.0, "it flew past");
    game.world().despawn(bullet);
    let without_it = looks(&mut game);
    assert_eq!(
        [while_it_flies, without_it],
        [60 * 4; 2],
        "looks at a sleeper that found it asleep"
    );
}
