//! How colliders become exact.

use crate::world::{Contacts, HZ, World};
use avian_faceoff::prelude::*;
use avian3d::math::AdjustPrecision;
use avian3d::prelude::*;
use bevy::prelude::*;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::testing::scenes::{Body, Shape};
use std::time::{Duration, Instant};

fn handle(world: &World, entity: Entity) -> Option<Handle<CollisionMesh>> {
    world
        .app
        .world()
        .get::<ExactCollider>(entity)
        .map(|exact| exact.0.clone())
}

fn trimesh(shape: Shape) -> Collider {
    let mesh = &shape.mesh().mesh;
    let vertices = mesh.vertices().iter().map(|v| v.adjust_precision()).collect();
    Collider::trimesh(vertices, mesh.triangles().to_vec())
}

#[test]
fn a_collider_is_made_of_the_mesh_at_once() {
    let mut world = World::new(Contacts::Exact);
    let knot = world.add(&Body::new(Shape::Knot, Vec3::ZERO, Quat::IDENTITY));
    let collider = world.app.world().get::<Collider>(knot).expect("a collider");
    let triangles = collider.shape().as_trimesh().expect("a mesh").indices().len();
    assert_eq!(triangles, Shape::Knot.mesh().mesh.triangles().len());
    assert!(!world.app.world().entity(knot).contains::<RigidBodyDisabled>());
}

