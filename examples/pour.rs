//! Knots are poured into a bin, where they catch in each other and come to rest.
//!
//! * `cargo run --release --example pour --features window` shows it in a window: space pours again;
//! * `cargo run --release --example pour -- --headless` prints how the bin fills. It ends with an error if a knot is
//!   outside of the bin at the end.
//!
//! The module `common` opens the window. In your own game use `DefaultPlugins` for that.

mod common;

use bevy::prelude::*;
use bevy_faceoff::prelude::*;

const KNOTS: usize = 40;
/// Diameter of a knot, metres.
const SIZE: f32 = 0.8;
/// Width of the inside of the bin, and height of its walls, metres.
const BIN: (f32, f32) = (2.4, 1.4);
/// Height from which they fall, metres.
const SPOUT: f32 = 4.5;
/// Steps from knot to knot.
const PAUSE: u64 = 10;
const STEPS: u32 = 64 * 12;

fn main() -> AppExit {
    let mut app = common::app("pour", STEPS);
    app.insert_resource(common::View {
        from: Vec3::new(2.1, 4.9, 4.5),
        at: Vec3::new(0.0, 1.1, 0.0),
    })
    .insert_resource(common::Help("space: again"))
    .add_systems(Startup, spawn)
    .add_systems(FixedUpdate, pour);
    if app.world().resource::<common::Options>().headless {
        app.add_systems(FixedLast, print);
    } else {
        #[cfg(feature = "window")]
        app.add_systems(Update, again);
    }
    app.run()
}

#[derive(Component)]
struct Knot;

/// What is left to pour.
#[derive(Resource)]
struct Jug {
    knot: MeshCollider,
    left: usize,
    random: fastrand::Rng,
}

fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
    let ((width, height), thickness) = (BIN, 0.2);
    let cube = MeshCollider(assets.load("cube.bake.ron"));
    for side in [Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z] {
        let along = Vec3::new(side.z.abs(), 0.0, side.x.abs());
        commands.spawn((
            cube.clone(),
            Transform::from_translation(0.5 * (width + thickness) * side + 0.5 * height * Vec3::Y)
                .with_scale(thickness * side.abs() + height * Vec3::Y + (width + 2.0 * thickness) * along),
        ));
    }
    commands.spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y));
    let knot = MeshCollider(assets.load("knot.bake.ron"));
    // The headless run waits for the meshes of all colliders, so this one, which is static, makes it wait for the
    // knots. It is so high that it casts no shadow.
    commands.spawn((knot.clone(), Transform::from_xyz(0.0, 10.0 * SPOUT, 0.0)));
    commands.insert_resource(Jug {
        knot,
        left: KNOTS,
        random: fastrand::Rng::with_seed(7),
    });
}

/// Drops a knot every few steps, from a point that goes round above the bin.
fn pour(mut commands: Commands, mut jug: ResMut<Jug>, report: Res<StepReport>) {
    if jug.left == 0 || !report.step.is_multiple_of(PAUSE) {
        return;
    }
    jug.left -= 1;
    let (sin, cos) = (2.4 * jug.left as f32).sin_cos();
    let turn = Vec3::from_array([0; 3].map(|_| 6.0 * jug.random.f32() - 3.0));
    commands.spawn((
        Knot,
        RigidBody::Dynamic,
        jug.knot.clone(),
        Transform::from_xyz(0.5 * cos, SPOUT, 0.5 * sin)
            .with_rotation(Quat::from_scaled_axis(turn))
            .with_scale(Vec3::splat(SIZE)),
        LinearVelocity(Vec3::NEG_Y * 3.0),
    ));
}

/// Prints once a second how many knots are in the bin, and how many are asleep.
fn print(knots: Query<(&Transform, &Sleeping), With<Knot>>, report: Res<StepReport>, mut exit: MessageWriter<AppExit>) {
    if !report.step.is_multiple_of(64) {
        return;
    }
    let inside = |at: Vec3| at.x.abs().max(at.z.abs()) < 0.5 * BIN.0 && (0.0..BIN.1 + SIZE).contains(&at.y);
    let inside = knots.iter().filter(|(pose, _)| inside(pose.translation)).count();
    let asleep = knots.iter().filter(|(_, sleeping)| sleeping.0).count();
    println!(
        "step {}: {inside} of {} knots are in the bin, {asleep} asleep",
        report.step,
        knots.iter().len()
    );
    if report.step == u64::from(STEPS) && inside != KNOTS {
        eprintln!("{} knots are not in the bin", KNOTS - inside);
        exit.write(AppExit::error());
    }
}

#[cfg(feature = "window")]
fn again(
    mut commands: Commands,
    keys: Res<ButtonInput<KeyCode>>,
    knots: Query<Entity, With<Knot>>,
    mut jug: ResMut<Jug>,
) {
    if keys.just_pressed(KeyCode::Space) {
        knots.iter().for_each(|knot| commands.entity(knot).despawn());
        jug.left = KNOTS;
    }
}
