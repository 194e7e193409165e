//! `faceoff simulate`: a headless Bevy app that runs a scene and prints what each stage cost and found.

use crate::gpu_work::WorkRecord;
use crate::headless::{self, Headless, STEP};
use crate::mechanics::Mechanics;
use crate::scenes::{self, SceneChoice};
use crate::{BackendChoice, CullingChoice, Outcome, Wrong, frames, mesh, output};
use bevy::prelude::*;
use bevy_faceoff::geometry::mesh::MAX_COORDINATE;
use bevy_faceoff::prelude::*;
use bevy_faceoff::testing::scenes::paper::{self, Paper};
use bevy_faceoff::types::stage::Stage;
use clap::ValueEnum;
use indicatif::ProgressBar;
use serde::Serialize;
use std::path::PathBuf;

/// The most bodies: some gigabytes of them.
const MAX_BODIES: u64 = 10_000_000;

/// Run a scene: the paper's, bodies in a box with random poses, sizes and velocities, or one in which bodies rest on
/// each other.
#[derive(clap::Args)]
pub struct Options {
    /// Which scene.
    #[arg(long, value_enum, default_value = "box")]
    scene: SceneChoice,
    /// torus (240 triangles), knot (1120 triangles), or a mesh file: .glb, .gltf, .obj, .stl, .ply, .off, .faceoff or
    /// .bake.ron [default: torus; knot for the scene pour].
    #[arg(long)]
    shape: Option<String>,
    /// How many bodies move, at most 10000000 [default: 2200 in the box, 50 in the chain, 10 in the stack, 100 poured].
    #[arg(long, value_parser = clap::builder::RangedU64ValueParser::<usize>::new().range(0..=MAX_BODIES))]
    bodies: Option<usize>,
    /// How many fixed steps of 1/64 s [default: 100 in the box, else 640].
    #[arg(long)]
    steps: Option<usize>,
    /// Seed of the random numbers.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Largest speed in the box in m/s [default: 3 for the knot, else 0.5].
    #[arg(long)]
    speed: Option<f32>,
    /// Side of the box in m [default: 22.5 * cbrt(bodies / 2200), about 0.7 sphere pairs per body].
    #[arg(long)]
    side: Option<f32>,
    /// How triangles are chosen for the test.
    #[arg(long, value_enum, default_value = "exact")]
    culling: CullingChoice,
    /// Where the stages run.
    #[arg(long, value_enum, default_value = "auto")]
    backend: BackendChoice,
    /// When the results of a GPU are read [default: lockstep]. With resident, collisions stay on the GPU and are only
    /// counted.
    #[arg(long, value_enum, alias = "reading")]
    readback: Option<ReadbackChoice>,
    /// Threads of the CPU stages, at most 1024; 0 for one per core.
    #[arg(long, default_value_t = 0, value_parser = clap::builder::RangedU64ValueParser::<usize>::new().range(0..=1024))]
    threads: usize,
    /// What happens to bodies that touch [default: impulse in the box, else contacts].
    #[arg(long, value_enum)]
    response: Option<ResponseChoice>,
    /// Write every step's times and counts as JSON to this file, or - for standard output.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Draw the scene into this folder as frame_STEP.png; made if it is missing.
    #[arg(long, value_name = "DIR")]
    frames: Option<PathBuf>,
    /// Draw every K-th step only, the last one always.
    #[arg(long, value_name = "K", default_value_t = 1, requires = "frames", value_parser = clap::value_parser!(u32).range(1..))]
    every: u32,
}

/// What happens to bodies that touch.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum ResponseChoice {
    /// Nothing: collisions are only counted, and bodies pass through each other and the walls.
    None,
    /// An impulse for each touching pair.
    Impulse,
    /// Contact points with friction, on which bodies rest.
    Contacts,
}

