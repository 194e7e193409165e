//! The plugin beside Bevy's renderer: the two share a device, and what one does when the other loses it.

#[path = "common/app.rs"]
mod app;
#[path = "common/gpu.rs"]
mod gpu;

use app::{Sim, ball_like};
use bevy::app::PluginGroupBuilder;
use bevy::camera::CameraPlugin;
use bevy::mesh::MeshPlugin;
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::render::error_handler::RenderErrorHandler;
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::renderer::RenderDevice;
use bevy::render::settings::WgpuSettings;
use bevy::time::TimeUpdateStrategy;
use bevy::window::ExitCondition;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::gpu::readback;
use bevy_faceoff::plugin::backend::recover_from_device_loss;
use bevy_faceoff::prelude::*;
use gpu::Test;
use std::time::Duration;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{BufferUsages, DeviceType, PollType};

const TESTS: &[Test] = &[
    ("the_stages_run_on_the_renderers_device", shares),
    ("beside_a_renderer_the_same_is_found_as_on_the_cpu", same_collisions),
    ("auto_does_not_take_a_renderers_adapter_that_computes_on_the_cpu", auto),
    ("a_renderer_without_a_device_changes_nothing", no_backend),
    ("a_renderer_that_is_added_later_shares_its_device_too", added_later),
    ("with_bevys_handler_the_app_ends_when_the_device_is_lost", lost_for_good),
    ("with_one_that_recovers_bodies_go_on_when_it_did", recovered),
    (
        "a_device_that_is_replaced_between_two_steps_is_noticed",
        replaced_unseen,
    ),
    ("a_device_may_be_lost_before_the_first_step", lost_early),
    ("the_cpu_takes_over_from_a_device_that_is_always_lost", lost_repeatedly),
    #[cfg(feature = "interpolation")]
    ("frames_between_steps_are_drawn_evenly", smooth),
];

fn main() {
    gpu::run(&[("renderer", TESTS)], &[], |_| {});
}

/// What a renderer needs, without a window.
fn renderer(settings: WgpuSettings) -> PluginGroupBuilder {
    PluginGroupBuilder::start::<MinimalPlugins>()
        .add(WindowPlugin {
            primary_window: None,
            exit_condition: ExitCondition::DontExit,
            ..default()
        })
        .add(RenderPlugin {
            render_creation: settings.into(),
            ..default()
        })
        .add(ImagePlugin::default())
        .add(MeshPlugin)
        .add(CameraPlugin)
}

fn faceoff(backend: Backend, readback: Readback) -> FaceoffPlugins {
    let threads = 1;
    FaceoffPlugins {
        step: StepPlugin {
            backend,
            threads,
            readback,
            ..default()
        },
    }
}

fn app(backend: Backend, readback: Readback, settings: WgpuSettings) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, AssetPlugin::default()));
    app.add_plugins((renderer(settings), faceoff(backend, readback)));
    app.insert_resource(Response::Impulse);
    watch(&mut app);
    app
}

/// How often an app was told what.
#[derive(Resource, Default, Clone, Copy, Debug, PartialEq)]
struct Told {
    ready: usize,
    failed: usize,
}

fn watch(app: &mut App) {
    let count =
        |mut told: ResMut<Told>, mut ready: MessageReader<BackendReady>, mut failed: MessageReader<BackendFailed>| {
            told.ready += ready.read().count();
            told.failed += failed.read().count();
        };
    app.init_resource::<Told>().add_systems(Last, count);
}

fn told(sim: &Sim) -> (usize, usize) {
    let told = sim.app.world().resource::<Told>();
    (told.ready, told.failed)
}

fn shared(readback: Readback) -> App {
    app(Backend::Gpu, readback, default())
}

/// An app as [`shared`] makes it, with a handler that opens a new device for a lost one.
fn shared_and_recovering(readback: Readback) -> App {
    let mut app = shared(readback);
    app.insert_resource(RenderErrorHandler(recover_from_device_loss));
    app
}

fn run(app: App) -> Sim {
    let mut sim = Sim::of(app);
    wait(&mut sim);
    sim
}

fn active(sim: &Sim) -> ActiveBackend {
    sim.app.world().resource::<ActiveBackend>().clone()
}

