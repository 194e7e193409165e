//! What no one should ask.

use super::approach::scene;
use super::compare::{on_cpu, on_gpu};
use super::scene::{body, state};
use crate::oracle::body::{Body, Mesh};
use crate::oracle::product::Product;
use crate::oracle::rng::Rng;
use crate::oracle::shapes::Shapes;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::manifolds::{Manifolds, MarginPair};
use bevy_faceoff::step::StepState;
use bevy_faceoff::step::gpu::StepError;
use bevy_faceoff::testing::gpu_manifolds::GpuManifolds;
use glam::{DVec3, Quat, Vec3};
use std::sync::Arc;

pub fn bad_pairs(gpu: &Gpu) {
    let (product, shapes) = (Product::default(), Shapes::new());
    let bodies = [0.0, 0.9, 3.0, 3.95].map(|x| body(&shapes.unit_cube, DVec3::X * x, Quat::IDENTITY));
    let state = state(&product, &bodies.each_ref());
    let pair = |a, b, margin| MarginPair { bodies: [a, b], margin };
    let wrong = [
        pair(0, 0, 0.1),
        pair(0, 1, f32::NAN),
        pair(0, 4, 0.1),
        pair(0, u32::MAX, 0.1),
        pair(2, 2, 0.1),
        pair(2, 3, -1.0),
        pair(7, 9, 0.1),
        pair(u32::MAX, u32::MAX, 0.1),
    ];
    let [wanted, found] = [on_cpu(&state, &wrong), on_gpu(gpu, &state, &wrong)];
    let bodies = |list: &Manifolds| list.pairs.iter().map(|pair| pair.bodies).collect::<Vec<_>>();
    assert_eq!(bodies(&wanted), [[0, 1], [2, 3]]);
    assert_eq!(bodies(&found), bodies(&wanted));
    // Infinitely far, every face is near every other.
    for margin in [1e30, f32::INFINITY] {
        let found = on_gpu(gpu, &state, &[pair(0, 3, margin)]);
        assert_eq!(found.pairs.len(), 1);
    }
}

/// Every face of one is near every face of the other: over a million pairs of triangles. A device that leaves long
/// loops must say so.
pub fn a_margin_around_everything(gpu: &Gpu) {
    let (product, shapes) = (Product::default(), Shapes::new());
    let bodies = [0.0, 1.2].map(|x| body(&shapes.knot, DVec3::X * x, Quat::IDENTITY));
    let state = state(&product, &bodies.each_ref());
    let pairs = [MarginPair {
        bodies: [0, 1],
        margin: f32::INFINITY,
    }];
    match GpuManifolds::new(gpu).unwrap().run(&state.input, &pairs) {
        Ok(found) => assert_eq!(found.pairs.len(), 1),
        Err(error) => assert_eq!(error, StepError::CutShort),
    }
}

pub fn nothing_at_all(gpu: &Gpu) {
    let none = on_gpu(gpu, &StepState::default(), &[]);
    assert_eq!(none, Manifolds::default());
    let pair = MarginPair {
        bodies: [0, 1],
        margin: 0.1,
    };
    assert_eq!(on_gpu(gpu, &StepState::default(), &[pair]), Manifolds::default());
}

/// A mesh may have been loaded twice. Bodies of the two that coincide are pushed apart as two of one mesh are.
pub fn equal_meshes_in_two_slots(gpu: &Gpu) {
    let (product, shapes) = (Product::default(), Shapes::new());
    let at = body(&shapes.torus, DVec3::new(1.0, 2.0, 3.0), Quat::from_rotation_y(0.7));
    let two_slots = state(&product, &[&at, &at]);
    let mut one_slot = state(&product, &[&at, &at]);
    one_slot.input.bodies.mesh.fill(0);
    let pair = MarginPair {
        bodies: [0, 1],
        margin: 0.01,
    };
    let [twice, once] = [two_slots, one_slot].map(|state| on_gpu(gpu, &state, &[pair]));
    assert_eq!(twice, once);
    assert!(!twice.points.is_empty());
}

/// Meshes that lie in each other exactly, or nearly, and soups: any answer will do that is made of numbers.
pub fn hostile_scenes(gpu: &Gpu) {
    let (product, shapes) = (Product::default(), Shapes::new());
    let mut meshes: Vec<&Arc<Mesh>> = shapes.solids().to_vec();
    meshes.extend([&shapes.triangle, &shapes.hollow_ball, &shapes.unwelded_torus]);
    meshes.extend(&shapes.soups);
    let mut cases = Vec::new();
    for mesh in meshes {
        for rotation in [Quat::IDENTITY, Quat::from_rotation_y(0.7)] {
            let body = body(mesh, DVec3::new(1.0, 2.0, 3.0), rotation);
            cases.push(([body.clone(), body.clone()], 0.01));
            cases.push(([body.clone(), body.moved(DVec3::X * 1e-6)], 0.0));
        }
    }
    let mut rng = Rng::new(15, 1);
    for _ in 0..100 {
        let size = 10f64.powf(rng.range(-6.0, 3.0));
        let far = rng.chance(0.5);
        let at = rng.in_ball(if far { 1e4 } else { 1.0 });
        let two = shapes.two(&mut rng);
        let scale = |rng: &mut Rng| Vec3::splat((size * rng.range(0.001, 1.0)) as f32);
        let (scale_a, scale_b) = (scale(&mut rng), scale(&mut rng));
        let a = Body {
            scale: scale_a,
            ..body(two[0], at, rng.rotation())
        };
        let b = Body {
            scale: scale_b,
            ..body(two[1], at + rng.in_ball(0.7 * size), rng.rotation())
        };
        cases.push(([a, b], (0.01 * size) as f32));
    }
    let (state, pairs) = scene(&product, &cases);
    assert!(!on_gpu(gpu, &state, &pairs).pairs.is_empty());
}
