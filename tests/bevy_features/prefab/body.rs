//! Scenes as one body, and as static colliders.

use super::*;
use crate::app::assert_near;
use crate::asset_app::write;
use bevy_faceoff::geometry::shapes;

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

    // The cart as one mesh, without a parent.
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
    assert!((sim.position(ball).y - 0.3).abs() < 0.01, "{}", sim.position(ball));
}
