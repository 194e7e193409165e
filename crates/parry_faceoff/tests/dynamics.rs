//! Scenes in rapier, moved with exact contacts.

mod common;

use bevy_faceoff::testing::scenes::incline::slope;
use bevy_faceoff::testing::scenes::{Body, Scene, Shape, chain};
use common::rapier::prelude::*;
use common::{Contacts, HZ, Moved, exact, vector, world};
use glam::{Quat, Vec3};
use parry_faceoff::parry::math::Vector;
use parry_faceoff::{ExactMesh, bevy_faceoff};
use std::sync::mpsc::channel;

/// A sheet of triangles that is seen from above, its squares a quarter of a metre wide.
fn sheet() -> ExactMesh {
    const CELL: f32 = 0.25;
    let (wide, deep) = (60_u32, 24_u32);
    let at = |i: u32, j: u32| Vec3::new(i as f32 * CELL - 7.5, 0.0, j as f32 * CELL - 3.0);
    let vertices = (0..=wide)
        .flat_map(|i| (0..=deep).map(move |j| vector(at(i, j))))
        .collect();
    let number = |i: u32, j: u32| i * (deep + 1) + j;
    let cells = (0..wide).flat_map(|i| (0..deep).map(move |j| (i, j)));
    let faces = cells.flat_map(|(i, j)| {
        let [a, b, c, d] = [number(i, j), number(i, j + 1), number(i + 1, j + 1), number(i + 1, j)];
        [[a, b, c], [a, c, d]]
    });
    ExactMesh::new(vertices, faces.collect()).expect("a valid mesh")
}

/// How far a cube slides on the sheet, where friction should stop it after 10 m, and the error of its deceleration in
/// the second second.
fn slide(contacts: Contacts, turn: f32) -> (f32, f32) {
    const FRICTION: f32 = 0.2;
    let wanted = FRICTION * 9.81;
    let mut scene = Scene::new();
    let mut cube = Body::new(
        Shape::Cube,
        Vec3::new(-5.03, 0.5 + 1e-5, 0.07),
        Quat::from_rotation_y(turn),
    );
    cube.velocity = Vec3::X * (2.0 * wanted * 10.0).sqrt();
    cube.friction.coefficient = FRICTION;
    scene.add(cube);
    let mut moved = Moved::new(contacts, &scene);
    let sheet = sheet();
    let floor = match contacts {
        Contacts::Exact => SharedShape::new(sheet),
        Contacts::Stock => {
            let surface = sheet.surface();
            let (vertices, triangles) = (surface.vertices().to_vec(), surface.indices().to_vec());
            SharedShape::trimesh_with_flags(vertices, triangles, TriMeshFlags::FIX_INTERNAL_EDGES)
                .expect("a valid mesh")
        }
    };
    moved
        .world
        .insert_collider(ColliderBuilder::new(floor).friction(FRICTION), None);
    moved.step(HZ);
    let speed = moved.velocity(0).x;
    moved.step(HZ);
    let error = (speed - moved.velocity(0).x) / wanted - 1.0;
    moved.step(2 * HZ);
    (moved.position(0).x + 5.03, error)
}

#[test]
fn a_cube_slides_over_inner_edges() {
    for turn in [0.0, 0.3, 0.785] {
        let (way, error) = slide(Contacts::Exact, turn);
        let (stock_way, stock_error) = slide(Contacts::Stock, turn);
        println!(
            "turned by {turn}: {way:.3} m, {:+.2} %; rapier's: {stock_way:.3} m, {:+.2} %",
            100.0 * error,
            100.0 * stock_error
        );
        assert!(error.abs() < 0.01, "{error}");
        assert!((way - 10.0).abs() < 0.1, "{way}");
    }
}

/// The error of the acceleration of a ball that rolls down a slope.
fn roll(contacts: Contacts, degrees: f32, recycling: bool) -> f32 {
    let angle = degrees.to_radians();
    let (mut scene, turn) = slope(f64::from(angle));
    let at = turn * (Vec3::Y * (0.5 + 1e-5));
    scene.add(Body::new(
        Shape::Ball,
        at,
        Quat::from_euler(glam::EulerRot::XYZ, 0.3, 0.5, 0.7),
    ));
    let mut moved = Moved::new(contacts, &scene);
    moved.world.integration_parameters.contact_recycling = recycling;
    moved.step(2 * HZ);
    let down = Vec3::new(angle.cos(), -angle.sin(), 0.0);
    let wanted = 2.0 * 5.0 / 7.0 * 9.81 * angle.sin();
    moved.velocity(1).dot(down) / wanted - 1.0
}

