//! Cubes of all sizes on each other. Theory: small and large bodies behave alike, and a tower of n stands n edges high.

use crate::game::{Game, body, check};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;

pub fn three_of_a_centimetre_stand(backend: Backend) {
    tower(backend, 0.01, 3);
}

pub fn five_of_a_centimetre_stand(backend: Backend) {
    tower(backend, 0.01, 5);
}

pub fn three_of_five_millimetres_stand(backend: Backend) {
    tower(backend, 0.005, 3);
}

pub fn five_of_five_millimetres_stand(backend: Backend) {
    tower(backend, 0.005, 5);
}

pub fn five_of_two_centimetres_stand(backend: Backend) {
    tower(backend, 0.02, 5);
}

pub fn five_of_a_metre_stand(backend: Backend) {
    tower(backend, 1.0, 5);
}

pub fn five_of_a_hundred_metres_stand(backend: Backend) {
    tower(backend, 100.0, 5);
}

/// So many cubes, each put exactly onto the one below, on a mesh and on a plane.
fn tower(backend: Backend, edge: f32, count: usize) {
    for on_mesh in [true, false] {
        let mut game = Game::new(backend);
        let cube = game.mesh(&shapes::cube(1.0));
        let ground = if on_mesh {
            game.slab(&cube, edge);
            "mesh"
        } else {
            game.plane();
            "plane"
        };
        let cubes: Vec<Entity> = (0..count)
            .map(|i| {
                let pose = Transform::from_xyz(0.0, edge * (0.5 + i as f32), 0.0).with_scale(Vec3::splat(edge));
                game.spawn(body(&cube, pose))
            })
            .collect();
        game.seconds(5.0);
        let mut below = -0.5;
        for (i, &cube) in cubes.iter().enumerate() {
            let at = game.position(cube) / edge;
            let name = format!("edge {edge} on a {ground}, cube {i}");
            check(format!("{name}, edges over what is below"), at.y - below, 0.99..=1.02);
            check(format!("{name}, edges aside"), at.xz().length(), 0.0..=0.02);
            below = at.y;
        }
        let asleep = cubes.iter().filter(|&&cube| game.sleeps(cube)).count();
        check(
            format!("edge {edge} on a {ground}, asleep"),
            asleep as f32,
            count as f32..=count as f32,
        );
    }
}
