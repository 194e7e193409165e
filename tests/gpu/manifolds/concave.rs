//! Tori, knots, rings, and whatever there is.

use super::approach::{against, scene};
use super::compare::{agreement, require};
use super::scene::{body, oracle_mesh, state};
use crate::oracle::body::{Body, Mesh};
use crate::oracle::product::Product;
use crate::oracle::rng::Rng;
use crate::oracle::shapes::Shapes;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::manifolds::MarginPair;
use glam::{DVec3, Quat, Vec3};
use std::f32::consts::TAU;
use std::sync::Arc;

/// Negative for gaps.
const OVERLAPS: [f64; 4] = [-0.004, 0.001, 0.01, 0.05];

/// From anywhere outside.
fn from_outside(product: &Product, mesh: &Arc<Mesh>, rng: &mut Rng, overlap: f64) -> Option<[Body; 2]> {
    let a = body(mesh, rng.in_ball(2.0), rng.rotation());
    let b = body(mesh, a.translation.as_dvec3() + rng.in_ball(0.1), rng.rotation());
    let way = rng.direction();
    let b = against(product, &a, &b, way, [-1.1, 0.0], overlap)?;
    Some([a, b])
}

/// Like two links of a chain that is pulled.
fn in_a_chain(product: &Product, mesh: &Arc<Mesh>, rng: &mut Rng, overlap: f64) -> Option<[Body; 2]> {
    let mut spin = |range: f64| rng.range(-range, range) as f32;
    let across = Quat::from_rotation_x(TAU / 4.0 + spin(0.4)) * Quat::from_rotation_z(spin(0.5));
    let a = body(mesh, DVec3::ZERO, Quat::from_rotation_z(spin(3.0)));
    let b = body(mesh, DVec3::X * 0.44, across);
    let way = (DVec3::X + rng.direction() * 0.3).normalize();
    let b = against(product, &a, &b, way, [0.0, 0.6], overlap)?;
    Some([a, b])
}

fn compare(
    name: &str,
    gpu: &Gpu,
    mesh: &TriMesh,
    count: u64,
    approach: fn(&Product, &Arc<Mesh>, &mut Rng, f64) -> Option<[Body; 2]>,
    share: f64,
) {
    let (product, mesh) = (Product::default(), oracle_mesh(name, mesh));
    for overlap in OVERLAPS {
        let case = |i| approach(&product, &mesh, &mut Rng::new(20, i), overlap);
        let cases: Vec<_> = (0..count).filter_map(case).map(|bodies| (bodies, 0.01)).collect();
        let (state, pairs) = scene(&product, &cases);
        require(&format!("{name}, {overlap}"), gpu, &state, &pairs, 0, share);
    }
}

pub fn tori(gpu: &Gpu) {
    compare("torus", gpu, &shapes::torus_240(), 40, from_outside, 0.01);
}

pub fn knots(gpu: &Gpu) {
    compare("knot", gpu, &shapes::knot_1120(), 24, from_outside, 0.01);
}

pub fn rings(gpu: &Gpu) {
    compare("ring", gpu, &shapes::ring(), 30, in_a_chain, 0.01);
}

/// Bodies of all kinds at random places, many deep in each other.
pub fn heaps(gpu: &Gpu) {
    let (product, shapes) = (Product::default(), Shapes::new());
    let solids = shapes.solids();
    let mut rng = Rng::new(21, 0);
    let bodies: Vec<Body> = (0..40)
        .map(|i| body(solids[i % solids.len()], rng.in_ball(1.0), rng.rotation()))
        .collect();
    let state = state(&product, &bodies.iter().collect::<Vec<_>>());
    let all = (0..40).flat_map(|a| (a + 1..40).map(move |b| [a, b]));
    let pairs: Vec<_> = all.map(|bodies| MarginPair { bodies, margin: 0.01 }).collect();
    let result = agreement("heap", gpu, &state, &pairs);
    assert!(result.pairs > 150);
    // Of extremes of a contour that are as far as each other another may be taken.
    assert!(result.missed == 0 && result.shifted * 50 <= result.pairs, "{result:?}");
    assert!(result.unmatched_share() < 0.02, "{result:?}");
}

/// Thousands of small triangles each.
pub fn fine_meshes(gpu: &Gpu) {
    let ball = oracle_mesh("fine ball", &shapes::ball(0.5, 4));
    let product = Product::default();
    let case = |i| from_outside(&product, &ball, &mut Rng::new(22, i), OVERLAPS[i as usize % 4]);
    let cases: Vec<_> = (0..12).filter_map(case).map(|bodies| (bodies, 0.01)).collect();
    let (state, pairs) = scene(&product, &cases);
    require("fine balls", gpu, &state, &pairs, 0, 0.02);
}

/// From what single precision hardly sees to a tenth.
pub fn overlaps_of_any_size(gpu: &Gpu) {
    let (product, shapes) = (Product::default(), Shapes::new());
    let solids = shapes.solids();
    for exponent in -7..=-1 {
        let overlap = 10f64.powi(exponent);
        let case = |i: u64| {
            let mesh = solids[i as usize % solids.len()];
            from_outside(&product, mesh, &mut Rng::new(23, i), overlap)
        };
        let cases: Vec<_> = (0..42).filter_map(case).map(|bodies| (bodies, 0.01)).collect();
        let (state, pairs) = scene(&product, &cases);
        let result = agreement(&format!("overlap of {overlap:e}"), gpu, &state, &pairs);
        assert!(result.missed == 0 && result.shifted <= 1, "{result:?}");
        // What overlaps by rounding alone has no contour.
        let most = if exponent < -5 { 0.1 } else { 0.02 };
        assert!(result.unmatched_share() < most, "{result:?}");
    }
}

/// Open, inward and separate ones too, deep in each other as well.
pub fn any_shapes_of_any_scale(gpu: &Gpu) {
    let (product, shapes) = (Product::default(), Shapes::new());
    let mut rng = Rng::new(15, 0);
    let cases: Vec<_> = (0..300)
        .map(|_| {
            let size = 10f64.powf(rng.range(-3.0, 2.0));
            let two = shapes.two(&mut rng);
            let scale = |rng: &mut Rng| {
                let mut part = || (size * rng.range(0.5, 1.0) * if rng.chance(0.3) { -1.0 } else { 1.0 }) as f32;
                Vec3::new(part(), part(), part())
            };
            let (scale_a, scale_b) = (scale(&mut rng), scale(&mut rng));
            let at = rng.in_ball(size);
            let a = Body {
                scale: scale_a,
                ..body(two[0], at, rng.rotation())
            };
            let b = Body {
                scale: scale_b,
                ..body(two[1], at + rng.in_ball(0.9 * size), rng.rotation())
            };
            ([a, b], (0.01 * size) as f32)
        })
        .collect();
    let (state, pairs) = scene(&product, &cases);
    let result = agreement("any shapes", gpu, &state, &pairs);
    assert!(result.pairs > 60);
    assert!(result.missed == 0 && result.shifted <= 1, "{result:?}");
    // Patches that no ray leaves name a triangle of their contour, of which each backend takes the first it has found.
    assert!(result.unmatched_share() < 0.03, "{result:?}");
}
