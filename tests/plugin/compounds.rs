//! Bodies of several colliders, and bodies and colliders anywhere in the hierarchy.

use crate::app::{Sim, assert_near, assert_told, sorted};
use bevy::prelude::*;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::prelude::*;

const HANDLE: Vec3 = Vec3::new(0.1, 1.0, 0.1);
const HEAD: Vec3 = Vec3::new(0.5, 0.2, 0.25);

/// A hammer whose handle and head are children. Returns root, handle and head.
fn hammer(sim: &mut Sim, at: Transform) -> [Entity; 3] {
    let cube = sim.mesh(&shapes::cube(1.0));
    let root = sim.spawn((RigidBody::Dynamic, at));
    let handle = sim.spawn((cube.clone(), Transform::from_scale(HANDLE), ChildOf(root)));
    let top = Transform::from_xyz(0.0, 0.5 * (HANDLE.y + HEAD.y), 0.0).with_scale(HEAD);
    let head = sim.spawn((cube, top, ChildOf(root)));
    [root, handle, head]
}

/// Handle and head as one mesh.
fn merged() -> TriMesh {
    let cube = shapes::cube(1.0);
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for (offset, scale) in [(0.0, HANDLE), (0.5 * (HANDLE.y + HEAD.y), HEAD)] {
        let first = vertices.len() as u32;
        vertices.extend(cube.vertices().iter().map(|&v| scale * v + offset * Vec3::Y));
        triangles.extend(cube.triangles().iter().map(|t| t.map(|i| i + first)));
    }
    TriMesh::new(vertices, triangles).unwrap()
}

/// A static floor whose top is at 0.
fn floor(sim: &mut Sim) -> Entity {
    let cube = sim.mesh(&shapes::cube(1.0));
    sim.spawn((
        cube,
        Transform::from_xyz(0.0, -0.5, 0.0).with_scale(Vec3::new(40.0, 1.0, 40.0)),
    ))
}

/// The pose in the world, from the `Transform`s.
fn in_world(sim: &Sim, entity: Entity) -> GlobalTransform {
    let own = GlobalTransform::from(sim.get::<Transform>(entity));
    match sim.app.world().get::<ChildOf>(entity) {
        Some(parent) => in_world(sim, parent.parent()) * own,
        None => own,
    }
}

fn fall() -> Gravity {
    Gravity(Vec3::NEG_Y * 9.81)
}

pub fn a_hammer_of_two_children_flies_like_the_merged_mesh() {
    let mut sim = Sim::new();
    let start = Transform::from_xyz(1.0, 2.0, 3.0).with_rotation(Quat::from_rotation_x(0.3));
    let velocities = (LinearVelocity(Vec3::X), AngularVelocity(Vec3::new(0.2, 3.0, 1.0)));
    let [root, ..] = hammer(&mut sim, start);
    sim.set(root, velocities);
    let mesh = sim.mesh(&merged());
    let other = Transform::from_translation(start.translation + 10.0 * Vec3::X).with_rotation(start.rotation);
    let one = sim.spawn((RigidBody::Dynamic, mesh, other, velocities));
    sim.step(64);
    assert_near(
        *sim.get::<ComputedCenterOfMass>(root),
        *sim.get::<ComputedCenterOfMass>(one),
        1e-5,
    );
    assert_near(sim.position(root) + 10.0 * Vec3::X, sim.position(one), 1e-4);
    let [a, b] = [root, one].map(|body| sim.get::<Transform>(body).rotation);
    // `angle_between` would take the arc cosine of a number near 1.
    let angle = 2.0 * (a * b.inverse()).xyz().length();
    assert!(angle < 1e-4, "{a} {b}");
    assert_near(sim.spin(root), sim.spin(one), 1e-3);
    assert_eq!(sim.report().bodies, 2);
}

