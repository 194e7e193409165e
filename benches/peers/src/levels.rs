//! Worlds in which nearly everything is static or asleep: ten cubes fall beside it. Each engine has the cubes that suit
//! it, meshes of twelve triangles in ours and cuboids in the others, and its default settings, in whole steps of an app
//! where it has one.

use crate::avian;
use crate::engine::{Contacts, THREADS};
use crate::rapier::vector;
use crate::report::{Machine, versions};
use crate::scene::STEP;
use crate::timing::{median, pool, time};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use rapier3d::prelude::{ColliderBuilder, PhysicsWorld, RigidBodyBuilder};

/// Steps before the first that counts: cubes on a floor fall asleep in them.
const WARM: usize = 256;
/// Steps that count, of one engine after the other.
const STEPS: usize = 128;
/// The cubes that fall begin at this height, metres.
const HEIGHT: f32 = 2000.0;

/// Cubes with edges of 1 m.
#[derive(Clone, Copy)]
struct Level {
    name: &'static str,
    fixed: usize,
    /// Dynamic cubes on a static floor.
    resting: usize,
    falling: usize,
}

const LEVELS: [Level; 6] = [
    Level::new("ten cubes fall", 0, 0, 10),
    Level::new("ten fall beside 1,000 static", 1_000, 0, 10),
    Level::new("ten fall beside 20,000 static", 20_000, 0, 10),
    Level::new("ten fall beside 100,000 static", 100_000, 0, 10),
    Level::new("ten fall beside 4,000 asleep", 0, 4_000, 10),
    Level::new("10,000 fall", 0, 0, 10_000),
];

impl Level {
    const fn new(name: &'static str, fixed: usize, resting: usize, falling: usize) -> Self {
        Self {
            name,
            fixed,
            resting,
            falling,
        }
    }

    fn grid(count: usize, spacing: f32, height: f32) -> impl Iterator<Item = Vec3> {
        let side = (count as f32).sqrt().ceil() as usize;
        (0..count).map(move |i| Vec3::new(spacing * (i % side) as f32, height, spacing * (i / side) as f32))
    }

    /// The centre of each cube, and whether it is static.
    fn cubes(&self) -> impl Iterator<Item = (Vec3, bool)> {
        let fixed = Self::grid(self.fixed, 3.0, 0.0).map(|at| (at, true));
        let resting = Self::grid(self.resting, 2.0, 0.5005).map(|at| (at, false));
        let falling = Self::grid(self.falling, 3.0, HEIGHT).map(|at| (at, false));
        fixed.chain(resting).chain(falling)
    }

    /// Centre and size of the floor.
    fn floor(&self) -> Option<(Vec3, Vec3)> {
        let size = Vec3::new(400.0, 1.0, 400.0);
        (self.resting > 0).then_some((Vec3::new(60.0, -0.5, 60.0), size))
    }
}

/// Takes a step.
pub type Step = Box<dyn FnMut()>;

fn ours(level: &Level) -> Step {
    use bevy_faceoff::prelude::*;
    let mut app = App::new();
    let step = StepPlugin {
        backend: Backend::Cpu,
        ..default()
    };
    app.add_plugins((MinimalPlugins, FaceoffHeadlessPlugins::default().set(step)))
        .insert_resource(Time::<Fixed>::from_duration(STEP));
    app.finish();
    app.cleanup();
    let world = app.world_mut();
    let mut meshes = world.resource_mut::<Assets<CollisionMesh>>();
    let cube = MeshCollider(meshes.add(CollisionMesh::new(&shapes::cube(1.0))));
    if let Some((at, size)) = level.floor() {
        let floor = Transform::from_translation(at).with_scale(size);
        world.spawn((RigidBody::Static, cube.clone(), floor));
    }
    for (at, fixed) in level.cubes() {
        let kind = if fixed { RigidBody::Static } else { RigidBody::Dynamic };
        world.spawn((kind, cube.clone(), Transform::from_translation(at)));
    }
    Box::new(move || app.world_mut().run_schedule(FaceoffStep))
}

fn rapier(level: &Level) -> Step {
    let mut world = PhysicsWorld::new();
    world.gravity = vector(Vec3::NEG_Y * 9.81);
    world.integration_parameters.dt = STEP.as_secs_f32();
    if let Some((at, size)) = level.floor() {
        let half = 0.5 * size;
        world.insert_collider(
            ColliderBuilder::cuboid(half.x, half.y, half.z).translation(vector(at)),
            None,
        );
    }
    for (at, fixed) in level.cubes() {
        let cube = ColliderBuilder::cuboid(0.5, 0.5, 0.5);
        if fixed {
            world.insert_collider(cube.translation(vector(at)), None);
        } else {
            let body = world.insert_body(RigidBodyBuilder::dynamic().translation(vector(at)));
            world.insert_collider(cube, Some(body));
        }
    }
    Box::new(move || world.step())
}

fn avian(level: &Level) -> Step {
    use avian3d::prelude::*;
    let mut app = avian::app(Contacts::Own);
    let world = app.world_mut();
    if let Some((at, size)) = level.floor() {
        let floor = Collider::cuboid(size.x, size.y, size.z);
        world.spawn((RigidBody::Static, floor, Transform::from_translation(at)));
    }
    for (at, fixed) in level.cubes() {
        let kind = if fixed { RigidBody::Static } else { RigidBody::Dynamic };
        world.spawn((kind, Collider::cuboid(1.0, 1.0, 1.0), Transform::from_translation(at)));
    }
    avian::begin(&mut app);
    Box::new(move || app.update())
}

/// Measures all levels and prints the table.
pub fn compare() {
    let mut machine = Machine::here();
    let mut rows = Vec::new();
    for level in &LEVELS {
        eprintln!("{} ..", level.name);
        let build: [fn(&Level) -> Step; 3] = [ours, rapier, avian];
        let times = build.map(|build| pool(THREADS).install(|| measure(build(level))));
        rows.push(format!(
            "| {} | {} |",
            level.name,
            times.map(|ms| format!("{ms:.3}")).join(" | ")
        ));
    }
    machine.finish();
    println!("{}; ms a step, median\n", machine.heading(versions().iter()));
    println!("| level | ours, meshes | rapier3d, cuboids | avian3d, cuboids |\n|---|---|---|---|");
    rows.iter().for_each(|row| println!("{row}"));
}

/// Milliseconds of a step.
fn measure(mut step: Step) -> f64 {
    (0..WARM).for_each(|_| step());
    1e3 * median((0..STEPS).map(|_| time(&mut step).0))
}
