//! Cubes and balls.

use super::approach::scene;
use super::compare::require;
use super::scene::{body, cube, oracle_mesh};
use crate::oracle::body::Body;
use crate::oracle::product::Product;
use crate::oracle::rng::Rng;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::gpu::device::Gpu;
use glam::{DVec3, Quat, Vec3};
use std::f32::consts::FRAC_PI_4;

/// Negative ones are gaps.
const DEPTHS: [f64; 4] = [0.01, 0.001, -0.003, 0.03];

/// Turned about the axis, shifted aside, and all of it turned any way.
fn face_on_face(count: usize, at: DVec3, depths: &[f64], seed: u64) -> Vec<([Body; 2], f32)> {
    let cube = cube();
    let mut rng = Rng::new(seed, 0);
    (0..count)
        .map(|case| {
            let frame = rng.rotation();
            let depth = depths[case % depths.len()];
            let aside = DVec3::new(rng.range(-0.4, 0.4), rng.range(-0.4, 0.4), 1.0 - depth);
            let a = body(&cube, at, frame);
            let about = Quat::from_rotation_z(rng.range(0.0, 6.0) as f32);
            let b = body(&cube, at + frame.as_dquat() * aside, frame * about);
            ([a, b], 0.01)
        })
        .collect()
}

pub fn cubes_face_on_face(gpu: &Gpu) {
    let (state, pairs) = scene(
        &Product::default(),
        &face_on_face(100, DVec3::new(5.0, -3.0, 2.0), &DEPTHS, 2),
    );
    require("cubes face on face", gpu, &state, &pairs, 0, 0.01);
}

/// What overlaps by rounding alone has a contour on the CPU and none on the device, or the other way round: what is
/// found beside the corners differs, not where the bodies are held.
pub fn cubes_that_touch(gpu: &Gpu) {
    let (state, pairs) = scene(
        &Product::default(),
        &face_on_face(60, DVec3::new(5.0, -3.0, 2.0), &[0.0], 4),
    );
    require("cubes that touch", gpu, &state, &pairs, 0, 0.4);
}

pub fn far_from_the_origin(gpu: &Gpu) {
    let product = Product::default();
    let at = DVec3::new(1e4, -1e4, 1e4);
    let (state, pairs) = scene(&product, &face_on_face(50, at, &DEPTHS, 3));
    require("cubes far from the origin", gpu, &state, &pairs, 0, 0.01);
}

pub fn cubes_aligned(gpu: &Gpu) {
    let cube = cube();
    let mut rng = Rng::new(17, 0);
    let cases: Vec<_> = (0..40)
        .map(|case| {
            let gap = [0.003, 1e-3, -1e-3, -0.02][case % 4];
            let frame = if case < 4 { Quat::IDENTITY } else { rng.rotation() };
            let up = (frame * Vec3::Z).as_dvec3();
            ([0.0, 1.0 + gap].map(|z| body(&cube, up * z, frame)), 0.01)
        })
        .collect();
    let (state, pairs) = scene(&Product::default(), &cases);
    require("cubes aligned", gpu, &state, &pairs, 0, 0.01);
}

pub fn cubes_edge_on_edge(gpu: &Gpu) {
    let cube = cube();
    let mut rng = Rng::new(3, 0);
    let cases: Vec<_> = (0..60)
        .map(|case| {
            let depth = [0.02, 0.003, -0.003][case % 3];
            // Each stands on an edge; seen from above the edges cross at some angle.
            let tilt = Quat::from_rotation_x(FRAC_PI_4);
            let above = Quat::from_rotation_z(rng.range(0.5, 2.6) as f32) * tilt;
            let aside = DVec3::X * rng.range(-0.2, 0.2);
            let a = body(&cube, DVec3::ZERO, tilt);
            let b = body(&cube, aside + DVec3::Z * (std::f64::consts::SQRT_2 - depth), above);
            ([a, b], 0.01)
        })
        .collect();
    let (state, pairs) = scene(&Product::default(), &cases);
    require("cubes edge on edge", gpu, &state, &pairs, 0, 0.0);
}

pub fn cubes_at_any_gap(gpu: &Gpu) {
    let cube = cube();
    let mut rng = Rng::new(8, 0);
    let cases: Vec<_> = (0..100)
        .map(|_| {
            let a = body(&cube, rng.in_ball(3.0), rng.rotation());
            let at = a.translation.as_dvec3() + rng.direction() * rng.range(0.9, 1.6);
            ([a, body(&cube, at, rng.rotation())], rng.range(0.0, 0.3) as f32)
        })
        .collect();
    let (state, pairs) = scene(&Product::default(), &cases);
    require("cubes at any gap", gpu, &state, &pairs, 0, 0.01);
}

pub fn balls(gpu: &Gpu) {
    let ball = oracle_mesh("ball", &shapes::ball(0.5, 3));
    let mut rng = Rng::new(9, 0);
    let cases: Vec<_> = (0..40)
        .map(|case| {
            let depth = [-0.004, 0.001, 0.01, 0.05][case % 4];
            let a = body(&ball, rng.in_ball(3.0), rng.rotation());
            let at = a.translation.as_dvec3() + rng.direction() * (0.99 - depth);
            ([a, body(&ball, at, rng.rotation())], 0.02)
        })
        .collect();
    let (state, pairs) = scene(&Product::default(), &cases);
    require("balls", gpu, &state, &pairs, 0, 0.01);
}

/// Boxes on a floor of two triangles a hundred times as large, in either order.
pub fn small_on_large(gpu: &Gpu) {
    let cube = cube();
    let mut rng = Rng::new(10, 0);
    let cases: Vec<_> = (0..40)
        .map(|case| {
            let size = rng.range(0.5, 1.5);
            let depth = [0.01, 0.001, -0.003, 0.03][case % 4] * size;
            let floor = Body {
                scale: Vec3::new(100.0, 80.0, 1.0),
                ..body(&cube, DVec3::new(3.0, 2.0, -0.5), Quat::IDENTITY)
            };
            let at = DVec3::new(rng.range(-30.0, 30.0), rng.range(-30.0, 30.0), 0.5 * size - depth);
            let small = Body {
                scale: Vec3::splat(size as f32),
                ..body(&cube, at, Quat::from_rotation_z(rng.range(0.0, 6.0) as f32))
            };
            let bodies = if case % 8 < 4 { [small, floor] } else { [floor, small] };
            (bodies, (0.01 * size) as f32)
        })
        .collect();
    let (state, pairs) = scene(&Product::default(), &cases);
    require("small on large", gpu, &state, &pairs, 0, 0.01);
}
