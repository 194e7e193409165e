//! One body inside the other.

use super::approach::scene;
use super::compare::{on_gpu, require};
use super::scene::body;
use crate::oracle::body::Body;
use crate::oracle::product::Product;
use crate::oracle::rng::Rng;
use crate::oracle::shapes::Shapes;
use bevy_faceoff::gpu::device::Gpu;
use glam::{DVec3, Quat, Vec3};

pub fn one_inside_the_other(gpu: &Gpu) {
    let (product, shapes) = (Product::default(), Shapes::new());
    let mut rng = Rng::new(14, 0);
    let inner = [
        &shapes.ball,
        &shapes.cube,
        &shapes.two_balls,
        &shapes.torus,
        &shapes.inward_ball,
    ];
    let cases: Vec<_> = (0..60)
        .map(|case| {
            let outer = body([&shapes.ball, &shapes.cube][case % 2], rng.in_ball(3.0), rng.rotation());
            let at = outer.translation.as_dvec3() + rng.in_ball(0.15);
            let inner = Body {
                scale: Vec3::splat(rng.range(0.1, 0.3) as f32),
                ..body(inner[case % inner.len()], at, rng.rotation())
            };
            let bodies = if case % 4 < 2 { [outer, inner] } else { [inner, outer] };
            (bodies, 0.01)
        })
        .collect();
    let (state, pairs) = scene(&product, &cases);
    require("inside", gpu, &state, &pairs, 0, 0.01);

    let outer = body(&shapes.hollow_ball, DVec3::ZERO, Quat::IDENTITY);
    let inner = Body::new(&shapes.ball, DVec3::ZERO, Quat::IDENTITY, 0.3);
    let (state, pairs) = scene(&product, &[([outer, inner], 0.01)]);
    assert!(
        on_gpu(gpu, &state, &pairs).pairs.is_empty(),
        "nothing touches in a hollow"
    );
}
