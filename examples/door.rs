//! A sensor opens a door while a ball is near it.
//!
//! * `cargo run --release --example door --features window` shows it in a window: WASD rolls the ball. While no key is
//!   pressed it rolls to and fro by itself;
//! * `cargo run --release --example door -- --headless` prints when the door opens and closes. It ends with an error if
//!   the ball does not get through.
//!
//! The module `common` opens the window. In your own game use `DefaultPlugins` for that.

mod common;

use bevy::prelude::*;
use bevy_faceoff::prelude::*;

/// Width of each half of the door, and height, metres.
const LEAF: Vec2 = Vec2::new(1.0, 1.6);
/// How fast a half of the door moves, m/s.
const DOOR_SPEED: f32 = 2.0;
/// Speed of the ball in m/s, and how quickly it gets there in m/s^2.
const BALL: (f32, f32) = (3.0, 6.0);

fn main() -> AppExit {
    let mut app = common::app("door", 64 * 12);
    app.insert_resource(common::View {
        from: Vec3::new(4.5, 4.0, 6.5),
        at: Vec3::new(0.0, 0.7, 0.0),
    })
    .insert_resource(common::Help("WASD: roll"))
    .init_resource::<Keys>()
    .init_resource::<Door>()
    .add_systems(Startup, spawn)
    // Bodies that the game moves are written in fixed time, as often as there are steps.
    .add_systems(FixedUpdate, (roll, move_door));
    if app.world().resource::<common::Options>().headless {
        app.add_systems(FixedLast, check);
    } else {
        #[cfg(feature = "window")]
        app.add_systems(Update, read_keys);
    }
    app.run()
}

/// How many balls are near the door, and how often it has opened.
#[derive(Resource, Default)]
struct Door {
    near: usize,
    opened: usize,
}

/// A half of the door, and where it is when the door is closed.
#[derive(Component)]
struct Leaf(Vec3);

#[derive(Component)]
struct Ball;

/// Where the player wants to go, if a key is pressed.
#[derive(Resource, Default)]
struct Keys(Option<Vec3>);

fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
    commands.spawn(PlaneCollider::default());
    let cube = MeshCollider(assets.load("cube.bake.ron"));
    for side in [-1.0, 1.0] {
        let closed = Vec3::new(0.0, 0.5 * LEAF.y, 0.5 * LEAF.x * side);
        commands.spawn((
            Leaf(closed),
            RigidBody::Kinematic,
            cube.clone(),
            // It stays a little above the ground and inside of the wall.
            Transform::from_translation(closed).with_scale(Vec3::new(0.1, LEAF.y - 0.02, LEAF.x)),
        ));
        // The wall has two sheets, and the half of the door slides between them.
        for sheet in [-0.15, 0.15] {
            commands.spawn((
                cube.clone(),
                Transform::from_xyz(sheet, 0.5 * LEAF.y + 0.1, (1.0 + 1.5) * side).with_scale(Vec3::new(
                    0.1,
                    LEAF.y + 0.2,
                    3.0,
                )),
            ));
        }
    }
    commands
        .spawn((
            Sensor,
            CollisionEventsEnabled,
            cube,
            Transform::from_xyz(0.0, 0.5, 0.0).with_scale(Vec3::new(4.0, 1.0, 2.0)),
        ))
        .observe(enter)
        .observe(leave);
    commands.spawn((
        Ball,
        RigidBody::Dynamic,
        MeshCollider(assets.load("ball.bake.ron")),
        Transform::from_xyz(-4.0, 0.41, 0.0).with_scale(Vec3::splat(0.8)),
    ));
}

/// The event is that of the sensor, so `body2` is who came. The halves of the door touch the sensor too.
fn enter(start: On<CollisionStart>, balls: Query<&Ball>, mut door: ResMut<Door>, time: Res<Time<Physics>>) {
    if balls.contains(start.body2) {
        door.near += 1;
        door.opened += 1;
        println!("{:.2} s: the door opens", time.elapsed_secs());
    }
}

fn leave(end: On<CollisionEnd>, balls: Query<&Ball>, mut door: ResMut<Door>, time: Res<Time<Physics>>) {
    if balls.contains(end.body2) {
        door.near -= 1;
        println!("{:.2} s: the door closes", time.elapsed_secs());
    }
}

/// The next step moves the halves from where they are to where they are put, and they push what is in their way.
fn move_door(door: Res<Door>, mut leaves: Query<(&Leaf, &mut Transform)>, time: Res<Time>) {
    for (leaf, mut transform) in &mut leaves {
        let aside = if door.near > 0 { 0.95 * LEAF.x } else { 0.0 };
        let goal = leaf.0 + Vec3::Z * aside * leaf.0.z.signum();
        transform.translation = transform.translation.move_towards(goal, DOOR_SPEED * time.delta_secs());
    }
}

/// Changes the velocity of the ball. Friction makes it roll.
fn roll(
    keys: Res<Keys>,
    mut back: Local<bool>,
    ball: Single<(&Transform, &mut LinearVelocity), With<Ball>>,
    time: Res<Time>,
) {
    let (pose, mut velocity) = ball.into_inner();
    let at = pose.translation;
    if at.x.abs() > 4.0 {
        *back = at.x > 0.0;
    }
    let way = keys
        .0
        .unwrap_or_else(|| Vec3::new(if *back { -1.0 } else { 1.0 }, 0.0, -at.z));
    let wanted = BALL.0 * way + Vec3::Y * velocity.y;
    velocity.0 = velocity.move_towards(wanted, BALL.1 * time.delta_secs());
}

/// Checks at the end that the ball went through the door and back.
fn check(door: Res<Door>, report: Res<StepReport>, mut exit: MessageWriter<AppExit>) {
    if report.step == 64 * 12 && door.opened < 3 {
        eprintln!("the door has opened {} times, not 3 times", door.opened);
        exit.write(AppExit::error());
    }
}

#[cfg(feature = "window")]
fn read_keys(input: Res<ButtonInput<KeyCode>>, mut keys: ResMut<Keys>) {
    let moves = [
        (KeyCode::KeyW, Vec3::NEG_X),
        (KeyCode::KeyS, Vec3::X),
        (KeyCode::KeyA, Vec3::Z),
        (KeyCode::KeyD, Vec3::NEG_Z),
    ];
    let pressed = moves.into_iter().filter(|(key, _)| input.pressed(*key));
    let way: Vec3 = pressed.map(|(_, way)| way).sum();
    keys.0 = (way != Vec3::ZERO).then(|| way.normalize());
}
