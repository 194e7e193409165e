//! Marbles roll down a spiral track, through a loop, and into a bowl.
//!
//! * `cargo run --release --example marbles --features window` shows it in a window: space lets go another marble;
//! * `cargo run --release --example marbles -- --headless` lets go twelve marbles. It ends with an error if one leaves
//!   the track or comes to rest before the bowl.
//!
//! A marble is a `BallCollider`: a point with a radius, so it rolls without bumps whatever the triangles of the track.
//! The track is a mesh, made in `track`.
//!
//! The module `common` opens the window. In your own game use `DefaultPlugins` for that.

mod common;

use bevy::prelude::*;
use bevy_faceoff::prelude::*;
use std::f32::consts::{PI, TAU};

/// Radius of a marble, metres.
const MARBLE: f32 = 0.08;
/// Radius of the gutter in which it rolls, metres.
const GUTTER: f32 = 0.2;
/// Marbles that are let go, and the steps between them.
const MARBLES: (u32, u64) = (12, 96);
/// Radius of the bowl and the height of its rim, metres.
const BOWL: (f32, f32) = (1.6, 0.9);
/// Steps until all must be in the bowl.
const STEPS: u32 = 64 * 40;

fn main() -> AppExit {
    let mut app = common::app("marbles", STEPS);
    app.insert_resource(common::View {
        from: Vec3::new(5.5, 5.0, 7.5),
        at: Vec3::new(0.6, 1.6, 0.0),
    })
    .insert_resource(common::Help("Space: another marble"))
    .init_resource::<Wanted>()
    .add_systems(Startup, spawn)
    .add_systems(FixedUpdate, let_go);
    if app.world().resource::<common::Options>().headless {
        app.add_systems(FixedLast, check);
    } else {
        #[cfg(feature = "window")]
        app.add_systems(Update, read_keys);
    }
    app.run()
}

#[derive(Component)]
struct Marble;

/// Marbles that a key has asked for.
#[derive(Resource, Default)]
struct Wanted(u32);

fn spawn(mut commands: Commands, mut meshes: ResMut<Assets<CollisionMesh>>) {
    let mut fixed = |mesh: TriMesh| {
        let mesh = meshes.add(CollisionMesh::new(&mesh));
        commands.spawn((MeshCollider(mesh), Friction::new(0.4), Transform::default()));
    };
    fixed(track());
    fixed(bowl());
}

/// The middle of the gutter along the way, and where it is open: a banked spiral that leads down, a straight run, and a
/// loop.
fn path() -> Vec<(Vec3, Vec3)> {
    let mut points = Vec::new();
    let top = 4.4;
    // Two turns of a spiral. It leans so that a rolling ball stays in the middle.
    let (turns, fall, radius) = (240, 1.6, 1.1);
    for i in 0..turns {
        let part = i as f32 / turns as f32;
        let (sin, cos) = (part * 2.0 * TAU - 0.5 * PI).sin_cos();
        let inward = -Vec3::new(cos, 0.0, sin);
        let speed_squared = 10.0 / 7.0 * 9.81 * fall * part;
        let up = Vec3::Y * 9.81 + inward * (speed_squared / radius);
        points.push((
            Vec3::new(-1.6, top - fall * part, 0.0) - radius * inward,
            up.normalize(),
        ));
    }
    // Straight on, down to the loop.
    let start = Vec3::new(-1.6, top - fall, -radius);
    for i in 0..60 {
        let part = i as f32 / 60.0;
        let down = 1.5 * part * part * (3.0 - 2.0 * part);
        points.push((start + Vec3::new(2.0 * part, -down, 0.0), Vec3::Y));
    }
    // The loop moves aside by more than the width of the gutter while it goes round.
    let (radius, begin) = (0.42, start + Vec3::new(2.0, -1.5, 0.0));
    for i in 0..=96 {
        let part = i as f32 / 96.0;
        let (sin, cos) = (part * TAU).sin_cos();
        let inward = Vec3::new(-sin, cos, 0.0);
        points.push((
            begin + Vec3::Y * radius - radius * inward + Vec3::Z * (0.5 * part),
            inward,
        ));
    }
    // And out over the rim of the bowl.
    let end = begin + Vec3::Z * 0.5;
    for i in 1..30 {
        let part = i as f32 / 30.0;
        points.push((end + Vec3::new(0.9 * part, -0.05 * part, 0.0), Vec3::Y));
    }
    // The lean changes little by little.
    let around = |i: usize| i.saturating_sub(12)..(i + 12).min(points.len());
    let lean = |i: usize| around(i).map(|k| points[k].1).sum::<Vec3>().normalize();
    (0..points.len()).map(|i| (points[i].0, lean(i))).collect()
}

