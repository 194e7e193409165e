//! Scenes of Bevy's glTF loader that go in as they are.

use crate::app::{Sim, assert_near, assert_told};
use crate::asset_app::{plain, update_until, write};
use crate::gltf_files::{Gltf, U16};
use bevy::ecs::message::Messages;
use bevy::gltf::GltfPlugin;
use bevy::image::ImagePlugin;
use bevy::mesh::MeshPlugin;
use bevy::mesh::skinning::SkinnedMeshInverseBindposes;
use bevy::prelude::*;
use bevy::world_serialization::WorldSerializationPlugin;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::plugin::prefab::{PrefabError, PrefabFault};
use bevy_faceoff::prelude::*;
use serde_json::{Value, json};
use std::path::Path;

/// What [`MeshColliderHierarchyReady`] told.
#[derive(Resource, Default)]
struct Told(Vec<MeshColliderHierarchyReady>);

/// A simulation that loads scenes from `folder`.
fn sim(folder: &Path) -> Sim {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        FaceoffHeadlessPlugins {
            assets: plain(folder),
            step: StepPlugin {
                backend: Backend::Cpu,
                threads: 1,
                ..default()
            },
        },
        ImagePlugin::default(),
        MeshPlugin,
        WorldSerializationPlugin,
    ))
    .init_asset::<SkinnedMeshInverseBindposes>()
    .add_plugins(GltfPlugin::default())
    .init_resource::<Told>()
    .add_observer(|ready: On<MeshColliderHierarchyReady>, mut told: ResMut<Told>| {
        told.0.push(ready.event().clone());
    });
    Sim::of(app)
}

/// Spawns the first scene of a file.
fn spawn(sim: &mut Sim, file: &str, bundle: impl Bundle) -> Entity {
    let scene = sim.world().resource::<AssetServer>().load(format!("{file}#Scene0"));
    sim.spawn((WorldAssetRoot(scene), bundle))
}

/// Waits until the colliders are there `times` times.
#[track_caller]
fn ready_again(sim: &mut Sim, root: Entity, times: usize) -> MeshColliderHierarchyReady {
    let mut found = None;
    update_until(&mut sim.app, |app| {
        let told = &app.world().resource::<Told>().0;
        found = told.iter().filter(|ready| ready.entity == root).nth(times - 1).cloned();
        found.is_some()
    });
    found.unwrap()
}

#[track_caller]
fn ready(sim: &mut Sim, root: Entity) -> MeshColliderHierarchyReady {
    ready_again(sim, root, 1)
}

/// The entity of this name.
#[track_caller]
fn entity(sim: &mut Sim, name: &str) -> Entity {
    let world = sim.world();
    let mut names = world.query::<(Entity, &Name)>();
    let found: Vec<_> = names.iter(world).filter(|(_, own)| own.as_str() == name).collect();
    assert_eq!(found.len(), 1, "{name}");
    found[0].0
}

fn has<C: Component>(sim: &Sim, entity: Entity) -> bool {
    sim.app.world().get::<C>(entity).is_some()
}

fn collision_mesh(sim: &Sim, entity: Entity) -> CollisionMesh {
    let MeshCollider(handle) = sim.get(entity);
    sim.app
        .world()
        .resource::<Assets<CollisionMesh>>()
        .get(&handle)
        .unwrap()
        .clone()
}

/// Number of collision meshes that were made since the last call.
fn made(sim: &mut Sim) -> usize {
    let mut events = sim.world().resource_mut::<Messages<AssetEvent<CollisionMesh>>>();
    events
        .drain()
        .filter(|event| matches!(event, AssetEvent::Added { .. }))
        .count()
}

fn faults(errors: &[PrefabError]) -> Vec<(String, String)> {
    errors
        .iter()
        .map(|error| (error.node.clone(), error.to_string()))
        .collect()
}

