//! Time of the stages on the GPU: `cargo bench --bench gpu [-- --quick]`. The binary can also be copied to any machine
//! with a driver.
//!
//! The scenes are those of the paper in several sizes, in the exact mode and with response. For each scene the table
//! has:
//! * the device time of each stage (medians of timestamps);
//! * the wall time of a step with all results read back at once, with results read back two steps later, and with only
//!   the counts read back two steps later;
//! * the time of the same step on the CPU.
//!
//! `--quick` omits scenes that take minutes on a software driver.

use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::gpu::device;
use bevy_faceoff::plugin::settings::LATENCY;
use bevy_faceoff::state::Body;
use bevy_faceoff::step::StepState;
use bevy_faceoff::step::gpu::results::Detail;
use bevy_faceoff::step::gpu::upload::Carried;
use bevy_faceoff::step::gpu::{GpuStep, StepError};
use bevy_faceoff::types::stage::Stage;
use glam::{Quat, Vec3};
use std::time::{Duration, Instant};

fn main() {
    let quick = std::env::args().any(|argument| argument == "--quick");
    let gpu = match device::open(true) {
        Ok(gpu) => gpu,
        Err(error) => {
            println!("nothing is measured: {error}");
            return;
        }
    };
    println!(
        "{} ({:?}, {}, {} {})\n",
        gpu.info.name, gpu.info.device_type, gpu.info.backend, gpu.info.driver, gpu.info.driver_info
    );
    println!(
        "| scene | sphere pairs | touching | face pairs | BroadPhase | Angles | TriangleTest | ForceScan | Integrate | \
         device, ms | lockstep, ms | latent, ms | resident, ms | CPU step, ms | CPU / device | list bytes |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    let (torus, knot) = (shapes::torus_240(), shapes::knot_1120());
    let scenes: &[(&str, &TriMesh, usize)] = if quick {
        &[("300 tori", &torus, 300), ("300 knots", &knot, 300)]
    } else {
        &[
            ("2200 tori", &torus, 2200),
            ("2200 knots", &knot, 2200),
            ("100,000 tori", &torus, 100_000),
            ("1,000,000 tori", &torus, 1_000_000),
        ]
    };
    let mut step = match GpuStep::new(gpu) {
        Ok(step) => step,
        Err(error) => {
            println!("nothing is measured: {error}");
            return;
        }
    };
    for (name, mesh, count) in scenes {
        if let Err(error) = measure(&mut step, name, mesh, *count, if quick { 3 } else { 9 }) {
            println!("| {name} | {error} |");
        }
    }
    println!("\ndispatches by stage: {:?}", step.dispatches());
}

fn measure(step: &mut GpuStep, name: &str, mesh: &TriMesh, count: usize, rounds: usize) -> Result<(), StepError> {
    let mesh = CollisionMesh::new(mesh);
    // Lists grow in the first step.
    let mut state = scene(&mesh, count);
    step.run(&mut state)?;
    let (mut stages, mut walls, mut cpu) = ([const { Vec::new() }; 5], Vec::new(), Vec::new());
    for _ in 0..rounds {
        let mut state = scene(&mesh, count);
        let start = Instant::now();
        step.run(&mut state)?;
        walls.push(start.elapsed());
        for (times, time) in stages.iter_mut().zip(state.results.times) {
            times.push(time);
        }
        let mut state = scene(&mesh, count);
        let start = Instant::now();
        for stage in Stage::ALL {
            bevy_faceoff::step::cpu::run(stage, &mut state);
        }
        cpu.push(start.elapsed());
    }
    let latent = in_flight(step, &scene(&mesh, count), Detail::All, rounds)?;
    let resident = in_flight(step, &scene(&mesh, count), Detail::Counts, rounds)?;
    let stages = stages.map(median);
    let (device, wall, cpu) = (stages.iter().sum::<f64>(), median(walls), median(cpu));
    let times: String = stages.iter().map(|time| format!("{time:.3} | ")).collect();
    println!(
        "| {name} | {} | {} | {} | {times}{device:.3} | {wall:.3} | {latent:.3} | {resident:.3} | {cpu:.3} | {:.3} | {} |",
        state.results.sphere_pairs.len(),
        state.results.contacts.pairs.len(),
        state.results.contacts.faces.len(),
        cpu / device,
        step.bytes(),
    );
    Ok(())
}

/// Milliseconds per step if each step continues from the one before, and results are read back some steps later.
fn in_flight(step: &mut GpuStep, state: &StepState, detail: Detail, rounds: usize) -> Result<f64, StepError> {
    let carried: Vec<_> = (0..state.input.bodies.len() as u32)
        .map(|source| Some(Carried::all(source)))
        .collect();
    let start = Instant::now();
    step.submit(&state.input, &[], detail)?;
    for _ in 1..rounds {
        step.submit(&state.input, &carried, detail)?;
        if step.in_flight() > LATENCY
            && let Some(output) = step.take()
        {
            output?;
        }
    }
    while let Some(output) = step.take() {
        output?;
    }
    Ok(start.elapsed().as_secs_f64() * 1.0e3 / rounds as f64)
}

/// Milliseconds.
fn median(mut times: Vec<Duration>) -> f64 {
    times.sort_unstable();
    times[times.len() / 2].as_secs_f64() * 1.0e3
}

/// Bodies in a box at the density of Aly & Elawady 2010: about 0.7 pairs of overlapping bounding spheres per body.
fn scene(mesh: &CollisionMesh, count: usize) -> StepState {
    let mut random = fastrand::Rng::with_seed(1);
    let mut between = |low: f32, high: f32| low + (high - low) * random.f32();
    let side = 22.5 * (count as f32 / 2200.0).cbrt();
    let mut state = StepState::default();
    let slot = state.input.meshes.add(mesh.clone());
    for _ in 0..count {
        let scale = between(0.25, 2.0) / (2.0 * mesh.radius);
        let [x, y, z, w] = [0; 4].map(|_| between(-1.0, 1.0));
        let position = Vec3::from_array([0; 3].map(|_| between(0.0, side)));
        // Nearly uniform over rotations.
        let rotation = Quat::from_xyzw(x, y, z, w + 1.0e-3).normalize();
        let mut body = Body::at_rest(slot, position, rotation, Vec3::splat(scale));
        body.linear_velocity = Vec3::from_array([0; 3].map(|_| between(-0.5, 0.5)));
        body.restitution = 1.0;
        state
            .input
            .bodies
            .push(&body, &state.input.meshes)
            .expect("a usable body");
    }
    state
}
