//! Balls, capsules and rounded boxes, against meshes, each other and half-spaces.

use super::compare::{Agreement, agreement};
use crate::support::{Random, open_torus};
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::manifolds::MarginPair;
use bevy_faceoff::projection::BakeSettings;
use bevy_faceoff::state::{Body, Plane};
use bevy_faceoff::step::StepState;
use glam::{Quat, Vec3};

/// Margin of all pairs, metres. The bodies are about a metre large.
const MARGIN: f32 = 0.05;

fn rounded(mesh: &TriMesh, rounding: f32) -> CollisionMesh {
    let settings = BakeSettings {
        rounding,
        ..BakeSettings::default()
    };
    CollisionMesh::without_faces(mesh, settings)
}

fn meshes() -> Vec<CollisionMesh> {
    let all = [
        shapes::cube(1.0),
        shapes::torus_240(),
        shapes::knot_1120(),
        shapes::ring(),
        shapes::ball_320(),
    ];
    all.iter().map(CollisionMesh::new).collect()
}

fn balls() -> Vec<CollisionMesh> {
    [0.05, 0.2, 0.6]
        .map(|radius| CollisionMesh::ball(radius).unwrap())
        .into()
}

fn capsules() -> Vec<CollisionMesh> {
    let all = [(0.05, 0.6), (0.2, 0.5), (0.3, 0.1)];
    all.map(|(radius, length)| CollisionMesh::capsule(radius, length).unwrap())
        .into()
}

fn rounded_boxes() -> Vec<CollisionMesh> {
    // The last one's core is flat.
    let all = [
        (Vec3::ONE, 0.1),
        (Vec3::new(0.8, 0.4, 0.6), 0.05),
        (Vec3::new(0.5, 0.3, 0.9), 0.15),
    ];
    all.map(|(size, rounding)| CollisionMesh::cuboid(size, rounding).unwrap())
        .into()
}

fn rounded_others() -> Vec<CollisionMesh> {
    vec![
        rounded(&shapes::torus_240(), 0.05),
        rounded(&shapes::ring(), 0.02),
        rounded(&open_torus(), 0.03),
        CollisionMesh::cylinder(0.4, 0.6, 0.1).unwrap(),
        CollisionMesh::cone(0.4, 0.6, 0.05).unwrap(),
    ]
}

/// A state of `count` pairs of one of each list, at distances of `range` times the sum of their radii.
fn pairs_of(
    first: &[CollisionMesh],
    second: &[CollisionMesh],
    count: u32,
    range: [f32; 2],
    seed: u64,
) -> (StepState, Vec<MarginPair>) {
    let mut random = Random::new(seed);
    let mut state = StepState::default();
    let mut add = |meshes: &[CollisionMesh]| -> Vec<u32> {
        let add = |mesh: &CollisionMesh| state.input.meshes.add(mesh.clone());
        meshes.iter().map(add).collect()
    };
    let slots = [add(first), add(second)];
    let mut pairs = Vec::new();
    for i in 0..count {
        let chosen = [0, 1].map(|k| {
            let at = random.unit() * slots[k].len() as f64;
            slots[k][at as usize % slots[k].len()]
        });
        let radii = chosen.map(|slot| state.input.meshes[slot].mesh.radius);
        let part = range[0] + (range[1] - range[0]) * random.unit() as f32;
        let apart = part * (radii[0] + radii[1]);
        // Every other pair is swapped.
        let order = if i % 2 == 0 { [0, 1] } else { [1, 0] };
        let way = random.direction().as_vec3();
        // Some are mirrored.
        let scale = Vec3::new(if i % 5 == 0 { -1.0 } else { 1.0 }, 1.0, 1.0);
        for (at, k) in [Vec3::ZERO, way * apart].into_iter().zip(order) {
            let turn = random.rotation().as_quat();
            let place = at + Vec3::X * (5.0 * i as f32 % 40.0);
            let body = Body::at_rest(chosen[k], place, turn, scale);
            state.input.bodies.push(&body, &state.input.meshes).unwrap();
        }
        pairs.push(MarginPair {
            bodies: [2 * i, 2 * i + 1],
            margin: MARGIN,
        });
    }
    (state, pairs)
}

