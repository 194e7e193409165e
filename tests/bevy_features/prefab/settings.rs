//! Settings by name and in the file.

use super::*;
use crate::asset_app::write;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::plugin::prefab::PrefabFault;

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
    let hierarchy = hierarchy
        .with_collider_for_name("BMesh", ColliderSettings::default())
        .with_collider_for_name("C", ColliderSettings::default());
    sim.set(root, hierarchy);
    let told = ready_again(&mut sim, root, 2);
    assert_eq!(told.colliders, [b, c]);
    assert!(!has::<MeshCollider>(&sim, a) && !has::<Density>(&sim, b) && has::<Friction>(&sim, b));

    // A collider that goes is a change, too.
    let hierarchy = sim.get::<MeshColliderHierarchy>(root).without_collider_for_name("C");
    sim.set(root, hierarchy);
    let told = ready_again(&mut sim, root, 3);
    assert!(told.colliders.is_empty() && told.errors.is_empty());
    assert!(!has::<MeshCollider>(&sim, c) && has::<MeshCollider>(&sim, b));
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
            node(
                4,
                json!({"faceoff_densty": 2.0, "faceoff_restitution": 0.5, "faceoff_rounding": 0.1}),
            ),
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
    let mesh = sim.get::<MeshCollider>(typo).0;
    let meshes = sim.app.world().resource::<Assets<CollisionMesh>>();
    assert_eq!(meshes.get(&mesh).unwrap().settings.rounding, 0.1);
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
