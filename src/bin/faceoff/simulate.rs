//! `faceoff simulate`: a headless Bevy app that runs the paper's scene and prints what each stage cost and found.

use crate::scene::{self, Scene};
use crate::{BackendChoice, CullingChoice, Outcome, frames, mesh, output};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_faceoff::geometry::mesh::MAX_COORDINATE;
use bevy_faceoff::prelude::*;
use bevy_faceoff::stages::Stage;
use clap::ValueEnum;
use indicatif::ProgressBar;
use serde::Serialize;
use std::path::PathBuf;
use std::time::Duration;

/// Run the paper's scene: bodies in a box with random poses, sizes and velocities.
#[derive(clap::Args)]
pub struct Options {
    /// torus (240 triangles), knot (1120 triangles), or a mesh file: .obj, .faceoff or .bake.ron.
    #[arg(long, default_value = "torus")]
    shape: String,
    /// How many bodies.
    #[arg(long, default_value_t = 2200)]
    bodies: usize,
    /// How many fixed steps of 1/64 s.
    #[arg(long, default_value_t = 100)]
    steps: usize,
    /// Seed of the random numbers.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Largest speed in m/s [default: 3 for the knot, else 0.5].
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
    /// Threads of the CPU stages, at most 1024; 0 for one per core.
    #[arg(long, default_value_t = 0, value_parser = clap::builder::RangedU64ValueParser::<usize>::new().range(0..=1024))]
    threads: usize,
    /// What happens to bodies that touch.
    #[arg(long, value_enum, default_value = "impulse")]
    response: ResponseChoice,
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
    shape: String,
    triangles: usize,
    bodies: usize,
    seed: u64,
    speed: f32,
    side: f32,
    culling: &'static str,
    backend: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    adapter: Option<String>,
    threads: usize,
    response: &'static str,
    dt: f64,
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
}

#[derive(Serialize)]
struct StageTimes {
    broad_phase: f64,
    angles: f64,
    triangle_test: f64,
    force_scan: f64,
    integrate: f64,
}

const STEP: Duration = Duration::from_nanos(15_625_000);

/// Runs the command.
pub fn run(options: &Options) -> Outcome {
    // What cannot be written should be known before the work is done.
    if let Some(path) = &options.json {
        output::create(path)?;
    }
    if let Some(folder) = &options.frames {
        output::folder(folder)?;
    }
    let mesh = mesh::shape(&options.shape, options.culling)?;
    let scene = Scene {
        bodies: options.bodies,
        side: positive("--side", options.side, scene::default_side(options.bodies))?,
        speed: positive(
            "--speed",
            options.speed,
            if options.shape == "knot" { 3.0 } else { 0.5 },
        )?,
        seed: options.seed,
    };
    let backend = match options.backend {
        BackendChoice::Auto => Backend::Auto,
        BackendChoice::Gpu => Backend::Gpu,
        BackendChoice::Cpu => Backend::Cpu,
    };

    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        FaceoffHeadlessPlugins {
            step: StepPlugin {
                backend,
                threads: options.threads,
                ..default()
            },
            ..default()
        },
    ))
    .insert_resource(Time::<Fixed>::from_duration(STEP))
    // Every update is one step, however long it takes.
    .insert_resource(TimeUpdateStrategy::ManualDuration(STEP))
    .insert_resource(Gravity(Vec3::ZERO))
    .insert_resource(Culling::from(options.culling))
    .insert_resource(match options.response {
        ResponseChoice::None => Response::None,
        ResponseChoice::Impulse => Response::Impulse,
    });
    if let ActiveBackend::None { reason } = app.world().resource() {
        return Err(format!("nothing can run the stages: {reason}").into());
    }
    let handle = app
        .world_mut()
        .resource_mut::<Assets<CollisionMesh>>()
        .add(mesh.clone());
    scene::spawn(app.world_mut(), &scene, &mesh, &handle);
    app.finish();
    app.cleanup();
    // Bevy's first update has no time behind it and runs no step.
    app.update();

    let progress = if options.steps > 1 {
        ProgressBar::new(options.steps as u64)
    } else {
        ProgressBar::hidden()
    };
    let mut steps = Vec::with_capacity(options.steps.min(1 << 20));
    for _ in 0..options.steps {
        app.update();
        let step = steps.len() + 1;
        if let Some(folder) = &options.frames
            && (step % options.every as usize == 0 || step == options.steps)
        {
            frames::save(app.world_mut(), scene.side, step, folder)?;
        }
        steps.push(StepRecord::from(app.world().resource::<StepReport>()));
        progress.inc(1);
    }
    progress.finish_and_clear();

    let active = app.world().resource::<ActiveBackend>().clone();
    let record = Record {
        meta: Meta {
            version: env!("CARGO_PKG_VERSION"),
            shape: options.shape.clone(),
            triangles: mesh.mesh.triangles().len(),
            bodies: scene.bodies,
            seed: scene.seed,
            speed: scene.speed,
            side: scene.side,
            culling: options.culling.name(),
            backend: active.name(),
            adapter: match &active {
                ActiveBackend::Gpu { adapter, .. } => Some(adapter.clone()),
                _ => None,
            },
            threads: bevy_faceoff::plugin::threads(app.world()),
            response: match options.response {
                ResponseChoice::None => "none",
                ResponseChoice::Impulse => "impulse",
            },
            dt: STEP.as_secs_f64(),
        },
        steps,
    };
    output::table(options.json.as_deref(), &summary(&record));
    match &options.json {
        Some(path) => output::json(path, &record),
        None => Ok(()),
    }
}

fn positive(name: &str, given: Option<f32>, default: f32) -> Outcome<f32> {
    match given {
        Some(x) if !(0.0..=MAX_COORDINATE).contains(&x) => {
            Err(format!("{name} must be a number from 0 to {MAX_COORDINATE:e}, not {x}").into())
        }
        given => Ok(given.unwrap_or(default)),
    }
}

impl From<&StepReport> for StepRecord {
    fn from(report: &StepReport) -> Self {
        let ms = |stage| report.time(stage).as_secs_f64() * 1e3;
        Self {
            step: report.step,
            step_ms: report.total.as_secs_f64() * 1e3,
            stages_ms: StageTimes {
                broad_phase: ms(Stage::BroadPhase),
                angles: ms(Stage::Angles),
                triangle_test: ms(Stage::TriangleTest),
                force_scan: ms(Stage::ForceScan),
                integrate: ms(Stage::Integrate),
            },
            sphere_pairs: report.sphere_pairs,
            touching_pairs: report.touching_pairs,
            triangle_tests: report.triangle_tests,
            face_pairs: report.face_pairs,
        }
    }
}

/// The medians, for people.
fn summary(record: &Record) -> String {
    let Meta {
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
    let mut text = format!(
        "{bodies} bodies of {triangles} triangles ({shape}) in a box of {side:.2} m, up to {speed} m/s; {place}, \
         {culling}; medians of {} steps\n\n",
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
    row("ForceScan", "ms", &|s| s.stages_ms.force_scan);
    row("Integrate", "ms", &|s| s.stages_ms.integrate);
    row("whole step", "ms", &|s| s.step_ms);
    row("sphere pairs", "", &|s| s.sphere_pairs as f64);
    row("touching pairs", "", &|s| s.touching_pairs as f64);
    row("triangle tests", "", &|s| s.triangle_tests as f64);
    row("face pairs", "", &|s| s.face_pairs as f64);
    text
}