pub fn it_falls_rests_sleeps_and_names_its_children() {
    let mut sim = Sim::new();
    sim.world().insert_resource(fall());
    let floor = floor(&mut sim);
    let [root, handle, head] = hammer(
        &mut sim,
        Transform::from_xyz(0.0, 1.0, 0.0).with_rotation(Quat::from_rotation_x(1.4)),
    );
    sim.set(root, CollidingEntities::default());
    sim.set(floor, CollidingEntities::default());
    sim.step(5 * 64);
    assert!(sim.get::<Sleeping>(root).0);
    assert_eq!(sim.report().sleeping, 1);
    let hit = sim.collisions().of(head).next().expect("the head lies on the floor");
    let bodies = if hit.collider1 == head {
        [hit.body1, hit.body2]
    } else {
        [hit.body2, hit.body1]
    };
    assert_eq!(bodies, [root, floor]);
    assert!(sim.collisions().of(root).count() >= 1);
    assert!(!sim.touch(handle, head), "its own parts do not collide");
    assert_eq!(**sim.get::<CollidingEntities>(root), [floor]);
    assert!(sim.get::<CollidingEntities>(floor).contains(&head));
    let pose: Transform = sim.get(root);
    sim.step(64);
    assert_eq!(sim.get::<Transform>(root), pose, "it moves in its sleep");
    assert_told(&sim);
}

pub fn events_reach_the_body_and_the_collider() {
    #[derive(Resource, Default)]
    struct Heard(Vec<[Entity; 3]>);
    let mut sim = Sim::new();
    sim.world().insert_resource(fall());
    sim.world().init_resource::<Heard>();
    let floor = floor(&mut sim);
    let [root, handle, head] = hammer(&mut sim, Transform::from_xyz(0.0, 0.6, 0.0));
    for entity in [root, handle] {
        sim.set(entity, CollisionEventsEnabled);
        sim.world()
            .entity_mut(entity)
            .observe(|on: On<CollisionStart>, mut heard: ResMut<Heard>| {
                heard.0.push([on.target, on.collider1, on.body1]);
            });
    }
    sim.step(32);
    assert!(
        sim.started
            .iter()
            .any(|s| sorted(s.collider1, s.collider2) == sorted(handle, floor))
    );
    let heard = &sim.app.world().resource::<Heard>().0;
    assert!(
        heard.contains(&[root, handle, root]) && heard.contains(&[handle, handle, root]),
        "{heard:?}"
    );
    assert!(heard.iter().all(|&[target, ..]| target != head));
}

pub fn a_scene_under_a_moved_turned_and_scaled_parent_is_one_body() {
    let mut sim = Sim::new();
    sim.world().insert_resource(fall());
    let above = Transform {
        translation: Vec3::new(3.0, 1.0, -2.0),
        rotation: Quat::from_rotation_y(0.7),
        scale: Vec3::new(2.0, 1.0, 0.5),
    };
    let level = sim.spawn(above);
    let floor = floor(&mut sim);
    let [root, ..] = hammer(&mut sim, Transform::from_xyz(0.5, 1.0, 0.0));
    sim.set(root, ChildOf(level));
    // The hammer as one mesh, without a parent.
    let mesh = sim.mesh(&merged());
    let placed = above * Transform::from_xyz(0.5, 1.0, 0.0);
    let one = sim.spawn((
        RigidBody::Dynamic,
        mesh,
        placed.with_translation(placed.translation + 20.0 * Vec3::X),
    ));
    sim.step(1);
    assert!(sim.rejected.is_empty(), "{:?}", sim.rejected);
    let forces = [root, one].map(|body| {
        let push = ExternalForces {
            angular_impulse: Vec3::new(0.01, 0.02, 0.03),
            impulse: Vec3::new(0.1, 0.0, 0.0),
            ..default()
        };
        sim.set(body, push);
        body
    });
    sim.step(1);
    let [[v, w], [v_one, w_one]] = forces.map(|body| [sim.velocity(body), sim.spin(body)]);
    assert!((v - v_one).length() < 1e-4 * v_one.length(), "{v} {v_one}");
    assert!((w - w_one).length() < 1e-4 * w_one.length(), "{w} {w_one}");
    let apart = in_world(&sim, one).translation() - in_world(&sim, root).translation();
    assert_near(apart, 20.0 * Vec3::X, 1e-4);
    sim.step(8 * 64);
    assert!(sim.get::<Sleeping>(root).0, "{}", in_world(&sim, root).translation());
    assert!(sim.collisions().of(root).count() > 0 && sim.collisions().of(floor).count() > 0);
    assert!(in_world(&sim, root).translation().y > 0.0);
    assert_told(&sim);
}

