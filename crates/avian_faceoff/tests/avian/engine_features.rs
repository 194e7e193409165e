//! What Avian offers works with exact meshes.

use crate::world::{Contacts, HZ, World};
use avian_faceoff::prelude::*;
use avian3d::dynamics::solver::SolverConfig;
use avian3d::math::{AdjustPrecision, Vector};
use avian3d::prelude::*;
use bevy::ecs::system::SystemState;
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::testing::scenes::paper::{self, Paper};
use bevy_faceoff::testing::scenes::{Body, Scene, Shape};

const GRAVITY: Vec3 = Vec3::new(0.0, -9.81, 0.0);

/// A floor of 8 m whose top is at height 0, with more components, and a cube 2 m above it.
fn cube_and_floor(more: impl Bundle) -> (World, [Entity; 2]) {
    let mut world = World::new(Contacts::Exact);
    world.app.insert_resource(Gravity(GRAVITY.adjust_precision()));
    let mut floor = Body::new(Shape::Cube, Vec3::NEG_Y * 0.5, Quat::IDENTITY);
    (floor.fixed, floor.scale) = (true, Vec3::new(8.0, 1.0, 8.0));
    let floor = world.add_with(&floor, more);
    let cube = world.add(&Body::new(Shape::Cube, Vec3::Y * 2.0, Quat::IDENTITY));
    (world, [floor, cube])
}

#[test]
fn sensors_tell_and_let_through() {
    let (mut world, [floor, cube]) = cube_and_floor((Sensor, CollisionEventsEnabled));
    world.begin();
    let (mut started, mut ended) = (0, 0);
    for _ in 0..2 * HZ {
        world.step();
        let messages = |world: &World| {
            let ours = |a, b| [a, b] == [floor, cube] || [b, a] == [floor, cube];
            let starts = world.app.world().resource::<Messages<CollisionStart>>();
            let ends = world.app.world().resource::<Messages<CollisionEnd>>();
            (
                starts
                    .iter_current_update_messages()
                    .filter(|m| ours(m.collider1, m.collider2))
                    .count(),
                ends.iter_current_update_messages()
                    .filter(|m| ours(m.collider1, m.collider2))
                    .count(),
            )
        };
        let (s, e) = messages(&world);
        (started, ended) = (started + s, ended + e);
    }
    assert!(world.position(cube).y < -5.0, "it falls through");
    assert_eq!((started, ended), (1, 1));
}

#[test]
fn layers_part_meshes() {
    let (mut world, [_, cube]) = cube_and_floor(CollisionLayers::new(0b10, LayerMask::ALL));
    world
        .app
        .world_mut()
        .entity_mut(cube)
        .insert(CollisionLayers::new(0b01, 0b01));
    world.begin();
    world.steps(2 * HZ);
    assert!(world.position(cube).y < -5.0, "it falls through");
}

#[test]
fn bodies_sleep_and_wake() {
    let (mut world, [_, cube]) = cube_and_floor(());
    for body in world.bodies.clone() {
        world.app.world_mut().entity_mut(body).remove::<SleepingDisabled>();
    }
    world.begin();
    world.steps(4 * HZ);
    assert!(world.app.world().entity(cube).contains::<Sleeping>());
    let height = world.position(cube).y;
    assert!((height - 0.5).abs() < 0.01, "it sleeps at {height} m");
    // Another one falls on it.
    let other = world.add(&Body::new(Shape::Cube, Vec3::new(0.1, 3.0, 0.0), Quat::IDENTITY));
    world.steps(HZ);
    assert!(!world.app.world().entity(cube).contains::<Sleeping>());
    world.steps(2 * HZ);
    let height = world.position(other).y;
    assert!((height - 1.5).abs() < 0.02, "it lies at {height} m");
}

#[test]
fn spatial_queries_hit_meshes() {
    let (mut world, [_, cube]) = cube_and_floor(());
    world.app.insert_resource(Gravity(Vector::ZERO));
    world.begin();
    world.steps(2);
    let mut state: SystemState<SpatialQuery> = SystemState::new(world.app.world_mut());
    let query = state.get(world.app.world()).expect("a query");
    let from = Vec3::new(0.2, 5.0, 0.1).adjust_precision();
    let hit = query
        .cast_ray(from, Dir3::NEG_Y, 10.0, true, &SpatialQueryFilter::default())
        .expect("a hit");
    assert_eq!(hit.entity, cube);
    assert!((hit.distance - 2.5).abs() < 1e-4);
}