/// A file with a node for each mesh, of the same name as the mesh.
fn nodes(meshes: &[(&str, &TriMesh, Value)]) -> Gltf {
    let mut gltf = Gltf::new();
    for (name, mesh, node) in meshes {
        let primitive = gltf.primitive(mesh, U16);
        let mesh = gltf.mesh(&format!("{name}Mesh"), vec![primitive]);
        let mut node = node.clone();
        (node["name"], node["mesh"]) = (json!(name), json!(mesh));
        gltf.root_node(node);
    }
    gltf
}

/// A cart: a box, and a ring on it, which is a child of a node without a mesh.
fn cart() -> Gltf {
    let mut gltf = nodes(&[("Box", &shapes::cube(1.0), json!({"scale": [2.0, 0.5, 1.0]}))]);
    let primitive = gltf.primitive(&shapes::torus_240(), U16);
    let ring = gltf.mesh("RingMesh", vec![primitive]);
    let ring =
        gltf.node(json!({"name": "Ring", "mesh": ring, "translation": [0.5, 0.0, 0.0], "scale": [0.5, 0.5, 0.5]}));
    gltf.root_node(json!({"name": "Top", "translation": [0.0, 1.0, 0.25], "children": [ring]}));
    gltf
}

/// Both meshes as one.
fn merged() -> TriMesh {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for (mesh, scale, offset) in [
        (shapes::cube(1.0), Vec3::new(2.0, 0.5, 1.0), Vec3::ZERO),
        (shapes::torus_240(), Vec3::splat(0.5), Vec3::new(0.5, 1.0, 0.25)),
    ] {
        let first = vertices.len() as u32;
        vertices.extend(mesh.vertices().iter().map(|&v| scale * v + offset));
        triangles.extend(mesh.triangles().iter().map(|t| t.map(|i| i + first)));
    }
    TriMesh::new(vertices, triangles).unwrap()
}

/// The pose in the world, from the `Transform`s.
fn in_world(sim: &Sim, entity: Entity) -> GlobalTransform {
    let own = GlobalTransform::from(sim.get::<Transform>(entity));
    match sim.app.world().get::<ChildOf>(entity) {
        Some(parent) => in_world(sim, parent.parent()) * own,
        None => own,
    }
}

#[test]
fn a_scene_under_a_moved_turned_and_scaled_parent_is_one_body() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "cart.glb", cart().for_bevy().glb());
    let mut sim = sim(folder.path());
    let above = Transform {
        translation: Vec3::new(3.0, 10.0, -2.0),
        rotation: Quat::from_rotation_y(0.7) * Quat::from_rotation_x(0.3),
        scale: Vec3::new(2.0, 1.0, 0.5),
    };
    let level = sim.spawn(above);
    let hierarchy = (RigidBody::Dynamic, MeshColliderHierarchy::default(), ChildOf(level));
    let body = spawn(&mut sim, "cart.glb", hierarchy);
    let told = ready(&mut sim, body);
    assert!(told.errors.is_empty(), "{:?}", told.errors);
    let parts = ["BoxMesh", "RingMesh"].map(|name| entity(&mut sim, name));
    assert_eq!(told.colliders, parts);

    // The same as one mesh in the world.
    let mesh = sim.mesh(&merged());
    let far = 20.0 * Vec3::X;
    let one = sim.spawn((
        RigidBody::Dynamic,
        mesh,
        above.with_translation(above.translation + far),
    ));
    sim.step(1);
    assert_eq!((sim.report().bodies, sim.rejected.len()), (2, 0), "{:?}", sim.rejected);
    let center = |body| in_world(&sim, body).transform_point(*sim.get::<ComputedCenterOfMass>(body));
    assert_near(center(body) + far, center(one), 1e-4);
    // Velocities after impulses are columns of the inverses of mass and inertia.
    for axis in Vec3::AXES {
        for (impulse, angular_impulse) in [(axis, Vec3::ZERO), (Vec3::ZERO, axis)] {
            let answer = [body, one].map(|body| {
                let still = (LinearVelocity::default(), AngularVelocity::default());
                let forces = ExternalForces {
                    impulse,
                    angular_impulse,
                    ..default()
                };
                sim.set(body, (still, forces));
                body
            });
            sim.step(1);
            let [[v, w], [v_one, w_one]] = answer.map(|body| [sim.velocity(body), sim.spin(body)]);
            assert!((v - v_one).length() <= 1e-4 * v_one.length(), "{v} {v_one}");
            assert!((w - w_one).length() <= 1e-4 * w_one.length(), "{w} {w_one}");
        }
    }
    // Contacts name the children.
    let cube = sim.mesh(&shapes::cube(1.0));
    let at = in_world(&sim, parts[1]).transform_point(0.5 * Vec3::X);
    let probe = sim.spawn((
        RigidBody::Dynamic,
        Sensor,
        cube,
        Transform::from_translation(at).with_scale(Vec3::splat(0.3)),
    ));
    sim.step(1);
    let hit = sim.collisions().get(parts[1], probe).expect("it is in the ring");
    assert!([hit.body1, hit.body2].contains(&body));
}