pub fn a_dynamic_body_stays_in_place_while_its_parent_moves() {
    let mut sim = Sim::new();
    let train = sim.spawn(Transform::default());
    let [root, _, head] = hammer(&mut sim, Transform::from_xyz(0.0, 2.0, 0.0));
    sim.set(root, ChildOf(train));
    sim.step(2);
    for i in 1..20 {
        let moved = Transform::from_xyz(0.1 * i as f32, 0.0, 0.0).with_rotation(Quat::from_rotation_y(0.1 * i as f32));
        sim.set(train, moved);
        sim.step(1);
        assert_near(in_world(&sim, root).translation(), 2.0 * Vec3::Y, 1e-5);
        assert_near(in_world(&sim, head).translation(), 2.6 * Vec3::Y, 1e-5);
    }
    // Its own `Transform` teleports it.
    sim.set(root, Transform::default());
    sim.step(1);
    assert_near(in_world(&sim, root).translation(), Vec3::new(1.9, 0.0, 0.0), 1e-5);
}

pub fn static_and_kinematic_bodies_follow_their_parents() {
    for kind in [None, Some(RigidBody::Static), Some(RigidBody::Kinematic)] {
        let mut sim = Sim::new();
        let cube = sim.mesh(&shapes::cube(1.0));
        let parent = sim.spawn(Transform::from_xyz(5.0, 0.0, 0.0));
        let child = sim.spawn((cube.clone(), Transform::from_xyz(0.0, 1.0, 0.0), ChildOf(parent)));
        if let Some(kind) = kind {
            sim.set(child, kind);
        }
        let probe = sim.spawn((
            RigidBody::Dynamic,
            Sensor,
            SleepingDisabled,
            cube,
            Transform::from_xyz(0.0, 1.5, 0.0),
        ));
        sim.step(1);
        assert!(sim.touching().is_empty());
        sim.set(parent, Transform::from_xyz(0.2, 0.0, 0.0));
        // A kinematic body is on its way during a step. The next one finds it there.
        sim.step(if kind == Some(RigidBody::Kinematic) { 2 } else { 1 });
        assert!(sim.touch(child, probe), "{kind:?}");
        sim.set(parent, Transform::from_xyz(-5.0, 0.0, 0.0));
        sim.step(20);
        assert!(sim.touching().is_empty());
        assert_told(&sim);
    }
}

/// A table, whose top and leg are children, with a body on the top. It sleeps. Returns the table, its top, its leg and
/// the body.
fn table(sim: &mut Sim) -> [Entity; 4] {
    sim.world().insert_resource(fall());
    floor(sim);
    let cube = sim.mesh(&shapes::cube(1.0));
    let table = sim.spawn((RigidBody::Dynamic, Transform::from_xyz(0.0, 0.001, 0.0)));
    let leg = Transform::from_xyz(0.0, 0.5, 0.0);
    let leg = sim.spawn((cube.clone(), leg, ChildOf(table)));
    let top = Transform::from_xyz(0.0, 1.1, 0.0).with_scale(Vec3::new(3.0, 0.2, 3.0));
    let top = sim.spawn((cube.clone(), top, ChildOf(table)));
    let load = sim.spawn((
        RigidBody::Dynamic,
        cube,
        Transform::from_xyz(1.1, 1.302, 0.0).with_scale(Vec3::splat(0.2)),
    ));
    sim.set(load, Transform::from_xyz(1.1, 1.302, 0.0).with_scale(Vec3::splat(0.2)));
    sim.step(3 * 64);
    assert!(sim.get::<Sleeping>(table).0 && sim.get::<Sleeping>(load).0);
    assert!(sim.touch(top, load));
    [table, top, leg, load]
}

/// Changes the table; the load must fall at once, and every start have its end.
fn the_load_falls(change: impl Fn(&mut Sim, [Entity; 4])) {
    let mut sim = Sim::new().exact();
    let entities = table(&mut sim);
    let [_, top, _, load] = entities;
    let before = sim.position(load).y;
    change(&mut sim, entities);
    sim.step(1);
    assert!(!sim.touch(top, load), "a stale pair");
    assert!(!sim.get::<Sleeping>(load).0, "it still sleeps");
    assert_told(&sim);
    sim.step(10);
    assert!(
        sim.position(load).y < before - 0.05,
        "{before} {}",
        sim.position(load).y
    );
    sim.step(20);
    assert_told(&sim);
}