#[test]
fn a_ball_of_triangles_rolls() {
    for degrees in [5.0, 10.0, 20.0] {
        for recycling in [false, true] {
            let [error, stock] = [Contacts::Exact, Contacts::Stock].map(|contacts| roll(contacts, degrees, recycling));
            println!(
                "{degrees} degrees, recycling {recycling}: {:+.2} %; rapier's: {:+.2} %",
                100.0 * error,
                100.0 * stock
            );
            assert!(error.abs() < 0.02, "{error}");
        }
    }
}

#[test]
fn a_knot_rests_on_a_cuboid_and_on_a_mesh() {
    let floor = vector(Vec3::new(2.0, 0.5, 2.0));
    let cuboid = SharedShape::cuboid(floor.x, floor.y, floor.z);
    let mesh = SharedShape::new(exact(Shape::Cube, Vec3::new(4.0, 1.0, 4.0)));
    for (name, floor) in [("cuboid", cuboid), ("mesh", mesh)] {
        let mut scene = Scene::new();
        scene.add(Body::new(Shape::Knot, Vec3::Y * 1.0, Quat::from_rotation_x(1.2)));
        let mut moved = Moved::new(Contacts::Exact, &scene);
        moved.world.insert_collider(
            ColliderBuilder::new(floor).translation(Vector::new(0.0, -0.5, 0.0)),
            None,
        );
        moved.step(5 * HZ);
        let (at, speed) = (moved.position(0), moved.velocity(0).length());
        let turn = moved.rotation(0);
        let vertices = Shape::Knot.mesh().mesh.vertices();
        let lowest = vertices
            .iter()
            .map(|&v| (turn * v + at).y)
            .fold(f32::INFINITY, f32::min);
        println!("{name}: at {at}, {speed} m/s, lowest vertex {lowest} m");
        assert!(speed < 0.02, "{name}: {speed}");
        assert!((-0.01..0.02).contains(&lowest), "{name}: {lowest}");
    }
}

#[test]
fn a_knot_enters_and_leaves_a_sensor() {
    let mut world = world();
    world.gravity = Vector::ZERO;
    // A knot is smaller than the box: it is inside before it leaves.
    let zone = exact(Shape::Cube, Vec3::splat(4.0));
    let zone = ColliderBuilder::new(SharedShape::new(zone))
        .sensor(true)
        .active_events(ActiveEvents::COLLISION_EVENTS);
    world.insert_collider(zone, None);
    let body = RigidBodyBuilder::dynamic()
        .translation(Vector::new(-5.0, 0.0, 0.0))
        .linvel(Vector::new(2.0, 0.0, 0.0));
    let knot = world.insert_body(body);
    world.insert_collider(
        ColliderBuilder::new(SharedShape::new(exact(Shape::Knot, Vec3::ONE))),
        Some(knot),
    );
    let (collisions, events) = channel();
    let collector = common::collector(collisions);
    for _ in 0..6 * HZ {
        world.step_with_events(&(), &collector);
    }
    let events: Vec<_> = events
        .try_iter()
        .map(|event| (event.started(), event.sensor()))
        .collect();
    assert_eq!(events, [(true, true), (false, true)]);
    let x = world.bodies[knot].translation().x;
    assert!((x - 7.0).abs() < 0.01, "a sensor stops nothing: {x}");
}

/// A hook that lets bodies through a platform from below.
struct OneWay;

impl PhysicsHooks for OneWay {
    fn modify_solver_contacts(&self, context: &mut ContactModificationContext) {
        let up = match context.collider1 == platform(context.colliders) {
            true => Vector::new(0.0, 1.0, 0.0),
            false => Vector::new(0.0, -1.0, 0.0),
        };
        context.update_as_oneway_platform(up, 0.5);
    }
}

/// The only collider of a scene that has hooks.
fn platform(colliders: &ColliderSet) -> ColliderHandle {
    let hooked = colliders
        .iter()
        .find(|(_, collider)| !collider.active_hooks().is_empty());
    hooked.expect("a platform").0
}

#[test]
fn a_platform_lets_bodies_through_from_below() {
    let mut heights = Vec::new();
    for hooked in [true, false] {
        let mut world = world();
        // Clusters of contacts forget what a platform's hook notes, for all composite shapes.
        world.integration_parameters.contact_clustering = false;
        let hooks = if hooked {
            ActiveHooks::MODIFY_SOLVER_CONTACTS
        } else {
            ActiveHooks::empty()
        };
        let shape = SharedShape::new(exact(Shape::Cube, Vec3::new(6.0, 0.2, 6.0)));
        world.insert_collider(ColliderBuilder::new(shape).active_hooks(hooks), None);
        let body = RigidBodyBuilder::dynamic()
            .translation(Vector::new(0.0, -1.0, 0.0))
            .linvel(Vector::new(0.0, 8.0, 0.0));
        let cube = world.insert_body(body);
        world.insert_collider(
            ColliderBuilder::new(SharedShape::new(exact(Shape::Cube, Vec3::splat(0.4)))),
            Some(cube),
        );
        for _ in 0..4 * HZ {
            match hooked {
                true => world.step_with_events(&OneWay, &()),
                false => world.step(),
            }
        }
        heights.push(world.bodies[cube].translation().y);
    }
    let [through, stopped] = [heights[0], heights[1]];
    assert!((0.28..0.32).contains(&through), "it lands on the platform: {through}");
    assert!(stopped < -1.0, "it bounces off: {stopped}");
}

