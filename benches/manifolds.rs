//! Time of contact generation per pair on one thread: `cargo bench --bench manifolds [PAIRS]`.
//!
//! There are three scenes. The first has the random poses of the narrow phase benchmark: bodies of diameters 0.25 to 2
//! whose bounding spheres overlap. Most are apart or deep inside each other. In the others bodies of diameter 1 rest
//! against each other: they overlap by 1 %, as in a pile, or are apart by half of the speculative margin. The margin is
//! 1 % of the smaller diameter. The last column is the time of a call after one with the same poses.

use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::manifolds::{Manifolds, MarginPair, cpu};
use bevy_faceoff::queries::{Placement, touching};
use bevy_faceoff::state::Body;
use bevy_faceoff::step::StepState;
use glam::{Quat, Vec3};
use std::time::Instant;

/// The poses of a pair: scale, rotation and translation of each body.
type Poses = [(f32, Quat, Vec3); 2];

fn main() {
    let count = std::env::args().find_map(|a| a.parse().ok()).unwrap_or(1000);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.expect("a thread");
    println!("one thread, best of 7 rounds, microseconds per pair\n");
    println!(
        "| shape | scene | pairs | with points | points each | us per pair | us per pair with points | the same, kept |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    let meshes = [
        ("torus 240", shapes::torus_240()),
        ("ring 384", shapes::ring()),
        ("knot 1120", shapes::knot_1120()),
        ("ball 5120", shapes::ball(0.5, 4)),
    ];
    for (name, mesh) in meshes {
        let baked = CollisionMesh::new(&mesh);
        let scenes: [(&str, Vec<Poses>); 3] = [
            ("spheres overlap", overlapping(&mesh, count)),
            ("1 % overlap", against(&baked, 0.01, count / 4)),
            ("gap of 0.5 %", against(&baked, -0.005, count / 4)),
        ];
        for (scene, poses) in scenes {
            pool.install(|| time(name, scene, &baked, &poses));
        }
    }
}

fn time(name: &str, scene: &str, mesh: &CollisionMesh, poses: &[Poses]) {
    let mut state = StepState::default();
    let slot = state.input.meshes.add(mesh.clone());
    let mut pairs = Vec::new();
    for pair in poses {
        let first = state.input.bodies.len() as u32;
        for (scale, rotation, at) in pair {
            let body = Body::at_rest(slot, *at, *rotation, Vec3::splat(*scale));
            state
                .input
                .bodies
                .push(&body, &state.input.meshes)
                .expect("a usable body");
        }
        pairs.push(MarginPair {
            bodies: [first, first + 1],
            margin: 0.01 * pair[0].0.min(pair[1].0),
        });
    }
    let (mut scratch, mut manifolds) = (cpu::Scratch::default(), Manifolds::default());
    let mut round = |pairs: &[MarginPair], keep: bool| {
        let times = (0..8).map(|_| {
            if !keep {
                scratch.forget();
            }
            let start = Instant::now();
            cpu::run(
                &state.input.bodies,
                &state.input.meshes,
                pairs,
                &mut scratch,
                &mut manifolds,
            );
            start.elapsed().as_secs_f64() * 1e6 / pairs.len().max(1) as f64
        });
        // The first run warms the caches.
        let best = times.skip(1).fold(f64::INFINITY, f64::min);
        (best, manifolds.pairs.clone(), manifolds.points.len())
    };
    let (all, found, points) = round(&pairs, false);
    let some: Vec<MarginPair> = found.iter().map(|m| pairs[m.bodies[0] as usize / 2]).collect();
    let [with_points, kept] = [false, true].map(|keep| round(&some, keep).0);
    println!(
        "| {name} | {scene} | {} | {} | {:.1} | {all:.1} | {with_points:.1} | {kept:.1} |",
        pairs.len(),
        found.len(),
        points as f64 / found.len().max(1) as f64,
    );
}

fn overlapping(mesh: &TriMesh, count: usize) -> Vec<Poses> {
    let mut random = fastrand::Rng::with_seed(1234);
    let radius = mesh.vertices().iter().map(|v| v.length()).fold(0.0, f32::max);
    let mut poses = Vec::new();
    while poses.len() < count {
        let [sa, sb] = [0; 2].map(|_| 0.25 + 1.75 * random.f32());
        let offset = 4.0 * vector(&mut random);
        let [qa, qb] = [0; 2].map(|_| rotation(&mut random));
        if offset.length() < radius * (sa + sb) {
            poses.push([(sa, qa, Vec3::ZERO), (sb, qb, offset)]);
        }
    }
    poses
}

/// Poses in which the second body is moved towards the first until it overlaps by `overlap`.
fn against(mesh: &CollisionMesh, overlap: f32, count: usize) -> Vec<Poses> {
    let mut random = fastrand::Rng::with_seed(5);
    let mut poses = Vec::new();
    while poses.len() < count {
        let [qa, qb] = [0; 2].map(|_| rotation(&mut random));
        let (direction, aside) = (vector(&mut random).normalize(), 0.2 * vector(&mut random));
        let place = |rotation: Quat, translation: Vec3| Placement {
            mesh: mesh.clone(),
            translation,
            rotation,
            scale: Vec3::ONE,
        };
        let at = |t: f32| aside + direction * t;
        let touch = |t: f32| {
            let pair = [place(qa, Vec3::ZERO), place(qb, at(t))];
            !touching(&pair).expect("usable placements").is_empty()
        };
        let Some(hit) = (0..150).map(|i| 1.1 - 0.01 * i as f32).find(|t| touch(*t)) else {
            continue;
        };
        let (mut low, mut high) = (hit, hit + 0.01);
        for _ in 0..12 {
            let middle = 0.5 * (low + high);
            if touch(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        poses.push([(1.0, qa, Vec3::ZERO), (1.0, qb, at(low - overlap))]);
    }
    poses
}

/// A random vector in the cube of edge 1 about the origin.
fn vector(random: &mut fastrand::Rng) -> Vec3 {
    Vec3::from_array([0; 3].map(|_| random.f32() - 0.5))
}

fn rotation(random: &mut fastrand::Rng) -> Quat {
    let [x, y, z, w] = [0; 4].map(|_| random.f32() - 0.5);
    Quat::from_xyzw(x, y, z, w).normalize()
}
