//! Kinematic bodies among dynamic ones that carry a load. Theory: equal supports carry equal parts, whatever their
//! kind.

use crate::game::{Game, body, check};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;

/// Three cubes in a row on the ground, and what each carries of a slab of this mass on them, after one of them was made
/// kinematic.
fn loads(backend: Backend, mass: f32, switched: usize) -> [f32; 3] {
    let mut game = Game::new(backend);
    game.world().insert_resource(SolverSettings {
        sleeping: false,
        ..default()
    });
    let cube = game.mesh(&shapes::cube(1.0));
    game.slab(&cube, 1.0);
    let supports = [-1.0, 0.0, 1.0].map(|x| {
        let pose = Transform::from_xyz(x, 0.25, 0.0).with_scale(Vec3::splat(0.5));
        game.spawn((body(&cube, pose), Mass(1.0)))
    });
    let pose = Transform::from_xyz(0.0, 0.6, 0.0).with_scale(Vec3::new(3.0, 0.2, 3.0));
    let slab = game.spawn((body(&cube, pose), Mass(mass)));
    game.seconds(2.0);
    game.set(supports[switched], RigidBody::Kinematic);
    game.seconds(2.0);
    let collisions = game.app.world().resource::<Collisions>();
    let weight = mass * 9.81 / 64.0;
    supports.map(|support| collisions.get(support, slab).map_or(0.0, |it| it.impulse) / weight)
}

pub fn one_that_is_made_kinematic_carries_its_part(backend: Backend) {
    for (mass, switched) in [(1.0, 1), (1.0, 0), (20.0, 1)] {
        let loads = loads(backend, mass, switched);
        println!("{mass} kg, {switched} made kinematic: {loads:?}");
        // Three supports in a row share a load as their springs give way, and not exactly by thirds.
        check(
            format!("part of {mass} kg that the kinematic support carries"),
            loads[switched],
            0.2..=0.4,
        );
        check("sum of all parts", loads.iter().sum(), 0.99..=1.01);
    }
}

/// A tower of ten layers of three wooden blocks each. One in the middle is switched to kinematic and pulled out.
pub fn a_block_is_pulled_from_a_tower(backend: Backend) {
    let mut game = Game::new(backend);
    let cube = game.mesh(&shapes::cube(1.0));
    game.slab(&cube, 0.1);
    let size = Vec3::new(0.025, 0.015, 0.075);
    let blocks: Vec<Entity> = (0..30)
        .map(|i| {
            let (layer, across) = (i / 3, (i % 3) as f32 - 1.0);
            let turn = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2 * (layer % 2) as f32);
            let at = turn * Vec3::X * across * 0.0255 + Vec3::Y * (0.0075 + 0.015 * layer as f32);
            let pose = Transform::from_translation(at).with_rotation(turn).with_scale(size);
            game.spawn((body(&cube, pose), Density(600.0)))
        })
        .collect();
    game.seconds(3.0);
    let start: Vec<Vec3> = blocks.iter().map(|&block| game.position(block)).collect();
    let pulled = 3 * 4 + 1;
    game.set(blocks[pulled], RigidBody::Kinematic);
    game.set(blocks[pulled], LinearVelocity(Vec3::Z * 0.05));
    game.seconds(2.0);
    check(
        "way of the block, metres",
        game.position(blocks[pulled]).z,
        0.099..=0.101,
    );
    for (i, &block) in blocks.iter().enumerate().filter(|&(i, _)| i != pulled) {
        let way = game.position(block).distance(start[i]);
        check(format!("way of block {i}, metres"), way, 0.0..=0.003);
    }
}
