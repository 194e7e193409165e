//! Loose fits that are tighter than the gap that bodies keep at rest. Theory: what has play is not held.

use crate::game::{Game, body, check};
use bevy::prelude::*;
use bevy_faceoff::prelude::*;

const SIDES: u32 = 32;

/// Rings of corners around y of these radii and heights, joined in turn by faces.
fn turned(profile: &[(f32, f32)]) -> TriMesh {
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for &(radius, height) in profile {
        vertices.extend((0..SIDES).map(|i| {
            let turn = Quat::from_rotation_y(std::f32::consts::TAU * i as f32 / SIDES as f32);
            turn * Vec3::X * radius + Vec3::Y * height
        }));
    }
    let rings = profile.len() as u32;
    for ring in 0..rings {
        for i in 0..SIDES {
            let corner = |ring: u32, i: u32| (ring % rings) * SIDES + i % SIDES;
            let [a, b] = [corner(ring, i), corner(ring, i + 1)];
            let [c, d] = [corner(ring + 1, i), corner(ring + 1, i + 1)];
            faces.extend([[a, b, d], [a, d, c]]);
        }
    }
    TriMesh::new(vertices, faces).unwrap()
}

/// A pipe of this length around y.
fn pipe(outer: f32, inner: f32, length: f32) -> TriMesh {
    let (low, high) = (-0.5 * length, 0.5 * length);
    turned(&[(outer, low), (outer, high), (inner, high), (inner, low)])
}

/// A pin of 2 m, as a pipe, in an upright hole that is 0.2 % wider: it has 0.2 mm of play on each side, and the gap at
/// rest is 1 mm.
pub fn a_pin_falls_through_its_hole(backend: Backend) {
    let mut game = Game::new(backend);
    let radius = 0.1;
    let hole = game.mesh(&pipe(0.3, radius * 1.002, 1.2));
    let pin = game.mesh(&pipe(radius, 0.05, 2.0));
    game.spawn((hole, Transform::IDENTITY));
    let pin = game.spawn(body(&pin, Transform::IDENTITY));
    game.seconds(0.5);
    check("metres fallen", -game.position(pin).y, 1.15..=1.26);
}

/// A hole like it, inclined by 40 degrees: the pin slides on one side, and friction of 0.3 holds it by that side's load
/// alone.
pub fn a_pin_slides_in_an_inclined_hole(backend: Backend) {
    let mut game = Game::new(backend);
    let radius = 0.1;
    let hole = game.mesh(&pipe(0.3, radius * 1.002, 1.2));
    let pin = game.mesh(&pipe(radius, 0.05, 2.0));
    let angle = 40f32.to_radians();
    let pose = Transform::from_rotation(Quat::from_rotation_z(std::f32::consts::FRAC_PI_2 - angle));
    let friction = Friction::new(0.3);
    game.spawn((hole, pose, friction));
    let pin = game.spawn((body(&pin, pose), friction));
    game.seconds(0.5);
    // Less than without load on the far side, because the facets of the hole carry it on two lines.
    let wanted = 0.125 * 9.81 * (angle.sin() - 0.3 * angle.cos());
    check(
        "metres slid",
        game.position(pin).length(),
        wanted * 0.85..=wanted * 1.03,
    );
}
