//! A scanner casts 180 rays over turning meshes, and knows exactly which face each of them hits.
//!
//! * `cargo run --release --example rays --features window` draws the rays and the faces that they hit;
//! * `cargo run --release --example rays -- --headless` prints what they hit.
//!
//! The module `common` opens the window. In your own game use `DefaultPlugins` for that.

mod common;

use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy_faceoff::prelude::*;
use std::f32::consts::TAU;

const RAYS: usize = 180;
/// Where the rays begin.
const EYE: Vec3 = Vec3::new(0.0, 1.4, 0.0);

fn main() -> AppExit {
    let mut app = common::app("rays", 64 * 3);
    app.init_resource::<Scan>()
        .add_systems(Startup, spawn)
        .add_systems(FixedLast, scan);
    if app.world().resource::<common::Options>().headless {
        app.add_systems(FixedLast, print.after(scan));
    } else {
        #[cfg(feature = "window")]
        app.add_systems(Update, draw);
    }
    app.run()
}

/// What the rays hit in this step.
#[derive(Resource, Default)]
struct Scan {
    hits: Vec<RayHitData>,
}

fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
    let meshes = ["knot", "torus", "ball", "ring", "cube", "knot", "ring", "torus"];
    for (i, mesh) in meshes.into_iter().enumerate() {
        let angle = i as f32 / meshes.len() as f32 * TAU;
        let (sin, cos) = angle.sin_cos();
        commands.spawn((
            Name::new(format!("{mesh} {i}")),
            RigidBody::Kinematic,
            MeshCollider(assets.load(format!("{mesh}.bake.ron"))),
            Transform::from_xyz(1.6 * cos, 0.1, 1.6 * sin).with_scale(Vec3::splat(0.8)),
            AngularVelocity(Vec3::new(0.4, 0.9 * cos, 0.7 * sin)),
        ));
    }
    commands.spawn((
        Name::new("floor"),
        MeshCollider(assets.load("cube.bake.ron")),
        Transform::from_xyz(0.0, -1.0, 0.0).with_scale(Vec3::new(8.0, 0.5, 8.0)),
    ));
}

/// Casts a cone of rays that widens and narrows.
fn scan(world: SpatialQuery, mut scan: ResMut<Scan>, time: Res<Time>) {
    let slope = 0.8 + 0.25 * (0.7 * time.elapsed_secs()).sin();
    let everything = SpatialQueryFilter::default();
    scan.hits.clear();
    for i in 0..RAYS {
        let (sin, cos) = (i as f32 / RAYS as f32 * TAU).sin_cos();
        let direction = Dir3::new(Vec3::new(cos, -slope, sin)).expect("not zero");
        scan.hits.extend(world.cast_ray(EYE, direction, 20.0, &everything));
    }
}

/// Prints twice a second how many rays hit what.
fn print(scan: Res<Scan>, report: Res<StepReport>, names: Query<&Name>) {
    if report.step % 32 != 1 {
        return;
    }
    let mut hits: HashMap<Entity, (usize, Vec<u32>)> = HashMap::default();
    for hit in &scan.hits {
        let (count, faces) = hits.entry(hit.body).or_default();
        *count += 1;
        faces.extend(hit.face.filter(|face| !faces.contains(face)));
    }
    let mut lines: Vec<_> = (hits.iter())
        .map(|(body, (count, faces))| {
            let name = names.get(*body).map_or("?", |name| name);
            format!("{name}: {count} rays on {} faces", faces.len())
        })
        .collect();
    lines.sort();
    println!("step {}: {}", report.step, lines.join("; "));
}

/// Draws every ray as far as it goes, and the edges of the faces.
#[cfg(feature = "window")]
fn draw(
    scan: Res<Scan>,
    colliders: Query<(&MeshCollider, &Transform)>,
    meshes: Res<Assets<CollisionMesh>>,
    mut gizmos: Gizmos,
) {
    for hit in &scan.hits {
        gizmos.line(EYE, hit.point, Color::srgba(1.0, 0.9, 0.4, 0.25));
        gizmos.arrow(hit.point, hit.point + 0.08 * hit.normal, Color::WHITE);
        let Ok((collider, transform)) = colliders.get(hit.collider) else {
            continue;
        };
        let face = meshes.get(&collider.0).zip(hit.face);
        if let Some(corners) = face.and_then(|(baked, face)| baked.mesh.input_face(face)) {
            let corners = corners.map(|corner| transform.transform_point(corner));
            gizmos.linestrip(corners.into_iter().cycle().take(4), Color::srgb(1.0, 0.3, 0.2));
        }
    }
}