/// Updates until there is something to run the stages on, and one step has been made there.
fn wait(sim: &mut Sim) {
    for _ in 0..10_000 {
        sim.step(1);
        if !matches!(active(sim), ActiveBackend::Opening | ActiveBackend::Lost) {
            return;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    panic!("still {:?}", active(sim));
}

fn on_renderers_device(sim: &Sim) -> bool {
    matches!(active(sim), ActiveBackend::Gpu { shared: true, .. })
}

/// As if the driver had lost it: at once, and the renderer knows.
fn lose(sim: &Sim) {
    let device = sim.app.world().resource::<RenderDevice>().wgpu_device();
    device.destroy();
    // Fails if there is something that the device will not do any more.
    let _ = device.poll(PollType::wait_indefinitely());
}

/// A body that moves by 1/64 m a step.
struct Mover {
    body: Entity,
    /// Steps that were made without it.
    before: u64,
}

impl Mover {
    fn new(sim: &mut Sim) -> Self {
        let torus = sim.mesh(&shapes::torus_240());
        Self {
            before: sim.report().step + sim.report().in_flight as u64,
            body: sim.spawn(ball_like(&torus, Vec3::ZERO, Vec3::X)),
        }
    }

    /// Where all the steps that were reported have brought it.
    fn x(&self, sim: &Sim) -> f32 {
        let (x, steps) = (sim.position(self.body).x, sim.report().step - self.before);
        assert!((x - steps as f32 / 64.0).abs() < 1.0e-6, "at {x} after {steps} steps");
        x
    }
}

fn shares(_: &Gpu) {
    let mut sim = run(shared(Readback::Auto));
    assert!(on_renderers_device(&sim), "{:?}", active(&sim));
    assert_eq!(told(&sim), (1, 0));
    sim.step(5);
    assert!(sim.report().in_flight > 0, "results are not waited for");

    // wgpu's devices may be equal and yet not the same, but none reads another one's buffers.
    let words = [3, 1, 4, 1, 5];
    let device = sim.app.world().resource::<RenderDevice>().wgpu_device();
    let buffer = device.create_buffer_init(&BufferInitDescriptor {
        label: None,
        contents: bytemuck::cast_slice(&words),
        usage: BufferUsages::COPY_SRC,
    });
    let ours = bevy_faceoff::plugin::gpu(sim.app.world()).expect("the stages run on a GPU");
    assert_eq!(readback::read_words(ours, &buffer, words.len()), Ok(words.to_vec()));
}

/// Tori that fly into each other.
fn crowd(sim: &mut Sim) -> Vec<Entity> {
    let torus = sim.mesh(&shapes::torus_240());
    let mut random = fastrand::Rng::with_seed(5);
    let mut point = move |size: f32| size * (Vec3::from_array([0; 3].map(|_| random.f32())) - 0.5);
    (0..30)
        .map(|_| sim.spawn(ball_like(&torus, point(4.0), point(2.0))))
        .collect()
}

/// Which of the bodies touch, after each step.
fn touching(sim: &mut Sim, bodies: &[Entity], steps: usize) -> Vec<Vec<[usize; 2]>> {
    let number = |entity| bodies.iter().position(|&body| body == entity).expect("a body");
    (0..steps)
        .map(|_| {
            sim.step(1);
            let mut pairs: Vec<_> = sim.touching().into_iter().map(|pair| pair.map(number)).collect();
            pairs.iter_mut().for_each(|pair| pair.sort_unstable());
            pairs.sort_unstable();
            pairs
        })
        .collect()
}

fn same_collisions(_: &Gpu) {
    let mut cpu = Sim::new();
    cpu.world().insert_resource(Response::Impulse);
    let bodies = crowd(&mut cpu);
    let on_cpu = touching(&mut cpu, &bodies, 8);
    assert!(on_cpu.iter().all(|pairs| !pairs.is_empty()));
    for (readback, late) in [(Readback::Lockstep, 0), (Readback::Auto, 2)] {
        let mut gpu = shared(readback);
        // As in a game: the renderer draws while the next steps run.
        gpu.add_plugins(PipelinedRenderingPlugin);
        let mut gpu = run(gpu);
        assert!(on_renderers_device(&gpu));
        let bodies = crowd(&mut gpu);
        let on_gpu = touching(&mut gpu, &bodies, 8 + late);
        assert_eq!(on_cpu, on_gpu[late..], "{readback:?}");
    }
}

fn auto(gpu: &Gpu) {
    let sim = run(app(Backend::Auto, Readback::Auto, default()));
    match active(&sim) {
        ActiveBackend::Cpu { reason, .. } if gpu.info.device_type == DeviceType::Cpu => {
            assert!(reason.contains(&gpu.info.name), "{reason}");
        }
        taken => assert!(on_renderers_device(&sim), "{taken:?}"),
    }
    let mut sim = Sim::of(app(Backend::Cpu, Readback::Auto, default()));
    assert_eq!(active(&sim).name(), "cpu");
    let mover = Mover::new(&mut sim);
    sim.step(3);
    assert!(mover.x(&sim) > 0.0);
}

fn no_backend(_: &Gpu) {
    let settings = || WgpuSettings {
        backends: None,
        ..default()
    };
    let mut sim = Sim::of(app(Backend::Gpu, Readback::Auto, settings()));
    assert!(
        matches!(active(&sim), ActiveBackend::Gpu { shared: false, .. }),
        "{:?}",
        active(&sim)
    );
    let mover = Mover::new(&mut sim);
    sim.step(3);
    assert_eq!(sim.report().step, 3, "results are waited for");
    assert!(mover.x(&sim) > 0.0);
    assert_eq!(
        active(&Sim::of(app(Backend::Cpu, Readback::Auto, settings()))).name(),
        "cpu"
    );
}

fn added_later(_: &Gpu) {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, AssetPlugin::default()));
    app.add_plugins(faceoff(Backend::Gpu, Readback::Auto));
    app.add_plugins(renderer(default()));
    watch(&mut app);
    let mut sim = run(app);
    assert!(on_renderers_device(&sim), "{:?}", active(&sim));
    assert_eq!(told(&sim), (1, 0));
    let mover = Mover::new(&mut sim);
    sim.step(6);
    assert!(mover.x(&sim) > 0.0);
}

