//! Rings hang in each other: a chain without joints. Only the contacts of the triangles hold it together.
//!
//! * `cargo run --release --example chain --features window` shows it in a window: space pushes the lowest ring;
//! * `cargo run --release --example chain -- --headless` pushes it once, and prints how far the chain is stretched. It
//!   ends with an error if a link breaks.
//!
//! The module `common` opens the window. In your own game use `DefaultPlugins` for that.

mod common;

use bevy::prelude::*;
use bevy_faceoff::prelude::*;
use std::f32::consts::FRAC_PI_2;

const RINGS: usize = 7;
/// Height of the fixed ring, metres.
const TOP: f32 = 5.3;
/// Distance of the centres of two rings at rest, metres: the tubes, of radius 0.06 around a circle of radius 0.44,
/// touch inside of both rings.
const LINK: f32 = 2.0 * (0.44 - 0.06);
const STEPS: u32 = 64 * 8;

fn main() -> AppExit {
    let mut app = common::app("chain", STEPS);
    app.insert_resource(common::View {
        from: Vec3::new(2.4, 3.6, 7.0),
        at: Vec3::new(0.0, 2.85, 0.0),
    })
    .insert_resource(common::Help("space: push"))
    .add_systems(Startup, spawn);
    if app.world().resource::<common::Options>().headless {
        app.add_systems(FixedLast, measure);
    } else {
        #[cfg(feature = "window")]
        app.add_systems(Update, push);
    }
    app.run()
}

/// Its number in the chain, from the top.
#[derive(Component)]
struct Ring(usize);

fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
    let ring = MeshCollider(assets.load("ring.bake.ron"));
    for i in 0..RINGS {
        // Each ring is turned by a quarter to its neighbours, and begins a little above its place at rest.
        let turn = Quat::from_rotation_y(if i % 2 == 0 { 0.0 } else { FRAC_PI_2 });
        let height = TOP - (LINK - 0.02) * i as f32;
        let mut spawned = commands.spawn((
            Ring(i),
            ring.clone(),
            Transform::from_xyz(0.0, height, 0.0).with_rotation(turn),
        ));
        match i {
            0 => spawned.insert(RigidBody::Static),
            _ if i == RINGS - 1 => spawned.insert((RigidBody::Dynamic, LinearVelocity(PUSH))),
            _ => spawned.insert(RigidBody::Dynamic),
        };
    }
    commands.spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y));
}

/// Velocity that a push gives to the lowest ring, m/s.
const PUSH: Vec3 = Vec3::new(6.0, 0.0, 1.5);

/// Prints once a second where the chain ends. A ring further from the one above than at rest has left it.
fn measure(rings: Query<(&Ring, &Transform)>, report: Res<StepReport>, mut exit: MessageWriter<AppExit>) {
    if !report.step.is_multiple_of(64) {
        return;
    }
    let mut at = [Vec3::ZERO; RINGS];
    for (ring, transform) in &rings {
        at[ring.0] = transform.translation;
    }
    let longest = at.windows(2).map(|two| two[0].distance(two[1])).fold(0.0, f32::max);
    println!(
        "step {}: the lowest ring is at {:.2}, the longest link is {longest:.3} m",
        report.step,
        at[RINGS - 1]
    );
    // `max` ignores NaN, so the end of the chain is looked at too.
    if longest > LINK + 0.03 || !at[RINGS - 1].is_finite() {
        eprintln!("a link is broken: at rest it is {LINK:.3} m long");
        exit.write(AppExit::error());
    }
}

#[cfg(feature = "window")]
fn push(keys: Res<ButtonInput<KeyCode>>, mut rings: Query<(&Ring, &mut LinearVelocity)>) {
    if !keys.just_pressed(KeyCode::Space) {
        return;
    }
    for (ring, mut velocity) in &mut rings {
        if ring.0 == RINGS - 1 {
            velocity.0 += PUSH;
        }
    }
}
