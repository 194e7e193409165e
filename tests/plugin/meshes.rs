//! Meshes that come late, change, or go while bodies use them.

use crate::app::{Sim, assert_near, resting};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;
use bevy_faceoff::state::fault::BodyFault;
use std::time::{Duration, Instant};

fn assets(sim: &mut Sim) -> Mut<'_, Assets<CollisionMesh>> {
    sim.world().resource_mut::<Assets<CollisionMesh>>()
}

fn insert(sim: &mut Sim, collider: &MeshCollider, mesh: &TriMesh) {
    assets(sim)
        .insert(collider.0.id(), CollisionMesh::new(mesh))
        .expect("the handle is alive");
}

/// Two sensors 1.2 apart: cubes of edge 1 do not touch, cubes of edge 2 do.
fn two(sim: &mut Sim, mesh: &MeshCollider) -> [Entity; 2] {
    [0.0, 1.2].map(|x| sim.spawn((resting(mesh, Vec3::new(x, 0.1, 0.0)), Sensor)))
}

/// Bodies reported for a mesh that is not there, all reports being of that kind.
fn told_missing(sim: &Sim) -> Vec<Entity> {
    assert!(sim.rejected.iter().all(|r| r.fault == BodyFault::MeshMissing));
    sim.rejected.iter().map(|r| r.entity).collect()
}

#[test]
fn a_body_joins_when_its_mesh_arrives() {
    let mut sim = Sim::new();
    let late = MeshCollider(assets(&mut sim).reserve_handle());
    let cube = sim.mesh(&shapes::cube(1.0));
    let waiting = sim.spawn((resting(&late, Vec3::ZERO), LinearVelocity(Vec3::Y)));
    let there = sim.spawn((resting(&cube, Vec3::X * 0.5), LinearVelocity(Vec3::Y)));
    sim.world().insert_resource(Response::None);
    sim.step(16);
    assert_eq!(sim.report().bodies, 1);
    assert_eq!(sim.position(waiting), Vec3::ZERO, "it waits where it is");
    assert_near(sim.position(there), Vec3::new(0.5, 0.25, 0.0), 1e-5);
    insert(&mut sim, &late, &shapes::cube(1.0));
    sim.step(16);
    assert_eq!(sim.report().bodies, 2);
    assert!(sim.touch(waiting, there));
    assert_near(sim.position(waiting), Vec3::Y * 0.25, 1e-5);
    assert_eq!(
        told_missing(&sim),
        [waiting],
        "once, while nobody had inserted the mesh"
    );
}

#[test]
fn a_mesh_from_a_file_is_used_as_soon_as_it_is_loaded() {
    let mut sim = Sim::new();
    let server = sim.world().resource::<AssetServer>().clone();
    let from_obj = MeshCollider(server.load("cube.obj"));
    let from_recipe = MeshCollider(server.load("ball.bake.ron"));
    let one = sim.spawn((resting(&from_obj, Vec3::ZERO), Sensor));
    let other = sim.spawn((resting(&from_recipe, Vec3::X * 0.7), Sensor));
    let start = Instant::now();
    while sim.report().bodies < 2 {
        assert!(start.elapsed() < Duration::from_secs(60), "the meshes never load");
        sim.step(1);
        std::thread::sleep(Duration::from_millis(2));
    }
    assert!(sim.touch(one, other));
    assert!(sim.rejected.is_empty());
}

#[test]
fn replacing_a_mesh_changes_collisions_in_the_next_step() {
    let mut sim = Sim::new().exact();
    let mesh = sim.mesh(&shapes::cube(1.0));
    let [one, other] = two(&mut sim, &mesh);
    sim.step(2);
    assert!(!sim.touch(one, other));
    insert(&mut sim, &mesh, &shapes::cube(2.0));
    sim.step(1);
    assert!(sim.touch(one, other));
    // More triangles than before, fewer, and the same mesh once more.
    insert(&mut sim, &mesh, &shapes::knot_1120());
    sim.step(1);
    assert!(!sim.touch(one, other));
    insert(&mut sim, &mesh, &shapes::cube(2.0));
    sim.step(1);
    assert!(sim.touch(one, other));
    assert!(
        sim.collisions()
            .get(one, other)
            .unwrap()
            .faces
            .unwrap()
            .iter()
            .all(|f| f.a < 12)
    );
    insert(&mut sim, &mesh, &shapes::cube(2.0));
    sim.step(1);
    assert!(sim.touch(one, other));
    assert_eq!((sim.started.len(), sim.ended.len()), (2, 1));
}

