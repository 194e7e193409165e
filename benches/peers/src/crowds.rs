//! Crowds, in ours and in rapier3d: balls and capsules that fall into a bin and settle there, and cubes that stand on
//! each other. Nothing sleeps, so that the same work is left at the end.

use crate::engine::THREADS;
use crate::levels::Step;
use crate::rapier::vector;
use crate::report::{Machine, versions};
use crate::scene::STEP;
use crate::timing::{median, pool, time};
use bevy::prelude::*;
use rapier3d::prelude::{ColliderBuilder, PhysicsWorld, RigidBodyBuilder};

/// Steps until all lie in the bin.
const FALL: usize = 384;
/// Steps of what lies there.
const REST: usize = 128;
/// Half the inner width of the bin, and the height of its walls, metres.
const BIN: [f32; 2] = [4.0, 12.0];

#[derive(Clone, Copy)]
enum Shape {
    Ball {
        radius: f32,
    },
    Capsule {
        radius: f32,
        length: f32,
    },
    /// With edges of 1 m.
    Cube,
}

#[derive(Clone, Copy)]
enum Arrangement {
    /// So many bodies, in layers over the bin, each slightly aside from the one below.
    Falling(usize),
    /// A wall of so many rows. Each has one more body than the one above.
    Pyramid(usize),
    Stack(usize),
}

#[derive(Clone, Copy)]
struct Crowd {
    name: &'static str,
    shape: Shape,
    arrangement: Arrangement,
}

const CROWDS: [Crowd; 5] = [
    Crowd {
        name: "2,000 balls",
        shape: Shape::Ball { radius: 0.25 },
        arrangement: Arrangement::Falling(2_000),
    },
    Crowd {
        name: "1,000 capsules",
        shape: Shape::Capsule {
            radius: 0.2,
            length: 0.5,
        },
        arrangement: Arrangement::Falling(1_000),
    },
    Crowd {
        name: "stack of 10 cubes",
        shape: Shape::Cube,
        arrangement: Arrangement::Stack(10),
    },
    Crowd {
        name: "pyramid of 465 cubes",
        shape: Shape::Cube,
        arrangement: Arrangement::Pyramid(30),
    },
    Crowd {
        name: "pyramid of 5,050 cubes",
        shape: Shape::Cube,
        arrangement: Arrangement::Pyramid(100),
    },
];

impl Crowd {
    /// Where each body begins.
    fn places(&self) -> Vec<(Vec3, Quat)> {
        let upright = |x: f32, y: usize| (Vec3::new(x, 0.5 + 1.001 * y as f32, 0.0), Quat::IDENTITY);
        match self.arrangement {
            Arrangement::Falling(count) => (0..count).map(Self::falling).collect(),
            Arrangement::Pyramid(rows) => (0..rows)
                .flat_map(|y| {
                    (0..rows - y).map(move |x| upright(1.02 * (x as f32 + 0.5 * ((y + 1) as f32 - rows as f32)), y))
                })
                .collect(),
            Arrangement::Stack(count) => (0..count).map(|y| upright(0.0, y)).collect(),
        }
    }

    fn falling(i: usize) -> (Vec3, Quat) {
        let (spacing, side) = (0.9f32, 8usize);
        let (x, z, y) = (i % side, i / side % side, i / (side * side));
        let aside = 0.05 * (y % 5) as f32;
        let at = Vec3::new(x as f32 - 3.5, y as f32, z as f32 - 3.5) * spacing + Vec3::new(aside, 1.0, 0.5 * aside);
        (at, Quat::from_rotation_z(0.3 * (i % 7) as f32))
    }

    /// Centre and size of what is fixed.
    fn walls(&self) -> Vec<(Vec3, Vec3)> {
        match self.arrangement {
            Arrangement::Falling(_) => Self::bin().to_vec(),
            Arrangement::Pyramid(_) | Arrangement::Stack(_) => vec![(Vec3::NEG_Y * 0.5, Vec3::new(120.0, 1.0, 10.0))],
        }
    }

