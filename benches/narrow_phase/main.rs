//! Time of the narrow phase compared with a plain all-pairs loop, on one thread, interleaved in one run:
//! `cargo bench --bench narrow_phase [PAIRS]`.
//!
//! The pairs are those of the paper: diameters 0.25 to 2 and random poses in which the bounding spheres overlap.

mod plain;

use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::state::Body;
use bevy_faceoff::step::StepState;
use bevy_faceoff::testing::use_baseline_only;
use bevy_faceoff::types::stage::Stage;
use glam::{DMat3, DQuat, DVec3, Mat3, Quat, Vec3};
use std::time::{Duration, Instant};

fn main() {
    let pairs = std::env::args().find_map(|a| a.parse().ok()).unwrap_or(1653);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("a thread");
    println!("{pairs} sphere pairs, one thread, medians of 5 interleaved rounds, microseconds per sphere pair\n");
    println!(
        "| shape | plain all pairs | Angles | TriangleTest with contacts | baseline | first hit | baseline | ratio of TriangleTest | ratio of both | near pairs | touching | face pairs (plain) | triangle tests per pair |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    for (name, mesh) in [("torus 240", shapes::torus_240()), ("knot 1120", shapes::knot_1120())] {
        pool.install(|| run(name, &mesh, pairs));
    }
}

fn run(name: &str, mesh: &TriMesh, count: usize) {
    let mut random = fastrand::Rng::with_seed(1234);
    let mut state = StepState::default();
    let baked = CollisionMesh::new(mesh);
    let slot = state.input.meshes.add(baked.clone());
    let center = baked.mass.center;
    let mut poses: Vec<(f32, Mat3, Vec3)> = Vec::new();
    while poses.len() < count {
        let [sa, sb] = [0; 2].map(|_| 0.25 + 1.75 * random.f32());
        let offset = Vec3::from_array([0; 3].map(|_| 4.0 * random.f32() - 2.0));
        if offset.length() >= baked.radius * (sa + sb) {
            continue;
        }
        let [qa, qb] = [0; 2].map(|_| rotation(&mut random));
        let i = 2 * poses.len() as u32;
        for (scale, rotation, at) in [(sa, qa, Vec3::ZERO), (sb, qb, offset)] {
            let position = at - rotation * (scale * center);
            let body = Body::at_rest(slot, position, rotation, Vec3::splat(scale));
            state
                .input
                .bodies
                .push(&body, &state.input.meshes)
                .expect("a usable body");
        }
        state.results.sphere_pairs.push([i, i + 1]);
        let [fa, fb] = [0, 1].map(|k| state.input.bodies.frame[i as usize + k]);
        let to_a: DMat3 = fa.rotation.transpose();
        let matrix = to_a * fb.rotation * sb as f64;
        let translation: DVec3 = to_a * (fb.position - fa.position);
        poses.push((sa, matrix.as_mat3(), translation.as_vec3()));
    }
    let triangles: Vec<[Vec3; 3]> = (0..mesh.triangles().len()).map(|t| mesh.corners(t)).collect();

    let [mut plain_times, mut angles] = [const { Vec::new() }; 2];
    // With the registers that the machine has, and with those that every machine has.
    let [mut triangle_tests, mut first_hit] = [const { [const { Vec::new() }; 2] }; 2];
    let mut plain_hits = 0;
    let mut placed = Vec::new();
    for _ in 0..5 {
        let start = Instant::now();
        plain_hits = 0;
        for (scale, matrix, translation) in &poses {
            let a: Vec<_> = triangles
                .iter()
                .map(|t| plain::Triangle::new(t.map(|p| p * *scale)))
                .collect();
            plain_hits += plain::count(&a, &triangles, *matrix, *translation, &mut placed);
        }
        plain_times.push(start.elapsed());
        bevy_faceoff::step::cpu::run(Stage::Angles, &mut state);
        angles.push(state.results.times[Stage::Angles as usize]);
        for (i, baseline_only) in [false, true].into_iter().enumerate() {
            use_baseline_only(baseline_only);
            bevy_faceoff::step::cpu::run(Stage::TriangleTest, &mut state);
            triangle_tests[i].push(state.results.times[Stage::TriangleTest as usize]);
            let start = Instant::now();
            let touching = bevy_faceoff::step::cpu::touching(&mut state);
            first_hit[i].push(start.elapsed());
            assert!(
                touching
                    .iter()
                    .eq(state.results.contacts.pairs.iter().map(|pair| &pair.bodies))
            );
        }
        use_baseline_only(false);
    }
    let [plain, angles] = [plain_times, angles].map(|times| micros(times, count));
    let [[triangle_test, triangle_test_baseline], [first_hit, first_hit_baseline]] =
        [triangle_tests, first_hit].map(|times| times.map(|times| micros(times, count)));
    println!(
        "| {name} | {plain:.1} | {angles:.2} | {triangle_test:.2} | {triangle_test_baseline:.2} | {first_hit:.2} | {first_hit_baseline:.2} | {:.1} | {:.1} | {} | {} | {} ({plain_hits}) | {:.0} |",
        plain / triangle_test,
        plain / (angles + triangle_test),
        state.results.near_pairs.len(),
        state.results.contacts.pairs.len(),
        state.results.contacts.faces.len(),
        state.results.contacts.triangle_tests as f64 / count as f64,
    );
}

fn micros(mut times: Vec<Duration>, pairs: usize) -> f64 {
    times.sort_unstable();
    times[times.len() / 2].as_secs_f64() * 1e6 / pairs as f64
}

fn rotation(random: &mut fastrand::Rng) -> Quat {
    let [u, v, w] = [0; 3].map(|_| random.f64());
    let (a, b) = ((1.0 - u).sqrt(), u.sqrt());
    let (v, w) = (v * std::f64::consts::TAU, w * std::f64::consts::TAU);
    DQuat::from_xyzw(a * v.sin(), a * v.cos(), b * w.sin(), b * w.cos()).as_quat()
}
