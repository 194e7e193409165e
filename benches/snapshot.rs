//! What a snapshot costs: 1,000 tori in a pile on the CPU, `cargo bench --bench snapshot`. The sizes are those in
//! memory and as text.
//!
//! Times are medians and depend on the machine; the counts are the same everywhere.

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::prelude::*;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;
use std::time::{Duration, Instant};

/// Tells the size of a snapshot.
#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// One fixed step.
const STEP: Duration = Duration::from_nanos(15_625_000);

/// Steps in which the pile forms.
const FALL: usize = 192;

/// How often each time is measured.
const TIMES: usize = 101;

fn main() {
    let mut app = app();
    spawn_pile(app.world_mut());
    // In Bevy's first update no time has passed, so it runs no step.
    for _ in 0..=FALL {
        app.update();
    }
    let world = app.world_mut();
    let start = Snapshot::take(world);

    // Every round measures the same two steps: the first after `restore`, and as the usual one that which follows it.
    let (mut take, mut restore) = (Vec::new(), Vec::new());
    let (mut first, mut usual, mut both) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..TIMES {
        restore.push(time(|| assert!(start.restore(world).is_empty())));
        first.push(time(|| world.run_schedule(FaceoffStep)));
        usual.push(time(|| world.run_schedule(FaceoffStep)));
        take.push(time(|| Snapshot::take(world)));
        both.push(restore[restore.len() - 1] + take[take.len() - 1]);
    }
    let region = Region::new(ALLOCATOR);
    let copy = start.clone();
    let allocated = region.change();
    let memory = allocated.bytes_allocated - allocated.bytes_deallocated;
    let text = ron::to_string(&copy).expect("a snapshot is plain data");
    println!(
        "size: {memory} bytes in memory, {} as RON, {} as RON compressed with LZ4",
        text.len(),
        lz4_flex::compress(text.as_bytes()).len()
    );
    let report = world.resource::<StepReport>();
    println!(
        "{} bodies, {} contact points, {} asleep",
        report.bodies, report.contact_points, report.sleeping
    );
    println!("| what | median ms | worst ms | of a usual step |");
    println!("|---|---|---|---|");
    let step = median(&mut usual);
    for (what, mut times) in [
        ("Snapshot::take", take),
        ("Snapshot::restore", restore),
        ("take + restore", both),
        ("usual step", usual),
        ("first step after restore", first),
    ] {
        let median = median(&mut times);
        println!(
            "| {what} | {median:.3} | {:.3} | {:.3} |",
            times[times.len() - 1],
            median / step
        );
    }
}

fn app() -> App {
    let mut app = App::new();
    let step = StepPlugin {
        backend: Backend::Cpu,
        ..default()
    };
    app.add_plugins((MinimalPlugins, FaceoffHeadlessPlugins { step, ..default() }))
        .insert_resource(Time::<Fixed>::from_duration(STEP))
        .insert_resource(TimeUpdateStrategy::ManualDuration(STEP));
    app.finish();
    app.cleanup();
    app
}

/// Ten layers of 100 tori of 240 triangles with a diameter of 0.5 m, above the ground between four walls.
fn spawn_pile(world: &mut World) {
    let torus = shapes::torus_240();
    let vertices = torus.vertices().iter().map(|v| *v * 0.25).collect();
    let torus = TriMesh::new(vertices, torus.triangles().to_vec()).expect("a torus");
    let torus = world
        .resource_mut::<Assets<CollisionMesh>>()
        .add(CollisionMesh::new(&torus));
    world.spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y));
    for side in [Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z] {
        world.spawn(PlaneCollider::through(3.0 * side, -side));
    }
    for i in 0..1000 {
        let place = Vec3::new((i % 10) as f32 - 4.5, 0.0, (i / 10 % 10) as f32 - 4.5) * 0.55;
        let layer = (i / 100) as f32;
        world.spawn((
            RigidBody::Dynamic,
            MeshCollider(torus.clone()),
            Transform::from_translation(place + Vec3::Y * (0.3 + 0.4 * layer))
                .with_rotation(Quat::from_rotation_x(0.3 * i as f32)),
            SleepingDisabled,
        ));
    }
}

/// The time that `run` takes, in ms.
fn time<T>(run: impl FnOnce() -> T) -> f64 {
    let start = Instant::now();
    let result = run();
    let time = start.elapsed();
    // Freed outside of the time, as by a game that keeps its last snapshots.
    drop(result);
    time.as_secs_f64() * 1e3
}

/// Sorts the times.
fn median(times: &mut [f64]) -> f64 {
    times.sort_unstable_by(f64::total_cmp);
    times[times.len() / 2]
}
