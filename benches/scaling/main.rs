//! Time per pair as a function of the number of triangles, on one thread, interleaved in one run:
//! `cargo bench --bench scaling [POSES] [CASES]`. `CASES` selects the cases whose names begin with one of these words.
//!
//! Each mesh comes in three resolutions, with a factor of 16 in the number of triangles between them. Pairs of equal
//! meshes in random rotations are moved together until about the same number of face pairs intersect at each
//! resolution. So the meshes grow, but not the contacts.

mod cases;

use bevy_faceoff::types::stage::Stage;
use cases::{Case, Scene};
use std::time::{Duration, Instant};

/// The number of rounds; each round measures all scenes in turn.
const ROUNDS: usize = 7;

fn main() {
    let (numbers, words): (Vec<String>, Vec<String>) = std::env::args()
        .skip(1)
        .filter(|word| !word.starts_with('-'))
        .partition(|word| word.parse::<usize>().is_ok());
    let poses = numbers.first().map_or(16, |word| word.parse().expect("digits"));
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("a thread");
    println!(
        "{poses} poses, one thread, medians of {ROUNDS} interleaved rounds, microseconds per pair; growth is that against the row above, the median of the rounds' ratios\n"
    );
    println!(
        "| case | triangles | Angles | TriangleTest | growth | first hit | growth | touching | face pairs per pair | triangle tests per pair |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    pool.install(|| {
        for case in cases::all().into_iter().chain(cases::nut_on_bolt()) {
            if words.is_empty() || words.iter().any(|word| case.name.starts_with(word.as_str())) {
                run(&case, poses);
            }
        }
    });
}

fn run(case: &Case, poses: usize) {
    let mut scenes: Vec<Scene> = case.scenes.iter().map(|scene| scene(poses)).collect();
    let mut times = vec![Vec::new(); scenes.len()];
    for _ in 0..ROUNDS {
        for (scene, times) in scenes.iter_mut().zip(&mut times) {
            // Small scenes take less than a clock tick, so take the best of three runs.
            let mut least = [f64::INFINITY; 3];
            let pairs = scene.state.results.sphere_pairs.len();
            for _ in 0..3 {
                for (least, stage) in least.iter_mut().zip([Stage::Angles, Stage::TriangleTest]) {
                    bevy_faceoff::step::cpu::run(stage, &mut scene.state);
                    *least = least.min(micros(scene.state.results.times[stage as usize], pairs));
                }
                let start = Instant::now();
                let touching = bevy_faceoff::step::cpu::touching(&mut scene.state);
                least[2] = least[2].min(micros(start.elapsed(), pairs));
                assert_eq!(
                    touching.len(),
                    scene.state.results.contacts.pairs.len(),
                    "first hits are hits"
                );
            }
            times.push(least);
        }
    }
    for (i, scene) in scenes.iter().enumerate() {
        let growth = |stage: usize| {
            let whole = |times: &[f64; 3]| times[0] + times[stage];
            let ratios = |i: usize| times[i].iter().zip(&times[i - 1]).map(|(t, s)| whole(t) / whole(s));
            (i > 0)
                .then(|| median(ratios(i)))
                .map_or(String::new(), |g| format!("{g:.2}"))
        };
        let contacts = &scene.state.results.contacts;
        let pairs = scene.state.results.sphere_pairs.len() as f64;
        println!(
            "| {} | {} | {:.2} | {:.2} | {} | {:.2} | {} | {} | {:.1} | {:.0} |",
            case.name,
            scene.triangles,
            median(times[i].iter().map(|t| t[0])),
            median(times[i].iter().map(|t| t[1])),
            growth(1),
            median(times[i].iter().map(|t| t[2])),
            growth(2),
            contacts.pairs.len(),
            contacts.faces.len() as f64 / pairs,
            contacts.triangle_tests as f64 / pairs,
        );
    }
}

fn micros(time: Duration, pairs: usize) -> f64 {
    time.as_secs_f64() * 1e6 / pairs as f64
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_unstable_by(f64::total_cmp);
    values[values.len() / 2]
}