pub fn what_lies_on_a_part_falls_when_the_part_goes() {
    the_load_falls(|sim, [_, top, ..]| {
        sim.world().despawn(top);
    });
    the_load_falls(|sim, [table, ..]| {
        sim.world().despawn(table);
    });
    the_load_falls(|sim, [_, top, ..]| sim.set(top, ColliderDisabled));
    the_load_falls(|sim, [table, ..]| sim.set(table, RigidBodyDisabled));
    the_load_falls(|sim, [_, top, ..]| sim.set(top, bevy::ecs::entity_disabling::Disabled));
    the_load_falls(|sim, [table, ..]| sim.set(table, bevy::ecs::entity_disabling::Disabled));
    the_load_falls(|sim, [_, top, ..]| {
        sim.world().entity_mut(top).remove::<MeshCollider>();
    });
    the_load_falls(|sim, [_, top, ..]| {
        sim.set(
            top,
            CollisionLayers {
                memberships: 0,
                filters: 0,
            },
        )
    });
    the_load_falls(|sim, [_, top, ..]| sim.set(top, Transform::from_xyz(0.0, 20.0, 0.0)));
    // Narrower than the place of the load.
    the_load_falls(|sim, [_, top, ..]| {
        sim.set(
            top,
            Transform::from_xyz(0.0, 1.1, 0.0).with_scale(Vec3::new(1.0, 0.2, 1.0)),
        );
    });
    the_load_falls(|sim, [_, top, ..]| {
        let ball = sim.mesh(&shapes::ball(0.1, 2));
        sim.set(top, ball);
    });
    // A hot reload.
    the_load_falls(|sim, [_, top, ..]| {
        let MeshCollider(mesh) = sim.get(top);
        let ball = CollisionMesh::new(&shapes::ball(0.1, 2));
        let mut meshes = sim.world().resource_mut::<Assets<CollisionMesh>>();
        // The leg has the same mesh as the top.
        meshes.insert(&mesh, ball).unwrap();
    });
    // To a parent elsewhere.
    the_load_falls(|sim, [_, top, ..]| {
        let elsewhere = sim.spawn(Transform::from_xyz(20.0, 0.0, 0.0));
        sim.set(top, ChildOf(elsewhere));
    });
    the_load_falls(|sim, [table, ..]| sim.set(table, Transform::from_xyz(10.0, 0.001, 0.0)));
    the_load_falls(|sim, [table, ..]| {
        sim.set(table, Transform::from_xyz(0.0, 0.001, 0.0).with_scale(Vec3::splat(0.3)))
    });
}

pub fn a_part_moves_to_another_body() {
    let mut sim = Sim::new();
    let [_, top, leg, load] = table(&mut sim);
    let shelf = sim.spawn((RigidBody::Static, Transform::default()));
    sim.set(top, ChildOf(shelf));
    sim.started.clear();
    sim.ended.clear();
    sim.step(1);
    // At the same place, so that the two touch on, but as a part of another body.
    assert!(sim.touch(top, load));
    let hit = sim.collisions().get(top, load).unwrap();
    assert!([hit.body1, hit.body2].contains(&shelf));
    let of_pair = |one, other| sorted(one, other) == sorted(top, load);
    let starts = sim.started.iter().filter(|s| of_pair(s.collider1, s.collider2));
    let ends = sim.ended.iter().filter(|e| of_pair(e.collider1, e.collider2));
    assert_eq!((starts.count(), ends.count()), (1, 1));
    // The leg stays with the table, and is now a body of its own.
    assert!(sim.touch(top, leg));
    sim.step(64);
    assert!(sim.position(load).y > 1.2);
}