/// A half pipe along the path.
fn track() -> TriMesh {
    let path = path();
    let strips = 12;
    let mut vertices = Vec::new();
    for (i, &(at, open)) in path.iter().enumerate() {
        let (last, next) = (path[i.saturating_sub(1)].0, path[(i + 1).min(path.len() - 1)].0);
        let along = (next - last).normalize();
        let up = open.reject_from(along).normalize();
        let side = along.cross(up);
        for k in 0..=strips {
            let (sin, cos) = (PI * (k as f32 / strips as f32 - 0.5)).sin_cos();
            vertices.push(at + GUTTER * (side * sin - up * cos));
        }
    }
    let at = |i: usize, k: usize| (i * (strips + 1) + k) as u32;
    let quads = (0..path.len() - 1).flat_map(|i| (0..strips).map(move |k| (i, k)));
    let faces = quads.flat_map(|(i, k)| {
        [
            [at(i, k), at(i + 1, k), at(i, k + 1)],
            [at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)],
        ]
    });
    TriMesh::new(vertices, faces.collect()).expect("the track is a mesh")
}

/// The middle of the bowl's bottom.
fn bowl_at() -> Vec3 {
    Vec3::new(2.4, 0.0, -0.6)
}

/// A part of a ball, open above, with a wall on the far side.
fn bowl() -> TriMesh {
    let (rings, sides) = (16u32, 64u32);
    let (radius, height) = BOWL;
    let ball = (radius * radius + height * height) / (2.0 * height);
    let most = (radius / ball).asin();
    let mut vertices = vec![bowl_at()];
    for ring in 1..=rings {
        let (sin, cos) = (most * ring as f32 / rings as f32).sin_cos();
        vertices.extend((0..sides).map(|side| {
            let (z, x) = (TAU * side as f32 / sides as f32).sin_cos();
            bowl_at() + ball * Vec3::new(sin * x, 1.0 - cos, sin * z)
        }));
    }
    // The wall is the last ring.
    vertices.extend(
        (0..sides)
            .map(|side| {
                let rim = vertices[(1 + (rings - 1) * sides + side) as usize];
                rim + Vec3::Y * (0.7 * (1.0 + (TAU * side as f32 / sides as f32).cos()))
            })
            .collect::<Vec<_>>(),
    );
    let at = |ring: u32, side: u32| {
        if ring == 0 {
            0
        } else {
            1 + (ring - 1) * sides + side % sides
        }
    };
    let mut faces = Vec::new();
    for side in 0..sides {
        faces.push([0, at(1, side + 1), at(1, side)]);
        for ring in 1..=rings {
            faces.push([at(ring, side), at(ring, side + 1), at(ring + 1, side)]);
            faces.push([at(ring + 1, side), at(ring, side + 1), at(ring + 1, side + 1)]);
        }
    }
    TriMesh::new(vertices, faces).expect("the bowl is a mesh")
}

/// Lets go a marble at the top every one and a half seconds, and those that are wanted.
fn let_go(mut commands: Commands, mut wanted: ResMut<Wanted>, mut step: Local<u64>, marbles: Query<&Marble>) {
    let due = step.is_multiple_of(MARBLES.1) && *step / MARBLES.1 < u64::from(MARBLES.0);
    *step += 1;
    let count = std::mem::take(&mut wanted.0) + u32::from(due);
    for i in 0..count.min(1) {
        let aside = 0.03 * ((marbles.iter().count() as u32 + i) % 5) as f32 - 0.06;
        let at = path()[4].0 + Vec3::new(0.0, -GUTTER + MARBLE + 0.02, aside);
        commands.spawn((
            Marble,
            RigidBody::Dynamic,
            BallCollider::new(MARBLE),
            Density(2500.0),
            Friction::new(0.4),
            Restitution::new(0.3),
            AngularDamping(0.05),
            Transform::from_translation(at),
        ));
    }
}

/// Checks at the end that all marbles are in the bowl.
fn check(marbles: Query<&Transform, With<Marble>>, report: Res<StepReport>, mut exit: MessageWriter<AppExit>) {
    if report.step != u64::from(STEPS) {
        return;
    }
    let in_bowl = |at: Vec3| {
        let from = at - bowl_at();
        from.xz().length() < BOWL.0 && from.y > 0.0 && from.y < BOWL.1 + 1.4
    };
    let there = marbles.iter().filter(|pose| in_bowl(pose.translation)).count();
    println!("{there} of {} marbles are in the bowl", MARBLES.0);
    if there != MARBLES.0 as usize {
        marbles
            .iter()
            .filter(|pose| !in_bowl(pose.translation))
            .for_each(|pose| eprintln!("one is at {}", pose.translation));
        exit.write(AppExit::error());
    }
}

#[cfg(feature = "window")]
fn read_keys(input: Res<ButtonInput<KeyCode>>, mut wanted: ResMut<Wanted>) {
    wanted.0 += u32::from(input.just_pressed(KeyCode::Space));
}