#[test]
fn a_body_waits_for_its_mesh() {
    let folder = std::env::temp_dir().join(format!("avian_faceoff_{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let cube = "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n\
                f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    std::fs::write(folder.join("cube.obj"), cube).expect("a file");
    let mut app = App::new();
    let step = Duration::from_secs(1) / HZ as u32;
    app.add_plugins((
        MinimalPlugins,
        TransformPlugin,
        AssetPlugin {
            file_path: folder.to_string_lossy().into_owned(),
            ..default()
        },
        PhysicsPlugins::default().with_exact_meshes(),
    ))
    .insert_resource(Time::<Fixed>::from_duration(step))
    .insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(step));
    let [mesh, missing] = ["cube.obj", "missing.obj"].map(|path| app.world().resource::<AssetServer>().load(path));
    app.world_mut().spawn((
        RigidBody::Static,
        Collider::cuboid(9.0, 1.0, 9.0),
        Transform::from_xyz(0.0, -5.0, 0.0),
    ));
    let [cube, broken] =
        [mesh, missing].map(|mesh| app.world_mut().spawn((RigidBody::Dynamic, ExactCollider(mesh))).id());
    assert!(app.world().entity(cube).contains::<RigidBodyDisabled>());
    app.finish();
    app.cleanup();
    let start = Instant::now();
    while !app.world().entity(cube).contains::<Collider>() {
        app.update();
        assert!(start.elapsed() < Duration::from_secs(60), "the mesh does not load");
    }
    let height = |app: &App, entity| app.world().get::<Position>(entity).expect("a position").y;
    assert!(height(&app, cube) > -0.01, "it has not fallen");
    for _ in 0..2 * HZ {
        app.update();
    }
    let end = height(&app, cube);
    assert!((end + 3.5).abs() < 0.02, "it falls now, to {end} m");
    assert!(!app.world().entity(broken).contains::<Collider>());
    assert_eq!(height(&app, broken), 0.0, "it waits");
    std::fs::remove_dir_all(&folder).expect("it was there");
}

#[test]
fn a_collider_follows_a_mesh_that_is_replaced() {
    let mut world = World::new(Contacts::Exact);
    let body = world.add(&Body::new(Shape::Cube, Vec3::ZERO, Quat::IDENTITY));
    world.begin();
    let mesh = handle(&world, body).expect("an exact collider");
    let mut meshes = world.app.world_mut().resource_mut::<Assets<CollisionMesh>>();
    meshes
        .insert(mesh.id(), CollisionMesh::new(&shapes::cube(3.0)))
        .expect("it is there");
    world.steps(2);
    let collider = world.app.world().get::<Collider>(body).expect("a collider");
    let bounds = collider.shape().compute_local_aabb();
    assert!((bounds.maxs.x - 1.5).abs() < 1e-6, "{bounds:?}");
}

#[test]
fn a_collider_follows_a_handle_whose_mesh_comes_later() {
    let mut world = World::new(Contacts::Exact);
    let body = world.add(&Body::new(Shape::Cube, Vec3::ZERO, Quat::IDENTITY));
    world.begin();
    let meshes = world.app.world_mut().resource_mut::<Assets<CollisionMesh>>();
    let later = meshes.reserve_handle();
    world
        .app
        .world_mut()
        .entity_mut(body)
        .insert(ExactCollider(later.clone()));
    world.steps(2);
    let mut meshes = world.app.world_mut().resource_mut::<Assets<CollisionMesh>>();
    meshes
        .insert(later.id(), CollisionMesh::new(&shapes::cube(3.0)))
        .expect("it is reserved");
    world.steps(2);
    let collider = world.app.world().get::<Collider>(body).expect("a collider");
    let bounds = collider.shape().compute_local_aabb();
    assert!((bounds.maxs.x - 1.5).abs() < 1e-6, "{bounds:?}");
}

#[test]
fn a_collider_that_was_made_of_a_mesh_is_not_baked_again() {
    let mut world = World::new(Contacts::Exact);
    let body = world.add_with(&Body::new(Shape::Cube, Vec3::ZERO, Quat::IDENTITY), ExactTrimesh);
    world.begin();
    let mesh = handle(&world, body);
    world.steps(3);
    assert_eq!(handle(&world, body), mesh);
}

#[test]
fn triangle_meshes_are_baked_and_shared() {
    let mut world = World::new(Contacts::Exact);
    let collider = trimesh(Shape::Ring);
    let spawn = |world: &mut World, collider: Collider| {
        world
            .app
            .world_mut()
            .spawn((RigidBody::Static, collider, ExactTrimesh))
            .id()
    };
    let [a, b] = [0, 1].map(|_| spawn(&mut world, collider.clone()));
    let other = spawn(&mut world, trimesh(Shape::Ring));
    let ball = spawn(&mut world, Collider::sphere(1.0));
    world.begin();
    world.step();
    let handles = [a, b, other].map(|entity| handle(&world, entity).expect("an exact collider"));
    assert_eq!(handles[0], handles[1], "one shape, one bake");
    assert_ne!(handles[0], handles[2]);
    assert_eq!(handle(&world, ball), None, "an error was logged");
    let meshes = world.app.world().resource::<Assets<CollisionMesh>>();
    let baked = meshes.get(&handles[0]).expect("a bake");
    assert_eq!(baked.mesh.triangles().len(), Shape::Ring.mesh().mesh.triangles().len());

    // Another shape, and back to a mesh.
    world.app.world_mut().entity_mut(a).insert(Collider::sphere(1.0));
    world.app.world_mut().entity_mut(ball).insert(collider);
    world.step();
    assert_eq!(handle(&world, a), None);
    assert_eq!(handle(&world, ball), Some(handles[1].clone()));
}

#[test]
fn a_new_trimesh_in_place_of_a_made_collider_is_exact() {
    let mut world = World::new(Contacts::Exact);
    let body = world.add_with(&Body::new(Shape::Cube, Vec3::ZERO, Quat::IDENTITY), ExactTrimesh);
    world.begin();
    world
        .app
        .world_mut()
        .entity_mut(body)
        .insert((trimesh(Shape::Knot), ExactTrimesh));
    world.steps(2);
    let mesh = handle(&world, body).expect("an exact collider");
    let meshes = world.app.world().resource::<Assets<CollisionMesh>>();
    let triangles = meshes.get(&mesh).expect("a bake").mesh.triangles().len();
    assert_eq!(triangles, Shape::Knot.mesh().mesh.triangles().len());
}

#[test]
fn a_collider_in_place_of_a_made_one_is_kept() {
    let mut world = World::new(Contacts::Exact);
    let body = world.add(&Body::new(Shape::Cube, Vec3::ZERO, Quat::IDENTITY));
    world.begin();
    world
        .app
        .world_mut()
        .entity_mut(body)
        .insert(Collider::cuboid(2.0, 2.0, 2.0));
    let mesh = handle(&world, body).expect("an exact collider");
    let mut meshes = world.app.world_mut().resource_mut::<Assets<CollisionMesh>>();
    meshes
        .insert(mesh.id(), CollisionMesh::new(&shapes::cube(1.5)))
        .expect("it is there");
    world.steps(2);
    let collider = world.app.world().get::<Collider>(body).expect("a collider");
    assert!(collider.shape().as_cuboid().is_some(), "it was replaced");
}

/// A body that has a mesh of these faces and does not move.
fn fixed(world: &mut World, vertices: &[[f32; 3]], faces: &[[u32; 4]]) -> Entity {
    let vertices = vertices.iter().map(|&v| v.into()).collect();
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let mesh = TriMesh::new(vertices, triangles).expect("a mesh");
    let ecs = world.app.world_mut();
    let mesh = ecs
        .resource_mut::<Assets<CollisionMesh>>()
        .add(CollisionMesh::new(&mesh));
    ecs.spawn((RigidBody::Static, ExactCollider(mesh), Transform::default()))
        .id()
}

/// Drops a ball, a box and a capsule. Their heights after three seconds.
fn dropped(world: &mut World) -> [f32; 3] {
    let colliders = [
        Collider::sphere(0.3),
        Collider::cuboid(0.6, 0.6, 0.6),
        Collider::capsule(0.2, 0.2),
    ];
    let mut x = -2.4;
    let bodies = colliders.map(|collider| {
        x += 1.2;
        let pose = Transform::from_xyz(x, 0.6, 0.0);
        world.app.world_mut().spawn((RigidBody::Dynamic, collider, pose)).id()
    });
    world.begin();
    world.steps(3 * HZ);
    bodies.map(|body| world.position(body).y)
}

#[test]
fn shapes_of_avian_stay_in_an_open_bin() {
    // Walls of one layer that look outward, and no lid.
    let mut world = World::new(Contacts::Exact);
    let corners = [
        [-2.0, 0.0, -1.0],
        [2.0, 0.0, -1.0],
        [2.0, 0.0, 1.0],
        [-2.0, 0.0, 1.0],
        [-2.0, 2.0, -1.0],
        [2.0, 2.0, -1.0],
        [2.0, 2.0, 1.0],
        [-2.0, 2.0, 1.0],
    ];
    let sides = [[0, 1, 2, 3], [0, 4, 5, 1], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 4, 0]];
    fixed(&mut world, &corners, &sides);
    for height in dropped(&mut world) {
        assert!((0.15..0.45).contains(&height), "{height} m");
    }
}