    /// A floor and four walls.
    fn bin() -> [(Vec3, Vec3); 5] {
        let [half, height] = BIN;
        let wall = |x: f32, z: f32| {
            let at = Vec3::new(x * (half + 0.5), 0.5 * height, z * (half + 0.5));
            let size = Vec3::new(
                1.0 + 2.0 * (half + 0.5) * z.abs(),
                height,
                1.0 + 2.0 * (half + 0.5) * x.abs(),
            );
            (at, size)
        };
        let floor = (Vec3::NEG_Y * 0.5, Vec3::new(4.0 * half, 1.0, 4.0 * half));
        [floor, wall(1.0, 0.0), wall(-1.0, 0.0), wall(0.0, 1.0), wall(0.0, -1.0)]
    }
}

fn ours(crowd: &Crowd) -> Step {
    use bevy_faceoff::prelude::*;
    let mut app = App::new();
    let step = StepPlugin {
        backend: Backend::Cpu,
        ..default()
    };
    app.add_plugins((MinimalPlugins, FaceoffHeadlessPlugins::default().set(step)))
        .insert_resource(Time::<Fixed>::from_duration(STEP))
        .insert_resource(SolverSettings {
            sleeping: false,
            ..default()
        });
    app.finish();
    app.cleanup();
    let world = app.world_mut();
    for (at, size) in crowd.walls() {
        world.spawn((CuboidCollider { size, rounding: 0.0 }, Transform::from_translation(at)));
    }
    for (at, turn) in crowd.places() {
        let body = (RigidBody::Dynamic, Transform::from_translation(at).with_rotation(turn));
        match crowd.shape {
            Shape::Ball { radius } => world.spawn((body, BallCollider::new(radius))),
            Shape::Capsule { radius, length } => world.spawn((body, CapsuleCollider::new(radius, length))),
            Shape::Cube => world.spawn((body, CuboidCollider::new(1.0, 1.0, 1.0))),
        };
    }
    Box::new(move || app.world_mut().run_schedule(FaceoffStep))
}

fn rapier(crowd: &Crowd) -> Step {
    let mut world = PhysicsWorld::new();
    world.gravity = vector(Vec3::NEG_Y * 9.81);
    world.integration_parameters.dt = STEP.as_secs_f32();
    for (at, size) in crowd.walls() {
        let half = 0.5 * size;
        world.insert_collider(
            ColliderBuilder::cuboid(half.x, half.y, half.z).translation(vector(at)),
            None,
        );
    }
    for (at, turn) in crowd.places() {
        let (axis, angle) = turn.to_axis_angle();
        let body = RigidBodyBuilder::dynamic()
            .translation(vector(at))
            .rotation(vector(axis * angle))
            .can_sleep(false);
        let body = world.insert_body(body);
        let shape = match crowd.shape {
            Shape::Ball { radius } => ColliderBuilder::ball(radius),
            Shape::Capsule { radius, length } => ColliderBuilder::capsule_y(0.5 * length, radius),
            Shape::Cube => ColliderBuilder::cuboid(0.5, 0.5, 0.5),
        };
        world.insert_collider(shape, Some(body));
    }
    Box::new(move || world.step())
}

/// Measures all crowds and prints the table.
pub fn compare() {
    let mut machine = Machine::here();
    let mut rows = Vec::new();
    for crowd in &CROWDS {
        eprintln!("{} ..", crowd.name);
        let build: [fn(&Crowd) -> Step; 2] = [ours, rapier];
        let [[fall, rest], [fall_peer, rest_peer]] = build.map(|build| pool(THREADS).install(|| measure(build(crowd))));
        rows.push(format!(
            "| {} | {fall:.2} | {fall_peer:.2} | {:.1} | {rest:.2} | {rest_peer:.2} | {:.1} |",
            crowd.name,
            fall / fall_peer,
            rest / rest_peer,
        ));
    }
    machine.finish();
    println!(
        "{}; ms a step, mean of the first steps, median at rest\n",
        machine.heading(versions().iter())
    );
    println!(
        "| crowd | first: ours | rapier3d | ratio | rests: ours | rapier3d | ratio |\n|---|---|---|---|---|---|---|"
    );
    rows.iter().for_each(|row| println!("{row}"));
}

/// Milliseconds of a step: the mean while bodies fall, and the median of what lies.
fn measure(mut step: Step) -> [f64; 2] {
    let fall: f64 = (0..FALL).map(|_| time(&mut step).0).sum();
    let rest = median((0..REST).map(|_| time(&mut step).0));
    [1e3 * fall / FALL as f64, 1e3 * rest]
}