/// Requires the same pairs but for `missed`, and that no more than a part of deepest points and of points differs.
fn require(name: &str, result: Agreement, missed: usize, shifted: f64, share: f64) {
    assert!(result.pairs > 50, "{name}: {} pairs", result.pairs);
    assert!(
        result.missed <= missed,
        "{name}: {} pairs only on one side",
        result.missed
    );
    assert!(
        result.shifted as f64 <= shifted * result.pairs as f64,
        "{name}: {} of {} deepest points differ",
        result.shifted,
        result.pairs
    );
    assert!(
        result.unmatched_share() <= share,
        "{name}: {:.2} % of points without the like",
        100.0 * result.unmatched_share()
    );
}

fn compare(name: &str, gpu: &Gpu, lists: [&[CollisionMesh]; 2], range: [f32; 2], limits: (usize, f64, f64)) {
    let (state, pairs) = pairs_of(lists[0], lists[1], 400, range, 7);
    let (missed, shifted, share) = limits;
    require(name, agreement(name, gpu, &state, &pairs), missed, shifted, share);
}

/// What touches, or nearly so.
const NEAR: [f32; 2] = [0.5, 1.02];

pub fn balls_and_balls(gpu: &Gpu) {
    compare("balls and balls", gpu, [&balls(), &balls()], [0.0, 1.1], (0, 0.0, 0.0));
}

pub fn balls_and_meshes(gpu: &Gpu) {
    compare("balls and meshes", gpu, [&balls(), &meshes()], NEAR, (0, 0.0, 0.005));
}

pub fn capsules_and_others(gpu: &Gpu) {
    compare(
        "capsules and capsules",
        gpu,
        [&capsules(), &capsules()],
        [0.1, 1.0],
        (0, 0.0, 0.005),
    );
    compare(
        "capsules and balls",
        gpu,
        [&capsules(), &balls()],
        [0.1, 1.0],
        (0, 0.0, 0.005),
    );
    compare(
        "capsules and meshes",
        gpu,
        [&capsules(), &meshes()],
        NEAR,
        (0, 0.0, 0.005),
    );
    compare(
        "deep capsules",
        gpu,
        [&capsules(), &meshes()],
        [0.0, 0.6],
        (0, 0.0, 0.01),
    );
}

pub fn rounded_boxes_and_others(gpu: &Gpu) {
    let (boxes, others) = (rounded_boxes(), rounded_others());
    compare("boxes and boxes", gpu, [&boxes, &boxes], NEAR, (0, 0.0, 0.005));
    compare("boxes and balls", gpu, [&boxes, &balls()], NEAR, (0, 0.0, 0.005));
    compare("boxes and capsules", gpu, [&boxes, &capsules()], NEAR, (0, 0.0, 0.005));
    compare("boxes and meshes", gpu, [&boxes, &meshes()], NEAR, (0, 0.0, 0.005));
    compare("others and balls", gpu, [&others, &balls()], NEAR, (0, 0.0, 0.005));
    compare("others and meshes", gpu, [&others, &meshes()], NEAR, (0, 0.0, 0.005));
    compare("others and others", gpu, [&others, &others], NEAR, (0, 0.0, 0.005));
}

/// Balls whose centres coincide get some direction.
pub fn balls_in_one_place(gpu: &Gpu) {
    let mut state = StepState::default();
    for radius in [0.2, 0.3] {
        let mesh = state.input.meshes.add(CollisionMesh::ball(radius).unwrap());
        let body = Body::at_rest(mesh, Vec3::ONE, Quat::IDENTITY, Vec3::ONE);
        state.input.bodies.push(&body, &state.input.meshes).unwrap();
    }
    let pairs = [MarginPair {
        bodies: [0, 1],
        margin: MARGIN,
    }];
    let result = agreement("balls in one place", gpu, &state, &pairs);
    assert_eq!((result.pairs, result.missed, result.unmatched), (1, 0, 0));
}

pub fn half_spaces(gpu: &Gpu) {
    let all = [balls(), capsules(), rounded_boxes(), rounded_others()].concat();
    let (mut state, _) = pairs_of(&all, &all, 100, [0.0, 1.0], 9);
    state.input.planes = vec![
        Plane {
            normal: Vec3::Y,
            distance: 0.0,
            ..Plane::default()
        },
        Plane {
            normal: Vec3::new(0.1, 1.0, -0.3).normalize(),
            distance: -0.2,
            ..Plane::default()
        },
    ];
    let result = agreement("rounded ones on half-spaces", gpu, &state, &[]);
    require("rounded ones on half-spaces", result, 0, 0.0, 0.02);
}
