//! A game: shoot the rocks, which break. Each hit counts. When the ship touches a rock, the game begins anew.
//!
//! * `cargo run --release --example asteroids --features window`: A and D turn, W thrusts, space fires, R begins
//!   anew;
//! * `cargo run --release --example asteroids -- --headless` ends with an error if the ship hits nothing.
//!
//! The ship flies by itself until a key is pressed. The module `common` opens the window: your game uses
//! `DefaultPlugins`.

mod common;

use bevy::prelude::*;
use bevy_faceoff::prelude::*;

/// Half of the field's sides, metres. Who leaves it comes back on the other side.
const FIELD: Vec3 = Vec3::new(9.6, 1.0, 6.0);
/// How many rocks there are at first, and diameters of rocks, from large to small.
const ROCKS: (usize, [f32; 3]) = (6, [2.2, 1.2, 0.7]);
/// Speed of a bullet in m/s, and seconds from shot to shot.
const BULLET: (f32, f32) = (16.0, 0.22);

fn main() -> AppExit {
    let mut app = common::app("asteroids", 64 * 30);
    app.insert_resource(Gravity(Vec3::ZERO))
        .insert_resource(common::View {
            from: Vec3::new(0.0, 14.5, 5.0),
            at: Vec3::ZERO,
        })
        .insert_resource(common::Help("A, D: turn, W: thrust, space: fire, R: again"))
        .add_systems(Startup, (load, send_rocks).chain())
        .add_systems(FixedPreUpdate, send_rocks.run_if(not(any_with_component::<Rock>)))
        .add_systems(FixedUpdate, (aim, fly, wrap).chain())
        .add_systems(FixedLast, check)
        .add_observer(hit)
        .add_observer(begin_anew);
    #[cfg(feature = "window")]
    if !app.world().resource::<common::Options>().headless {
        app.insert_resource(ClearColor(Color::srgb(0.02, 0.03, 0.06)))
            .add_systems(Update, read_keys);
    }
    app.run()
}

#[derive(Resource)]
struct Game {
    bullet: MeshCollider,
    rocks: [MeshCollider; 2],
    random: fastrand::Rng,
}

#[derive(Component, Default)]
#[require(RigidBody, CollisionLayers = CollisionLayers { memberships: 1, filters: 2 }, CollisionEventsEnabled)]
#[require(LockedAxes = LockedAxes::TRANSLATION_Y | LockedAxes::ROTATION_X | LockedAxes::ROTATION_Z)]
struct Ship {
    /// Seconds until it can fire again.
    reload: f32,
    is_steered: bool,
    turn: f32,
    thrust: bool,
    fire: bool,
    hits: u32,
    /// The most hits of all games.
    best: u32,
}

/// The game is lost, or the player wants another one.
#[derive(Event)]
struct BeginAnew;

/// It is fast: without `ContinuousCollision` it could pass through a rock.
#[derive(Component)]
#[require(RigidBody, CollisionLayers = CollisionLayers { memberships: 1, filters: 2 }, CollisionEventsEnabled)]
#[require(ContinuousCollision)]
struct Bullet;

/// The number of its size.
#[derive(Component)]
#[require(RigidBody, CollisionLayers = CollisionLayers { memberships: 2, filters: 3 })]
#[require(LockedAxes = LockedAxes::TRANSLATION_Y, Restitution = Restitution::new(1.0))]
struct Rock(usize);

fn load(mut commands: Commands, assets: Res<AssetServer>, mut meshes: ResMut<Assets<CollisionMesh>>) {
    // A dart: nose, left, notch and right, below and above.
    let outline = [(0.0, -0.65), (-0.42, 0.5), (0.0, 0.25), (0.42, 0.5)];
    let corners = [-0.12, 0.12].map(|y| outline.map(|(x, z)| Vec3::new(x, y, z)));
    let sides = (0..4).flat_map(|i| [[i, (i + 1) % 4, i + 4], [i + 4, (i + 1) % 4, (i + 1) % 4 + 4]]);
    let caps = [[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]];
    let dart = TriMesh::new(corners.concat(), sides.chain(caps).collect()).expect("all indices are of corners");
    let dart = meshes.add(CollisionMesh::new(&dart));
    commands.spawn((Ship::default(), MeshCollider(dart), Transform::default()));
    commands.insert_resource(Game {
        bullet: MeshCollider(assets.load("ball.bake.ron")),
        rocks: ["knot.bake.ron", "torus.bake.ron"].map(|path| MeshCollider(assets.load(path))),
        random: fastrand::Rng::with_seed(1979),
    });
}

/// Sends rocks from the border, a radian apart: so six go round.
fn send_rocks(mut commands: Commands, mut game: ResMut<Game>) {
    for i in 0..ROCKS.0 {
        let at = FIELD * (Quat::from_rotation_y(i as f32) * Vec3::X);
        game.spawn_rock(&mut commands, 0, at, 1.2 * at.cross(Vec3::Y).normalize());
    }
}

impl Game {
    fn spawn_rock(&mut self, commands: &mut Commands, size: usize, at: Vec3, velocity: Vec3) {
        commands.spawn((
            Rock(size),
            self.rocks[self.random.usize(0..2)].clone(),
            Transform::from_translation(at).with_scale(Vec3::splat(ROCKS.1[size])),
            LinearVelocity(velocity),
            AngularVelocity(Vec3::from_array([0; 3].map(|_| 3.0 * self.random.f32() - 1.5))),
        ));
    }
}

