//! Drawn without reading back: 100,000 tori fly in a box and bounce. They stay on the GPU from step to step, and a
//! shader draws them from there.
//!
//! * `cargo run --release --example swarm --features window` shows it in a window. Add `-- --bodies 1000000` for more;
//! * `cargo run --release --example swarm -- --headless` prints what a step costs. It ends with an error if nothing
//!   collides, or if more than counts is read back.
//!
//! It needs a GPU: on a driver that computes on the CPU there are fewer tori. `draw.rs` is what a game needs to draw
//! its own swarm. The module `common` opens the window. In your own game use `DefaultPlugins` for that.

#[path = "../common/mod.rs"]
mod common;
#[cfg(feature = "window")]
mod draw;

use bevy::prelude::*;
use bevy_faceoff::prelude::*;

/// How many tori, unless `--bodies` says otherwise: on a GPU, and where the driver computes on the CPU.
const TORI: (usize, usize) = (100_000, 300);
/// The box is as full as the largest scene of the paper: so many tori, in a box of half this side in metres.
const PAPER: (f32, f32) = (2200.0, 11.25);
/// Smallest and largest diameter, metres.
const DIAMETERS: (f32, f32) = (0.25, 2.0);
/// Largest speed along each axis, m/s.
const SPEED: f32 = 3.0;
const STEPS: u32 = 40;
/// Prints after so many steps.
const EVERY: u64 = 32;
/// More than the counts of a step, fewer than the poses of the smallest swarm. Bytes.
const FEW_BYTES: u64 = 1024;

fn main() -> AppExit {
    let resident = StepPlugin {
        // Without a GPU it ends and says so. `Backend::Auto` would go on with the CPU.
        backend: Backend::Gpu,
        readback: Readback::Resident,
        ..default()
    };
    let mut app = common::app_with("swarm", STEPS, resident);
    app.insert_resource(Gravity(Vec3::ZERO))
        .insert_resource(Response::Impulse)
        .init_resource::<Count>()
        .add_systems(Startup, wait_for_gpu)
        .add_systems(Update, spawn.run_if(on_message::<BackendReady>))
        .add_systems(FixedLast, print);
    #[cfg(feature = "window")]
    draw::add_to(&mut app);
    app.run()
}

/// The entity that stands for the tori until there are some.
fn wait_for_gpu(mut commands: Commands) {
    commands.spawn(common::NotReady);
}

/// Spawns the tori once it is known what draws them.
fn spawn(world: &mut World) {
    let software = match bevy_faceoff::plugin::gpu(world) {
        Some(gpu) => gpu.info.device_type == wgpu::DeviceType::Cpu,
        None => {
            eprintln!("the tori are drawn from the memory of a GPU: run this without --backend cpu");
            world.write_message(AppExit::error());
            return;
        }
    };
    let asked = world.resource::<common::Options>().bodies;
    let tori = asked.unwrap_or(if software { TORI.1 } else { TORI.0 });
    if software && asked.is_none() {
        println!(
            "{tori} tori and not {}, because this driver computes on the CPU",
            TORI.0
        );
    }
    let half = PAPER.1 * (tori as f32 / PAPER.0).cbrt();
    let torus = MeshCollider(world.load_asset("torus.bake.ron"));
    let mut random = fastrand::Rng::with_seed(2010);
    let mut between = |low: f32, high: f32| low + (high - low) * random.f32();
    let bodies: Vec<_> = (0..tori)
        .map(|_| {
            let diameter = between(DIAMETERS.0, DIAMETERS.1);
            let mut vector = |reach: f32| Vec3::from_array([0; 3].map(|_| between(-reach, reach)));
            (
                RigidBody::Dynamic,
                torus.clone(),
                Transform::from_translation(vector(half - 0.5 * diameter))
                    .with_rotation(Quat::from_scaled_axis(vector(3.0)))
                    .with_scale(Vec3::splat(diameter)),
                LinearVelocity(vector(SPEED)),
                AngularVelocity(vector(1.0)),
                Restitution::new(1.0),
                common::DrawnByExample,
            )
        })
        .collect();
    world.spawn_batch(bodies);
    common::spawn_box(&mut world.commands(), half);
    let waiting: Vec<_> = world
        .query_filtered::<Entity, With<common::NotReady>>()
        .iter(world)
        .collect();
    waiting.into_iter().for_each(|entity| {
        world.despawn(entity);
    });
    #[cfg(feature = "window")]
    draw::look_at_box(world, half);
}

/// What has happened so far.
#[derive(Resource, Default)]
struct Count {
    touched: usize,
}

/// Prints what the step costs: twice a second.
fn print(mut count: ResMut<Count>, report: Res<StepReport>, mut exit: MessageWriter<AppExit>) {
    let Some(work) = report.gpu.filter(|_| report.bodies > 0) else {
        return;
    };
    count.touched += report.touching_pairs;
    if !report.step.is_multiple_of(EVERY) {
        return;
    }
    println!(
        "step {}: {} tori, {} pairs touch, {:.1} ms for the app, {} dispatches, {} bytes uploaded, {} bytes read back",
        report.step,
        report.bodies,
        report.touching_pairs,
        1e3 * report.total.as_secs_f32(),
        work.dispatches,
        work.uploaded_bytes,
        work.read_back_bytes
    );
    if count.touched == 0 || work.read_back_bytes > FEW_BYTES {
        eprintln!("nothing touches, or the tori are read back");
        exit.write(AppExit::error());
    }
}
