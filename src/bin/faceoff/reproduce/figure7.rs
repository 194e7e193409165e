//! Figure 7: time against the number of bodies while the number of colliding pairs stays the same.

#[path = "../../../../benches/narrow_phase/plain.rs"]
mod plain;

use super::plot::{self, Series};
use super::report::{Report, Table};
use super::world::Shape;
use super::{Plan, median, paper};
use crate::Outcome;
use bevy_faceoff::state::Body;
use bevy_faceoff::step::{StepState, cpu};
use bevy_faceoff::testing::scenes::paper::{Paper, default_side};
use bevy_faceoff::types::settings::Culling;
use bevy_faceoff::types::stage::Stage;
use glam::{DMat3, Vec3};
use serde_json::json;
use std::time::Instant;

/// Sphere pairs per body in a box of the default side.
const PAIRS_PER_BODY: f32 = 0.7;

const METHODS: [&str; 3] = ["all triangles", "faces of collision", "exact"];

/// Measures on one thread, so that the methods are compared and not their use of threads.
pub fn figure_7(plan: &Plan, torus: &Shape, report: &mut Report) -> Outcome {
    let mut table = Table::new(
        "figure7",
        &[
            "bodies",
            "sphere_pairs",
            "method",
            "broad_ms",
            "narrow_ms",
            "both_ms",
            "touching_pairs",
        ],
    );
    let mut lines = METHODS.map(|name| Series {
        name: name.to_owned(),
        points: Vec::new(),
    });
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    for &bodies in plan.figure_7 {
        let rows = pool.install(|| measure(plan, torus, bodies))?;
        for ((method, line), (pairs, broad, narrow, touching)) in METHODS.iter().zip(&mut lines).zip(rows) {
            let both = broad + narrow;
            table.rows.push(vec![
                json!(bodies),
                json!(pairs),
                json!(method),
                json!(broad),
                json!(narrow),
                json!(both),
                json!(touching),
            ]);
            line.points.push((bodies as f64, both));
        }
        plan.bar.inc(1);
    }
    let title = format!("Figure 7: tori with about {} sphere pairs", paper::FIGURE_7_PAIRS);
    report.plot(
        "figure7",
        plot::svg(&title, "bodies", "milliseconds, broad and narrow phase", &lines)?,
    );
    report.table(&table);
    Ok(())
}

/// Sphere pairs, times of both phases, and touching pairs of each method.
fn measure(plan: &Plan, torus: &Shape, bodies: usize) -> Result<[(usize, f64, f64, usize); 3], String> {
    let more = PAIRS_PER_BODY * bodies as f32 / paper::FIGURE_7_PAIRS as f32;
    let scene = Paper {
        bodies,
        side: default_side(bodies) * more.cbrt(),
        speed: 0.0,
        seed: plan.seed,
    };
    let mut state = StepState::default();
    let slot = state.input.meshes.add(torus.mesh.clone());
    let mut random = fastrand::Rng::with_seed(plan.seed);
    for flyer in scene.flyers(&torus.mesh, || random.f32()) {
        let body = Body::at_rest(slot, flyer.position, flyer.rotation, Vec3::splat(flyer.scale));
        state
            .input
            .bodies
            .push(&body, &state.input.meshes)
            .map_err(|e| format!("a body of figure 7 is not usable: {e:?}"))?;
    }
    let mesh = &torus.mesh.mesh;
    let triangles: Vec<[Vec3; 3]> = (0..mesh.triangles().len()).map(|t| mesh.corners(t)).collect();
    let mut broad = Vec::new();
    let mut narrow: [Vec<f64>; 3] = Default::default();
    let mut touching = [0; 3];
    for _ in 0..plan.rounds {
        let ms = |state: &mut StepState, stage| {
            cpu::run(stage, state);
            state.results.times[stage as usize].as_secs_f64() * 1e3
        };
        broad.push(ms(&mut state, Stage::BroadPhase));
        let start = Instant::now();
        touching[0] = all_triangles(&state, &triangles);
        narrow[0].push(start.elapsed().as_secs_f64() * 1e3);
        for (i, culling) in [(1, Culling::FacesOfCollision), (2, Culling::Exact)] {
            state.input.bodies.culling.fill(culling);
            let time = ms(&mut state, Stage::Angles) + ms(&mut state, Stage::TriangleTest);
            narrow[i].push(time);
            touching[i] = state.results.contacts.pairs.len();
        }
    }
    let pairs = state.results.sphere_pairs.len();
    let broad = median(broad.into_iter());
    Ok([0, 1, 2].map(|i| (pairs, broad, median(narrow[i].iter().copied()), touching[i])))
}

/// Tests all triangles of each sphere pair, and returns how many pairs touch.
fn all_triangles(state: &StepState, triangles: &[[Vec3; 3]]) -> usize {
    let mut placed = Vec::new();
    let mut touching = 0;
    for pair in &state.results.sphere_pairs {
        let [a, b] = pair.map(|i| state.input.bodies.frame[i as usize]);
        let scale = a.scale.x as f32;
        let to_a: DMat3 = a.rotation.transpose();
        let matrix = (to_a * b.rotation * b.scale.x).as_mat3();
        let offset = (to_a * (b.position - a.position)).as_vec3();
        let place = |t: &[Vec3; 3]| plain::Triangle::new(t.map(|p| p * scale));
        let first: Vec<_> = triangles.iter().map(place).collect();
        touching += usize::from(plain::count(&first, triangles, matrix, offset, &mut placed) > 0);
    }
    touching
}