#[test]
fn without_a_body_a_scene_is_static() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "cart.glb", cart().for_bevy().glb());
    let mut sim = sim(folder.path());
    let root = spawn(&mut sim, "cart.glb", MeshColliderHierarchy::default());
    ready(&mut sim, root);
    sim.world().insert_resource(Gravity::default());
    let ball = sim.mesh(&shapes::ball_320());
    let ball = sim.spawn((
        RigidBody::Dynamic,
        ball,
        Transform::from_xyz(0.0, 0.6, 0.0).with_scale(Vec3::splat(0.1)),
    ));
    sim.step(64);
    let part = entity(&mut sim, "BoxMesh");
    assert!(sim.touch(part, ball));
    assert!((sim.position(ball).y - 0.35).abs() < 0.01, "{}", sim.position(ball));
}

#[test]
fn settings_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let cube = shapes::cube(1.0);
    let at = |x: i32| json!({"translation": [2 * x, 0, 0]});
    let scene = nodes(&[("A", &cube, at(0)), ("B", &cube, at(1)), ("C", &cube, at(2))]);
    write(folder.path(), "abc.glb", scene.for_bevy().glb());
    let mut sim = sim(folder.path());
    let settings = |density| ColliderSettings {
        density: Some(Density(density)),
        ..default()
    };
    let hierarchy = MeshColliderHierarchy::new(settings(2.0))
        .with_collider_for_name("BMesh", settings(3.0))
        .with_collider_for_name(
            "B",
            ColliderSettings {
                body: Some(RigidBody::Dynamic),
                mass: Some(Mass(7.0)),
                friction: Some(Friction::new(0.0)),
                ..default()
            },
        )
        .without_collider_for_name("C");
    let root = spawn(&mut sim, "abc.glb", hierarchy);
    let told = ready(&mut sim, root);
    let [a, b, c] = ["AMesh", "BMesh", "CMesh"].map(|name| entity(&mut sim, name));
    assert_eq!(told.colliders, [a, b]);
    assert_eq!(sim.get::<Density>(a), Density(2.0));
    assert_eq!(
        (sim.get::<Density>(b), sim.get::<Friction>(b)),
        (Density(3.0), Friction::new(0.0))
    );
    assert!(!has::<MeshCollider>(&sim, c));
    let body = entity(&mut sim, "B");
    assert_eq!(
        (sim.get::<RigidBody>(body), sim.get::<Mass>(body)),
        (RigidBody::Dynamic, Mass(7.0))
    );
    sim.step(1);
    assert_eq!(sim.report().bodies, 2);

    // Settings that change are followed.
    let mut hierarchy: MeshColliderHierarchy = sim.get(root);
    hierarchy.default = None;
    let hierarchy = hierarchy.with_collider_for_name("C", ColliderSettings::default());
    sim.set(root, hierarchy);
    let told = ready_again(&mut sim, root, 2);
    assert_eq!(told.colliders, [b, c]);
    assert!(!has::<MeshCollider>(&sim, a) && !has::<Density>(&sim, b));
}

