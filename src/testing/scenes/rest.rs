//! Bodies at rest on each other. `gap` is the distance that resting bodies keep, metres.

use super::{Body, RING_TUBE, Scene, Shape};
use glam::{Quat, Vec3};
use std::f32::consts::FRAC_PI_2;

const FLOOR: Vec3 = Vec3::new(40.0, 1.0, 40.0);

/// A cube of edge `edge` on a floor.
pub fn cube(edge: f32, gap: f32) -> Scene {
    let mut scene = Scene::new();
    scene.floor(FLOOR, Quat::IDENTITY);
    let at = Vec3::new(0.3, 0.5 + gap, 0.2) * edge;
    scene.add(Body::new(Shape::Cube, at, Quat::from_rotation_y(0.4))).scale = Vec3::splat(edge);
    scene
}

/// A stack of `count` cubes of edge 1, each rotated slightly against the one below.
pub fn stack(count: usize, gap: f32) -> Scene {
    let mut scene = Scene::new();
    scene.floor(FLOOR, Quat::IDENTITY);
    for i in 0..count {
        let at = Vec3::Y * (0.5 + gap + (1.0 + gap) * i as f32);
        scene.add(Body::new(Shape::Cube, at, Quat::from_rotation_y(0.1 * i as f32)));
    }
    scene
}

/// A plane pyramid of cubes: each row is one shorter than the row below.
pub fn pyramid(rows: usize, gap: f32) -> Scene {
    let mut scene = Scene::new();
    scene.floor(FLOOR, Quat::IDENTITY);
    for row in 0..rows {
        for k in 0..rows - row {
            // Neighbours are farther apart than their margin.
            let x = 1.05 * (k as f32 - 0.5 * (rows - 1 - row) as f32);
            let y = 0.5 + gap + (1.0 + gap) * row as f32;
            scene.add(Body::new(Shape::Cube, Vec3::new(x, y, 0.0), Quat::IDENTITY));
        }
    }
    scene
}

/// Five rings on each other, alternately shifted by `shift`.
pub fn rings(shift: f32, gap: f32) -> Scene {
    let mut scene = Scene::new();
    scene.floor(FLOOR, Quat::IDENTITY);
    let tube = RING_TUBE as f32;
    for i in 0..5 {
        let at = Vec3::new(shift * (i % 2) as f32, tube + gap + (2.0 * tube + gap) * i as f32, 0.0);
        let turn = Quat::from_rotation_y(0.4 * i as f32) * Quat::from_rotation_x(FRAC_PI_2);
        scene.add(Body::new(Shape::Ring, at, turn));
    }
    scene
}