/// When the results of a GPU are read.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum ReadbackChoice {
    /// Each step waits for its results.
    Lockstep,
    /// Results are read two steps later.
    Latent,
    /// Bodies stay on the GPU, and counts are read two steps later.
    Resident,
}

impl ReadbackChoice {
    fn name(self) -> &'static str {
        match self {
            Self::Lockstep => "lockstep",
            Self::Latent => "latent",
            Self::Resident => "resident",
        }
    }
}

impl From<ReadbackChoice> for Readback {
    fn from(choice: ReadbackChoice) -> Self {
        match choice {
            ReadbackChoice::Lockstep => Self::Lockstep,
            ReadbackChoice::Latent => Self::Latent,
            ReadbackChoice::Resident => Self::Resident,
        }
    }
}

impl From<ResponseChoice> for Response {
    fn from(choice: ResponseChoice) -> Self {
        match choice {
            ResponseChoice::None => Self::None,
            ResponseChoice::Impulse => Self::Impulse,
            ResponseChoice::Contacts => Self::Contacts,
        }
    }
}

/// The JSON output.
#[derive(Serialize)]
struct Record {
    meta: Meta,
    steps: Vec<StepRecord>,
}

#[derive(Serialize)]
struct Meta {
    version: &'static str,
    scene: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    shape: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    triangles: Option<usize>,
    bodies: usize,
    seed: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    speed: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    side: Option<f32>,
    culling: &'static str,
    backend: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    adapter: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    readback: Option<&'static str>,
    threads: usize,
    response: &'static str,
    dt: f64,
    /// The most memory that this process had at any time, where the system tells.
    peak_memory_bytes: Option<u64>,
}

#[derive(Serialize)]
struct StepRecord {
    step: u64,
    step_ms: f64,
    stages_ms: StageTimes,
    sphere_pairs: usize,
    touching_pairs: usize,
    triangle_tests: u64,
    face_pairs: usize,
    contact_points: usize,
    collision_substeps: u32,
    mean_collision_substeps: f32,
    sleeping: usize,
    crowded_bodies: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    gpu: Option<WorkRecord>,
    /// Only where it is written: it costs a look at every body.
    #[serde(flatten)]
    mechanics: Option<Mechanics>,
}

#[derive(Serialize)]
struct StageTimes {
    broad_phase: f64,
    angles: f64,
    triangle_test: f64,
    manifolds: f64,
    force_scan: f64,
    integrate: f64,
}

