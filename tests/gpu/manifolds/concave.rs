//! Tori, knots, rings, and whatever there is.

use super::approach::{against, scene};
use super::compare::{agreement, require};
use super::scene::{bar_on_a_foot, body, oracle_mesh, state, uneven_legs};
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
    // Where extremes of a contour are equally far, the GPU may take another.
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

/// A slab with a field of so many by so many pyramids on its top, of different heights.
fn pyramids(side: u32) -> TriMesh {
    let mut rng = Rng::new(24, 0);
    let at = |i: u32| i as f32 / side as f32 - 0.5;
    let top = |i: u32, k: u32| i * (side + 1) + k;
    let rows = || 0..=side;
    let mut vertices: Vec<Vec3> = rows()
        .flat_map(|i| rows().map(move |k| Vec3::new(at(i), at(k), 0.0)))
        .collect();
    let mut faces = Vec::new();
    for (i, k) in (0..side).flat_map(|i| (0..side).map(move |k| (i, k))) {
        let apex = vertices.len() as u32;
        let height = rng.range(0.4, 0.6) as f32 / side as f32;
        vertices.push(Vec3::new(at(i) + 0.5 / side as f32, at(k) + 0.5 / side as f32, height));
        let ring = [top(i, k), top(i + 1, k), top(i + 1, k + 1), top(i, k + 1)];
        faces.extend((0..4).map(|edge| [ring[edge], ring[(edge + 1) % 4], apex]));
    }
    // Counter-clockwise seen from above.
    let border: Vec<u32> = (0..4 * side)
        .map(|i| match (i / side, i % side) {
            (0, at) => top(at, 0),
            (1, at) => top(side, at),
            (2, at) => top(side - at, side),
            (_, at) => top(0, side - at),
        })
        .collect();
    let below = vertices.len() as u32;
    let bottom: Vec<Vec3> = border.iter().map(|&v| vertices[v as usize] - 0.3 * Vec3::Z).collect();
    vertices.extend(bottom);
    let center = vertices.len() as u32;
    vertices.push(-0.3 * Vec3::Z);
    for (i, &v) in (0..).zip(&border) {
        let next = (i + 1) % border.len() as u32;
        faces.extend([
            [border[next as usize], v, below + i],
            [border[next as usize], below + i, below + next],
            [below + next, below + i, center],
        ]);
    }
    TriMesh::new(vertices, faces).unwrap()
}

/// Hundreds of contours in one pair, each with features of its own.
pub fn hundreds_of_patches(gpu: &Gpu) {
    let product = Product::default();
    let side = 24;
    let (field, cube) = (
        oracle_mesh("pyramids", &pyramids(side)),
        oracle_mesh("cube", &shapes::cube(1.2)),
    );
    let slab = body(&field, DVec3::ZERO, Quat::IDENTITY);
    let lid = body(
        &cube,
        DVec3::Z * (0.6 + 0.3 / f64::from(side)),
        Quat::from_rotation_z(0.1),
    );
    let (state, pairs) = scene(&product, &[([slab, lid], 0.001)]);
    let result = agreement("pyramids", gpu, &state, &pairs);
    assert_eq!((result.pairs, result.missed, result.shifted), (1, 0, 0), "{result:?}");
    // Where a feature does not find its patch, a ray stands in for it, and hits another face of the same apex.
    assert!(result.named * 10 >= 9 * result.points, "{result:?}");
}

/// Patches with features beside patches that are too deep for any, and both in one.
pub fn patches_too_deep_for_features(gpu: &Gpu) {
    let (product, slab) = (Product::default(), oracle_mesh("slab", &shapes::cube(2.0)));
    let mut rng = Rng::new(30, 0);
    let cases: Vec<_> = [(uneven_legs(), 0.4), (bar_on_a_foot(), -0.01)]
        .iter()
        .flat_map(|(mesh, height)| (0..20).map(move |_| (mesh, height)))
        .map(|(mesh, height)| {
            let frame = rng.rotation();
            let a = body(&slab, frame.as_dquat() * DVec3::NEG_Z, frame);
            let tilt = Quat::from_scaled_axis(rng.in_ball(0.01).as_vec3());
            let b = body(mesh, frame.as_dquat() * (DVec3::Z * *height), frame * tilt);
            ([a, b], 0.01)
        })
        .collect();
    let (state, pairs) = scene(&product, &cases);
    require("too deep for features", gpu, &state, &pairs, 0, 0.02);
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
