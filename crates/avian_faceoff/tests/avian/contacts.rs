//! Contacts are those of the core, warm started, and the same in every run.

use crate::world::{Contacts, HZ, World, double};
use avian_faceoff::prelude::*;
use avian3d::prelude::*;
use bevy::ecs::system::SystemParam;
use bevy::math::{DQuat, DVec3};
use bevy::prelude::*;
use bevy_faceoff::queries::{ContactWorker, PairMemory, Placed};
use bevy_faceoff::testing::scenes::{Body, Scene, Shape, any_turn, pour};
use std::sync::Mutex;

/// Two knots that lie in each other a little.
fn crossed() -> Scene {
    let mut scene = Scene::weightless();
    scene.add(Body::new(Shape::Knot, Vec3::ZERO, Quat::IDENTITY));
    let other = scene.add(Body::new(
        Shape::Knot,
        Vec3::new(0.5, 0.2, 0.1),
        Quat::from_rotation_y(0.7),
    ));
    other.scale = Vec3::new(1.0, 1.2, 0.9);
    scene
}

/// Depths of the core's points, deepest first.
fn depths_by_the_core(scene: &Scene) -> Vec<f64> {
    let placed = [0, 1].map(|i| {
        let Body {
            shape,
            position,
            rotation,
            scale,
            ..
        } = scene.bodies[i];
        Placed::new(shape.mesh(), position.as_dvec3(), rotation.as_dquat(), scale).expect("a valid pose")
    });
    let mut points = Vec::new();
    // Avian's tolerance.
    let margin = double(NarrowPhaseConfig::default().contact_tolerance) as f32;
    ContactWorker::new().manifold(&placed[0], &placed[1], margin, &mut PairMemory::default(), &mut points);
    let mut depths: Vec<f64> = points.iter().map(|p| f64::from(-p.separation)).collect();
    depths.sort_by(|a, b| b.total_cmp(a));
    depths
}

#[test]
fn points_are_those_of_the_core() {
    let scene = crossed();
    let wanted = depths_by_the_core(&scene);
    assert!(wanted.len() > 4, "{wanted:?}");
    let mut world = World::of(Contacts::Exact, &scene);
    world.step();
    let points = world.points();
    let mut found: Vec<f64> = points.iter().map(|p| double(p.penetration)).collect();
    found.sort_by(|a, b| b.total_cmp(a));
    // Avian drops points that do not close in.
    assert!(
        found.len() > 4 && found.len() <= wanted.len(),
        "{found:?} of {wanted:?}"
    );
    for depth in &found {
        let nearest = wanted.iter().map(|w| (w - depth).abs()).fold(f64::INFINITY, f64::min);
        assert!(nearest < 1e-6, "{depth} is none of {wanted:?}");
    }
    let graph = world.app.world().resource::<ContactGraph>();
    assert!(
        graph
            .iter_active_touching()
            .all(|pair| pair.manifolds.iter().all(|m| m.points.len() <= 4))
    );
}

#[test]
fn a_rest_offset_keeps_surfaces_apart() {
    let height = |rest_offset: f32| {
        let mut scene = Scene::new();
        scene.floor(Vec3::new(4.0, 1.0, 4.0), Quat::IDENTITY);
        scene.add(Body::new(Shape::Cube, Vec3::Y * 0.52, Quat::IDENTITY));
        let mut world = World::new(Contacts::Exact);
        world.app.insert_resource(ExactContacts { rest_offset });
        world.fill(&scene);
        world.begin();
        world.steps(2 * HZ);
        f64::from(world.position(world.bodies[1]).y) - 0.5
    };
    let [none, some] = [height(0.0), height(0.01)];
    // 1 % of the cube's diagonal.
    assert!((some - none - 0.01732).abs() < 1e-4, "{none} m without, {some} m with");
    assert!(none.abs() < 5e-3, "{none}");
}