#[test]
fn a_replaced_mesh_changes_mass_too() {
    let mut sim = Sim::new();
    let (mesh, fixed) = (sim.mesh(&shapes::ball(0.5, 2)), sim.mesh(&shapes::ball(0.5, 2)));
    let heavy = sim.spawn((
        resting(&mesh, Vec3::Z * -1.3),
        LinearVelocity(Vec3::Z),
        Restitution::new(1.0),
    ));
    let light = sim.spawn((resting(&fixed, Vec3::Z * 0.6), Restitution::new(1.0)));
    sim.step(1);
    insert(&mut sim, &mesh, &shapes::ball(1.0, 2));
    sim.step(63);
    assert_near(sim.velocity(heavy), Vec3::Z * (7.0 / 9.0), 1e-2);
    assert_near(sim.velocity(light), Vec3::Z * (16.0 / 9.0), 1e-2);
}

#[test]
fn a_body_whose_mesh_is_removed_waits_and_returns_with_the_mesh() {
    let mut sim = Sim::new();
    let mesh = sim.mesh(&shapes::cube(2.0));
    let other_mesh = sim.mesh(&shapes::cube(2.0));
    let [one, other] = two(&mut sim, &mesh);
    sim.set(other, other_mesh.clone());
    sim.step(1);
    assert!(sim.touch(one, other));
    assets(&mut sim).remove(mesh.0.id());
    sim.step(3);
    assert_eq!(sim.report().bodies, 1);
    assert_eq!(sim.ended.len(), 1);
    // Another mesh takes the freed place.
    let third = sim.mesh(&shapes::torus_240());
    let torus = sim.spawn((resting(&third, Vec3::X * 1.2), Sensor));
    sim.step(1);
    assert!(sim.touch(torus, other));
    insert(&mut sim, &mesh, &shapes::cube(2.0));
    sim.step(1);
    assert!(sim.touch(one, other) && sim.touch(torus, other));
    assert_eq!(sim.report().bodies, 3);
    assert_eq!(told_missing(&sim), [one]);
}

#[test]
fn a_body_may_change_its_mesh() {
    let mut sim = Sim::new();
    let (small, large) = (sim.mesh(&shapes::cube(1.0)), sim.mesh(&shapes::cube(2.0)));
    let [one, other] = two(&mut sim, &small);
    sim.step(1);
    assert!(!sim.touch(one, other));
    sim.set(one, large);
    sim.step(1);
    assert!(sim.touch(one, other));
    sim.set(one, small);
    sim.step(1);
    assert!(!sim.touch(one, other));
}

#[test]
fn a_mesh_is_let_go_with_its_last_body() {
    let mut sim = Sim::new();
    let mesh = sim.mesh(&shapes::cube(1.0));
    let id = mesh.0.id();
    let bodies = two(&mut sim, &mesh);
    drop(mesh);
    sim.step(3);
    assert!(assets(&mut sim).contains(id));
    for body in bodies {
        sim.world().despawn(body);
    }
    sim.step(3);
    assert!(!assets(&mut sim).contains(id), "the step holds no handle of its own");
    assert_eq!(sim.report().bodies, 0);
}

#[test]
fn a_default_handle_is_told_once_and_disturbs_nobody() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    let none = sim.spawn((
        resting(&MeshCollider(Handle::default()), Vec3::ZERO),
        LinearVelocity(Vec3::X),
    ));
    let body = sim.spawn((resting(&cube, Vec3::ZERO), LinearVelocity(Vec3::X)));
    sim.step(10);
    assert_eq!(sim.report().bodies, 1);
    assert_eq!(sim.position(none), Vec3::ZERO);
    assert!(sim.position(body).x > 0.1);
    assert_eq!(told_missing(&sim), [none]);
    assert!(sim.started.is_empty());
}
