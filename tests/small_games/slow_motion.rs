//! What moves slowly, and what only trembles. Theory: sleep stops nothing that goes on moving, of whatever size.

use crate::game::{Game, any_rotation, body, check};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;

fn friction(coefficient: f32) -> Friction {
    Friction::new(coefficient).with_combine(CombineRule::Min)
}

/// A cube of this edge on a slope of this angle with this coefficient of friction. Returns the way downhill too.
fn cube_on_a_slope(game: &mut Game, edge: f32, angle: f32, coefficient: f32) -> (Entity, Vec3) {
    let cube = game.mesh(&shapes::cube(1.0));
    let turn = Quat::from_rotation_z(-angle);
    let size = Vec3::new(40.0, 1.0, 10.0) * edge;
    let slope = Transform::from_translation(turn * Vec3::NEG_Y * 0.5 * edge);
    game.spawn((
        cube.clone(),
        slope.with_rotation(turn).with_scale(size),
        friction(coefficient),
    ));
    let pose = Transform::from_translation(turn * Vec3::Y * 0.5 * edge);
    let pose = pose.with_rotation(turn).with_scale(Vec3::splat(edge));
    (game.spawn((body(&cube, pose), friction(coefficient))), turn * Vec3::X)
}

/// The slope is a little too steep for the friction: the cube gains 0.0878 m/s each second.
pub fn a_cube_slides_where_friction_nearly_holds_it(backend: Backend) {
    for edge in [0.1, 1.0, 10.0] {
        let mut game = Game::new(backend);
        let angle = 26.565f32.to_radians();
        let (cube, downhill) = cube_on_a_slope(&mut game, edge, angle, 0.49);
        let start = game.position(cube);
        let acceleration = 9.81 * (angle.sin() - 0.49 * angle.cos());
        game.seconds(4.0);
        assert!(!game.sleeps(cube), "a cube of {edge} m");
        let way = (game.position(cube) - start).dot(downhill);
        let wanted = 0.5 * acceleration * 16.0;
        check(
            format!("way of a cube of {edge} m in 4 s, metres"),
            way,
            wanted * 0.97..=wanted * 1.03,
        );
    }
}

/// Pushed uphill on ice it stops for a moment, and comes back with the same speed.
pub fn a_cube_turns_round_on_ice(backend: Backend) {
    let mut game = Game::new(backend);
    let (cube, downhill) = cube_on_a_slope(&mut game, 1.0, 0.002, 0.0);
    game.seconds(0.25);
    game.set(cube, LinearVelocity(downhill * -0.02));
    game.seconds(2.0 * 0.02 / (9.81 * 0.002));
    assert!(!game.sleeps(cube));
    check("speed downhill, m/s", game.velocity(cube).dot(downhill), 0.018..=0.022);
}

pub fn what_touches_nothing_goes_on(backend: Backend) {
    let motions = [(0.049, 0.0), (0.0, 0.1), (0.001, 0.0), (0.0, 0.002)];
    for edge in [0.1, 5.0] {
        let mut game = Game::new(backend).without_gravity();
        let cube = game.mesh(&shapes::cube(1.0));
        let bodies: Vec<Entity> = (0..)
            .zip(motions)
            .map(|(i, (speed, spin))| {
                let pose = Transform::from_xyz(0.0, 0.0, 20.0 * i as f32).with_scale(Vec3::splat(edge));
                let motion = (LinearVelocity(Vec3::X * speed), AngularVelocity(Vec3::Y * spin));
                game.spawn((body(&cube, pose), motion))
            })
            .collect();
        game.seconds(10.0);
        for (&body, (speed, spin)) in bodies.iter().zip(motions) {
            check("speed, m/s", game.velocity(body).x, speed * 0.9999..=speed * 1.0001);
            check("spin, rad/s", game.spin(body).y, spin * 0.9999..=spin * 1.0001);
            assert!(!game.sleeps(body));
        }
        game.set(bodies[0], LinearVelocity(Vec3::ZERO));
        game.seconds(1.0);
        assert!(game.sleeps(bodies[0]), "at rest it sleeps");
    }
}

/// Bodies of this mesh in a bin, which are so many times as large.
fn pile(backend: Backend, mesh: &TriMesh, count: usize, scale: f32, seconds: f32) {
    let mut game = Game::new(backend);
    let mesh = game.mesh(mesh);
    let cube = game.mesh(&shapes::cube(1.0));
    let across = (count as f32).cbrt().ceil() as usize;
    let width = 1.15 * across as f32 + 0.2;
    for side in [Vec3::NEG_Y, Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z] {
        let (at, size) = if side.y == 0.0 {
            let along = side.abs() + (Vec3::ONE - side.abs()) * 2.0 * width;
            (side * (0.5 * width + 0.5) + Vec3::Y * width, along)
        } else {
            (Vec3::NEG_Y * 0.5, Vec3::new(2.0 * width, 1.0, 2.0 * width))
        };
        game.spawn((
            cube.clone(),
            Transform::from_translation(at * scale).with_scale(size * scale),
        ));
    }
    let mut random = fastrand::Rng::with_seed(7);
    let bodies: Vec<Entity> = (0..count)
        .map(|i| {
            let cell = [i % across, i / (across * across), i / across % across].map(|k| k as f32);
            let middle = 0.5 * (across - 1) as f32;
            let at = (Vec3::from_array(cell) - Vec3::new(middle, 0.0, middle)) * 1.15 + Vec3::Y;
            let pose = Transform::from_translation(at * scale).with_rotation(any_rotation(&mut random));
            game.spawn(body(&mesh, pose.with_scale(Vec3::splat(scale))))
        })
        .collect();
    for _ in 0..(2.0 * seconds) as usize {
        game.seconds(0.5);
        if bodies.iter().all(|&body| game.sleeps(body)) {
            return;
        }
    }
    let awake = bodies.iter().filter(|&&body| !game.sleeps(body)).count();
    panic!("{awake} of {count} bodies are awake after {seconds} s");
}

pub fn a_pile_of_tori_falls_asleep(backend: Backend) {
    pile(backend, &shapes::torus_240(), 30, 1.0, 20.0);
}

pub fn a_pile_of_small_tori_falls_asleep(backend: Backend) {
    pile(backend, &shapes::torus_240(), 30, 0.02, 20.0);
}

pub fn a_pile_of_knots_falls_asleep(backend: Backend) {
    pile(backend, &shapes::knot_1120(), 12, 1.0, 20.0);
}