#[test]
fn fast_bodies_do_not_tunnel() {
    // Avian's speculative margin reaches as far as the body moves, and no farther than its size; `SweptCcd` covers the
    // rest.
    for swept in [false, true] {
        let mut world = World::new(Contacts::Exact);
        let mut scene = Scene::weightless();
        scene.block(Vec3::X * 3.0, Vec3::new(0.02, 4.0, 4.0));
        let bullet = scene.add(Body::new(Shape::Cube, Vec3::ZERO, Quat::IDENTITY));
        bullet.scale = Vec3::splat(0.5);
        bullet.velocity = Vec3::X * if swept { 100.0 } else { 20.0 };
        world.fill(&scene);
        let bullet = world.bodies[1];
        if swept {
            world.app.world_mut().entity_mut(bullet).insert(SweptCcd::default());
        }
        world.begin();
        world.steps(HZ);
        let x = world.position(bullet).x;
        assert!(x < 3.0, "swept {swept}: it is at {x} m");
    }
}

#[test]
fn small_bodies_rest_too() {
    // Avian's tolerances are lengths. Its unit tells it how small bodies are.
    let plugins = PhysicsPlugins::default().with_length_unit(0.04).with_exact_meshes();
    let mut world = World::with(Contacts::Exact, plugins);
    let mut scene = Scene::new();
    scene.floor(Vec3::new(1.0, 0.1, 1.0), Quat::IDENTITY);
    for i in 0..2 {
        let at = Vec3::Y * (0.02 + 0.0401 * i as f32);
        scene
            .add(Body::new(Shape::Cube, at, Quat::from_rotation_y(0.2 * i as f32)))
            .scale = Vec3::splat(0.04);
    }
    world.fill(&scene);
    world.app.insert_resource(Gravity(GRAVITY.adjust_precision()));
    world.begin();
    world.steps(5 * HZ);
    for (&body, start) in world.bodies.iter().zip(&scene.bodies) {
        let moved = world.position(body).distance(start.position);
        assert!(moved < 0.01, "a cube of 4 cm has moved by {moved} m");
    }
}

/// The paper's scene: tori in flight in a box, of which many lie deep in each other at first.
#[test]
fn energy_stays_low_where_bodies_begin_in_each_other() {
    let mesh = CollisionMesh::new(&shapes::torus_240());
    let count = 300;
    let paper = Paper {
        bodies: count,
        side: paper::default_side(count),
        speed: 0.5,
        seed: 1,
    };
    let mut world = World::new(Contacts::Exact);
    world
        .app
        .insert_resource(Gravity(Vector::ZERO))
        .insert_resource(DefaultFriction(Friction::ZERO))
        // Avian parts bodies at up to 4 m/s, eight times as fast as these fly.
        .insert_resource(SolverConfig {
            max_overlap_solve_speed: 0.5,
            ..default()
        });
    let side = paper.side + 8.0;
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        for out in [axis, -axis] {
            let size = (Vec3::splat(side) - axis * (side - 8.0)).adjust_precision();
            let at = Transform::from_translation(out * (0.5 * paper.side + 4.0));
            let wall = Collider::cuboid(size.x, size.y, size.z);
            world.app.world_mut().spawn((RigidBody::Static, wall, at));
        }
    }
    let mut random = fastrand::Rng::with_seed(1);
    let flyers: Vec<_> = paper.flyers(&mesh, || random.f32()).collect();
    let torus = world.app.world_mut().resource_mut::<Assets<CollisionMesh>>().add(mesh);
    for flyer in flyers {
        let body = world.app.world_mut().spawn((
            RigidBody::Dynamic,
            ExactCollider(torus.clone()),
            Transform {
                translation: flyer.position,
                rotation: flyer.rotation,
                scale: Vec3::splat(flyer.scale),
            },
            LinearVelocity(flyer.velocity.adjust_precision()),
            SleepingDisabled,
        ));
        let body = body.id();
        world.bodies.push(body);
    }
    world.begin();
    let start = world.kinetic_energy();
    let mut most: f64 = 0.0;
    for _ in 0..3 * HZ {
        world.step();
        most = most.max(world.kinetic_energy());
    }
    println!(
        "energy at most {:.0} % of the start, at the end {:.0} %",
        100.0 * most / start,
        100.0 * world.kinetic_energy() / start
    );
    assert!(most < 2.0 * start, "{most} J, {start} J at the start");
}