#[test]
fn a_large_body_rests_no_farther_apart_than_avian_finds_pairs() {
    let mut scene = Scene::new();
    scene.floor(Vec3::new(80.0, 20.0, 80.0), Quat::IDENTITY);
    let mut cube = Body::new(Shape::Cube, Vec3::Y * 10.1, Quat::IDENTITY);
    cube.scale = Vec3::splat(20.0);
    scene.add(cube);
    let mut world = World::new(Contacts::Exact);
    // 0.69 m: so far apart Avian has no pair, and the cube would hop for ever.
    world.app.insert_resource(ExactContacts { rest_offset: 0.02 });
    world.fill(&scene);
    world.begin();
    world.steps(3 * HZ);
    let cube = world.bodies[1];
    for _ in 0..HZ {
        world.step();
        let (gap, speed) = (world.position(cube).y - 10.0, world.velocity(cube).length());
        assert!((gap - 0.05).abs() < 0.01 && speed < 0.02, "{gap} m, {speed} m/s");
    }
}

/// The impulses that contacts begin with.
#[derive(Resource, Default)]
struct Starts(Mutex<f64>);

#[derive(SystemParam)]
struct Watch<'w> {
    starts: Res<'w, Starts>,
}

impl CollisionHooks for Watch<'_> {
    fn modify_contacts(&self, contacts: &mut ContactPair, _: &mut Commands) -> bool {
        let points = contacts.manifolds.iter().flat_map(|m| &m.points);
        *self.starts.0.lock().expect("no test panics in it") =
            points.map(|p| double(p.warm_start_normal_impulse)).sum();
        true
    }
}

#[test]
fn contacts_begin_with_the_impulses_of_the_last_step() {
    let plugins = PhysicsPlugins::default()
        .with_collision_hooks::<Watch>()
        .with_exact_meshes();
    let mut world = World::with(Contacts::Exact, plugins);
    world.app.init_resource::<Starts>();
    let mut scene = Scene::new();
    scene.floor(Vec3::new(4.0, 1.0, 4.0), Quat::IDENTITY);
    world.fill(&scene);
    let cube = Body::new(Shape::Cube, Vec3::Y * 0.5, Quat::from_rotation_y(0.3));
    world.add_with(&cube, ActiveCollisionHooks::MODIFY_CONTACTS);
    world.begin();
    world.steps(HZ);
    let found = *world
        .app
        .world()
        .resource::<Starts>()
        .0
        .lock()
        .expect("no test panics in it");
    // The weight of a kilogram in one of six substeps.
    let wanted = 9.81 / (6 * HZ) as f64;
    assert!((found / wanted - 1.0).abs() < 0.02, "{found} N s of {wanted}");
}

/// Poses of a pour after a second.
fn poured() -> Vec<(Vec3, Quat)> {
    let mut scene = Scene::new();
    pour::walls(&mut scene, 6.0, 2.4, 4.0);
    let mut random = fastrand::Rng::with_seed(3);
    pour::knots(&mut scene, 8, 2, || any_turn(&mut || random.f32()));
    let mut world = World::of(Contacts::Exact, &scene);
    world.steps(HZ);
    assert!(world.points().len() > 20, "they touch");
    world
        .bodies
        .iter()
        .map(|&body| (world.position(body), world.rotation(body)))
        .collect()
}

#[test]
fn two_runs_have_the_same_bits() {
    assert_eq!(poured(), poured());
}

#[test]
fn ten_kilometres_from_the_origin_contacts_are_the_same() {
    let near = Placed::new(Shape::Knot.mesh(), DVec3::ZERO, DQuat::IDENTITY, Vec3::ONE).expect("a valid pose");
    assert!(near.bounding_radius() > 0.4);
    let mut scene = Scene::new();
    scene.floor(Vec3::new(4.0, 1.0, 4.0), Quat::IDENTITY);
    scene.add(Body::new(Shape::Knot, Vec3::Y * 0.6, Quat::IDENTITY));
    for body in &mut scene.bodies {
        body.position += Vec3::X * 8192.0;
    }
    let mut world = World::of(Contacts::Exact, &scene);
    world.steps(3 * HZ);
    let height = world.position(world.bodies[1]).y;
    assert!((0.1..0.6).contains(&height), "it lies at {height} m");
    assert!(world.velocity(world.bodies[1]).length() < 0.05);
}
