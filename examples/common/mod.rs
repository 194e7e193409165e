//! Shared code of the examples: an app that opens a window, or with `--headless` runs its steps as fast as possible.
//!
//! | argument | effect |
//! |---|---|
//! | `--headless` | without window and GPU: runs a number of fixed steps that the example chooses, then ends |
//! | `--backend auto\|cpu\|gpu` | where the steps run: by default on a GPU if there is one |
//! | `--bodies N` | how many bodies, in examples that leave it open |
//! | `--frames N` | ends after N steps (headless) or N frames (window) |
//! | `--screenshot FILE` | saves the last of these frames as a picture; needs `--frames` |
//! | `--gif FILE` | saves the window as a moving picture of N frames, 80 by default; steps keep pace with them |
//! | `--skip N` | with `--gif`: begins N frames later |
#![allow(dead_code, reason = "no example uses all of it")]

#[cfg(feature = "window")]
mod gif;
#[cfg(feature = "window")]
pub mod window;

use bevy::app::ScheduleRunnerPlugin;
use bevy::asset::LoadState;
use bevy::log::LogPlugin;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_faceoff::prelude::*;
use std::path::PathBuf;
use std::process::exit;
use std::time::Duration;

/// Length of a fixed step, Bevy's default.
const STEP: Duration = Duration::from_nanos(15_625_000);

/// The example is not ready: the steps or frames that are counted have not begun.
#[derive(Component)]
pub struct NotReady;

/// The window gives this collider no visible mesh: the example draws it.
#[derive(Component)]
pub struct DrawnByExample;

/// Where the window's camera is at the start, and the point that it looks at and turns about. In metres.
///
/// An example inserts its own. Without a window it does nothing.
#[derive(Resource, Clone, Copy)]
pub struct View {
    pub from: Vec3,
    pub at: Vec3,
}

impl Default for View {
    fn default() -> Self {
        Self {
            from: Vec3::new(0.0, 1.3, 4.0),
            at: Vec3::ZERO,
        }
    }
}

