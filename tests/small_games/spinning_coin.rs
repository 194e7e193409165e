//! A flat disc that spins on a half-space. Theory: its weight is spread evenly, so that friction brakes it with
//! 4/3 mu g / R rad/s^2, however the disc is cut into triangles.

use crate::game::{Game, body, check};
use bevy::prelude::*;
use bevy_faceoff::prelude::*;
use std::f32::consts::TAU;

const RADIUS: f32 = 0.5;
const SIDES: u32 = 32;

/// A flat cylinder about y, its caps cut into fans: about a vertex in the middle, or about a vertex of the rim.
fn disc(thickness: f32, vertex_in_the_middle: bool) -> TriMesh {
    let mut vertices = Vec::new();
    for y in [-0.5 * thickness, 0.5 * thickness] {
        vertices.extend((0..SIDES).map(|k| {
            let (sin, cos) = (TAU * k as f32 / SIDES as f32).sin_cos();
            Vec3::new(RADIUS * cos, y, RADIUS * sin)
        }));
    }
    let [below, above] = [0, SIDES].map(|first| move |k: u32| first + k % SIDES);
    let mut faces: Vec<[u32; 3]> = (0..SIDES)
        .flat_map(|k| {
            let [a, b, c, d] = [below(k), below(k + 1), above(k), above(k + 1)];
            [[a, c, b], [b, c, d]]
        })
        .collect();
    if vertex_in_the_middle {
        let middle = vertices.len() as u32;
        vertices.extend([-0.5, 0.5].map(|part| Vec3::Y * part * thickness));
        faces.extend((0..SIDES).map(|k| [middle, below(k), below(k + 1)]));
        faces.extend((0..SIDES).map(|k| [middle + 1, above(k + 1), above(k)]));
    } else {
        faces.extend((1..SIDES - 1).map(|k| [below(0), below(k), below(k + 1)]));
        faces.extend((1..SIDES - 1).map(|k| [above(0), above(k + 1), above(k)]));
    }
    TriMesh::new(vertices, faces).unwrap()
}

pub fn with_a_vertex_in_the_middle_slows_down_by_theory(backend: Backend) {
    slows_down(backend, true);
}

pub fn without_a_vertex_in_the_middle_slows_down_by_theory(backend: Backend) {
    slows_down(backend, false);
}

fn slows_down(backend: Backend, vertex_in_the_middle: bool) {
    let mut game = Game::new(backend);
    let mesh = disc(0.05, vertex_in_the_middle);
    assert!(mesh.is_solid());
    let disc = game.mesh(&mesh);
    game.plane();
    let friction = 0.4;
    let pose = Transform::from_xyz(0.0, 0.03, 0.0);
    let coin = game.spawn((
        body(&disc, pose),
        Friction::new(friction).with_combine(CombineRule::Min),
        AngularVelocity(Vec3::Y * 20.0),
    ));
    // It falls flat first.
    game.seconds(0.25);
    let before = game.spin(coin).y;
    game.seconds(0.5);
    let braked = (before - game.spin(coin).y) / 0.5;
    let uniform = 4.0 / 3.0 * friction * 9.81 / RADIUS;
    check(
        "deceleration over that of a weight spread evenly",
        braked / uniform,
        0.9..=1.1,
    );
    check("height, m", game.position(coin).y, 0.024..=0.035);
}
