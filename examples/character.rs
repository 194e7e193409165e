//! A character climbs stairs, walks down a ramp, pushes crates and rides a lift.
//!
//! * `cargo run --release --example character --features window` shows it in a window: WASD moves, space jumps. While
//!   no key is pressed it goes its way by itself;
//! * `cargo run --release --example character -- --headless` prints where it is, and on what it stands.
//!
//! The module `common` opens the window. In your own game use `DefaultPlugins` for that.

mod common;

use bevy::prelude::*;
use bevy_faceoff::prelude::*;

/// Metres a second.
const SPEED: f32 = 2.0;
/// Where it waits for the lift.
const LIFT: f32 = 9.0;
/// How high the lift goes.
const UPSTAIRS: f32 = 2.0;

fn main() -> AppExit {
    let mut app = common::app("character", 64 * 16);
    app.init_resource::<Keys>()
        .add_systems(Startup, spawn)
        .add_systems(FixedUpdate, (move_lift, steer));
    if app.world().resource::<common::Options>().headless {
        app.add_systems(FixedLast, print);
    } else {
        #[cfg(feature = "window")]
        app.add_systems(Update, (read_keys, follow));
    }
    app.run()
}

/// What the player wants, if a key is pressed.
#[derive(Resource, Default)]
struct Keys(Option<(Vec3, bool)>);

#[derive(Component)]
struct Lift;

fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
    let cube = MeshCollider(assets.load("cube.bake.ron"));
    let mut block = |name: &str, low: Vec3, high: Vec3| {
        commands.spawn((
            Name::new(name.to_owned()),
            cube.clone(),
            Transform::from_translation(0.5 * (low + high)).with_scale(high - low),
        ));
    };
    block("floor", Vec3::new(-6.0, -1.0, -3.0), Vec3::new(14.0, 0.0, 3.0));
    let (rise, tread) = (0.2, 0.33);
    for i in 0..6 {
        let low = Vec3::new(-2.0 + tread * i as f32, 0.0, -1.0);
        block("stairs", low, Vec3::new(2.0, rise * (i + 1) as f32, 1.0));
    }
    block("upstairs", Vec3::new(10.1, 0.0, -1.0), Vec3::new(14.0, UPSTAIRS, 1.0));
    // From the top of the stairs down to the floor.
    let (top, foot) = (Vec3::new(2.0, 1.2, 0.0), Vec3::new(5.0, 0.0, 0.0));
    let along = foot - top;
    let turn = Quat::from_rotation_arc(Vec3::X, along.normalize());
    commands.spawn((
        Name::new("ramp"),
        cube.clone(),
        Transform::from_translation(0.5 * (top + foot) - turn * Vec3::Y * 0.1)
            .with_rotation(turn)
            .with_scale(Vec3::new(along.length(), 0.2, 2.0)),
    ));
    commands.spawn((
        Name::new("lift"),
        Lift,
        RigidBody::Kinematic,
        cube.clone(),
        Transform::from_xyz(LIFT, -0.05, 0.0).with_scale(Vec3::new(2.0, 0.2, 2.0)),
    ));
    for (i, at) in [Vec2::new(6.0, 0.4), Vec2::new(6.7, -0.4), Vec2::new(7.3, 0.45)]
        .into_iter()
        .enumerate()
    {
        commands.spawn((
            Name::new(format!("crate {i}")),
            RigidBody::Dynamic,
            cube.clone(),
            Transform::from_xyz(at.x, 0.26, at.y).with_scale(Vec3::splat(0.5)),
        ));
    }
    // The collider, with which it pushes crates, is wider than the capsule.
    commands.spawn((
        Name::new("character"),
        Character::new(0.3, 0.5),
        RigidBody::Kinematic,
        cube,
        Transform::from_xyz(-4.5, 1.0, 0.0).with_scale(Vec3::new(0.66, 1.4, 0.66)),
    ));
}

/// Moves the lift up and down: it rests for a while at both ends.
fn move_lift(mut lift: Single<&mut Transform, With<Lift>>, time: Res<Time>) {
    let phase = (1.0 - (0.7 * time.elapsed_secs()).cos()) * 0.8 - 0.3;
    lift.translation.y = -0.05 + (UPSTAIRS - 0.05) * phase.clamp(0.0, 1.0);
}

/// Sets the velocity that the character wants: that of the keys, or that of its way.
fn steer(keys: Res<Keys>, character: Single<(&mut Character, &CharacterGround, &Transform)>) {
    let (mut character, ground, transform) = character.into_inner();
    let at = transform.translation;
    let (way, jumps) = keys.0.unwrap_or_else(|| {
        let arrives = at.x > 12.0;
        let waits = (at.x - LIFT).abs() < 0.2 && at.y < UPSTAIRS + 0.75;
        let way = if arrives || waits { Vec3::ZERO } else { Vec3::X };
        (way - 2.0 * Vec3::Z * at.z, arrives)
    });
    character.velocity.x = SPEED * way.x;
    character.velocity.z = SPEED * way.z;
    if jumps && ground.is_some() {
        character.velocity.y = 4.0;
    }
}

/// Prints twice a second where it is.
fn print(report: Res<StepReport>, character: Single<(&Character, &CharacterGround, &Transform)>, names: Query<&Name>) {
    if report.step % 32 != 1 {
        return;
    }
    let (character, ground, transform) = *character;
    let stands = match **ground {
        Some(contact) => names.get(contact.body).map_or("?", |name| name),
        None => "the air",
    };
    println!(
        "step {}: at {:.2}, on {stands}, {:.2} m/s",
        report.step,
        transform.translation,
        character.velocity.length()
    );
}

#[cfg(feature = "window")]
fn read_keys(input: Res<ButtonInput<KeyCode>>, mut keys: ResMut<Keys>) {
    let moves = [
        (KeyCode::KeyW, Vec3::NEG_Z),
        (KeyCode::KeyS, Vec3::Z),
        (KeyCode::KeyA, Vec3::NEG_X),
        (KeyCode::KeyD, Vec3::X),
    ];
    let pressed = moves.into_iter().filter(|(key, _)| input.pressed(*key));
    let way: Vec3 = pressed.map(|(_, way)| way).sum();
    let jumps = input.pressed(KeyCode::Space);
    let any = input.get_pressed().next().is_some();
    keys.0 = any.then_some((way.normalize_or_zero(), jumps));
}

/// The camera follows the character.
#[cfg(feature = "window")]
fn follow(
    character: Single<&Transform, With<Character>>,
    mut camera: Single<&mut Transform, (With<Camera3d>, Without<Character>)>,
) {
    let at = character.translation;
    **camera = Transform::from_translation(at + Vec3::new(-2.0, 2.5, 6.5)).looking_at(at, Vec3::Y);
}
