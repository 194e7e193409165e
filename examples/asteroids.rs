//! A game: shoot the rocks, which break, and do not touch them.
//!
//! * `cargo run --release --example asteroids --features window`: A and D turn, W thrusts, space fires, R starts again. Until
//!   a key is pressed the ship flies by itself;
//! * `cargo run --release --example asteroids -- --headless` lets it fly by itself, and prints the score. It ends with an error
//!   if that is zero.
//!
//! The module `common` opens the window. In your own game use `DefaultPlugins` for that.

mod common;

use bevy::prelude::*;
use bevy_faceoff::prelude::*;
use std::f32::consts::TAU;

/// Half of the field's sides, metres. Who leaves it comes back on the other side.
const FIELD: Vec3 = Vec3::new(9.6, 1.0, 6.0);
/// Diameters of rocks, from large to small, and points for each.
const ROCKS: [(f32, u32); 3] = [(2.2, 20), (1.2, 50), (0.7, 100)];
/// Speed of a bullet in m/s; how long it flies, and from shot to shot, seconds.
const BULLET: (f32, f32, f32) = (16.0, 0.8, 0.22);
/// The ship and bullets collide with rocks, rocks with all.
const PLAYER: CollisionLayers = CollisionLayers {
    memberships: 1,
    filters: 2,
};
const ROCK: CollisionLayers = CollisionLayers {
    memberships: 2,
    filters: 3,
};

fn main() -> AppExit {
    let mut app = common::app("asteroids", 64 * 30);
    app.insert_resource(Gravity(Vec3::ZERO))
        .insert_resource(common::View {
            from: Vec3::new(0.0, 14.5, 5.0),
            at: Vec3::ZERO,
        })
        .insert_resource(common::Help("A, D: turn, W: thrust, space: fire, R: again"))
        .init_resource::<Pilot>()
        .add_systems(Startup, (load, start, next_wave).chain())
        .add_systems(FixedUpdate, (fly_alone, fly, wrap).chain())
        // After each step, because a slow frame has several.
        .add_systems(FixedLast, (hit, next_wave, print).chain());
    #[cfg(feature = "window")]
    if !app.world().resource::<common::Options>().headless {
        app.insert_resource(ClearColor(Color::srgb(0.01, 0.01, 0.03)));
        app.add_systems(Update, read_keys);
    }
    app.run()
}

/// What the ship is to do.
#[derive(Resource, Default)]
struct Pilot {
    human: bool,
    turn: f32,
    thrust: bool,
    fire: bool,
}

#[derive(Resource)]
struct Game {
    ship: MeshCollider,
    bullet: MeshCollider,
    rocks: [MeshCollider; 2],
    random: fastrand::Rng,
    score: u32,
    wave: usize,
}

/// How many seconds until it can fire again.
#[derive(Component)]
#[require(RigidBody, CollisionLayers = PLAYER, LinearDamping = LinearDamping(0.5))]
#[require(LockedAxes = LockedAxes::TRANSLATION_Y | LockedAxes::ROTATION_X | LockedAxes::ROTATION_Z)]
struct Ship(f32);

/// How many seconds it still has. It is fast: without `ContinuousCollision` it could pass through a rock.
#[derive(Component)]
#[require(RigidBody, CollisionLayers = PLAYER, ContinuousCollision)]
struct Bullet(f32);

/// Its number in [`ROCKS`].
#[derive(Component)]
#[require(RigidBody, CollisionLayers = ROCK, LockedAxes = LockedAxes::TRANSLATION_Y, Restitution = Restitution::new(1.0))]
struct Rock(usize);