/// Runs the command.
pub fn run(options: &Options) -> Outcome {
    // What cannot be written should be known before the work is done.
    let choice = options.scene;
    options.check()?;
    let shape = options.shape.as_deref().or(choice.shape());
    if let Some(path) = &options.json {
        output::refuse(path, shape.into_iter().flat_map(mesh::files))?;
        output::check(path)?;
    }
    if let Some(folder) = &options.frames {
        output::folder(folder)?;
    }
    let mesh = shape.map(|shape| mesh::shape(shape, options.culling)).transpose()?;
    let bodies = options.bodies.or(choice.bodies()).unwrap_or_default();
    let scene = Paper {
        bodies,
        side: positive("--side", options.side, paper::default_side(bodies))?,
        speed: positive("--speed", options.speed, if shape == Some("knot") { 3.0 } else { 0.5 })?,
        seed: options.seed,
    };
    let step_count = options.steps.unwrap_or(choice.steps());
    let response = options.response.map_or_else(|| choice.response(), Response::from);
    let readback = options.readback.unwrap_or(ReadbackChoice::Lockstep);
    let is_resident = matches!(readback, ReadbackChoice::Resident);
    let mut app = Headless {
        backend: options.backend,
        readback: readback.into(),
        threads: options.threads,
        culling: options.culling,
        response,
        gravity: match choice {
            SceneChoice::Box => Gravity(Vec3::ZERO),
            _ => Gravity::default(),
        },
    }
    .app()?;
    let framing = scenes::spawn(app.world_mut(), choice, &scene, mesh.as_ref());
    let moving = app
        .world_mut()
        .query::<(&RigidBody, &MeshCollider)>()
        .iter(app.world())
        .filter(|(body, _)| **body == RigidBody::Dynamic)
        .count();

    let progress = if step_count > 1 {
        ProgressBar::new(step_count as u64)
    } else {
        ProgressBar::hidden()
    };
    let mut steps = Vec::with_capacity(step_count.min(1 << 20));
    while steps.len() < step_count {
        headless::step(&mut app)?;
        let step = steps.len() + 1;
        if let Some(folder) = &options.frames
            && (step % options.every as usize == 0 || step == step_count)
        {
            frames::save(app.world_mut(), &framing, step, folder)?;
        }
        let mechanics = (options.json.is_some() && !is_resident).then(|| Mechanics::of(app.world_mut()));
        steps.push(StepRecord::new(app.world().resource::<StepReport>(), mechanics));
        progress.inc(1);
    }
    progress.finish_and_clear();

    let active = app.world().resource::<ActiveBackend>().clone();
    let record = Record {
        meta: Meta {
            version: env!("CARGO_PKG_VERSION"),
            scene: choice.name(),
            shape: shape.map(str::to_string),
            triangles: mesh.as_ref().map(|mesh| mesh.mesh.triangles().len()),
            bodies: moving,
            seed: scene.seed,
            speed: (choice == SceneChoice::Box).then_some(scene.speed),
            side: (choice == SceneChoice::Box).then_some(scene.side),
            culling: options.culling.name(),
            backend: active.name(),
            adapter: match &active {
                ActiveBackend::Gpu { adapter, .. } => Some(adapter.clone()),
                _ => None,
            },
            readback: matches!(active, ActiveBackend::Gpu { .. }).then(|| readback.name()),
            threads: bevy_faceoff::plugin::threads(app.world()),
            response: match response {
                Response::None => "none",
                Response::Impulse => "impulse",
                _ => "contacts",
            },
            dt: STEP.as_secs_f64(),
            peak_memory_bytes: peak_memory(),
        },
        steps,
    };
    if let Some(path) = &options.json {
        output::json(path, &record)?;
    }
    output::table(options.json.as_deref(), &summary(&record))
}

impl Options {
    /// Checks that every option that is given has a meaning for the scene.
    fn check(&self) -> Outcome {
        let scene = self.scene;
        let idle = [
            ("--shape", self.shape.is_some() && scene.shape().is_none()),
            ("--bodies", self.bodies.is_some() && scene.bodies().is_none()),
            ("--speed", self.speed.is_some() && scene != SceneChoice::Box),
            ("--side", self.side.is_some() && scene != SceneChoice::Box),
        ];
        let is_resident = matches!(self.readback, Some(ReadbackChoice::Resident));
        if is_resident && self.frames.is_some() {
            return Err(Wrong(
                "--frames draws what is read back, and --readback resident reads nothing: use latent".into(),
            )
            .into());
        }
        match idle.iter().find(|(_, given)| *given) {
            Some((option, _)) => Err(Wrong(format!("{option} has no meaning for --scene {}", scene.name())).into()),
            None => Ok(()),
        }
    }
}

/// Reads `VmHWM` of proc_pid_status(5), which only Linux has.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(1024 * line.trim().trim_end_matches("kB").trim().parse::<u64>().ok()?)
}

fn positive(name: &str, given: Option<f32>, default: f32) -> Outcome<f32> {
    match given {
        Some(x) if !(0.0..=MAX_COORDINATE).contains(&x) => {
            Err(Wrong(format!("{name} must be a number from 0 to {MAX_COORDINATE:e}, not {x}")).into())
        }
        given => Ok(given.unwrap_or(default)),
    }
}

