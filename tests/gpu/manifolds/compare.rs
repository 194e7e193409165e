//! What the device finds beside what the CPU finds.

use super::scene::require_sane;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::manifolds::cpu::planes;
use bevy_faceoff::manifolds::{ManifoldPoint, Manifolds, MarginPair, cpu};
use bevy_faceoff::step::StepState;
use bevy_faceoff::testing::gpu_manifolds::GpuManifolds;
use std::collections::BTreeMap;

/// Distances of points, in units of the smaller body's diameter, that count as the same.
const SAME_PLACE: f32 = 2.0e-3;
/// And of unit normals.
const SAME_WAY: f32 = 0.02;

/// How well two lists of manifolds agree.
#[derive(Clone, Copy, Debug, Default)]
pub struct Agreement {
    /// Pairs that both have.
    pub pairs: usize,
    /// Pairs that only one has, though not by a hair.
    pub missed: usize,
    /// Points of both.
    pub points: usize,
    /// Points of one without the like in the other.
    pub unmatched: usize,
    /// Points with the like in the other list on the same faces.
    pub named: usize,
    /// Pairs whose deepest points differ by more than 1e-4 of the size.
    pub shifted: usize,
    /// The largest difference of deepest points, in units of the smaller body's diameter.
    pub worst: f32,
}

impl Agreement {
    /// Points of one without the like in the other, as a part of all.
    pub fn unmatched_share(&self) -> f64 {
        self.unmatched as f64 / self.points.max(1) as f64
    }
}

/// What the CPU finds, half-spaces included, ascending.
pub fn on_cpu(state: &StepState, pairs: &[MarginPair]) -> Manifolds {
    let mut found = Manifolds::default();
    cpu::run(
        &state.input.bodies,
        &state.input.meshes,
        pairs,
        &mut cpu::Scratch::default(),
        &mut found,
    );
    let mut scratch = planes::Scratch::default();
    let mut bodies = state.input.bodies.clone();
    bodies.travel_time.fill(state.input.config.dt);
    planes::find(
        &bodies,
        &state.input.meshes,
        &state.input.planes,
        &state.input.config,
        |_| true,
        &mut scratch,
        &mut found,
    );
    let mut order: Vec<usize> = (0..found.pairs.len()).collect();
    order.sort_by_key(|&i| found.pairs[i].bodies);
    let mut sorted = Manifolds::default();
    for i in order {
        let mut pair = found.pairs[i];
        let points = found.points_of(&pair).to_vec();
        pair.first_point = sorted.points.len() as u32;
        sorted.pairs.push(pair);
        sorted.points.extend(points);
    }
    sorted
}

/// What the device finds.
pub fn on_gpu(gpu: &Gpu, state: &StepState, pairs: &[MarginPair]) -> Manifolds {
    let mut run = GpuManifolds::new(gpu).expect("the kernels compile");
    let found = run.run(&state.input, pairs).expect("the device does it");
    require_sane(&found);
    assert!(found.pairs.is_sorted_by(|p, q| p.bodies < q.bodies));
    found
}

/// The smaller diameter of a pair's bodies; half-spaces have none.
fn size(state: &StepState, bodies: [u32; 2]) -> f32 {
    let of = |body: u32| {
        let i = body as usize;
        if i >= state.input.bodies.len() {
            return f32::INFINITY;
        }
        let aabb = state.input.meshes[state.input.bodies.mesh[i]].lanes.aabb;
        let core = ((aabb.max - aabb.min) * state.input.bodies.scale[i].abs()).max_element();
        core + 2.0 * state.input.bodies.rounding[i]
    };
    of(bodies[0]).min(of(bodies[1]))
}

fn same_radius(p: f32, q: f32) -> bool {
    p == q || (p - q).abs() <= 1e-3 * p.abs().max(q.abs())
}

fn deepest(points: &[ManifoldPoint]) -> f32 {
    points.iter().map(|p| p.separation).fold(f32::INFINITY, f32::min)
}

/// Compares both; pairs that differ say so under `name`.
pub fn agreement(name: &str, gpu: &Gpu, state: &StepState, pairs: &[MarginPair]) -> Agreement {
    let lists = [on_cpu(state, pairs), on_gpu(gpu, state, pairs)];
    let margins: BTreeMap<[u32; 2], f32> = pairs.iter().map(|pair| (pair.bodies, pair.margin)).collect();
    let by_pair = lists.each_ref().map(|list| {
        let all = list.pairs.iter().map(|pair| (pair.bodies, list.points_of(pair)));
        all.collect::<BTreeMap<_, _>>()
    });
    let mut result = Agreement::default();
    for (from, to) in [(0, 1), (1, 0)] {
        for (bodies, points) in &by_pair[from] {
            let size = size(state, *bodies);
            let Some(others) = by_pair[to].get(bodies) else {
                // Whether a gap is as wide as the margin is decided by the last bits.
                let margin = margins.get(bodies).copied().unwrap_or(deepest(points)).max(0.0);
                let by_a_hair = (deepest(points) - margin).abs() < 2e-5 * size;
                if !by_a_hair {
                    result.missed += 1;
                    println!("{name}: {bodies:?} of size {size} only in {from}: {points:?}");
                }
                continue;
            };
            result.pairs += from;
            result.points += points.len();
            let like = |p: &ManifoldPoint, q: &ManifoldPoint| {
                p.anchors[0].distance(q.anchors[0]) < SAME_PLACE * size
                    && p.normal.distance(q.normal) < SAME_WAY
                    && (p.separation - q.separation).abs() < SAME_PLACE * size
                    && (0..2).all(|i| same_radius(p.curvature_radii[i], q.curvature_radii[i]))
                    && same_radius(p.normal_rotation, q.normal_rotation)
            };
            let named = |p: &&ManifoldPoint| others.iter().any(|q| like(p, q) && p.faces == q.faces);
            result.named += points.iter().filter(named).count();
            result.unmatched += points.iter().filter(|p| !others.iter().any(|q| like(p, q))).count();
            let apart = (deepest(points) - deepest(others)).abs() / size;
            result.worst = result.worst.max(apart);
            if apart > 1e-4 {
                result.shifted += from;
                if from == 0 {
                    println!(
                        "{name}: {bodies:?} of size {size}: {} and {}, {} and {} points",
                        deepest(points),
                        deepest(others),
                        points.len(),
                        others.len()
                    );
                }
            }
        }
    }
    println!(
        "{name}: {} pairs, {} only in one; {} points, {:.2} % without the like, {:.1} % on the same faces; {} deepest points differ, by {:.1e} at most",
        result.pairs,
        result.missed,
        result.points,
        100.0 * result.unmatched_share(),
        100.0 * result.named as f64 / result.points.max(1) as f64,
        result.shifted,
        result.worst
    );
    result
}

/// Requires the same pairs, the same deepest points but for `shifted` of them, and that no more than this share of
/// points is without the like.
pub fn require(name: &str, gpu: &Gpu, state: &StepState, pairs: &[MarginPair], shifted: usize, share: f64) {
    let result = agreement(name, gpu, state, pairs);
    assert!(result.pairs > 0, "{name}");
    assert_eq!(result.missed, 0, "{name}");
    assert!(
        result.shifted <= shifted,
        "{name}: {} deepest points differ",
        result.shifted
    );
    assert!(
        result.unmatched_share() <= share,
        "{name}: {:.2} % of points without the like",
        100.0 * result.unmatched_share()
    );
}
