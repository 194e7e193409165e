//! A scene of a nut on a bolt.

use super::{Body, Scene, Shape};
use crate::geometry::TriMesh;
use crate::types::material::Friction;
use glam::{Quat, Vec3};
use std::f32::consts::{FRAC_PI_2, FRAC_PI_6, TAU};

/// Mean radius of the thread, metres.
const RADIUS: f32 = 0.5;
/// Height of crest and root over the mean radius.
const DEPTH: f32 = 0.1;
/// Radial clearance of the nut: more than twice the gap that resting bodies keep, or both flanks would jam.
const CLEARANCE: f32 = 0.06;
/// Advance per turn, metres.
pub const PITCH: f32 = 0.4;
/// Segments per turn.
const AROUND: usize = 40;
/// Rows of vertices per pitch.
const ROWS: usize = 10;
/// Turns of thread of the bolt and of the nut.
const TURNS: [usize; 2] = [12, 3];

/// Radius of the thread at an angle and a height along its axis, y: a triangle wave that climbs one pitch per turn.
fn thread(angle: f32, height: f32) -> f32 {
    let phase = (height / PITCH - angle / TAU).rem_euclid(1.0);
    RADIUS + DEPTH * (4.0 * (phase - 0.5).abs() - 1.0)
}

/// A closed tube about y: rings of points, each joined to the next and the last to the first. `radius` gives the radius
/// of a point from ring and angle, `height` the height of a ring.
fn tube(rings: usize, radius: impl Fn(usize, f32) -> f32, height: impl Fn(usize) -> f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut points = Vec::new();
    let mut faces = Vec::new();
    for ring in 0..rings {
        for k in 0..AROUND {
            let angle = TAU * k as f32 / AROUND as f32;
            let r = radius(ring, angle);
            points.push(Vec3::new(r * angle.cos(), height(ring), -r * angle.sin()));
            let at = |ring: usize, k: usize| (ring % rings * AROUND + k % AROUND) as u32;
            let [a, b, c, d] = [at(ring, k), at(ring, k + 1), at(ring + 1, k + 1), at(ring + 1, k)];
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    (points, faces)
}

/// Length of the bolt, metres.
pub const LENGTH: f32 = PITCH * TURNS[0] as f32;

/// The bolt, which stands on height 0.
pub(super) fn bolt() -> TriMesh {
    let rows = ROWS * TURNS[0];
    let height = |ring: usize| PITCH * ring as f32 / ROWS as f32;
    let (mut points, mut faces) = tube(rows + 1, |ring, angle| thread(angle, height(ring)), height);
    // The last ring is not joined to the first; caps close both ends.
    faces.truncate(2 * AROUND * rows);
    let [bottom, top] = [0, 1].map(|k| (points.len() + k) as u32);
    points.extend([Vec3::ZERO, Vec3::Y * height(rows)]);
    let last = (AROUND * rows) as u32;
    for k in 0..AROUND as u32 {
        let next = (k + 1) % AROUND as u32;
        faces.extend([[bottom, next, k], [top, last + k, last + next]]);
    }
    TriMesh::new(points, faces).expect("a valid mesh")
}

/// The nut, which fits the bolt at its initial position, one turn below the top.
pub(super) fn nut() -> TriMesh {
    let floor = TURNS[0] - TURNS[1] - 1;
    let rows = ROWS * TURNS[1];
    let height = |ring: usize| PITCH * (floor as f32 + ring.min(2 * rows + 1 - ring).min(rows) as f32 / ROWS as f32);
    let hexagon = |angle: f32| 0.95 / ((angle.rem_euclid(2.0 * FRAC_PI_6)) - FRAC_PI_6).cos();
    // The tube runs up outside and down inside; the outside has rings only at its ends.
    let rings = rows + 3;
    let ring_height = |ring: usize| match ring {
        0 => height(0),
        1 => height(rows),
        inner => height(rows + 2 - inner),
    };
    let radius = |ring: usize, angle: f32| match ring {
        0 | 1 => hexagon(angle),
        inner => thread(angle, ring_height(inner)) + CLEARANCE,
    };
    let (points, faces) = tube(rings, radius, ring_height);
    TriMesh::new(points, faces).expect("a valid mesh")
}

/// The bolt is static; the nut starts near its top with an angular velocity that screws it down, and its weight drives
/// it on.
pub fn nut_on_bolt() -> Scene {
    let mut scene = Scene::new();
    for (shape, spin) in [(Shape::Bolt, Vec3::ZERO), (Shape::Nut, Vec3::NEG_Y * FRAC_PI_2)] {
        let body = scene.add(Body::new(shape, Vec3::ZERO, Quat::IDENTITY));
        (body.fixed, body.spin, body.friction) = (shape == Shape::Bolt, spin, Friction::new(0.02));
    }
    scene
}