/// A hook that makes all surfaces a conveyor belt.
struct Conveyor;

impl PhysicsHooks for Conveyor {
    fn modify_solver_contacts(&self, context: &mut ContactModificationContext) {
        let contacts = common::solver_contacts(context);
        for contact in contacts.iter_mut() {
            contact.tangent_velocity = Vector::new(1.0, 0.0, 0.0);
        }
    }
}

#[test]
fn a_hook_makes_a_conveyor_belt() {
    let mut scene = Scene::new();
    scene.floor(Vec3::new(40.0, 1.0, 4.0), Quat::IDENTITY);
    scene.add(Body::new(Shape::Knot, Vec3::Y * 0.7, Quat::from_rotation_x(1.2)));
    let mut moved = Moved::new(Contacts::Exact, &scene);
    for (_, collider) in moved.world.colliders.iter_mut() {
        collider.set_active_hooks(ActiveHooks::MODIFY_SOLVER_CONTACTS);
    }
    for _ in 0..4 * HZ {
        moved.world.step_with_events(&Conveyor, &());
    }
    let speed = moved.velocity(1).x.abs();
    assert!((0.9..1.1).contains(&speed), "{speed}");
}

#[test]
fn scaled_cubes_stack() {
    let mut scene = Scene::new();
    scene.floor(Vec3::new(10.0, 1.0, 10.0), Quat::IDENTITY);
    let mut top = 0.0;
    for scale in [
        Vec3::new(2.0, 0.5, 1.5),
        Vec3::new(-1.5, 1.0, 1.2),
        Vec3::new(0.8, 0.7, 0.9),
    ] {
        let at = Vec3::Y * (top + 0.5 * scale.y + 1e-4);
        scene.add(Body::new(Shape::Cube, at, Quat::IDENTITY)).scale = scale;
        top += scale.y;
    }
    let mut moved = Moved::new(Contacts::Exact, &scene);
    moved.step(4 * HZ);
    for (i, body) in scene.bodies.iter().enumerate() {
        let moved = moved.position(i).distance(body.position);
        assert!(moved < 0.01, "body {i} moved by {moved} m");
    }
}

#[test]
fn a_contact_skin_keeps_meshes_apart() {
    let mut scene = Scene::new();
    scene.floor(Vec3::new(10.0, 1.0, 10.0), Quat::IDENTITY);
    scene.add(Body::new(Shape::Cube, Vec3::Y * 0.7, Quat::IDENTITY));
    let mut moved = Moved::new(Contacts::Exact, &scene);
    for (_, collider) in moved.world.colliders.iter_mut() {
        collider.set_contact_skin(0.05);
    }
    moved.step(4 * HZ);
    let height = moved.position(1).y;
    assert!((height - 0.6).abs() < 0.01, "{height}");
}

#[test]
fn a_fast_cube_does_not_pass_a_thin_mesh() {
    // What is swept is convex, as with rapier's own meshes; the target is exact.
    let mut world = world();
    let wall = SharedShape::new(exact(Shape::Cube, Vec3::new(0.02, 4.0, 4.0)));
    world.insert_collider(ColliderBuilder::new(wall), None);
    let body = RigidBodyBuilder::dynamic()
        .translation(Vector::new(-3.1, 0.0, 0.0))
        .linvel(Vector::new(90.0, 0.0, 0.0));
    let ball = world.insert_body(body.ccd_enabled(true));
    world.insert_collider(ColliderBuilder::ball(0.1), Some(ball));
    for _ in 0..HZ {
        world.step();
    }
    let x = world.bodies[ball].translation().x;
    assert!(x < 0.0, "{x}");
}