fn load(mut commands: Commands, assets: Res<AssetServer>, mut meshes: ResMut<Assets<CollisionMesh>>) {
    // A dart: nose, left, notch and right, below and above.
    let outline = [(0.0, -0.65), (-0.42, 0.5), (0.0, 0.25), (0.42, 0.5)];
    let corners = [-0.12, 0.12].map(|y| outline.map(|(x, z)| Vec3::new(x, y, z)));
    let sides = (0..4).flat_map(|i| [[i, (i + 1) % 4, i + 4], [i + 4, (i + 1) % 4, (i + 1) % 4 + 4]]);
    let caps = [[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]];
    let dart = TriMesh::new(corners.concat(), sides.chain(caps).collect()).expect("all indices are of corners");
    commands.insert_resource(Game {
        ship: MeshCollider(meshes.add(CollisionMesh::new(&dart))),
        bullet: MeshCollider(assets.load("ball.bake.ron")),
        rocks: ["knot.bake.ron", "torus.bake.ron"].map(|path| MeshCollider(assets.load(path))),
        random: fastrand::Rng::with_seed(1979),
        score: 0,
        wave: 0,
    });
}

/// Begins a game. What is left of the last one goes.
fn start(mut commands: Commands, mut game: ResMut<Game>, bodies: Query<Entity, With<RigidBody>>) {
    bodies.iter().for_each(|body| commands.entity(body).despawn());
    (game.score, game.wave) = (0, 0);
    commands.spawn((Ship(0.0), game.ship.clone(), Transform::default()));
}

/// Sends rocks from the border when there are none.
fn next_wave(mut commands: Commands, mut game: ResMut<Game>, rocks: Query<(), With<Rock>>) {
    if rocks.is_empty() {
        game.wave += 1;
        let count = 4 + 2 * game.wave;
        for around in (0..count).map(|i| TAU * i as f32 / count as f32) {
            let at = FIELD * Vec3::new(around.cos(), 0.0, around.sin());
            game.spawn_rock(&mut commands, 0, at, 1.2 * at.cross(Vec3::Y).normalize());
        }
    }
}

impl Game {
    fn spawn_rock(&mut self, commands: &mut Commands, size: usize, at: Vec3, velocity: Vec3) {
        let turn = Vec3::from_array([0; 3].map(|_| 3.0 * self.random.f32() - 1.5));
        commands.spawn((
            Rock(size),
            self.rocks[self.random.usize(0..2)].clone(),
            Transform::from_translation(at)
                .with_rotation(Quat::from_scaled_axis(2.0 * turn))
                .with_scale(Vec3::splat(ROCKS[size].0)),
            LinearVelocity(velocity),
            AngularVelocity(turn),
        ));
    }
}

/// Aims at the nearest rock, while no human steers.
fn fly_alone(
    mut pilot: ResMut<Pilot>,
    ship: Query<&Transform, With<Ship>>,
    rocks: Query<(&Transform, &LinearVelocity), With<Rock>>,
) {
    let (false, Ok(pose)) = (pilot.human, ship.single()) else {
        return;
    };
    // Where a bullet would meet each rock, as the ship sees it.
    let ways = rocks.iter().map(|(rock, velocity)| {
        let way = rock.translation - pose.translation;
        way + velocity.0 * way.length() / BULLET.0
    });
    let Some(way) = ways.min_by(|a, b| a.length().total_cmp(&b.length())) else {
        return;
    };
    let angle = pose.forward().cross(way).y.atan2(pose.forward().dot(way));
    pilot.turn = (4.0 * angle).clamp(-1.0, 1.0);
    pilot.fire = angle.abs() < 0.15;
    pilot.thrust = pilot.fire && way.length() > 6.0;
}

/// Moves the ship, fires, and removes bullets when their time is over.
fn fly(
    mut commands: Commands,
    pilot: Res<Pilot>,
    game: Res<Game>,
    mut ship: Query<(&mut Ship, &Transform, &mut LinearVelocity, &mut AngularVelocity)>,
    mut bullets: Query<(Entity, &mut Bullet)>,
    time: Res<Time>,
) {
    for (mut ship, pose, mut velocity, mut spin) in &mut ship {
        spin.0 = 4.0 * pilot.turn * Vec3::Y;
        if pilot.thrust {
            velocity.0 += 8.0 * time.delta_secs() * pose.forward();
        }
        ship.0 -= time.delta_secs();
        if pilot.fire && ship.0 <= 0.0 {
            ship.0 = BULLET.2;
            commands.spawn((
                Bullet(BULLET.1),
                game.bullet.clone(),
                Transform::from_translation(pose.translation + 0.8 * pose.forward()).with_scale(Vec3::splat(0.18)),
                LinearVelocity(velocity.0 + BULLET.0 * pose.forward()),
            ));
        }
    }
    for (entity, mut bullet) in &mut bullets {
        bullet.0 -= time.delta_secs();
        if bullet.0 < 0.0 {
            commands.entity(entity).despawn();
        }
    }
}

