//! Time of the CPU broad phase for scenes of equal density and different mixtures of sizes:
//! `cargo bench --bench broad_phase [BODIES]`. The default is 10,000, 100,000 and 1,000,000 bodies.
//!
//! All bodies that are not static move a little before each round, as between steps.

mod scenes;

use bevy_faceoff::step::StepState;
use bevy_faceoff::types::body::RigidBody;
use bevy_faceoff::types::stage::Stage;
use scenes::Scene;
use std::time::Duration;

const THREADS: usize = 2;

fn main() {
    let one: Option<usize> = std::env::args().find_map(|a| a.parse().ok());
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(THREADS)
        .build()
        .expect("threads");
    println!("{THREADS} threads; medians of interleaved rounds\n");
    println!("| bodies | scene | ms | million bodies a second | pairs | ns per pair | times equal sizes |");
    println!("|---|---|---|---|---|---|---|");
    for count in one.map_or(vec![10_000, 100_000, 1_000_000], |one| vec![one]) {
        pool.install(|| table(count));
    }
}

fn table(count: usize) {
    let mut states = Scene::ALL.map(|scene| scene.state(count));
    let mut times = Scene::ALL.map(|_| Vec::new());
    let rounds = (20_000_000 / count).clamp(9, 101);
    for round in 0..=rounds {
        for (state, times) in states.iter_mut().zip(&mut times) {
            drift(state, round);
            bevy_faceoff::step::cpu::run(Stage::BroadPhase, state);
            // The first round allocates.
            if round > 0 {
                times.push(state.results.times[Stage::BroadPhase as usize]);
            }
        }
    }
    let mut equal = None;
    for ((scene, state), times) in Scene::ALL.iter().zip(&states).zip(&mut times) {
        times.sort_unstable();
        let time: Duration = times[times.len() / 2];
        let pairs = state.results.sphere_pairs.len();
        let per_pair = time.as_secs_f64() * 1e9 / pairs as f64;
        let ratio = per_pair / *equal.get_or_insert(per_pair);
        println!(
            "| {count} | {} | {:.2} | {:.1} | {pairs} | {per_pair:.0} | {ratio:.2} |",
            scene.name(),
            time.as_secs_f64() * 1e3,
            count as f64 / time.as_secs_f64() * 1e-6,
        );
    }
}

/// Moves all bodies that are not static by up to 0.1 m along each axis, back and forth.
fn drift(state: &mut StepState, round: usize) {
    let mut random = fastrand::Rng::with_seed(round as u64 / 2);
    let sign = if round.is_multiple_of(2) { 0.1 } else { -0.1 };
    let bodies = &mut state.input.bodies;
    for (center, kind) in bodies.center.iter_mut().zip(&bodies.kind) {
        if *kind != RigidBody::Static {
            *center += sign * glam::Vec3::new(random.f32(), random.f32(), random.f32());
        }
    }
}