impl StepRecord {
    fn new(report: &StepReport, mechanics: Option<Mechanics>) -> Self {
        let ms = |stage| report.time(stage).as_secs_f64() * 1e3;
        Self {
            step: report.step,
            step_ms: report.total.as_secs_f64() * 1e3,
            stages_ms: StageTimes {
                broad_phase: ms(Stage::BroadPhase),
                angles: ms(Stage::Angles),
                triangle_test: ms(Stage::TriangleTest),
                manifolds: ms(Stage::Manifolds),
                force_scan: ms(Stage::ForceScan),
                integrate: ms(Stage::Integrate),
            },
            sphere_pairs: report.sphere_pairs,
            touching_pairs: report.touching_pairs,
            triangle_tests: report.triangle_tests,
            face_pairs: report.face_pairs,
            contact_points: report.contact_points,
            collision_substeps: report.collision_substeps,
            mean_collision_substeps: report.mean_collision_substeps,
            sleeping: report.sleeping,
            crowded_bodies: report.crowded_bodies,
            gpu: report.gpu.as_ref().map(WorkRecord::from),
            mechanics,
        }
    }
}

/// The medians, for people.
fn summary(record: &Record) -> String {
    let Meta {
        scene,
        shape,
        triangles,
        bodies,
        side,
        speed,
        threads,
        culling,
        adapter,
        ..
    } = &record.meta;
    let place = match adapter {
        Some(adapter) => format!("GPU, {adapter}; stages in device time"),
        None => format!("CPU, {threads} threads"),
    };
    let what = match (shape, triangles) {
        (Some(shape), Some(triangles)) => format!(" of {triangles} triangles ({shape})"),
        _ => String::new(),
    };
    let setting = match (side, speed) {
        (Some(side), Some(speed)) => format!("in a box of {side:.2} m, up to {speed} m/s"),
        _ => format!("in the scene {scene}"),
    };
    let mut text = format!(
        "{bodies} bodies{what} {setting}; {place}, {culling}; medians of {} steps\n\n",
        record.steps.len()
    );
    let mut row = |name: &str, unit: &str, value: &dyn Fn(&StepRecord) -> f64| {
        let mut values: Vec<f64> = record.steps.iter().map(value).collect();
        values.sort_unstable_by(f64::total_cmp);
        let median = values.get(values.len() / 2).copied().unwrap_or(0.0);
        let digits = if unit == "ms" { 3 } else { 0 };
        text += &format!("{name:<16}{median:>12.digits$} {unit}\n");
    };
    row("BroadPhase", "ms", &|s| s.stages_ms.broad_phase);
    row("Angles", "ms", &|s| s.stages_ms.angles);
    row("TriangleTest", "ms", &|s| s.stages_ms.triangle_test);
    row("Manifolds", "ms", &|s| s.stages_ms.manifolds);
    row("ForceScan", "ms", &|s| s.stages_ms.force_scan);
    row("Integrate", "ms", &|s| s.stages_ms.integrate);
    row("whole step", "ms", &|s| s.step_ms);
    row("sphere pairs", "", &|s| s.sphere_pairs as f64);
    row("touching pairs", "", &|s| s.touching_pairs as f64);
    row("triangle tests", "", &|s| s.triangle_tests as f64);
    row("face pairs", "", &|s| s.face_pairs as f64);
    row("contact points", "", &|s| s.contact_points as f64);
    if record.steps.iter().any(|step| step.crowded_bodies > 0) {
        row("crowded bodies", "", &|s| s.crowded_bodies as f64);
    }
    if record.steps.iter().any(|step| step.gpu.is_some()) {
        let of = |value: fn(&WorkRecord) -> u64| move |s: &StepRecord| s.gpu.as_ref().map_or(0, value) as f64;
        row("dispatches", "", &of(WorkRecord::all_dispatches));
        row("uploaded", "bytes", &of(|work| work.uploaded_bytes));
        row("read back", "bytes", &of(|work| work.read_back_bytes));
        row("memory", "bytes", &of(|work| work.memory_bytes));
    }
    text
}
