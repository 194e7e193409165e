//! Rollback: two players push their rings through a pile, and the inputs of the other one arrive 8 steps late.
//!
//! * `cargo run --release --example rollback --features window` shows it in a window: WASD push the ring of this
//!   player;
//! * `cargo run --release --example rollback -- --headless` compares it with a run without delay. It ends with an error
//!   if they differ in a single bit.
//!
//! Each step begins at the last state for which all inputs are known. It goes one step on with the inputs that have
//! arrived, takes a [`Snapshot`], and then repeats the 8 steps up to now with a guess of those that have not. The guess
//! is drawn.
//!
//! The module `common` opens the window. In your own game use `DefaultPlugins` for that.

mod common;

use bevy::prelude::*;
use bevy_faceoff::prelude::*;
use std::collections::VecDeque;
use std::f32::consts::TAU;
use std::time::{Duration, Instant};

/// How late inputs arrive, in steps: an eighth of a second.
const DELAY: usize = 8;
const STEPS: usize = 64 * 10;
/// Mass of a player's ring, kilograms, and the force of a push, newtons.
const MASS: f32 = 3.0;
const PUSH: f32 = 45.0;
/// Half the width of the ground, metres.
const HALF: f32 = 2.4;

fn main() -> AppExit {
    let step = StepPlugin {
        // A GPU gives other bits.
        backend: Backend::Cpu,
        ..default()
    };
    let mut app = common::app_with("rollback", STEPS as u32, step);
    app.insert_resource(common::View {
        from: Vec3::new(0.0, 5.4, 6.2),
        at: Vec3::new(0.0, 0.2, 0.0),
    })
    .insert_resource(common::Help("WASD: push"))
    .init_resource::<LocalInput>()
    .add_systems(Startup, spawn)
    .add_systems(FixedUpdate, advance);
    // Only `advance` makes steps.
    app.world_mut().resource_mut::<Time<Physics>>().pause();
    #[cfg(feature = "window")]
    app.add_systems(Update, read_keys.run_if(resource_exists::<ButtonInput<KeyCode>>));
    app.run()
}

/// The ring of a player: 0 is here, 1 is elsewhere.
#[derive(Component, Clone, Copy)]
struct Player(usize);

/// The direction in which the player here pushes. `None` while no key is pressed: then the ring goes its way by itself.
#[derive(Resource, Default)]
struct LocalInput(Option<Vec3>);

/// The directions in which both players push in a step.
type Inputs = [Vec3; 2];

/// What is known of the game.
#[derive(Resource)]
struct Session {
    /// The state before the first step.
    first: Snapshot,
    /// The state after the last step whose inputs are all known.
    confirmed: Snapshot,
    /// The inputs of all steps so far. Those of the other player count only when they have arrived.
    inputs: Vec<Inputs>,
    /// Where the other player's ring was guessed to be after the last steps.
    guesses: VecDeque<Vec3>,
    /// The largest error of a guess, metres.
    error: f32,
    /// Time for all steps so far.
    time: Duration,
}

fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
    // With a key of its own, each body comes in the same order on the machines of both players.
    let mut key = 0;
    let mut place = |bundle: (Transform, MeshCollider)| {
        key += 1;
        commands.spawn((StableKey(key), RigidBody::Dynamic, bundle)).id()
    };
    let [ring, knot, torus] =
        ["ring", "knot", "torus"].map(|name| MeshCollider(assets.load(format!("{name}.bake.ron"))));
    let players = [-1.0, 1.0].map(|side| {
        let at = Transform::from_xyz(1.8 * side, 0.1, 0.0).with_rotation(Quat::from_rotation_x(TAU / 4.0));
        place((at, ring.clone()))
    });
    for i in 0..24 {
        let (column, row) = (i % 4, i / 4);
        let at = 0.45 * Vec3::new(column as f32 - 1.5, 1.0, row as f32 - 2.5);
        let size = Vec3::splat(0.4);
        let mesh = if i % 2 == 0 { &knot } else { &torus };
        place((Transform::from_translation(at).with_scale(size), mesh.clone()));
    }
    for (number, player) in players.into_iter().enumerate() {
        commands.entity(player).insert((
            Player(number),
            Mass(MASS),
            ExternalForces::default(),
            LinearDamping(1.0),
        ));
    }
    let walls = [Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z].map(|side| PlaneCollider::through(HALF * side, -side));
    let ground = PlaneCollider::through(Vec3::ZERO, Vec3::Y);
    for (plane, key) in walls.into_iter().chain([ground]).zip(1000..) {
        commands.spawn((StableKey(key), plane));
    }
}