pub fn a_child_that_is_added_or_enabled_takes_part_in_the_next_step() {
    let mut sim = Sim::new();
    let [root, _, head] = hammer(&mut sim, Transform::default());
    let cube = sim.mesh(&shapes::cube(0.2));
    let probe = sim.spawn((
        RigidBody::Dynamic,
        Sensor,
        SleepingDisabled,
        cube.clone(),
        Transform::from_xyz(0.0, 0.6, 0.3),
    ));
    sim.set(head, ColliderDisabled);
    sim.step(2);
    assert!(!sim.touch(head, probe));
    sim.world().entity_mut(head).remove::<ColliderDisabled>();
    sim.step(1);
    assert!(!sim.touch(head, probe), "they are apart");
    sim.set(probe, Transform::from_xyz(0.0, 0.6, 0.2));
    sim.step(1);
    assert!(sim.touch(head, probe));
    let added = sim.spawn((cube, Transform::from_xyz(0.0, 0.6, 0.2), ChildOf(root)));
    sim.step(1);
    assert!(sim.touch(added, probe) && sim.touch(head, probe));
    sim.set(root, RigidBodyDisabled);
    sim.step(16);
    assert!(sim.touching().is_empty());
    assert_told(&sim);
}

pub fn parts_have_their_own_density_friction_and_layers() {
    let mut sim = Sim::new();
    let [root, handle, head] = hammer(&mut sim, Transform::default());
    sim.set(root, Density(2.0));
    sim.set(head, Density(10.0));
    sim.step(1);
    let [handle_mass, head_mass] = [2.0 * HANDLE.element_product(), 10.0 * HEAD.element_product()];
    let center = 0.6 * head_mass / (handle_mass + head_mass);
    assert_near(*sim.get::<ComputedCenterOfMass>(root), center * Vec3::Y, 1e-5);
    // A sensor has no mass.
    sim.set(head, Sensor);
    sim.step(1);
    assert_near(*sim.get::<ComputedCenterOfMass>(root), Vec3::ZERO, 1e-5);
    sim.set(root, CenterOfMass(Vec3::NEG_Y));
    sim.step(1);
    assert_near(*sim.get::<ComputedCenterOfMass>(root), Vec3::NEG_Y, 1e-6);
    let cube = sim.mesh(&shapes::cube(0.1));
    let near = Transform::from_xyz(0.0, 0.6, 0.0);
    let layers = CollisionLayers {
        memberships: 2,
        filters: 2,
    };
    let probe = sim.spawn((RigidBody::Dynamic, Sensor, cube, near, layers));
    sim.step(1);
    assert!(sim.touching().is_empty());
    sim.set(head, layers);
    sim.step(1);
    assert!(sim.touch(head, probe) && !sim.touch(handle, probe));
}

/// Steps until a copy of a mesh is baked in the background.
fn wait_until(sim: &mut Sim, done: impl Fn(&Sim) -> bool) {
    for _ in 0..2000 {
        if done(sim) {
            return;
        }
        std::thread::sleep(std::time::Duration::from_millis(5));
        sim.step(1);
    }
    panic!("it takes too long");
}

/// A turned head under an unequal scale is sheared: mass and centre are those of the mesh with the shear applied.
pub fn a_sheared_part_has_a_mesh_of_its_own() {
    let mut sim = Sim::new();
    let scale = Vec3::new(1.0, 2.0, 0.5);
    let [root, handle, head] = hammer(&mut sim, Transform::from_scale(scale));
    let turned = sim.get::<Transform>(head).with_rotation(Quat::from_rotation_z(0.5));
    sim.set(head, turned);
    let whole = |head: Transform| {
        let cube = shapes::cube(1.0);
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        for pose in [Transform::from_scale(HANDLE), head] {
            let first = vertices.len() as u32;
            vertices.extend(cube.vertices().iter().map(|&v| scale * pose.transform_point(v)));
            triangles.extend(cube.triangles().iter().map(|t| t.map(|i| i + first)));
        }
        CollisionMesh::new(&TriMesh::new(vertices, triangles).unwrap()).mass
    };
    let wanted = whole(turned).center;
    let center = |sim: &Sim| *sim.get::<ComputedCenterOfMass>(root) * scale;
    wait_until(&mut sim, |sim| center(sim).distance(wanted) < 1e-4);
    assert!(sim.rejected.is_empty());
    // It touches with the sheared head. Its highest corner is above that of the head that is only turned.
    let reach = |v: Vec3| scale * turned.transform_point(v);
    let corner = reach(Vec3::new(-0.5, 0.5, 0.5));
    let small = sim.mesh(&shapes::cube(0.05));
    let probe = sim.spawn((
        RigidBody::Dynamic,
        Sensor,
        small,
        Transform::from_translation(corner),
        SleepingDisabled,
    ));
    sim.step(1);
    assert!(sim.touch(head, probe));
    // Its turn changes while it touches. It collides all the time, and soon with the new shear.
    let turned = turned.with_rotation(Quat::from_rotation_z(0.52));
    sim.set(head, turned);
    let wanted = whole(turned).center;
    for _ in 0..3 {
        sim.step(1);
        assert!(sim.touch(head, probe));
    }
    wait_until(&mut sim, |sim| center(sim).distance(wanted) < 1e-5);
    // A quarter turn exchanges axes only.
    sim.set(
        head,
        turned.with_rotation(Quat::from_rotation_z(std::f32::consts::FRAC_PI_2)),
    );
    sim.step(1);
    assert!(!sim.touch(head, probe) && sim.get::<ComputedCenterOfMass>(root).y > 0.1);
    assert!(sim.app.world().get_entity(handle).is_ok() && sim.rejected.is_empty());
    sim.step(16);
    assert_told(&sim);
}

