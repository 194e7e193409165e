//! Fifty knots fall onto rings that stand in each other. Some stay hanging there, caught by their own holes.
//!
//! * `cargo run --release --example falling_knots --features window` shows it in a window: space kicks them up again;
//! * `cargo run --release --example falling_knots -- --headless` prints how they come to rest. It ends with an error if
//!   one is below the ground at the end.
//!
//! The module `common` opens the window. In your own game use `DefaultPlugins` for that.

mod common;

use bevy::prelude::*;
use bevy_faceoff::prelude::*;
use std::f32::consts::FRAC_PI_2;

const KNOTS: usize = 50;
/// Diameter of the rings, metres.
const RING: f32 = 5.0;
const STEPS: u32 = 64 * 8;

fn main() -> AppExit {
    let mut app = common::app("falling knots", STEPS);
    app.insert_resource(common::View {
        from: Vec3::new(3.5, 5.2, 9.0),
        at: Vec3::new(0.0, 2.4, 0.0),
    })
    .insert_resource(common::Help("space: kick"))
    .add_systems(Startup, spawn);
    if app.world().resource::<common::Options>().headless {
        app.add_systems(FixedLast, print);
    } else {
        #[cfg(feature = "window")]
        app.add_systems(Update, kick);
    }
    app.run()
}

#[derive(Component)]
struct Knot;

fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
    commands.spawn((PlaneCollider::default(), Friction::new(0.7)));

    // A collider without a `RigidBody` is static.
    let ring = MeshCollider(assets.load("ring.bake.ron"));
    for turn in [0.0, 1.0, 2.0] {
        commands.spawn((
            ring.clone(),
            Transform::from_xyz(0.0, 0.5 * RING, 0.0)
                .with_rotation(Quat::from_euler(
                    EulerRot::YXZ,
                    turn * FRAC_PI_2 / 1.5,
                    0.35 * turn,
                    0.0,
                ))
                .with_scale(Vec3::splat(RING)),
        ));
    }

    // All share one mesh, which is loaded once.
    let knot = MeshCollider(assets.load("knot.bake.ron"));
    let mut random = fastrand::Rng::with_seed(3);
    let mut between = |low: f32, high: f32| low + (high - low) * random.f32();
    for i in 0..KNOTS {
        let turn = Vec3::from_array([0; 3].map(|_| between(-3.0, 3.0)));
        commands.spawn((
            Knot,
            RigidBody::Dynamic,
            knot.clone(),
            Transform::from_xyz(between(-1.0, 1.0), RING + 1.0 + 0.5 * i as f32, between(-1.0, 1.0))
                .with_rotation(Quat::from_scaled_axis(turn))
                .with_scale(Vec3::splat(between(0.6, 1.1))),
            AngularVelocity(turn),
            Restitution::new(0.3),
            ExternalForces::default(),
        ));
    }
}

/// Prints once a second how many knots hang in the air, and how many sleep.
fn print(
    knots: Query<(Entity, &Transform, &Sleeping), With<Knot>>,
    ground: Single<Entity, With<PlaneCollider>>,
    collisions: Res<Collisions>,
    report: Res<StepReport>,
    mut exit: MessageWriter<AppExit>,
) {
    if !report.step.is_multiple_of(64) {
        return;
    }
    let lying = knots
        .iter()
        .filter(|(knot, ..)| collisions.get(*knot, *ground).is_some());
    let asleep = knots.iter().filter(|(.., sleeping)| sleeping.0);
    println!(
        "step {}: {} of {KNOTS} knots touch the ground, {} pairs touch, {} knots sleep",
        report.step,
        lying.count(),
        collisions.len(),
        asleep.count()
    );
    if knots
        .iter()
        .any(|(_, pose, _)| pose.translation.y.is_nan() || pose.translation.y < 0.0)
    {
        eprintln!("a knot is below the ground");
        exit.write(AppExit::error());
    }
}

/// An impulse acts in the next step, once. It wakes a body that sleeps.
#[cfg(feature = "window")]
fn kick(keys: Res<ButtonInput<KeyCode>>, mut knots: Query<(&mut ExternalForces, &Transform)>) {
    if !keys.just_pressed(KeyCode::Space) {
        return;
    }
    for (mut forces, pose) in &mut knots {
        // A knot of diameter 1 has a volume of about 0.1 m^3, and a density of 1 kg/m^3.
        forces.impulse += 0.6 * pose.scale.x.powi(3) * Vec3::Y;
    }
}
