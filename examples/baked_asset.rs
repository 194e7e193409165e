//! A game that loads a mesh which was baked ahead of time, with its face table.
//!
//! ```sh
//! cargo run --release --features cli -- bake assets/knot.bake.ron -o assets/baked
//! cargo run --release --features window --example baked_asset
//! cargo run --release --features cli --example baked_asset -- --headless
//! ```
//!
//! The first command writes `assets/baked/knot.faceoff`, with the settings of the recipe. Without it the example loads
//! the recipe itself, `assets/knot.bake.ron`, which bakes on load: the same mesh, later. It prints how long it has
//! waited, and how the knots fare. It ends with an error if none of them collide.
//!
//! Bevy's asset processor does the same while you develop: see the example `bake_assets`. The module `common` opens the
//! window. In your own game use `DefaultPlugins` for that.

mod common;

use bevy::asset::LoadState;
use bevy::prelude::*;
use bevy_faceoff::prelude::*;
use std::path::Path;
use std::time::Instant;

const BAKED: &str = "baked/knot.faceoff";
const RECIPE: &str = "knot.bake.ron";
const KNOTS: usize = 60;
/// Where the knots begin: on a sphere of this radius, metres.
const RADIUS: f32 = 5.0;

fn main() -> AppExit {
    let mut app = common::app("baked asset", 64 * 8);
    app.insert_resource(Gravity(Vec3::ZERO))
        .insert_resource(Response::Impulse)
        // What the table is for: only faces that the other body sees are tested.
        .insert_resource(Culling::FacesOfCollision)
        .insert_resource(common::View {
            from: Vec3::new(3.0, 4.0, 12.0),
            at: Vec3::ZERO,
        })
        .add_systems(Startup, load)
        .add_systems(Update, start.run_if(any_with_component::<common::NotReady>))
        .add_systems(FixedLast, print);
    app.run()
}

/// Keeps the mesh in memory, and remembers when the game began to wait for it.
#[derive(Resource)]
struct Knot {
    mesh: Handle<CollisionMesh>,
    path: &'static str,
    since: Instant,
}

fn load(mut commands: Commands, assets: Res<AssetServer>) {
    // A game knows what it ships. This one has to look.
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
    let path = if folder.join(BAKED).exists() {
        BAKED
    } else {
        println!("not baked yet: cargo run --release --features cli -- bake assets/{RECIPE} -o assets/baked");
        RECIPE
    };
    commands.insert_resource(Knot {
        mesh: assets.load(path),
        path,
        since: Instant::now(),
    });
    // The examples' steps wait for it. A game would have a state for its loading screen.
    commands.spawn(common::NotReady);
}

/// Spawns the knots as soon as the mesh is there.
fn start(
    mut commands: Commands,
    knot: Res<Knot>,
    assets: Res<AssetServer>,
    meshes: Res<Assets<CollisionMesh>>,
    loading: Query<Entity, With<common::NotReady>>,
    mut exit: MessageWriter<AppExit>,
) {
    if let LoadState::Failed(error) = assets.load_state(&knot.mesh) {
        eprintln!("{error}");
        exit.write(AppExit::error());
    }
    let Some(mesh) = meshes.get(&knot.mesh) else { return };
    let table = if mesh.faces.is_some() { "with" } else { "without" };
    let waited = knot.since.elapsed().as_millis();
    println!("{}: {waited} ms, {table} a table of faces of collision", knot.path);
    for i in 0..KNOTS {
        // Evenly on a sphere: the golden angle from one to the next.
        let height = 1.0 - 2.0 * (i as f32 + 0.5) / KNOTS as f32;
        let (sin, cos) = (2.399_963 * i as f32).sin_cos();
        let out = Vec3::new(
            cos * (1.0 - height * height).sqrt(),
            height,
            sin * (1.0 - height * height).sqrt(),
        );
        commands.spawn((
            RigidBody::Dynamic,
            MeshCollider(knot.mesh.clone()),
            Transform::from_translation(RADIUS * out).with_rotation(Quat::from_scaled_axis(3.0 * out)),
            LinearVelocity(-1.5 * out),
            AngularVelocity(out.zxy()),
            Restitution::new(0.9),
        ));
    }
    common::spawn_box(&mut commands, RADIUS + 0.6);
    loading.iter().for_each(|entity| commands.entity(entity).despawn());
}

/// Prints once a second what touches. If no pair was approximate, the step tested all triangles.
fn print(
    mut started: MessageReader<CollisionStart>,
    mut count: Local<usize>,
    report: Res<StepReport>,
    mut exit: MessageWriter<AppExit>,
) {
    *count += started.read().count();
    if report.step == 0 || !report.step.is_multiple_of(64) {
        return;
    }
    println!(
        "step {}: {} collisions so far, {} pairs touch, {} are tested by the table",
        report.step, *count, report.touching_pairs, report.approximate_pairs
    );
    if report.step == 64 * 8 && *count == 0 {
        eprintln!("no knots collide");
        exit.write(AppExit::error());
    }
}
