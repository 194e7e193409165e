//! Scenes that change after they were spawned.

use super::*;
use crate::app::assert_told;
use crate::asset_app::write;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy_faceoff::geometry::shapes;

/// A mesh as Bevy has it.
fn drawn(mesh: &TriMesh) -> Mesh {
    let positions: Vec<[f32; 3]> = mesh.vertices().iter().map(|v| v.to_array()).collect();
    let indices = Indices::U32(mesh.triangles().as_flattened().to_vec());
    Mesh::new(PrimitiveTopology::TriangleList, default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
        .with_inserted_indices(indices)
}

fn triangles(sim: &Sim, entity: Entity) -> usize {
    collision_mesh(sim, entity).mesh.triangles().len()
}

/// A table, whose top and leg are nodes of a scene, with a body on the top. Root, top, leg and body.
fn table(sim: &mut Sim, folder: &Path) -> [Entity; 4] {
    let cube = shapes::cube(1.0);
    let top = json!({"translation": [0.0, 1.1, 0.0], "scale": [3.0, 0.2, 3.0]});
    let leg = json!({"translation": [0.0, 0.5, 0.0]});
    write(
        folder,
        "table.glb",
        nodes(&[("Top", &cube, top), ("Leg", &cube, leg)]).for_bevy().glb(),
    );
    let hierarchy = (RigidBody::Dynamic, MeshColliderHierarchy::default());
    let root = spawn(sim, "table.glb", (hierarchy, Transform::from_xyz(0.0, 0.001, 0.0)));
    ready(sim, root);
    let cube = sim.mesh(&cube);
    let floor = Transform::from_xyz(0.0, -0.5, 0.0).with_scale(Vec3::new(90.0, 1.0, 90.0));
    sim.spawn((cube.clone(), floor));
    let load = Transform::from_xyz(1.1, 1.302, 0.0).with_scale(Vec3::splat(0.2));
    let load = sim.spawn((RigidBody::Dynamic, cube, load));
    sim.world().insert_resource(Gravity::default());
    sim.step(16);
    let [top, leg] = ["TopMesh", "LegMesh"].map(|name| entity(sim, name));
    assert!(sim.touch(top, load));
    [root, top, leg, load]
}

/// Changes the table until the load falls, or at once; every start has its end.
fn the_load_falls(change: impl Fn(&mut Sim, [Entity; 4])) {
    let folder = tempfile::tempdir().unwrap();
    let mut sim = sim(folder.path()).exact();
    let entities @ [_, top, _, load] = table(&mut sim, folder.path());
    let before = sim.position(load).y;
    change(&mut sim, entities);
    sim.step(1);
    assert!(!sim.touch(top, load), "a stale pair");
    assert_told(&sim);
    sim.step(12);
    assert!(sim.position(load).y < before - 0.05, "{before} {}", sim.position(load));
    sim.step(24);
    assert_told(&sim);
}

#[test]
fn what_lies_on_a_node_falls_when_the_node_changes() {
    the_load_falls(|sim, [_, top, ..]| {
        sim.world().despawn(top);
    });
    the_load_falls(|sim, [root, ..]| {
        sim.world().despawn(root);
    });
    // Teleport, and a change of scale.
    the_load_falls(|sim, [root, ..]| sim.set(root, Transform::from_xyz(20.0, 0.001, 0.0)));
    the_load_falls(|sim, [root, ..]| sim.set(root, Transform::from_scale(Vec3::splat(0.3))));
    the_load_falls(|sim, [_, top, ..]| {
        let node = sim.get::<ChildOf>(top).parent();
        sim.set(
            node,
            Transform::from_xyz(0.0, 1.1, 0.0).with_scale(Vec3::new(1.0, 0.2, 1.0)),
        );
    });
    // To another parent.
    the_load_falls(|sim, [_, top, ..]| {
        let elsewhere = sim.spawn(Transform::from_xyz(20.0, 0.0, 0.0));
        sim.set(top, ChildOf(elsewhere));
    });
    the_load_falls(|sim, [root, top, ..]| {
        let node = sim.get::<ChildOf>(top).parent();
        let elsewhere = sim.spawn(Transform::from_xyz(20.0, 0.0, 0.0));
        sim.set(node, ChildOf(elsewhere));
        assert!(sim.app.world().get_entity(root).is_ok());
    });
    // Another mesh.
    the_load_falls(|sim, [_, top, ..]| {
        let ball = sim
            .world()
            .resource_mut::<Assets<Mesh>>()
            .add(drawn(&shapes::ball(0.1, 2)));
        sim.set(top, Mesh3d(ball));
        update_until(&mut sim.app, |app| {
            let MeshCollider(mesh) = app.world().get(top).unwrap();
            app.world()
                .resource::<Assets<CollisionMesh>>()
                .get(mesh)
                .unwrap()
                .mesh
                .triangles()
                .len()
                > 12
        });
    });
    // The mesh asset changes, not the handle: a hot reload.
    the_load_falls(|sim, [_, top, ..]| {
        let Mesh3d(mesh) = sim.get(top);
        let ball = drawn(&shapes::ball(0.1, 2));
        sim.world().resource_mut::<Assets<Mesh>>().insert(&mesh, ball).unwrap();
        update_until(&mut sim.app, |app| {
            let MeshCollider(mesh) = app.world().get(top).unwrap();
            app.world()
                .resource::<Assets<CollisionMesh>>()
                .get(mesh)
                .unwrap()
                .mesh
                .triangles()
                .len()
                > 12
        });
    });
}

#[test]
fn what_comes_later_gets_colliders_too() {
    let folder = tempfile::tempdir().unwrap();
    let cube = shapes::cube(1.0);
    write(
        folder.path(),
        "cube.glb",
        nodes(&[("Cube", &cube, json!({}))]).for_bevy().glb(),
    );
    let mut sim = sim(folder.path());
    let ball = sim
        .world()
        .resource_mut::<Assets<Mesh>>()
        .add(drawn(&shapes::ball_320()));
    let other = sim.mesh(&shapes::torus_240());
    let root = spawn(&mut sim, "cube.glb", MeshColliderHierarchy::default());
    ready(&mut sim, root);
    let late = sim.spawn((Mesh3d(ball.clone()), Transform::from_xyz(3.0, 0.0, 0.0), ChildOf(root)));
    assert_eq!(ready_again(&mut sim, root, 2).colliders, [late]);
    // Below a node, of which nothing was known.
    let node = sim.spawn(Transform::from_xyz(6.0, 0.0, 0.0));
    let below = sim.spawn((Mesh3d(ball.clone()), Transform::default(), ChildOf(node)));
    sim.step(4);
    assert!(!has::<MeshCollider>(&sim, below));
    sim.set(node, ChildOf(root));
    assert_eq!(ready_again(&mut sim, root, 3).colliders, [below]);
    // Entities with a collider keep it. Entities below another hierarchy are left to that one.
    let own = sim.spawn((Mesh3d(ball.clone()), other.clone(), Transform::default(), ChildOf(root)));
    let inner = sim.spawn((
        MeshColliderHierarchy::only_named().with_collider_for_name("yes", default()),
        Transform::default(),
        ChildOf(root),
    ));
    let yes = sim.spawn((
        Name::new("yes"),
        Mesh3d(ball.clone()),
        Transform::default(),
        ChildOf(inner),
    ));
    let no = sim.spawn((
        Name::new("no"),
        Mesh3d(ball.clone()),
        Transform::default(),
        ChildOf(inner),
    ));
    assert_eq!(ready(&mut sim, inner).colliders, [yes]);
    sim.step(8);
    assert_eq!(sim.get::<MeshCollider>(own), other);
    assert!(!has::<MeshCollider>(&sim, no));
    assert_eq!(sim.app.world().resource::<Told>().0.len(), 4);
    // Who leaves keeps its collider.
    sim.world().entity_mut(late).remove::<ChildOf>();
    sim.step(2);
    assert_eq!(triangles(&sim, late), 320);
}

#[test]
fn children_become_bodies_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let mut sim = sim(folder.path()).exact();
    let [root, top, leg, load] = table(&mut sim, folder.path());
    for part in [top, leg] {
        let node = sim.get::<ChildOf>(part).parent();
        sim.set(node, RigidBody::Dynamic);
    }
    sim.world().entity_mut(root).remove::<RigidBody>();
    sim.step(2);
    assert_eq!((sim.report().bodies, sim.rejected.len()), (4, 0), "{:?}", sim.rejected);
    // The top now lies on the leg.
    assert!(sim.touch(top, leg) && sim.touch(top, load));
    assert_told(&sim);
}

#[test]
fn a_child_with_a_mesh_collider_from_is_part_of_its_body() {
    let folder = tempfile::tempdir().unwrap();
    let mut sim = sim(folder.path());
    let ball = sim
        .world()
        .resource_mut::<Assets<Mesh>>()
        .add(drawn(&shapes::ball_320()));
    let body = sim.spawn((RigidBody::Dynamic, Transform::default()));
    let child = |x: f32| {
        (
            MeshColliderFrom(ball.clone()),
            Transform::from_xyz(x, 0.0, 0.0),
            ChildOf(body),
        )
    };
    let [a, b] = [child(1.0), child(3.0)].map(|child| sim.spawn(child));
    update_until(&mut sim.app, |app| app.world().get::<MeshCollider>(b).is_some());
    sim.step(2);
    assert_eq!(sim.get::<MeshCollider>(a), sim.get::<MeshCollider>(b));
    assert_eq!(sim.report().bodies, 1);
    crate::app::assert_near(*sim.get::<ComputedCenterOfMass>(body), 2.0 * Vec3::X, 1e-5);
}
