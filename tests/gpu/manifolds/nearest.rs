//! Meshes that are apart: the least distance of their contact points on the device is that of the meshes.

use super::nearest_pairs::{At, Near, all_shapes, near};
use crate::support::Random;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::manifolds::MarginPair;
use bevy_faceoff::state::Body;
use bevy_faceoff::step::StepState;
use bevy_faceoff::testing::gpu_manifolds::GpuManifolds;
use glam::Vec3;

/// Upper bound of the errors of single precision, metres. The bodies are about a metre large.
const ROUNDING: f64 = 4.0e-6;

/// A pose of single precision.
fn rounded(at: At) -> At {
    At {
        translation: at.translation.as_vec3().as_dvec3(),
        rotation: at.rotation.normalize().as_quat().as_dquat(),
    }
}

pub fn are_found(gpu: &Gpu) {
    let shapes = all_shapes();
    let mut random = Random::new(33);
    let pairs: Vec<Near> = (0..4000)
        .filter_map(|_| near(&shapes, &mut random, rounded))
        .filter(|pair| pair.least > ROUNDING)
        .collect();
    let mut state = StepState::default();
    let meshes: Vec<u32> = shapes
        .iter()
        .map(|shape| state.input.meshes.add(shape.baked.clone()))
        .collect();
    for pair in &pairs {
        for (shape, at) in pair.shapes.into_iter().zip(pair.at) {
            let mesh = meshes[shapes.iter().position(|other| other.name == shape.name).unwrap()];
            let body = Body::at_rest(mesh, at.translation.as_vec3(), at.rotation.as_quat(), Vec3::ONE);
            state.input.bodies.push(&body, &state.input.meshes).unwrap();
        }
    }
    let margins: Vec<MarginPair> = (0..)
        .zip(&pairs)
        .map(|(i, pair)| MarginPair {
            bodies: [2 * i, 2 * i + 1],
            margin: (pair.margin + ROUNDING) as f32,
        })
        .collect();
    let mut run = GpuManifolds::new(gpu).expect("the kernels compile");
    let found = run.run(&state.input, &margins).expect("the device does it");
    let mut tested = 0;
    let mut worst = 0.0f64;
    for manifold in &found.pairs {
        let bodies = manifold.bodies.map(|body| body as usize);
        let pair = &pairs[bodies[0] / 2];
        let centers = bodies.map(|body| state.input.bodies.frame[body].center);
        let (mut nearest, names) = (f64::INFINITY, pair.shapes.map(|shape| shape.name));
        for point in found.points_of(manifold) {
            let [a, b] = [0, 1].map(|i| centers[i] + point.anchors[i].as_dvec3());
            nearest = nearest.min(a.distance(b));
            let along = (b - a).dot(point.normal.as_dvec3());
            let apart = f64::from(point.separation);
            assert!(
                (along - apart).abs() < 1.0e-5 && apart > 0.99 * pair.least - 1.0e-5,
                "{names:?}: {point:?}, {}",
                pair.least
            );
        }
        let error = (nearest - pair.least).abs();
        if error > ROUNDING {
            println!(
                "{names:?}: {nearest} for {}, {:?}, margin {}",
                pair.least, pair.at, pair.margin
            );
        }
        worst = worst.max(error);
        tested += 1;
    }
    println!("{tested} of {} pairs, worst error {worst:.1e}", pairs.len());
    assert_eq!(tested, pairs.len());
    assert!(worst < ROUNDING, "{worst}");
}
