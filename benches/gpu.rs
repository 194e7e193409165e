//! Time and work of the stages on the GPU: `cargo bench --bench gpu [-- --quick]`. The binary can also be copied to any
//! machine with a driver.
//!
//! The scenes are those of the paper in several sizes, in the exact mode, with each response. A table of times has:
//! * the device time of each stage (medians of timestamps);
//! * the wall time of a step with all results read back at once, with results read back two steps later, and with only
//!   the counts read back two steps later;
//! * the time of the same step on the CPU.
//!
//! A table of work has what a step asks of the device once lists are long enough, for each of the three readings.
//!
//! `--kernels` prints the time of each kernel instead, with contacts, in the first step and in the fourth.
//!
//! `--memory` prints the size of all buffers for a million tori and of the largest ones, from the lists of 2,200 at the
//! same density.
//!
//! `--quick` takes scenes of 300 bodies, because larger ones take minutes on a software driver. `--only NAME` takes
//! those whose name contains NAME. `--counts` counts 2,200 tori without measuring times, contacts at two speeds, and so
//! with one and with several collision substeps. `--counts --strewn` counts 100,000 tori so far apart that fewer than a
//! thousand pairs touch.
//!
//! Faces are counted, and listed only with `--faces`.

use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::gpu::buffers::{Buffers, Capacity};
use bevy_faceoff::gpu::device::{self, Gpu};
use bevy_faceoff::manifolds::gpu::{BatchSize, ContactBuffers, ContactCapacity, ContactScratch};
use bevy_faceoff::plugin::settings::LATENCY;
use bevy_faceoff::solver::gpu::SolverBuffers;
use bevy_faceoff::state::Body;
use bevy_faceoff::step::StepState;
use bevy_faceoff::step::gpu::buffers::{StepBuffers, StepCapacity};
use bevy_faceoff::step::gpu::results::Detail;
use bevy_faceoff::step::gpu::upload::Carried;
use bevy_faceoff::step::gpu::{GpuStep, StepError};
use bevy_faceoff::types::gpu_work::{GpuList, GpuWork};
use bevy_faceoff::types::kernel_cache::KernelCache;
use bevy_faceoff::types::settings::Response;
use bevy_faceoff::types::stage::Stage;
use glam::{Quat, Vec3};
use std::time::{Duration, Instant};

const RESPONSES: [Response; 3] = [Response::Impulse, Response::None, Response::Contacts];

