//! Tori of many sizes fly in a box and bounce: the scene of Aly & Elawady 2010.
//!
//! * `cargo run --release --example tori_in_a_box --features window` shows it in a window: keys choose the response to
//!   collisions and the culling of triangles;
//! * `cargo run --release --example tori_in_a_box --features window -- --bodies 2200` is figure 6 of the paper. Add
//!   `--backend cpu` or `--backend gpu` to compare both;
//! * `cargo run --release --example tori_in_a_box -- --headless` prints how many pairs touch, and what a step takes. It
//!   ends with an error if none do, or if a torus leaves the box.
//!
//! The module `common` opens the window. In your own game use `DefaultPlugins` for that.

mod common;

use bevy::prelude::*;
use bevy_faceoff::prelude::*;

/// How many tori, unless `--bodies` says otherwise.
const TORI: usize = 150;
/// The largest scene of the paper: so many tori, and half of the box's side in metres. Smaller boxes are as full.
const PAPER: (usize, f32) = (2200, 11.25);
/// Smallest and largest diameter, metres.
const DIAMETERS: (f32, f32) = (0.25, 2.0);
/// Largest speed along each axis, m/s.
const SPEED: f32 = 2.0;
const STEPS: u32 = 64 * 5;

fn main() -> AppExit {
    let mut app = common::app("tori in a box", STEPS);
    let options = app.world().resource::<common::Options>().clone();
    let tori = options.bodies.unwrap_or(TORI);
    let half = PAPER.1 * (tori as f32 / PAPER.0 as f32).cbrt().max(0.15);
    app.insert_resource(Gravity(Vec3::ZERO))
        .insert_resource(Scene { tori, half })
        // One impulse for each pair that touches. It is the fastest, and does not push apart what overlaps at the
        // start.
        .insert_resource(Response::Impulse)
        .insert_resource(common::View {
            from: half * Vec3::new(1.4, 1.0, 2.7),
            at: Vec3::ZERO,
        })
        .insert_resource(common::Help(
            "1: pass through, 2: impulses, 3: contacts, F: faces of collision",
        ))
        .add_systems(Startup, spawn);
    if options.headless {
        app.init_resource::<Count>().add_systems(FixedLast, print);
    } else {
        #[cfg(feature = "window")]
        app.add_systems(Update, (choose, draw_box));
    }
    app.run()
}

#[derive(Resource, Clone, Copy)]
struct Scene {
    tori: usize,
    /// Half of the box's side, metres.
    half: f32,
}

fn spawn(mut commands: Commands, assets: Res<AssetServer>, scene: Res<Scene>) {
    let Scene { tori, half } = *scene;
    let torus = MeshCollider(assets.load("torus.bake.ron"));
    let mut random = fastrand::Rng::with_seed(2010);
    let mut between = |low: f32, high: f32| low + (high - low) * random.f32();
    for _ in 0..tori {
        let diameter = between(DIAMETERS.0, DIAMETERS.1);
        let mut vector = |reach: f32| Vec3::from_array([0; 3].map(|_| between(-reach, reach)));
        commands.spawn((
            RigidBody::Dynamic,
            torus.clone(),
            Transform::from_translation(vector(half - 0.5 * diameter))
                .with_rotation(Quat::from_scaled_axis(vector(3.0)))
                .with_scale(Vec3::splat(diameter)),
            LinearVelocity(vector(SPEED)),
            AngularVelocity(vector(1.0)),
            Restitution::new(1.0),
        ));
    }
    common::spawn_box(&mut commands, half);
}

/// What has happened so far.
#[derive(Resource, Default)]
struct Count {
    started: usize,
}

/// Prints once a second what touches, and how fast the tori are.
fn print(
    mut count: ResMut<Count>,
    mut started: MessageReader<CollisionStart>,
    collisions: Res<Collisions>,
    tori: Query<(&Transform, &LinearVelocity)>,
    report: Res<StepReport>,
    scene: Res<Scene>,
    mut exit: MessageWriter<AppExit>,
) {
    count.started += started.read().count();
    if !report.step.is_multiple_of(64) {
        return;
    }
    let speed: f32 = tori.iter().map(|(_, velocity)| velocity.length()).sum();
    println!(
        "step {}: {} pairs touch, {} collisions since the start, mean speed {:.2} m/s, {:.1} ms a step",
        report.step,
        collisions.len(),
        count.started,
        speed / scene.tori as f32,
        1e3 * report.total.as_secs_f32()
    );
    let inside = |at: Vec3| at.abs().max_element() < scene.half;
    let outside = tori.iter().filter(|(pose, _)| !inside(pose.translation)).count();
    if outside > 0 || count.started == 0 {
        eprintln!(
            "{outside} tori are outside of the box, after {} collisions",
            count.started
        );
        exit.write(AppExit::error());
    }
}

/// Keys choose what collisions do.
#[cfg(feature = "window")]
fn choose(keys: Res<ButtonInput<KeyCode>>, mut response: ResMut<Response>, mut culling: ResMut<Culling>) {
    for (key, choice) in [
        (KeyCode::Digit1, Response::None),
        (KeyCode::Digit2, Response::Impulse),
        (KeyCode::Digit3, Response::Contacts),
    ] {
        if keys.just_pressed(key) {
            *response = choice;
            info!("{choice:?}");
        }
    }
    if keys.just_pressed(KeyCode::KeyF) {
        *culling = match *culling {
            Culling::Exact => Culling::FacesOfCollision,
            _ => Culling::Exact,
        };
        info!("{:?}", *culling);
    }
}

#[cfg(feature = "window")]
fn draw_box(mut gizmos: Gizmos, scene: Res<Scene>) {
    gizmos.cube(
        Transform::from_scale(Vec3::splat(2.0 * scene.half)),
        Color::srgb(0.9, 0.95, 1.0),
    );
}
