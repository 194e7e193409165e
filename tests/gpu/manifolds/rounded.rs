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
    // The last one's core is thin.
    let all = [
        (Vec3::ONE, 0.1),
        (Vec3::new(0.8, 0.4, 0.6), 0.05),
        (Vec3::new(0.5, 0.3, 0.9), 0.14),
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

/// What bodies of a scene have in common.
#[derive(Clone, Copy)]
struct Setting {
    /// Number of pairs.
    count: u32,
    /// Distances of centres, in units of the sum of the radii.
    range: [f32; 2],
    /// Whether scales differ, also from axis to axis.
    is_scaled: bool,
}

/// What touches, or nearly so.
const NEAR: Setting = Setting {
    count: 240,
    range: [0.5, 1.02],
    is_scaled: false,
};
const DEEP: Setting = Setting {
    range: [0.0, 0.6],
    ..NEAR
};
const ANY: Setting = Setting {
    range: [0.0, 1.1],
    ..NEAR
};
const SCALED: Setting = Setting {
    range: [0.2, 0.9],
    is_scaled: true,
    ..NEAR
};

/// A state with pairs of one mesh of each list.
fn pairs_of(lists: [&[CollisionMesh]; 2], setting: Setting) -> (StepState, Vec<MarginPair>) {
    let mut random = Random::new(7);
    let mut state = StepState::default();
    let slots = lists.map(|meshes| {
        let add = |mesh: &CollisionMesh| state.input.meshes.add(mesh.clone());
        meshes.iter().map(add).collect::<Vec<u32>>()
    });
    let mut pairs = Vec::new();
    for i in 0..setting.count {
        let chosen = [0, 1].map(|k| {
            let at = random.unit() * slots[k].len() as f64;
            slots[k][at as usize % slots[k].len()]
        });
        // Some are mirrored.
        let mirrored = Vec3::new(if i % 5 == 0 { -1.0 } else { 1.0 }, 1.0, 1.0);
        let scales = [0, 1].map(|_| if setting.is_scaled { random.scale() } else { mirrored });
        let radius = |k: usize| state.input.meshes[chosen[k]].mesh.radius * scales[k].abs().max_element();
        let [least, most] = setting.range;
        let apart = (least + (most - least) * random.unit() as f32) * (radius(0) + radius(1));
        let offset = random.direction().as_vec3() * apart;
        // Every other pair is swapped.
        let order = if i % 2 == 0 { [0, 1] } else { [1, 0] };
        for (at, k) in [Vec3::ZERO, offset].into_iter().zip(order) {
            let place = at + Vec3::X * (5.0 * i as f32 % 40.0);
            let body = Body::at_rest(chosen[k], place, random.rotation().as_quat(), scales[k]);
            state.input.bodies.push(&body, &state.input.meshes).unwrap();
        }
        pairs.push(MarginPair {
            bodies: [2 * i, 2 * i + 1],
            margin: MARGIN,
        });
    }
    (state, pairs)
}

/// Requires the same pairs with the same deepest points, and that no more than this share of points is without the
/// like.
fn require(name: &str, result: Agreement, share: f64) {
    assert!(result.pairs > 50, "{name}: {} pairs", result.pairs);
    assert_eq!(
        (result.missed, result.shifted),
        (0, 0),
        "{name}: pairs only on one side, and other deepest points"
    );
    assert!(
        result.unmatched_share() <= share,
        "{name}: {:.2} % of points without the like",
        100.0 * result.unmatched_share()
    );
}

fn compare(name: &str, gpu: &Gpu, lists: [&[CollisionMesh]; 2], setting: Setting) {
    let (state, pairs) = pairs_of(lists, setting);
    require(name, agreement(name, gpu, &state, &pairs), 0.005);
}

pub fn balls_and_others(gpu: &Gpu) {
    compare("balls and balls", gpu, [&balls(), &balls()], ANY);
    compare("balls and meshes", gpu, [&balls(), &meshes()], NEAR);
    compare("deep balls", gpu, [&balls(), &meshes()], DEEP);
}

pub fn capsules_and_others(gpu: &Gpu) {
    let capsules = capsules();
    compare("capsules and capsules", gpu, [&capsules, &capsules], ANY);
    compare("capsules and balls", gpu, [&capsules, &balls()], ANY);
    compare("capsules and meshes", gpu, [&capsules, &meshes()], NEAR);
    compare("deep capsules", gpu, [&capsules, &meshes()], DEEP);
}

pub fn rounded_boxes_and_others(gpu: &Gpu) {
    let (boxes, others) = (rounded_boxes(), rounded_others());
    compare("boxes and boxes", gpu, [&boxes, &boxes], NEAR);
    compare("boxes and balls", gpu, [&boxes, &balls()], NEAR);
    compare("boxes and capsules", gpu, [&boxes, &capsules()], NEAR);
    compare("boxes and meshes", gpu, [&boxes, &meshes()], NEAR);
    compare("others and balls", gpu, [&others, &balls()], NEAR);
    compare("others and meshes", gpu, [&others, &meshes()], NEAR);
    compare("others and others", gpu, [&others, &others], NEAR);
}

/// The rounding is that of the smallest component of a scale.
pub fn of_any_scale(gpu: &Gpu) {
    let all = [balls(), capsules(), rounded_boxes()].concat();
    compare("scaled ones", gpu, [&all, &all], SCALED);
    compare("scaled ones and meshes", gpu, [&all, &meshes()], SCALED);
}

/// Pairs of large meshes are split into pieces.
pub fn of_large_meshes(gpu: &Gpu) {
    let fine = [0.0, 0.05].map(|rounding| rounded(&shapes::ball(0.5, 3), rounding));
    let setting = Setting {
        count: 120,
        range: [0.85, 1.02],
        ..NEAR
    };
    compare("large meshes", gpu, [&fine[1..], &fine], setting);
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
    let setting = Setting { count: 100, ..ANY };
    let (mut state, _) = pairs_of([&all, &all], setting);
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
    require("rounded ones on half-spaces", result, 0.0);
}