#[test]
fn shapes_of_avian_stay_on_a_sheet_that_looks_down() {
    let mut world = World::new(Contacts::Exact);
    let corners = [[-3.0, 0.0, -3.0], [3.0, 0.0, -3.0], [3.0, 0.0, 3.0], [-3.0, 0.0, 3.0]];
    fixed(&mut world, &corners, &[[0, 1, 2, 3]]);
    for height in dropped(&mut world) {
        assert!((0.15..0.45).contains(&height), "{height} m");
    }
}

#[test]
fn closed_meshes_have_no_inner_edges() {
    let mut world = World::new(Contacts::Exact);
    let flags = |world: &World, entity| {
        let collider = world.app.world().get::<Collider>(entity).expect("a collider");
        collider.shape().as_trimesh().expect("a mesh").flags()
    };
    let solid = world.add(&Body::new(Shape::Cube, Vec3::ZERO, Quat::IDENTITY));
    assert!(flags(&world, solid).contains(TrimeshFlags::FIX_INTERNAL_EDGES.into()));
    let corners = [[-3.0, 0.0, -3.0], [3.0, 0.0, -3.0], [3.0, 0.0, 3.0], [-3.0, 0.0, 3.0]];
    let sheet = fixed(&mut world, &corners, &[[0, 1, 2, 3]]);
    assert!(flags(&world, sheet).is_empty());
}

#[test]
fn scaled_children_touch() {
    // A dumb-bell of two scaled knots falls on a mesh.
    let mut world = World::new(Contacts::Exact);
    world
        .app
        .insert_resource(Gravity((Vec3::NEG_Y * 9.81).adjust_precision()));
    let mut floor = Body::new(Shape::Cube, Vec3::NEG_Y * 0.5, Quat::IDENTITY);
    (floor.fixed, floor.scale) = (true, Vec3::new(6.0, 1.0, 6.0));
    world.add(&floor);
    let body = world
        .app
        .world_mut()
        .spawn((RigidBody::Dynamic, SleepingDisabled, Transform::from_xyz(0.0, 1.5, 0.0)))
        .id();
    for x in [-1.0, 1.0] {
        let pose = Transform::from_xyz(x, 0.0, 0.0).with_scale(Vec3::splat(1.5));
        let child = world.app.world_mut().spawn((ChildOf(body), pose)).id();
        world.shape(child, Shape::Knot);
    }
    world.begin();
    world.steps(4 * HZ);
    let height = world.position(body).y;
    // The knot is 0.35 thick where it lies flat, and 1 where it stands.
    assert!((0.2..0.8).contains(&height), "it lies at {height} m");
    assert!(world.velocity(body).length() < 0.1);
    assert!(world.points().len() >= 3);
}

#[test]
fn without_the_plugin_of_assets_the_app_goes_on() {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        TransformPlugin,
        PhysicsPlugins::default().with_exact_meshes(),
    ));
    app.world_mut()
        .spawn((RigidBody::Dynamic, trimesh(Shape::Cube), ExactTrimesh));
    app.finish();
    app.cleanup();
    for _ in 0..4 {
        app.update();
    }
}
