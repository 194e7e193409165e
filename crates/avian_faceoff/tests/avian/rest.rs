//! Bodies at rest: on meshes, on Avian's shapes, in piles, on a joint.

use crate::world::{Contacts, HZ, World};
use avian3d::math::AdjustPrecision;
use avian3d::prelude::*;
use bevy::prelude::*;
use bevy_faceoff::queries::{ContactWorker, Placed};
use bevy_faceoff::testing::scenes::{Body, Scene, Shape, any_turn, pour, rest};

/// The deepest overlap of unscaled bodies of one shape, as a part of the diameter 1, from all points of the core.
fn deepest(world: &World, bodies: &[Entity], shape: Shape) -> f32 {
    let placed: Vec<Placed> = bodies
        .iter()
        .map(|&body| {
            let (at, turn) = (world.position(body).as_dvec3(), world.rotation(body).as_dquat());
            Placed::new(shape.mesh(), at, turn, Vec3::ONE).expect("a valid pose")
        })
        .collect();
    let (mut worker, mut points) = (ContactWorker::new(), Vec::new());
    for (i, a) in placed.iter().enumerate() {
        for b in &placed[..i] {
            worker.points(a, b, 0.0, &mut points);
        }
    }
    points.iter().map(|point| -point.separation).fold(0.0, f32::max)
}

#[test]
fn a_pour_of_knots_comes_to_rest() {
    let mut scene = Scene::new();
    let (count, width) = (12, 2.4);
    pour::walls(&mut scene, 6.0, width, 10.0);
    let mut random = fastrand::Rng::with_seed(3);
    pour::knots(&mut scene, count, 2, || any_turn(&mut || random.f32()));
    let mut world = World::of(Contacts::Exact, &scene);
    world.steps(8 * HZ);
    let knots: Vec<Entity> = world.bodies[5..].to_vec();
    assert_eq!(knots.len(), count);
    for &knot in &knots {
        let at = world.position(knot);
        assert!(
            at.y > 0.0 && at.x.abs().max(at.z.abs()) < 0.5 * width,
            "one has left the bin: {at}"
        );
    }
    let deepest = deepest(&world, &knots, Shape::Knot);
    println!("deepest {:.2} % of the diameter", 100.0 * deepest);
    assert!(deepest < 0.02, "{deepest}");
}

#[test]
fn a_stack_stands() {
    let mut world = World::of(Contacts::Exact, &rest::stack(10, 0.0));
    let from: Vec<Vec3> = world.bodies.iter().map(|&body| world.position(body)).collect();
    world.steps(10 * HZ);
    for (&body, from) in world.bodies.iter().zip(from) {
        let moved = world.position(body).distance(from);
        assert!(moved < 0.05, "a cube has moved by {moved} m");
    }
}

/// A knot that falls on a floor of edge 4, whose top is at height 0; its world after 5 s.
fn knot_on(floor: impl FnOnce(&mut World)) -> (World, Entity) {
    let mut world = World::new(Contacts::Exact);
    world
        .app
        .insert_resource(Gravity((Vec3::NEG_Y * 9.81).adjust_precision()));
    floor(&mut world);
    let knot = world.add(&Body::new(Shape::Knot, Vec3::Y * 0.8, Quat::from_rotation_x(0.4)));
    world.begin();
    world.steps(5 * HZ);
    (world, knot)
}

/// How far the lowest vertex is above the floor.
fn clearance(world: &World, knot: Entity) -> f32 {
    let (at, turn) = (world.position(knot), world.rotation(knot));
    let heights = Shape::Knot.mesh().mesh.vertices().iter().map(|v| (at + turn * *v).y);
    heights.fold(f32::INFINITY, f32::min)
}

#[test]
fn a_knot_rests_on_shapes_of_avian_and_on_meshes() {
    let on_cuboid = knot_on(|world| {
        world.app.world_mut().spawn((
            RigidBody::Static,
            Collider::cuboid(4.0, 1.0, 4.0),
            Transform::from_xyz(0.0, -0.5, 0.0),
        ));
    });
    let on_mesh = knot_on(|world| {
        let mut floor = Body::new(Shape::Cube, Vec3::NEG_Y * 0.5, Quat::IDENTITY);
        (floor.fixed, floor.scale) = (true, Vec3::new(4.0, 1.0, 4.0));
        world.add(&floor);
    });
    for (floor, (world, knot)) in [("cuboid", on_cuboid), ("mesh", on_mesh)] {
        let (speed, clearance) = (world.velocity(knot).length(), clearance(&world, knot));
        println!("on a {floor}: {:.3} mm above it, {speed:.1e} m/s", 1e3 * clearance);
        assert!(speed < 0.02, "on a {floor}: {speed} m/s");
        assert!(clearance.abs() < 0.01, "on a {floor}: {clearance} m above it");
    }
}

/// A knot swings on a joint into another one.
#[test]
fn a_knot_on_a_joint_swings_into_another() {
    let mut world = World::new(Contacts::Exact);
    world
        .app
        .insert_resource(Gravity((Vec3::NEG_Y * 9.81).adjust_precision()));
    let swings = world.add(&Body::new(Shape::Knot, Vec3::X * 2.0, Quat::IDENTITY));
    let mut other = Body::new(Shape::Knot, Vec3::new(0.3, -2.0, 0.0), Quat::IDENTITY);
    other.fixed = true;
    world.add(&other);
    let arm = 2.0;
    let ecs = world.app.world_mut();
    let anchor = ecs.spawn((RigidBody::Static, Transform::default())).id();
    ecs.spawn(SphericalJoint::new(anchor, swings).with_local_anchor2((Vec3::NEG_X * arm).adjust_precision()));
    world.begin();
    let mut touched = false;
    for _ in 0..5 * HZ {
        world.step();
        touched |= !world.points().is_empty();
        let hinge = world.position(swings) + world.rotation(swings) * (Vec3::NEG_X * arm);
        assert!(hinge.length() < 0.05, "the joint has stretched by {} m", hinge.length());
        let depth = world.deepest();
        assert!(depth < 0.1, "{depth} m deep in the other");
    }
    assert!(touched);
}