/// A static wall under sheared entities, mirrored: a ball is pushed out of it, not in.
pub fn a_mirrored_sheared_wall_pushes_outward() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    let parent = sim.spawn(Transform::from_scale(Vec3::new(-1.0, 3.0, 1.0)));
    let turned = Transform::from_rotation(Quat::from_rotation_z(0.4));
    sim.spawn((cube.clone(), turned, ChildOf(parent)));
    let ball = sim.mesh(&shapes::ball(0.25, 2));
    let at = Vec3::new(3.0, 0.0, 0.0);
    let flyer = sim.spawn((
        RigidBody::Dynamic,
        ball,
        Transform::from_translation(at),
        LinearVelocity(Vec3::ZERO),
    ));
    // The wall is there once its copy is baked.
    for _ in 0..100 {
        std::thread::sleep(std::time::Duration::from_millis(5));
        sim.step(1);
    }
    sim.set(flyer, LinearVelocity(Vec3::NEG_X * 2.0));
    sim.step(128);
    assert!(
        !sim.started.is_empty() && sim.position(flyer).x > 0.3,
        "{}",
        sim.position(flyer)
    );
    assert_told(&sim);
}

pub fn a_snapshot_of_a_nested_hammer_repeats_to_the_bit() {
    let mut sim = Sim::new();
    sim.world().insert_resource(fall());
    floor(&mut sim);
    let level = sim.spawn(Transform::from_xyz(1.0, 0.5, 0.0).with_rotation(Quat::from_rotation_y(0.4)));
    let [root, ..] = hammer(
        &mut sim,
        Transform::from_xyz(0.0, 1.0, 0.0).with_rotation(Quat::from_rotation_x(0.4)),
    );
    sim.set(root, ChildOf(level));
    sim.step(40);
    let snapshot = Snapshot::take(sim.world());
    sim.step(30);
    let wanted: (Transform, LinearVelocity) = (sim.get(root), sim.get(root));
    assert!(snapshot.restore(sim.world()).is_empty());
    sim.step(30);
    assert_eq!((sim.get::<Transform>(root), sim.get::<LinearVelocity>(root)), wanted);
}

pub fn a_body_without_colliders_of_its_own_waits_for_its_children() {
    let mut sim = Sim::new();
    let root = sim.spawn((RigidBody::Dynamic, Transform::default(), LinearVelocity(Vec3::X)));
    sim.step(2);
    assert_eq!(sim.position(root), Vec3::ZERO);
    let cube = sim.mesh(&shapes::cube(1.0));
    // Below an entity that is no collider.
    let middle = sim.spawn((Transform::from_xyz(0.0, 1.0, 0.0), ChildOf(root)));
    sim.spawn((cube, Transform::from_xyz(0.0, 1.0, 0.0), ChildOf(middle)));
    sim.step(1);
    assert_near(sim.position(root), Vec3::X / 64.0, 1e-6);
    assert_near(*sim.get::<ComputedCenterOfMass>(root), 2.0 * Vec3::Y, 1e-6);
}