fn lost_for_good(_: &Gpu) {
    for readback in [Readback::Lockstep, Readback::Auto] {
        let mut sim = run(shared(readback));
        let mover = Mover::new(&mut sim);
        sim.step(4);
        assert_eq!(sim.app.should_exit(), None);
        let before = mover.x(&sim);
        lose(&sim);
        sim.step(4);
        assert_eq!(active(&sim), ActiveBackend::Lost);
        assert_eq!(told(&sim), (1, 1));
        assert_eq!(sim.app.should_exit(), Some(AppExit::error()));
        assert_eq!(mover.x(&sim), before, "nobody moves it");
    }
}

fn recovered(_: &Gpu) {
    for readback in [Readback::Lockstep, Readback::Auto] {
        let mut sim = run(shared_and_recovering(readback));
        let mover = Mover::new(&mut sim);
        sim.step(8);
        let before = mover.x(&sim);
        assert!(before > 0.0);
        lose(&sim);
        sim.step(1);
        assert_eq!(active(&sim), ActiveBackend::Lost);
        assert_eq!(told(&sim), (1, 1));
        assert_eq!(mover.x(&sim), before);
        wait(&mut sim);
        assert!(on_renderers_device(&sim), "{:?}", active(&sim));
        sim.step(8);
        assert!(mover.x(&sim) > before);
        assert_eq!(told(&sim), (2, 1));
        assert_eq!(sim.app.should_exit(), None);
    }
}

fn replaced_unseen(_: &Gpu) {
    let mut sim = run(shared_and_recovering(Readback::Auto));
    let mover = Mover::new(&mut sim);
    sim.step(8);
    let before = mover.x(&sim);
    let clock = |sim: &mut Sim, step| {
        sim.app.insert_resource(TimeUpdateStrategy::ManualDuration(step));
    };
    clock(&mut sim, Duration::ZERO);
    lose(&sim);
    sim.step(6);
    assert_eq!(told(&sim), (1, 0));
    clock(&mut sim, app::STEP);
    wait(&mut sim);
    assert!(on_renderers_device(&sim), "{:?}", active(&sim));
    sim.step(8);
    assert_eq!(told(&sim), (2, 1));
    assert!(mover.x(&sim) > before);
}

fn lost_early(_: &Gpu) {
    let mut sim = Sim::of(shared_and_recovering(Readback::Auto));
    assert_eq!(active(&sim), ActiveBackend::Opening);
    lose(&sim);
    wait(&mut sim);
    assert!(on_renderers_device(&sim), "{:?}", active(&sim));
    let mover = Mover::new(&mut sim);
    sim.step(8);
    assert!(mover.x(&sim) > 0.0);
}

fn lost_repeatedly(_: &Gpu) {
    let mut sim = run(shared_and_recovering(Readback::Lockstep));
    let mover = Mover::new(&mut sim);
    let mut losses = 0;
    while active(&sim).name() == "gpu" {
        assert!(losses < 20, "a device that is lost in every step is given up");
        lose(&sim);
        sim.step(1);
        wait(&mut sim);
        losses += 1;
    }
    assert_eq!(active(&sim).name(), "cpu");
    assert_eq!(losses, 4, "it is opened again three times");
    assert_eq!(told(&sim).1, losses);
    let before = mover.x(&sim);
    sim.step(5);
    assert_eq!(active(&sim).name(), "cpu", "though the renderer has a new device");
    assert!(mover.x(&sim) > before);
}

/// 240 frames a second, about four to a step, with both readings that write components.
#[cfg(feature = "interpolation")]
fn smooth(_: &Gpu) {
    const FRAME: Duration = Duration::from_nanos(4_166_667);
    for readback in [Readback::Lockstep, Readback::Latent] {
        let mut sim = run(shared(readback));
        let mover = Mover::new(&mut sim);
        sim.set(mover.body, TransformInterpolation);
        sim.world().insert_resource(TimeUpdateStrategy::ManualDuration(FRAME));
        // Until results arrive.
        sim.step(24);
        let mut before = sim.position(mover.body).x;
        for frame in 0..120 {
            sim.step(1);
            let now = sim.position(mover.body).x;
            let moved = (now - before) / FRAME.as_secs_f32();
            assert!((moved - 1.0).abs() < 1e-2, "{readback:?}, frame {frame}: {moved} m/s");
            before = now;
        }
        // A jump is one, and what comes later of the steps before it does not undo it.
        let there = Transform::from_xyz(0.0, 50.0, 0.0);
        sim.set(mover.body, (there, Teleport));
        for _ in 0..40 {
            sim.step(1);
            let height = sim.position(mover.body).y;
            assert!((height - 50.0).abs() < 1e-4, "{readback:?}: {height}");
        }
        assert!(sim.position(mover.body).x > 0.0, "it flies on");
    }
}