#[test]
fn a_knot_hangs_on_a_spherical_joint() {
    let mut world = world();
    let anchor = world.insert_body(RigidBodyBuilder::fixed().translation(Vector::new(0.0, 2.0, 0.0)));
    let knot = world.insert_body(
        RigidBodyBuilder::dynamic()
            .translation(Vector::new(1.0, 2.0, 0.0))
            .can_sleep(false),
    );
    let shape = SharedShape::new(exact(Shape::Knot, Vec3::ONE));
    world.insert_collider(ColliderBuilder::new(shape.clone()), Some(knot));
    let joint = SphericalJointBuilder::new().local_anchor2(Vector::new(-1.0, 0.0, 0.0));
    world.insert_impulse_joint(anchor, knot, joint);
    // It swings against a second knot.
    let other = RigidBodyBuilder::fixed().translation(Vector::new(0.0, 1.0, 0.0));
    let other = world.insert_body(other);
    world.insert_collider(ColliderBuilder::new(shape), Some(other));
    let mut touched = false;
    for _ in 0..4 * HZ {
        world.step();
        touched |= world.contact_pairs().any(|pair| pair.has_any_active_contact());
        let body = &world.bodies[knot];
        let hook = body.position() * Vector::new(-1.0, 0.0, 0.0);
        let off = hook.distance(Vector::new(0.0, 2.0, 0.0));
        assert!(off < 0.02, "{off}");
    }
    assert!(touched);
}

#[test]
fn two_runs_have_the_same_bits() {
    let mut scene = Scene::new();
    scene.floor(Vec3::new(6.0, 1.0, 6.0), Quat::IDENTITY);
    for i in 0..12 {
        let at = Vec3::new(0.3 * (i % 3) as f32, 0.8 + 0.9 * i as f32, 0.2 * (i % 2) as f32);
        scene.add(Body::new(Shape::Knot, at, Quat::from_rotation_x(i as f32)));
    }
    let run = |threads: usize| {
        let pool = rayon_pool(threads);
        pool.install(|| {
            let mut moved = Moved::new(Contacts::Exact, &scene);
            moved.step(4 * HZ);
            let poses = (0..scene.bodies.len()).map(|i| (moved.position(i).to_array(), moved.rotation(i).to_array()));
            poses
                .map(|(at, turn)| (at.map(f32::to_bits), turn.map(f32::to_bits)))
                .collect::<Vec<_>>()
        })
    };
    let first = run(1);
    assert_eq!(first, run(1));
    assert_eq!(first, run(4));
}

fn rayon_pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("threads")
}

#[test]
fn a_copy_of_a_world_moves_as_the_world_does() {
    let mut scene = Scene::new();
    scene.floor(Vec3::new(6.0, 1.0, 6.0), Quat::IDENTITY);
    for i in 0..3 {
        scene.add(Body::new(
            Shape::Knot,
            Vec3::Y * (0.8 + i as f32),
            Quat::from_rotation_x(i as f32),
        ));
    }
    let mut moved = Moved::new(Contacts::Exact, &scene);
    moved.step(HZ);
    let world = &moved.world;
    let mut copy = Moved {
        world: PhysicsWorld {
            gravity: world.gravity,
            integration_parameters: world.integration_parameters,
            islands: world.islands.clone(),
            broad_phase: world.broad_phase.clone(),
            narrow_phase: world.narrow_phase.clone(),
            bodies: world.bodies.clone(),
            colliders: world.colliders.clone(),
            ..PhysicsWorld::new()
        },
        bodies: moved.bodies.clone(),
    };
    for moved in [&mut moved, &mut copy] {
        moved.step(HZ);
    }
    for i in 0..scene.bodies.len() {
        assert_eq!(moved.position(i), copy.position(i));
        assert_eq!(moved.rotation(i), copy.rotation(i));
    }
}

/// Hangs a chain of so many rings for so long, and returns the error of its length.
fn hang(rings: usize, seconds: usize, recycling: bool) -> f64 {
    let mut moved = Moved::new(Contacts::Exact, &chain::chain(rings, 0.74));
    moved.world.integration_parameters.contact_recycling = recycling;
    let ring = |moved: &Moved, i: usize| (moved.position(i).as_dvec3(), moved.rotation(i).as_dquat());
    for second in 0..seconds {
        moved.step(HZ);
        for i in 1..rings {
            let links = chain::linking_number(ring(&moved, i - 1), ring(&moved, i));
            assert_ne!(links, 0, "link {i} of {rings} is open after {second} s");
        }
    }
    let length = f64::from(moved.position(0).distance(moved.position(rings - 1)));
    length / chain::length(rings) - 1.0
}

#[test]
fn a_chain_of_ten_rings_hangs() {
    let error = hang(10, 10, true);
    println!("{:+.2} %", 100.0 * error);
    assert!(error.abs() < 0.02, "{error}");
}

#[test]
fn a_long_chain_hangs_if_contacts_are_not_recycled() {
    for rings in [20, 50] {
        let error = hang(rings, 20, false);
        println!("{rings} rings: {:+.2} %", 100.0 * error);
        assert!(error.abs() < 0.05, "{error}");
    }
}