/// What the keys of an example do, for a line in the corner of the window.
#[derive(Resource, Clone, Copy, Default)]
pub struct Help(pub &'static str);

/// The command line.
#[derive(Resource, Clone, Default)]
pub struct Options {
    pub headless: bool,
    pub frames: Option<u32>,
    pub screenshot: Option<PathBuf>,
    pub gif: Option<PathBuf>,
    /// Frames before the moving picture begins.
    pub skip: u32,
    pub backend: Option<Backend>,
    pub bodies: Option<usize>,
}

impl Options {
    fn parse() -> Self {
        let mut options = Self::default();
        let mut args = std::env::args().skip(1);
        while let Some(arg) = args.next() {
            let mut value = || args.next().unwrap_or_else(|| usage(&format!("{arg} needs a value")));
            match arg.as_str() {
                "--headless" => options.headless = true,
                "--backend" => options.backend = Some(backend(&value())),
                "--bodies" => options.bodies = Some(number(&arg, &value()) as usize),
                "--frames" => options.frames = Some(number(&arg, &value())),
                "--screenshot" => options.screenshot = Some(value().into()),
                "--gif" => options.gif = Some(value().into()),
                "--skip" => options.skip = number(&arg, &value()),
                _ => usage(&format!("unknown argument {arg}")),
            }
        }
        if options.headless && (options.screenshot.is_some() || options.gif.is_some()) {
            usage("--screenshot and --gif need a window");
        }
        if options.screenshot.is_some() && options.frames.is_none() {
            usage("--screenshot needs --frames");
        }
        options
    }

    /// `step` with the backend of the command line.
    fn apply_to(&self, step: StepPlugin) -> StepPlugin {
        StepPlugin {
            backend: self.backend.unwrap_or(step.backend),
            ..step
        }
    }
}

fn number(arg: &str, value: &str) -> u32 {
    value
        .parse()
        .unwrap_or_else(|_| usage(&format!("{arg} needs a number, not {value}")))
}

fn backend(value: &str) -> Backend {
    match value {
        "auto" => Backend::Auto,
        "cpu" => Backend::Cpu,
        "gpu" => Backend::Gpu,
        _ => usage(&format!("--backend needs auto, cpu or gpu, not {value}")),
    }
}

fn usage(what: &str) -> ! {
    eprintln!(
        "{what}; arguments: [--headless] [--backend auto|cpu|gpu] [--bodies N] [--frames N] [--screenshot FILE.png] \
         [--gif FILE.gif [--skip N]]"
    );
    exit(2)
}

/// An app with Bevy's plugins and ours. With `--headless` it runs `steps` fixed steps, or those of `--frames`.
pub fn app(title: &str, steps: u32) -> App {
    app_with(title, steps, StepPlugin::default())
}

/// An app as [`app`] makes it, with other settings of the step.
pub fn app_with(title: &str, steps: u32, step: StepPlugin) -> App {
    let options = Options::parse();
    let step = options.apply_to(step);
    let mut app = App::new();
    app.insert_resource(options.clone());
    if options.headless {
        app.add_plugins((
            MinimalPlugins.build().disable::<ScheduleRunnerPlugin>(),
            LogPlugin::default(),
            FaceoffHeadlessPlugins { step, ..default() },
        ));
        let steps = options.frames.unwrap_or(steps);
        app.set_runner(move |app| run_headless(app, steps));
    } else {
        #[cfg(feature = "window")]
        window::open(&mut app, title, step);
        #[cfg(not(feature = "window"))]
        {
            eprintln!("{title}: built without windows; add --features window, or run it with -- --headless");
            exit(2);
        }
    }
    app
}

/// Waits for the meshes, then runs one step per update, as fast as possible.
fn run_headless(mut app: App, steps: u32) -> AppExit {
    app.finish();
    app.cleanup();
    loop {
        // Where kernels are compiled in the background, only a step notices that they are there. Nothing moves before that.
        let is_opening = matches!(app.world().resource(), ActiveBackend::Opening);
        let time = if is_opening { STEP } else { Duration::ZERO };
        app.insert_resource(TimeUpdateStrategy::ManualDuration(time));
        app.update();
        if let Some(exit) = app.should_exit() {
            return exit;
        }
        match meshes_loaded(app.world_mut()) {
            Ok(true) if is_ready(app.world_mut()) => break,
            Ok(_) => std::thread::sleep(Duration::from_millis(1)),
            Err(error) => {
                eprintln!("{error}");
                return AppExit::error();
            }
        }
    }
    if let ActiveBackend::None { reason } = app.world().resource() {
        eprintln!("nothing can run the steps: {reason}");
        return AppExit::error();
    }
    app.insert_resource(TimeUpdateStrategy::ManualDuration(STEP));
    for _ in 0..steps {
        app.update();
        if let Some(exit) = app.should_exit() {
            return exit;
        }
    }
    AppExit::Success
}

fn is_ready(world: &mut World) -> bool {
    world.query_filtered::<(), With<NotReady>>().iter(world).len() == 0
}

fn meshes_loaded(world: &mut World) -> Result<bool, String> {
    let mut colliders = world.query::<&MeshCollider>();
    let (server, meshes) = (
        world.resource::<AssetServer>(),
        world.resource::<Assets<CollisionMesh>>(),
    );
    for MeshCollider(handle) in colliders.iter(world) {
        if let LoadState::Failed(error) = server.load_state(handle) {
            return Err(error.to_string());
        }
        if !meshes.contains(handle) {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Spawns six planes that form a box around the origin. `half` is the distance of each in metres.
pub fn spawn_box(commands: &mut Commands, half: f32) {
    for side in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|axis| [axis, -axis]) {
        commands.spawn((PlaneCollider::through(half * side, -side), Restitution::new(1.0)));
    }
}
