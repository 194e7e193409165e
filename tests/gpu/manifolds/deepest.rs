//! Slender bodies in thick ones: they are as deep as their lowest corner, which is far from where they enter.

use super::approach::scene;
use super::compare::{on_gpu, require};
use super::scene::{body, oracle_mesh};
use crate::ccd::shapes::cuboid;
use crate::oracle::product::Product;
use crate::oracle::rng::Rng;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::gpu::device::Gpu;
use glam::{DVec3, Quat, Vec3};

pub fn slender_bodies(gpu: &Gpu) {
    let size = Vec3::new(0.1, 0.12, 1.0);
    let (bar, slab) = (
        oracle_mesh("bar", &cuboid(size)),
        oracle_mesh("slab", &shapes::cube(2.0)),
    );
    let mut rng = Rng::new(40, 0);
    let (mut cases, mut depths) = (Vec::new(), Vec::new());
    for case in 0..60 {
        let depth = [0.002, 0.03, 0.1, 0.3][case % 4];
        let frame = rng.rotation();
        let about = Quat::from_rotation_z(rng.range(0.0, 6.0) as f32);
        let rotation = Quat::from_rotation_x(rng.range(0.0, 1.0) as f32) * about;
        let corner = |i: u32| {
            let sign = |bit: u32| if i >> bit & 1 == 1 { 0.5 } else { -0.5 };
            rotation * (size * Vec3::new(sign(0), sign(1), sign(2)))
        };
        let lowest = (0..8).map(|i| corner(i).z).fold(f32::INFINITY, f32::min);
        let aside = DVec3::new(rng.range(-0.3, 0.3), rng.range(-0.3, 0.3), -f64::from(lowest) - depth);
        let a = body(&slab, frame.as_dquat() * DVec3::NEG_Z, frame);
        let b = body(&bar, frame.as_dquat() * aside, frame * rotation);
        cases.push(if case % 3 == 0 {
            ([b, a], 0.001)
        } else {
            ([a, b], 0.001)
        });
        depths.push(depth as f32);
    }
    let (state, pairs) = scene(&Product::default(), &cases);
    require("slender bodies", gpu, &state, &pairs, 0, 0.02);
    let found = on_gpu(gpu, &state, &pairs);
    for (pair, depth) in found.pairs.iter().zip(depths) {
        let points = found.points_of(pair).iter().map(|point| -point.separation);
        let deepest = points.fold(f32::NEG_INFINITY, f32::max);
        // A ray through the middle is nearly as deep as the vertex.
        assert!((deepest / depth - 1.0).abs() < 0.025, "{deepest} for {depth}");
    }
}