/// Aims at the nearest rock, until somebody steers.
fn aim(ship: Single<(&mut Ship, &Transform)>, rocks: Query<&Transform, With<Rock>>) {
    let (mut ship, pose) = ship.into_inner();
    let ways = rocks.iter().map(|rock| rock.translation - pose.translation);
    if let (Some(way), false) = (ways.min_by(|a, b| a.length().total_cmp(&b.length())), ship.is_steered) {
        let angle = pose.forward().cross(way).y.atan2(pose.forward().dot(way));
        ship.turn = (4.0 * angle).clamp(-1.0, 1.0);
        ship.fire = angle.abs() < 0.15;
        ship.thrust = ship.fire && way.length() > 6.0;
    }
}

fn fly(
    mut commands: Commands,
    game: Res<Game>,
    ship: Single<(&mut Ship, &Transform, &mut LinearVelocity, &mut AngularVelocity)>,
    time: Res<Time>,
) {
    let (mut ship, pose, mut velocity, mut spin) = ship.into_inner();
    // It slows down by itself.
    let goal = if ship.thrust { 16.0 * pose.forward() } else { Vec3::ZERO };
    velocity.0 = velocity.lerp(goal, 0.5 * time.delta_secs());
    spin.0 = 4.0 * ship.turn * Vec3::Y;
    ship.reload -= time.delta_secs();
    if ship.fire && ship.reload <= 0.0 {
        ship.reload = BULLET.1;
        commands.spawn((
            Bullet,
            game.bullet.clone(),
            Transform::from_translation(pose.translation + 0.8 * pose.forward()).with_scale(Vec3::splat(0.18)),
            LinearVelocity(velocity.0 + BULLET.0 * pose.forward()),
        ));
    }
}

/// Moves a body that left the field to its other side, where `Teleport` shows it at once. Bullets are despawned.
fn wrap(mut commands: Commands, mut bodies: Query<(Entity, &mut Transform, Has<Bullet>), With<RigidBody>>) {
    for (entity, mut pose, is_bullet) in &mut bodies {
        let outside = pose.translation.abs().cmpgt(FIELD + 0.5);
        if outside.any() && is_bullet {
            commands.entity(entity).despawn();
        } else if outside.any() {
            pose.translation = Vec3::select(outside, -pose.translation.clamp(-FIELD, FIELD), pose.translation);
            commands.entity(entity).insert(Teleport);
        }
    }
}

/// Breaks a rock. The event is that of a bullet or the ship, so `body2` is a rock.
fn hit(
    start: On<CollisionStart>,
    mut commands: Commands,
    mut game: ResMut<Game>,
    mut ship: Single<&mut Ship>,
    rocks: Query<(&Rock, &Transform, &LinearVelocity)>,
    bullets: Query<(), With<Bullet>>,
) {
    // Another bullet may have broken it in the same step.
    let Ok((Rock(size), pose, velocity)) = rocks.get(start.body2) else {
        return;
    };
    if !bullets.contains(start.body1) {
        commands.trigger(BeginAnew);
        return;
    }
    ship.hits += 1;
    ship.best = ship.best.max(ship.hits);
    commands.entity(start.body2).despawn();
    commands.entity(start.body1).try_despawn();
    let aside = velocity.cross(Vec3::Y).normalize_or(Vec3::X);
    for way in [aside, -aside].into_iter().filter(|_| size + 1 < ROCKS.1.len()) {
        let at = pose.translation + 0.55 * ROCKS.1[size + 1] * way;
        game.spawn_rock(&mut commands, size + 1, at, velocity.0 + 1.2 * way);
    }
}

/// Clears the field, to which new rocks then come, and places the ship in the middle.
fn begin_anew(
    _: On<BeginAnew>,
    mut commands: Commands,
    others: Query<Entity, Or<(With<Rock>, With<Bullet>)>>,
    ship: Single<(Entity, &mut Ship, &mut Transform, &mut LinearVelocity)>,
) {
    for other in &others {
        commands.entity(other).try_despawn();
    }
    let (entity, mut ship, mut pose, mut velocity) = ship.into_inner();
    (ship.hits, *pose, velocity.0) = (0, Transform::default(), Vec3::ZERO);
    commands.entity(entity).insert(Teleport);
}

/// Checks that the ship hits something in the first seconds.
fn check(ship: Single<&Ship>, report: Res<StepReport>, mut exit: MessageWriter<AppExit>) {
    if report.step.is_multiple_of(320) && report.step > 0 {
        println!("step {}: {} hits, at best {}", report.step, ship.hits, ship.best);
    }
    if report.step == 320 && ship.best == 0 {
        eprintln!("the ship has not hit anything");
        exit.write(AppExit::error());
    }
}

#[cfg(feature = "window")]
fn read_keys(
    mut commands: Commands,
    keys: Res<ButtonInput<KeyCode>>,
    mut ship: Single<&mut Ship>,
    mut window: Single<&mut Window>,
) {
    if keys.just_pressed(KeyCode::KeyR) {
        commands.trigger(BeginAnew);
    }
    let [left, right, thrust, fire] =
        [KeyCode::KeyA, KeyCode::KeyD, KeyCode::KeyW, KeyCode::Space].map(|key| keys.pressed(key));
    ship.is_steered |= left || right || thrust || fire;
    if ship.is_steered {
        (ship.turn, ship.thrust, ship.fire) = (f32::from(left) - f32::from(right), thrust, fire);
    }
    window.title = format!("asteroids: {} hits, at best {}", ship.hits, ship.best);
}
