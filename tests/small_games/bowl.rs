//! A ball without friction in a bowl. Theory: it swings for ever, and never has more energy than before. The edges
//! between the facets of a bowl may take some.

use crate::game::{Game, body, check};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;
use std::f32::consts::{FRAC_PI_2, TAU};

/// The lower half of a sphere about `(0, radius, 0)`, open at the top and facing inward.
fn bowl(radius: f32, around: u32, up: u32) -> TriMesh {
    let mut vertices = vec![Vec3::ZERO];
    for ring in 1..=up {
        let (sin, cos) = (FRAC_PI_2 * ring as f32 / up as f32).sin_cos();
        vertices.extend((0..around).map(|k| {
            let (s, c) = (TAU * k as f32 / around as f32).sin_cos();
            radius * Vec3::new(sin * c, 1.0 - cos, sin * s)
        }));
    }
    let at = |ring: u32, k: u32| 1 + (ring - 1) * around + k % around;
    let mut faces: Vec<[u32; 3]> = (0..around).map(|k| [0, at(1, k + 1), at(1, k)]).collect();
    for ring in 1..up {
        faces.extend((0..around).flat_map(|k| {
            let [a, b, c, d] = [at(ring, k), at(ring, k + 1), at(ring + 1, k), at(ring + 1, k + 1)];
            [[a, b, d], [a, d, c]]
        }));
    }
    TriMesh::new(vertices, faces).unwrap()
}

/// Released at rest, and pushed sideways.
pub fn a_ball_in_a_bowl_gains_no_energy(backend: Backend) {
    for speed in [0.0, 2.0] {
        swing(backend, speed);
    }
}

fn swing(backend: Backend, speed: f32) {
    let mut game = Game::new(backend);
    let (ball, bowl) = (game.mesh(&shapes::ball(0.1, 3)), game.mesh(&bowl(1.0, 96, 24)));
    game.spawn((bowl, Transform::default(), Friction::new(0.0)));
    // Its centre is at a height of 0.6 m, and almost 0.9 m from that of the bowl.
    let (start, reach) = (0.6f32, 0.899f32);
    let aside = (reach * reach - (1.0 - start).powi(2)).sqrt();
    let ball = game.spawn((
        body(&ball, Transform::from_xyz(aside, start, 0.0)),
        Friction::new(0.0),
        LinearVelocity(Vec3::Z * speed),
    ));
    let before = 0.5 * speed * speed + 9.81 * start;
    let (mut lowest, mut highest) = (f32::INFINITY, 0.0f32);
    for step in 0..640 {
        game.steps(1);
        let height = game.position(ball).y;
        let energy = 0.5 * game.velocity(ball).length_squared() + 9.81 * height;
        check(
            format!("energy after step {step} over that before"),
            energy / before,
            0.6..=1.002,
        );
        if step > 64 {
            lowest = lowest.min(height);
            highest = highest.max(height);
        }
    }
    check("highest after the first swing, m", highest, 0.55..=0.601);
    // The ball is a polyhedron: its faces are nearer to the centre than its corners.
    check("lowest, m", lowest, 0.097..=if speed == 0.0 { 0.11 } else { 0.5 });
}