#[test]
fn properties_in_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let cube = shapes::cube(1.0);
    let node = |x: i32, extras: Value| json!({"translation": [2 * x, 0, 0], "extras": extras});
    let mut scene = nodes(&[
        ("Plain", &cube, node(0, json!({"height": 3}))),
        ("None", &cube, node(1, json!({"faceoff": "none"}))),
        (
            "Zone",
            &cube,
            node(2, json!({"faceoff": "sensor", "faceoff_layers": [1, 2]})),
        ),
        (
            "Crate",
            &cube,
            node(
                3,
                json!({"faceoff_body": "dynamic", "faceoff_mass": 4.5, "faceoff_friction": 0.25}),
            ),
        ),
        (
            "Typo",
            &cube,
            node(4, json!({"faceoff_densty": 2.0, "faceoff_restitution": 0.5})),
        ),
    ]);
    scene.json["meshes"][3]["extras"] =
        json!({"faceoff_density": 9.0, "faceoff_friction": 1.0, "faceoff_body": "static"});
    // An empty object that makes what is below it a body.
    let below = scene.node(json!({"name": "Below", "mesh": 0, "translation": [0, 5, 0]}));
    scene.root_node(json!({"name": "Group", "children": [below], "extras": {"faceoff_body": "kinematic"}}));
    scene.root_node(json!({"name": "Lost", "extras": {"faceoff_density": 1.0}}));
    write(folder.path(), "scene.glb", scene.for_bevy().glb());
    let mut sim = sim(folder.path());
    let root = spawn(&mut sim, "scene.glb", MeshColliderHierarchy::default());
    let told = ready(&mut sim, root);
    let mut errors = faults(&told.errors);
    errors.sort();
    let expected = [
        ("Crate", "faceoff_body"),
        ("Lost", "faceoff_density"),
        ("Typo", "faceoff_densty"),
    ];
    assert_eq!(errors.len(), expected.len(), "{errors:?}");
    for ((node, text), (expected, property)) in errors.iter().zip(expected) {
        assert_eq!(node, expected);
        assert!(
            [expected, property, "scene.glb"].iter().all(|word| text.contains(word)),
            "{text}"
        );
    }
    assert!(
        told.errors
            .iter()
            .all(|error| matches!(error.fault, PrefabFault::Property(_)))
    );

    let [none, zone, chest, typo] =
        ["NoneMesh", "ZoneMesh", "CrateMesh", "TypoMesh"].map(|name| entity(&mut sim, name));
    assert!(!has::<MeshCollider>(&sim, none));
    assert!(has::<Sensor>(&sim, zone));
    assert_eq!(sim.get::<CollisionLayers>(zone).memberships, 6);
    assert_eq!(
        (sim.get::<Density>(chest), sim.get::<Friction>(chest)),
        (Density(9.0), Friction::new(0.25))
    );
    assert_eq!(sim.get::<Restitution>(typo), Restitution::new(0.5));
    let [body, group] = ["Crate", "Group"].map(|name| entity(&mut sim, name));
    assert_eq!(
        (sim.get::<RigidBody>(body), sim.get::<Mass>(body)),
        (RigidBody::Dynamic, Mass(4.5))
    );
    assert_eq!(sim.get::<RigidBody>(group), RigidBody::Kinematic);
    sim.world().insert_resource(Gravity::default());
    sim.set(group, LinearVelocity(Vec3::Y));
    sim.step(16);
    assert!(sim.position(body).y < -0.1 && sim.position(group).y > 0.2);
    assert!(sim.rejected.is_empty(), "{:?}", sim.rejected);
}
