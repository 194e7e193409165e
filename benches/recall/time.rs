//! The table of time per pair.

use crate::cases::{Pair, rotation};
use crate::plain;
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::TriMesh;
use bevy_faceoff::step::StepState;
use bevy_faceoff::types::settings::Culling;
use bevy_faceoff::types::stage::Stage;
use glam::{DMat3, DVec3, Mat3, Vec3};
use std::time::{Duration, Instant};

const MODES: [(Culling, &str); 3] = [
    (Culling::Exact, "exact"),
    (Culling::FacesOfCollision, "faces of collision"),
    (Culling::FrontFacing, "front-facing"),
];

/// The time of a method in each round, and its results.
#[derive(Default)]
struct Measured {
    times: Vec<Duration>,
    tests: u64,
    touching: usize,
    faces: usize,
}

/// Prints a row per method.
pub fn table(name: &str, mesh: &TriMesh, baked: &CollisionMesh, count: usize) {
    let mut state = StepState::default();
    let slot = state.input.meshes.add(baked.clone());
    let poses = fill(&mut state, slot, baked, count);
    let triangles: Vec<[Vec3; 3]> = (0..mesh.triangles().len()).map(|t| mesh.corners(t)).collect();
    let mut placed = Vec::new();
    let mut plain = Measured::default();
    let mut modes = MODES.map(|_| Measured::default());
    for _ in 0..5 {
        plain = Measured {
            times: plain.times,
            tests: (triangles.len() * triangles.len() * count) as u64,
            ..Measured::default()
        };
        let start = Instant::now();
        for (scale, matrix, translation) in &poses {
            let a: Vec<_> = triangles
                .iter()
                .map(|t| plain::Triangle::new(t.map(|p| p * *scale)))
                .collect();
            let hits = plain::count(&a, &triangles, *matrix, *translation, &mut placed);
            plain.faces += hits as usize;
            plain.touching += usize::from(hits > 0);
        }
        plain.times.push(start.elapsed());
        for ((culling, _), measured) in MODES.iter().zip(&mut modes) {
            state.input.bodies.culling.fill(*culling);
            bevy_faceoff::step::cpu::run(Stage::Angles, &mut state);
            bevy_faceoff::step::cpu::run(Stage::TriangleTest, &mut state);
            let [angles, triangle_test] = [Stage::Angles, Stage::TriangleTest].map(|s| state.results.times[s as usize]);
            measured.times.push(angles + triangle_test);
            measured.tests = state.results.contacts.triangle_tests;
            measured.touching = state.results.contacts.pairs.len();
            measured.faces = state.results.contacts.faces.len();
        }
    }
    let yardstick = micros(&mut plain.times, count);
    let rows = [("plain all pairs", &mut plain)].into_iter();
    for (method, measured) in rows.chain(MODES.map(|(_, method)| method).into_iter().zip(&mut modes)) {
        let time = micros(&mut measured.times, count);
        println!(
            "| {name} | {method} | {:.0} | {time:.2} | {:.1} | {} | {} |",
            measured.tests as f64 / count as f64,
            yardstick / time,
            measured.touching,
            measured.faces
        );
    }
}

/// Fills the state with sphere pairs as in a scene. Returns the input of the plain loop for each pair: the scale of the
/// first body, and the matrix and translation of the second.
fn fill(state: &mut StepState, slot: u32, baked: &CollisionMesh, count: usize) -> Vec<(f32, Mat3, Vec3)> {
    let mut random = fastrand::Rng::with_seed(1234);
    let mut poses = Vec::new();
    while poses.len() < count {
        let diameters = [0; 2].map(|_| 0.25 + 1.75 * random.f64());
        let offset = DVec3::from_array([0; 3].map(|_| 4.0 * random.f64() - 2.0));
        if offset.length() >= 0.5 * (diameters[0] + diameters[1]) {
            continue;
        }
        let pair = Pair {
            diameters,
            rotations: [0; 2].map(|_| rotation(&mut random)),
            offset,
        };
        let i = 2 * poses.len();
        for body in pair.bodies(slot, baked.mass.center, Culling::Exact) {
            state
                .input
                .bodies
                .push(&body, &state.input.meshes)
                .expect("a usable body");
        }
        state.results.sphere_pairs.push([i as u32, i as u32 + 1]);
        let [a, b] = [i, i + 1].map(|k| state.input.bodies.frame[k]);
        let to_a: DMat3 = a.rotation.transpose();
        let matrix = to_a * b.rotation * b.scale.x;
        poses.push((
            a.scale.x as f32,
            matrix.as_mat3(),
            (to_a * (b.position - a.position)).as_vec3(),
        ));
    }
    poses
}

fn micros(times: &mut [Duration], pairs: usize) -> f64 {
    times.sort_unstable();
    times[times.len() / 2].as_secs_f64() * 1e6 / pairs as f64
}