fn main() {
    let has = |option: &str| std::env::args().any(|argument| argument == option);
    let only = std::env::args().skip_while(|argument| argument != "--only").nth(1);
    let opened = device::open(true, &KernelCache::Off);
    let opened = if has("--kernels") {
        opened.and_then(Gpu::with_kernel_times)
    } else {
        opened
    };
    let made = opened.and_then(GpuStep::new);
    let mut step = match made {
        Ok(step) => step,
        Err(error) => {
            println!("nothing is measured: {error}");
            return;
        }
    };
    let info = &step.gpu().info;
    println!(
        "{} ({:?}, {}, {} {})\n",
        info.name, info.device_type, info.backend, info.driver, info.driver_info
    );
    let (torus, knot) = (shapes::torus_240(), shapes::knot_1120());
    let mut scenes: Vec<(&str, &TriMesh, usize)> = if has("--counts") {
        vec![]
    } else if has("--quick") {
        vec![("300 tori", &torus, 300), ("300 knots", &knot, 300)]
    } else {
        vec![
            ("2200 tori", &torus, 2200),
            ("2200 knots", &knot, 2200),
            ("100,000 tori", &torus, 100_000),
            ("1,000,000 tori", &torus, 1_000_000),
        ]
    };
    if let Some(only) = only {
        scenes.retain(|(name, ..)| name.contains(&only));
    }
    if has("--kernels") {
        for (name, mesh, count) in scenes {
            if let Err(error) = kernels(&mut step, name, mesh, count) {
                println!("{name}: {error}");
            }
        }
        return;
    }
    if has("--memory") {
        for response in RESPONSES {
            if let Err(error) = memory(&mut step, &torus, response) {
                println!("{response:?}: {error}");
            }
        }
        return;
    }
    if !scenes.is_empty() {
        let stages: String = Stage::ALL.map(|stage| format!(" {} |", stage.name())).concat();
        println!(
            "| scene | response | sphere pairs | touching | face pairs |{stages} device, ms | lockstep, ms | latent, ms \
             | resident, ms | CPU step, ms | CPU / device |"
        );
        println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    }
    for &(name, mesh, count) in &scenes {
        for response in RESPONSES {
            if let Err(error) = measure(&mut step, name, mesh, (count, response)) {
                println!("| {name} | {response:?} | {error} |");
            }
        }
    }
    println!(
        "\n| scene | response | reading | touching | dispatches | indirect | added by wgpu | passes | copies | uploaded, bytes | read back, bytes | memory, bytes |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
    // With their distance, as a multiple of that in the paper.
    let counted: Vec<(&str, &TriMesh, usize, f32)> = if has("--strewn") {
        vec![("100,000 tori, strewn", &torus, 100_000, 4.0)]
    } else if scenes.is_empty() {
        vec![("2200 tori", &torus, 2200, 1.0)]
    } else {
        scenes
            .iter()
            .map(|&(name, mesh, count)| (name, mesh, count, 1.0))
            .collect()
    };
    for (name, mesh, count, spread) in counted {
        for response in RESPONSES {
            // The number of collision substeps is that of the fastest body.
            let speeds: &[f32] = if response == Response::Contacts && has("--strewn") {
                &[0.1 * SPEED]
            } else if response == Response::Contacts {
                &[0.1 * SPEED, 1.4 * SPEED]
            } else {
                &[SPEED]
            };
            for &speed in speeds {
                if let Err(error) = tally(&mut step, name, mesh, (count, response, speed), spread) {
                    println!("| {name} | {response:?} | {error} |");
                }
            }
        }
    }
}

/// Prints the time of each kernel in two steps with contacts: the first, and one that has kept what it could.
fn kernels(step: &mut GpuStep, name: &str, mesh: &TriMesh, count: usize) -> Result<(), StepError> {
    let mesh = CollisionMesh::new(mesh);
    let make = || scene(&mesh, count, Response::Contacts, SPEED, 1.0);
    // Lists grow in the first step.
    step.run(&mut make())?;
    step.forget();
    let mut state = make();
    for number in 1..=4 {
        step.run(&mut state)?;
        let times = step.gpu().kernel_times().map_err(StepError::Device)?;
        if number == 1 || number == 4 {
            let substeps = state.results.collision_substeps;
            let step = format!("{name}, contacts, step {number}, {substeps} collision substeps");
            print_kernel_times(&step, &times);
        }
    }
    Ok(())
}

/// Prints the time of each kernel, the longest first.
fn print_kernel_times(step: &str, times: &[(&'static str, Duration)]) {
    let mut sums: Vec<(&str, usize, Duration)> = Vec::new();
    for &(kernel, time) in times {
        match sums.iter_mut().find(|sum| sum.0 == kernel) {
            Some(sum) => (sum.1, sum.2) = (sum.1 + 1, sum.2 + time),
            None => sums.push((kernel, 1, time)),
        }
    }
    sums.sort_by_key(|&(_, _, time)| std::cmp::Reverse(time));
    let milliseconds = |time: Duration| 1.0e3 * time.as_secs_f64();
    let all = milliseconds(sums.iter().map(|&(_, _, time)| time).sum()).max(f64::MIN_POSITIVE);
    println!("\n{step}: {all:.3} ms\n\n| kernel | calls | ms | share |\n|---|---|---|---|");
    for (kernel, calls, time) in sums {
        let time = milliseconds(time);
        println!("| {kernel} | {calls} | {time:.3} | {:.1} % |", 100.0 * time / all);
    }
}

/// Prints the memory of a million bodies, if lists are as long by body as those of 2,200 are now.
fn memory(step: &mut GpuStep, mesh: &TriMesh, response: Response) -> Result<(), StepError> {
    const MANY: u32 = 1_000_000;
    /// The longest list that the card binds, bytes.
    const LONGEST: u64 = 1 << 30;
    let count = 2200;
    let mesh = CollisionMesh::new(mesh);
    let mut state = scene(&mesh, count, response, SPEED, 1.0);
    step.forget();
    step.run(&mut state)?;
    let lists = state.results.gpu.unwrap_or_default().lists;
    let many = |list: GpuList| (u64::from(list.length) * u64::from(MANY) / count as u64) as u32;
    let capacity = Capacity::default().grown(Capacity {
        bodies: MANY,
        pairs: many(lists.sphere_pairs),
        hits: many(lists.face_pairs),
        pieces: many(lists.pair_pieces),
        meshes: 1,
        words: step.capacity().words,
        ..Capacity::default()
    });
    let none = StepCapacity {
        contacts: ContactCapacity::default(),
        bodies: 0,
        touches: 0,
        solves: false,
        has_fast_bodies: false,
    };
    let at_once = ContactCapacity {
        batches: 1,
        margin_pairs: capacity.pairs,
        slots: 0,
        near_triangles: many(lists.near_triangles),
        pieces: many(lists.near_pieces),
        features: many(lists.features),
        segments: many(lists.segments),
        staged_points: many(lists.staged_points),
        pairs: many(lists.manifolds),
        points: many(lists.contact_points),
    };
    let batches = BatchSize::with_longest(LONGEST).batches_of(&at_once);
    let for_contacts = none.grown(StepCapacity {
        contacts: ContactCapacity { batches, ..at_once },
        bodies: MANY,
        touches: many(lists.touches),
        solves: response == Response::Contacts,
        has_fast_bodies: false,
    });
    let mut sizes = Buffers::sizes(&capacity);
    if response != Response::Impulse {
        let for_contacts = for_contacts.covering(&capacity);
        sizes.extend(ContactBuffers::sizes(&for_contacts.contacts));
        sizes.extend(ContactScratch::sizes(&for_contacts.contacts));
        sizes.extend(SolverBuffers::sizes(&for_contacts.solver()));
        sizes.extend(StepBuffers::sizes(&for_contacts));
    }
    sizes.sort_by_key(|&(_, size)| std::cmp::Reverse(size));
    let total: u64 = sizes.iter().map(|&(_, size)| size).sum();
    let megabytes = |bytes: u64| bytes as f64 / 1.0e6;
    let in_batches = if response == Response::Impulse {
        String::new()
    } else {
        format!(" in {batches} batches")
    };
    println!(
        "{response:?}{in_batches}: {:.0} MB in all, and of these",
        megabytes(total)
    );
    for (what, size) in sizes.iter().take(24) {
        println!("    {what}: {:.0} MB", megabytes(*size));
    }
    Ok(())
}

/// Prints the work of a step whose lists are long enough.
fn tally(
    step: &mut GpuStep,
    name: &str,
    mesh: &TriMesh,
    (count, response, speed): (usize, Response, f32),
    spread: f32,
) -> Result<(), StepError> {
    let mesh = CollisionMesh::new(mesh);
    for (reading, detail, latency) in [
        ("lockstep", Detail::All, 0),
        ("latent", Detail::All, LATENCY),
        ("resident", Detail::Counts, LATENCY),
    ] {
        // Deep overlaps take a software driver minutes, and bodies far apart need as many dispatches.
        let spread = if response == Response::Contacts {
            spread.max(2.0)
        } else {
            spread
        };
        let state = scene(&mesh, count, response, speed, spread);
        let (work, substeps, touching) = in_flight(step, &state, detail, latency, 2 + latency)?.1;
        let substeps = if response == Response::Contacts {
            format!(", {substeps} collision substeps")
        } else {
            String::new()
        };
        println!(
            "| {name} | {response:?}{substeps} | {reading} | {touching} | {} | {} | {} | {} | {} | {} | {} | {} |",
            work.dispatches,
            work.indirect,
            work.validations,
            work.passes,
            work.copies,
            work.uploaded_bytes,
            work.read_back_bytes,
            work.memory_bytes,
        );
    }
    Ok(())
}

/// Prints the times of a step.
fn measure(
    step: &mut GpuStep,
    name: &str,
    mesh: &TriMesh,
    (count, response): (usize, Response),
) -> Result<(), StepError> {
    let mesh = CollisionMesh::new(mesh);
    let make = || scene(&mesh, count, response, SPEED, 1.0);
    // Lists grow in the first step.
    let mut state = make();
    step.run(&mut state)?;
    let mut stages = [const { Vec::new() }; Stage::COUNT];
    let (mut walls, mut cpu) = (Vec::new(), Vec::new());
    repeat(|| {
        let mut state = make();
        step.forget();
        let start = Instant::now();
        step.run(&mut state)?;
        walls.push(start.elapsed());
        for (times, time) in stages.iter_mut().zip(state.results.times) {
            times.push(time);
        }
        Ok(())
    })?;
    let made = make();
    let mut mean_in_flight = |detail| {
        let mut means = Vec::new();
        repeat(|| {
            means.push(in_flight(step, &made, detail, LATENCY, 9)?.0);
            Ok(())
        })?;
        Ok::<_, StepError>(median(means))
    };
    let latent = mean_in_flight(Detail::All)?;
    let resident = mean_in_flight(Detail::Counts)?;
    // Not between the steps of the card: it lowers its clock while it waits.
    repeat(|| {
        let mut state = make();
        let start = Instant::now();
        for stage in Stage::ALL {
            bevy_faceoff::step::cpu::run(stage, &mut state);
        }
        cpu.push(start.elapsed());
        Ok(())
    })?;
    let stages = stages.map(median);
    let (device, wall, cpu) = (stages.iter().sum::<f64>(), median(walls), median(cpu));
    let times: String = stages.iter().map(|time| format!("{time:.3} | ")).collect();
    println!(
        "| {name} | {response:?} | {} | {} | {} | {times}{device:.3} | {wall:.3} | {latent:.3} | {resident:.3} | {cpu:.3} | {:.3} |",
        state.results.sphere_pairs.len(),
        state.results.contacts.pairs.len(),
        state.results.contacts.faces.len(),
        cpu / device,
    );
    Ok(())
}

/// Calls a measurement three times, and then until a second has passed, but at most 99 times.
fn repeat(mut measurement: impl FnMut() -> Result<(), StepError>) -> Result<(), StepError> {
    let start = Instant::now();
    for round in 0..99 {
        if round >= 3 && start.elapsed() > Duration::from_secs(1) {
            break;
        }
        measurement()?;
    }
    Ok(())
}

/// Time per step, the work of the last one, and its numbers of collision substeps and touching pairs. Each step
/// continues from the one before, and results are read back `latency` steps later.
fn in_flight(
    step: &mut GpuStep,
    state: &StepState,
    detail: Detail,
    latency: usize,
    rounds: usize,
) -> Result<(Duration, (GpuWork, u32, usize)), StepError> {
    let carried: Vec<_> = (0..state.input.bodies.len() as u32)
        .map(|source| Some(Carried::all(source)))
        .collect();
    step.forget();
    let mut last = (GpuWork::default(), 0, 0);
    let start = Instant::now();
    for round in 0..rounds {
        step.submit(&state.input, if round == 0 { &[] } else { &carried }, detail)?;
        if step.in_flight() > latency
            && let Some(output) = step.take()
        {
            let output = output?;
            last = (output.work, output.collision_substeps, output.counts.touching_pairs);
        }
    }
    while let Some(output) = step.take() {
        let output = output?;
        last = (output.work, output.collision_substeps, output.counts.touching_pairs);
    }
    Ok((start.elapsed() / rounds as u32, last))
}

/// Milliseconds.
fn median(mut times: Vec<Duration>) -> f64 {
    times.sort_unstable();
    times[times.len() / 2].as_secs_f64() * 1.0e3
}

/// The largest speed along each axis, m/s.
const SPEED: f32 = 0.5;

/// Bodies in a box at the density of Aly & Elawady 2010: about 0.7 pairs of overlapping bounding spheres per body;
/// `spread` times as far apart.
fn scene(mesh: &CollisionMesh, count: usize, response: Response, speed: f32, spread: f32) -> StepState {
    let mut random = fastrand::Rng::with_seed(1);
    let mut between = |low: f32, high: f32| low + (high - low) * random.f32();
    let side = spread * 22.5 * (count as f32 / 2200.0).cbrt();
    let mut state = StepState::default();
    state.input.config.response = response;
    state.input.config.face_lists = std::env::args().any(|argument| argument == "--faces");
    let slot = state.input.meshes.add(mesh.clone());
    for _ in 0..count {
        let scale = between(0.25, 2.0) / (2.0 * mesh.radius);
        let [x, y, z, w] = [0; 4].map(|_| between(-1.0, 1.0));
        let position = Vec3::from_array([0; 3].map(|_| between(0.0, side)));
        // Nearly uniform over rotations.
        let rotation = Quat::from_xyzw(x, y, z, w + 1.0e-3).normalize();
        let mut body = Body::at_rest(slot, position, rotation, Vec3::splat(scale));
        body.linear_velocity = Vec3::from_array([0; 3].map(|_| between(-speed, speed)));
        body.restitution = 1.0;
        state
            .input
            .bodies
            .push(&body, &state.input.meshes)
            .expect("a usable body");
    }
    state
}