/// Where a player pushes in a step: in another direction every half a second.
fn script(player: usize, step: usize) -> Vec3 {
    let turn = step / 32 * (5 + 2 * player) + 4 * player;
    let (sin, cos) = (turn as f32 / 16.0 * TAU).sin_cos();
    Vec3::new(cos, 0.0, sin)
}

#[cfg(feature = "window")]
fn read_keys(keys: Res<ButtonInput<KeyCode>>, mut input: ResMut<LocalInput>) {
    let directions = [
        (KeyCode::KeyW, Vec3::NEG_Z),
        (KeyCode::KeyS, Vec3::Z),
        (KeyCode::KeyA, Vec3::NEG_X),
        (KeyCode::KeyD, Vec3::X),
    ];
    let pressed = directions.into_iter().filter(|&(key, _)| keys.pressed(key));
    input.0 = pressed.map(|(_, direction)| direction).reduce(|a, b| a + b);
}

/// One step of the game: a step whose inputs are all known, and the steps up to now again.
fn advance(world: &mut World) {
    if !world.contains_resource::<Session>() && !begin(world) {
        return;
    }
    let Some(mut session) = world.remove_resource::<Session>() else {
        return;
    };
    let start = Instant::now();
    let now = session.inputs.len();
    let here = world.resource::<LocalInput>().0.unwrap_or_else(|| script(0, now));
    session.inputs.push([here, script(1, now)]);

    session.confirmed.restore(world);
    // The inputs of the other player have arrived for the steps before this one.
    let known = session.inputs.len().saturating_sub(DELAY);
    let mut guess = Vec3::ZERO;
    if let Some(last) = known.checked_sub(1) {
        simulate(world, session.inputs[last]);
        session.confirmed = Snapshot::take(world);
        guess = session.inputs[last][1];
        let error = session.guesses.pop_front().map(|at| at.distance(other_player(world)));
        session.error = session.error.max(error.unwrap_or_default());
    }
    for inputs in &session.inputs[known..] {
        simulate(world, [inputs[0], guess]);
    }
    session.guesses.push_back(other_player(world));
    session.time += start.elapsed();

    let options = world.resource::<common::Options>();
    if options.headless && session.inputs.len() == STEPS {
        let exit = compare(world, &session);
        world.write_message(exit);
    }
    world.insert_resource(session);
}

/// Begins the game when all meshes are loaded. Returns whether they are.
fn begin(world: &mut World) -> bool {
    let mut colliders = world.query::<&MeshCollider>();
    let meshes = world.resource::<Assets<CollisionMesh>>();
    if !colliders.iter(world).all(|collider| meshes.contains(&collider.0)) {
        return false;
    }
    let first = Snapshot::take(world);
    world.insert_resource(Session {
        confirmed: first.clone(),
        first,
        inputs: Vec::new(),
        guesses: VecDeque::new(),
        error: 0.0,
        time: Duration::ZERO,
    });
    true
}

/// Runs one step with these inputs.
fn simulate(world: &mut World, inputs: Inputs) {
    let mut players = world.query::<(&Player, &mut ExternalForces)>();
    for (player, mut forces) in players.iter_mut(world) {
        forces.force = PUSH * inputs[player.0];
    }
    world.run_schedule(FaceoffStep);
}

fn other_player(world: &mut World) -> Vec3 {
    let mut players = world.query::<(&Player, &Transform)>();
    let other = players.iter(world).find(|(player, _)| player.0 == 1);
    other.map_or(Vec3::ZERO, |(_, transform)| transform.translation)
}

/// Plays the same inputs again without a delay, and compares the states.
fn compare(world: &mut World, session: &Session) -> AppExit {
    session.first.restore(world);
    let known = STEPS - DELAY;
    for &inputs in &session.inputs[..known] {
        simulate(world, inputs);
    }
    println!(
        "{} bodies, {STEPS} steps, each repeated {DELAY} times: {:.2} ms a step; the other player was guessed to within {:.2} m",
        world.resource::<StepReport>().bodies,
        session.time.as_secs_f64() * 1e3 / STEPS as f64,
        session.error,
    );
    if Snapshot::take(world) == session.confirmed {
        println!("after {known} steps the state is that of a run without delay, to the bit");
        AppExit::Success
    } else {
        eprintln!("after {known} steps the state differs from that of a run without delay");
        AppExit::error()
    }
}
