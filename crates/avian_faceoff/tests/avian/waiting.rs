//! Bodies whose meshes come later.

use crate::world::{Contacts, HZ, World};
use avian_faceoff::prelude::*;
use avian3d::prelude::*;
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;

/// A world with a floor whose top is at height 0, and the handle of a mesh that is not there yet.
fn world() -> (World, Handle<CollisionMesh>) {
    let mut world = World::new(Contacts::Exact);
    world.app.world_mut().spawn((
        RigidBody::Static,
        Collider::cuboid(20.0, 1.0, 20.0),
        Transform::from_xyz(0.0, -0.5, 0.0),
    ));
    let later = world.app.world().resource::<Assets<CollisionMesh>>().reserve_handle();
    (world, later)
}

fn is_disabled(world: &World, body: Entity) -> bool {
    world.app.world().entity(body).contains::<RigidBodyDisabled>()
}

/// The mesh of a cube of edge 1 comes.
fn load(world: &mut World, mesh: &Handle<CollisionMesh>) {
    let mut meshes = world.app.world_mut().resource_mut::<Assets<CollisionMesh>>();
    meshes
        .insert(mesh.id(), CollisionMesh::new(&shapes::cube(1.0)))
        .expect("it is reserved");
}

/// Checks that the body falls on the floor within two seconds and stays on it.
#[track_caller]
fn lands(world: &mut World, body: Entity) {
    world.steps(2 * HZ);
    assert!(!is_disabled(world, body));
    let height = world.position(body).y;
    assert!((height - 0.5).abs() < 0.02, "it is at {height} m");
}

const ABOVE: Transform = Transform::from_xyz(0.0, 2.0, 0.0);

#[test]
fn a_body_goes_on_with_a_collider_that_comes_before_the_mesh() {
    let (mut world, later) = world();
    let body = world
        .app
        .world_mut()
        .spawn((RigidBody::Dynamic, ExactCollider(later.clone()), ABOVE))
        .id();
    world.begin();
    world.steps(4);
    assert!(is_disabled(&world, body));
    assert_eq!(world.position(body).y, 2.0);
    world
        .app
        .world_mut()
        .entity_mut(body)
        .insert(Collider::cuboid(1.0, 1.0, 1.0));
    lands(&mut world, body);
    load(&mut world, &later);
    lands(&mut world, body);
}

#[test]
fn a_body_goes_on_without_an_exact_collider() {
    let (mut world, later) = world();
    let body = world
        .app
        .world_mut()
        .spawn((RigidBody::Dynamic, ExactCollider(later), ABOVE))
        .id();
    world.begin();
    world.step();
    world.app.world_mut().entity_mut(body).remove::<ExactCollider>();
    world.steps(8);
    assert!(!is_disabled(&world, body));
    assert!(world.position(body).y < 2.0, "it falls");
}

#[test]
fn what_the_game_disables_stays_disabled() {
    let (mut world, later) = world();
    let mut spawn = || {
        let exact = ExactCollider(later.clone());
        world.app.world_mut().spawn((RigidBody::Dynamic, exact, ABOVE)).id()
    };
    let [before, meanwhile] = [spawn(), spawn()];
    world.app.world_mut().entity_mut(before).remove::<ExactCollider>();
    world
        .app
        .world_mut()
        .entity_mut(before)
        .insert(RigidBodyDisabled)
        .insert(ExactCollider(later.clone()));
    world.app.world_mut().entity_mut(meanwhile).insert(RigidBodyDisabled);
    world.begin();
    world.step();
    load(&mut world, &later);
    world.steps(8);
    for body in [before, meanwhile] {
        assert!(world.app.world().entity(body).contains::<Collider>());
        assert!(is_disabled(&world, body));
        assert_eq!(world.position(body).y, 2.0);
    }
}

#[test]
fn a_body_waits_for_the_meshes_of_all_its_children() {
    let (mut world, later) = world();
    let last = world.app.world().resource::<Assets<CollisionMesh>>().reserve_handle();
    let there = world
        .app
        .world_mut()
        .resource_mut::<Assets<CollisionMesh>>()
        .add(CollisionMesh::new(&shapes::cube(1.0)));
    let body = world
        .app
        .world_mut()
        .spawn((
            RigidBody::Dynamic,
            ABOVE,
            children![
                (ExactCollider(later.clone()), Transform::from_xyz(-1.0, 0.0, 0.0)),
                (ExactCollider(there), Transform::from_xyz(1.0, 0.0, 0.0)),
                (
                    Transform::default(),
                    children![(ExactCollider(last.clone()), Transform::from_xyz(0.0, 0.0, 1.0))]
                ),
            ],
        ))
        .id();
    world.begin();
    for mesh in [&later, &last] {
        world.steps(8);
        assert!(is_disabled(&world, body));
        assert_eq!(world.position(body).y, 2.0);
        load(&mut world, mesh);
    }
    lands(&mut world, body);
}

#[test]
fn a_body_waits_whatever_comes_first() {
    let (mut world, later) = world();
    let ecs = world.app.world_mut();
    // The collider before the body, the child before the parent.
    let alone = ecs.spawn((ExactCollider(later.clone()), ABOVE)).id();
    ecs.entity_mut(alone).insert(RigidBody::Dynamic);
    let child = ecs.spawn(ExactCollider(later.clone())).id();
    let parent = ecs
        .spawn((RigidBody::Dynamic, Transform::from_xyz(4.0, 2.0, 0.0)))
        .add_child(child)
        .id();
    world.begin();
    world.steps(8);
    for body in [alone, parent] {
        assert!(is_disabled(&world, body));
        assert_eq!(world.position(body).y, 2.0);
    }
    load(&mut world, &later);
    lands(&mut world, alone);
    lands(&mut world, parent);
}

#[test]
fn a_child_that_goes_is_not_awaited() {
    let (mut world, later) = world();
    let ecs = world.app.world_mut();
    let body = ecs
        .spawn((RigidBody::Dynamic, Collider::cuboid(1.0, 1.0, 1.0), ABOVE))
        .id();
    let child = ecs.spawn((ChildOf(body), ExactCollider(later))).id();
    world.begin();
    world.steps(8);
    assert!(is_disabled(&world, body));
    world.app.world_mut().despawn(child);
    lands(&mut world, body);
}
