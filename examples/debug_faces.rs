//! Two bodies rotate near each other. The faces of collision of each, towards the other, are highlighted.
//!
//! * `cargo run --release --example debug_faces --features window` shows them in a window;
//! * `cargo run --release --example debug_faces -- --headless` prints their number in every eighth step.
//!
//! Faces of collision are the faces that `Culling::FacesOfCollision` tests. They come from the mesh's baked face table.

mod common;

use bevy::prelude::*;
use bevy_faceoff::plugin::assets::CollisionMeshSettings;
use bevy_faceoff::prelude::*;

fn main() -> AppExit {
    let mut app = common::app("debug_faces", 64);
    app.insert_resource(Gravity(Vec3::ZERO)).add_systems(Startup, spawn);
    if app.world().resource::<common::Options>().headless {
        app.add_systems(FixedLast, print);
    } else {
        #[cfg(feature = "window")]
        app.add_systems(Update, paint);
    }
    app.run()
}

/// The other body.
#[derive(Component)]
struct Partner(Entity);

fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
    let [knot, torus] = [
        ("knot", -1.0, Vec3::new(0.3, 0.8, 0.1)),
        ("torus", 1.0, Vec3::new(0.5, -0.4, 0.6)),
    ]
    .map(|(mesh, side, spin)| {
        // A coarse table bakes quickly. These settings override the recipe.
        let bake = |settings: &mut CollisionMeshSettings| {
            settings.bake = Some(BakeSettings {
                faces: true,
                degrees: 3,
                image: 256,
                ..BakeSettings::default()
            });
        };
        let handle = assets
            .load_builder()
            .with_settings(bake)
            .load(format!("{mesh}.bake.ron"));
        let collider = MeshCollider(handle);
        let pose = Transform::from_xyz(1.05 * side, 0.0, 0.0).with_scale(Vec3::splat(1.9));
        commands
            .spawn((
                Name::new(mesh),
                RigidBody::Kinematic,
                collider,
                pose,
                AngularVelocity(spin),
            ))
            .id()
    });
    for (body, partner) in [(knot, torus), (torus, knot)] {
        commands.entity(body).insert(Partner(partner));
        #[cfg(feature = "window")]
        commands
            .entity(body)
            .insert(bevy_faceoff::plugin::debug::ShowFacesTowards(partner));
    }
}

/// Calls `each` with each body, its mesh and its faces of collision towards its partner.
fn for_each_lit(
    bodies: &Query<(Entity, &Partner, &MeshCollider, &Transform)>,
    meshes: &Assets<CollisionMesh>,
    mut each: impl FnMut(Entity, &CollisionMesh, bevy_faceoff::projection::Group),
) {
    for (entity, partner, collider, pose) in bodies {
        let Ok((_, _, other, other_pose)) = bodies.get(partner.0) else {
            continue;
        };
        // Meshes are missing until they are loaded.
        let (Some(mesh), Some(other)) = (meshes.get(&collider.0), meshes.get(&other.0)) else {
            continue;
        };
        let center = other_pose.transform_point(other.mass.center);
        let lit = mesh.faces_towards(pose, center).expect("they have a table");
        each(entity, mesh, lit);
    }
}

/// Prints the number of highlighted faces in every eighth step.
fn print(
    bodies: Query<(Entity, &Partner, &MeshCollider, &Transform)>,
    meshes: Res<Assets<CollisionMesh>>,
    names: Query<&Name>,
    report: Res<StepReport>,
) {
    if report.step % 8 != 1 {
        return;
    }
    print!("step {:3}:", report.step);
    for_each_lit(&bodies, &meshes, |entity, mesh, lit| {
        let name = names.get(entity).expect("both have names");
        print!("  {name} {:3} of {} faces lit", lit.len(), mesh.mesh.triangles().len());
    });
    println!();
}

/// Highlights faces by vertex colours.
#[cfg(feature = "window")]
fn paint(
    bodies: Query<(Entity, &Partner, &MeshCollider, &Transform)>,
    baked: Res<Assets<CollisionMesh>>,
    drawn: Query<&Mesh3d>,
    mut meshes: ResMut<Assets<Mesh>>,
) {
    // Vertex colours multiply the colour of the material.
    const DARK: [f32; 4] = [0.25, 0.25, 0.25, 1.0];
    const LIT: [f32; 4] = [2.0, 2.0, 2.0, 1.0];
    for_each_lit(&bodies, &baked, |entity, mesh, lit| {
        let Some(mut drawn) = drawn.get(entity).ok().and_then(|drawn| meshes.get_mut(&drawn.0)) else {
            return;
        };
        let mut colors = vec![DARK; 3 * mesh.mesh.triangles().len()];
        for t in lit {
            colors[3 * t as usize..][..3].fill(LIT);
        }
        drawn.insert_attribute(Mesh::ATTRIBUTE_COLOR, colors);
    });
}
