//! Boxes that bounce without loss and without friction, on corners, edges and faces. Theory: energy is conserved,
//! within 1 % and never above.

use crate::game::{Game, any_rotation, body, check, elastic};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;

/// What is left of the energy. Rounding alone may add a thousandth.
const KEPT: std::ops::RangeInclusive<f32> = 0.99..=1.001;

/// Kinetic energy of a cube of edge 1, per mass.
fn energy(game: &Game, cube: Entity) -> f32 {
    0.5 * (game.velocity(cube).length_squared() + game.spin(cube).length_squared() / 6.0)
}

pub fn one_bounce_on_a_plane_keeps_the_energy(backend: Backend) {
    one_bounce(backend, false);
}

pub fn one_bounce_on_a_mesh_keeps_the_energy(backend: Backend) {
    one_bounce(backend, true);
}

/// Twenty cubes in any pose, each far from the others, fall at 5 m/s.
fn one_bounce(backend: Backend, on_mesh: bool) {
    let mut game = Game::new(backend).without_gravity();
    let mut random = fastrand::Rng::with_seed(11);
    let cube = game.mesh(&shapes::cube(1.0));
    if on_mesh {
        game.slab(&cube, 5.0);
    } else {
        game.plane();
    }
    let cubes: Vec<Entity> = (0..20)
        .map(|i| {
            let at = Vec3::new(4.0 * (i % 5) as f32, 1.5 + 0.1 * random.f32(), 4.0 * (i / 5) as f32);
            let pose = Transform::from_translation(at).with_rotation(any_rotation(&mut random));
            game.spawn((body(&cube, pose), elastic(), LinearVelocity(Vec3::NEG_Y * 5.0)))
        })
        .collect();
    game.seconds(1.0);
    for (i, &cube) in cubes.iter().enumerate() {
        check(format!("energy of cube {i}"), energy(&game, cube) / 12.5, KEPT);
        assert!(game.velocity(cube).y > -4.9, "cube {i} met the ground");
    }
}

pub fn a_cube_between_six_planes_keeps_its_energy(backend: Backend) {
    closed_box(backend, false);
}

pub fn a_cube_between_six_walls_keeps_its_energy(backend: Backend) {
    closed_box(backend, true);
}

/// For half a minute, in a room of 4 m. One slow impact that does not bounce may take more than a hundredth of the
/// energy.
fn closed_box(backend: Backend, of_meshes: bool) {
    let mut game = Game::new(backend).without_gravity().with_all_bounces();
    let cube = game.mesh(&shapes::cube(1.0));
    for out in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|axis| [axis, -axis]) {
        if of_meshes {
            let wall = Transform::from_translation(out * 2.5).with_scale(Vec3::splat(5.0) - 4.0 * out.abs());
            game.spawn((cube.clone(), wall));
        } else {
            game.spawn(PlaneCollider::through(out * 2.0, -out));
        }
    }
    let body = game.spawn((
        body(&cube, Transform::from_rotation(Quat::from_rotation_x(0.4))),
        elastic(),
        LinearVelocity(Vec3::new(3.0, 2.0, 1.0)),
        AngularVelocity(Vec3::new(0.5, 1.0, 0.2)),
    ));
    let start = energy(&game, body);
    for second in 1..=30 {
        game.seconds(1.0);
        check(format!("energy after {second} s"), energy(&game, body) / start, KEPT);
    }
    let inside = game.position(body).abs().max_element();
    check("metres from the middle of the room", inside, 0.0..=1.51);
}