/// Places who left the field on its other side. `Teleport` shows it there at once.
fn wrap(mut commands: Commands, mut bodies: Query<(Entity, &mut Transform), With<RigidBody>>) {
    for (entity, mut pose) in &mut bodies {
        let outside = pose.translation.abs().cmpgt(FIELD + 0.5);
        if outside.any() {
            pose.translation = Vec3::select(outside, -pose.translation.clamp(-FIELD, FIELD), pose.translation);
            commands.entity(entity).insert(Teleport);
        }
    }
}

/// Breaks rocks that bullets hit, and removes the ship if it touches one.
fn hit(
    mut commands: Commands,
    mut started: MessageReader<CollisionStart>,
    mut game: ResMut<Game>,
    rocks: Query<(&Rock, &Transform, &LinearVelocity)>,
    others: Query<Has<Ship>, Without<Rock>>,
) {
    let mut gone = Vec::new();
    for start in started.read() {
        for [rock, other] in [[start.body1, start.body2], [start.body2, start.body1]] {
            let (Ok((Rock(size), pose, velocity)), Ok(is_ship)) = (rocks.get(rock), others.get(other)) else {
                continue;
            };
            // A bullet may hit two rocks in one step.
            if gone.contains(&rock) || gone.contains(&other) {
                continue;
            }
            gone.extend([rock, other]);
            game.score += if is_ship { 0 } else { ROCKS[*size].1 };
            if let Some((diameter, _)) = ROCKS.get(size + 1) {
                let aside = velocity.cross(Vec3::Y).normalize_or(Vec3::X);
                for way in [aside, -aside] {
                    game.spawn_rock(
                        &mut commands,
                        size + 1,
                        pose.translation + 0.55 * diameter * way,
                        velocity.0 + 1.2 * way,
                    );
                }
            }
        }
    }
    gone.into_iter().for_each(|body| commands.entity(body).despawn());
}

/// Prints the score when the ship is lost, and every five seconds. Without a human it then begins again.
fn print(
    mut commands: Commands,
    game: Res<Game>,
    pilot: Res<Pilot>,
    ships: Query<(), With<Ship>>,
    report: Res<StepReport>,
    mut lost: Local<bool>,
    mut exit: MessageWriter<AppExit>,
) {
    let was_lost = std::mem::replace(&mut *lost, ships.is_empty());
    if (*lost && !was_lost) || report.step.is_multiple_of(320) {
        let lost = if *lost { ", and the ship is lost" } else { "" };
        println!("step {}: wave {}, score {}{lost}", report.step, game.wave, game.score);
    }
    if *lost && !pilot.human {
        commands.run_system_cached(start);
    } else if report.step == 320 && game.score == 0 {
        eprintln!("the ship has not hit anything");
        exit.write(AppExit::error());
    }
}

#[cfg(feature = "window")]
fn read_keys(
    mut commands: Commands,
    keys: Res<ButtonInput<KeyCode>>,
    mut pilot: ResMut<Pilot>,
    mut window: Single<&mut Window>,
    game: Res<Game>,
) {
    let [left, right, thrust, fire] =
        [KeyCode::KeyA, KeyCode::KeyD, KeyCode::KeyW, KeyCode::Space].map(|key| keys.pressed(key));
    if pilot.human || left || right || thrust || fire {
        let turn = f32::from(u8::from(left)) - f32::from(u8::from(right));
        *pilot = Pilot {
            human: true,
            turn,
            thrust,
            fire,
        };
    }
    if keys.just_pressed(KeyCode::KeyR) {
        commands.run_system_cached(start);
    }
    window.title = format!("asteroids: {}", game.score);
}
