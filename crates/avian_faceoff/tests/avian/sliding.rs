//! Bodies that slide and roll over meshes, beside Avian's own contacts.

use crate::world::{Contacts, HZ, World};
use avian_faceoff::prelude::*;
use avian3d::math::AdjustPrecision;
use avian3d::prelude::*;
use bevy::prelude::*;
use bevy_faceoff::geometry::TriMesh;
use bevy_faceoff::testing::scenes::incline::slope;
use bevy_faceoff::testing::scenes::{Body, Shape};
use bevy_faceoff::types::material::Friction as Surface;

const GRAVITY: f32 = 9.81;
const FRICTION: f32 = 0.2;
/// What friction lets the cube slide, metres.
const WAY: f32 = 10.0;
/// Edge of the floor's squares, metres.
const CELL: f32 = 0.25;

/// A sheet of squares, each of two triangles.
fn floor() -> TriMesh {
    let (wide, deep) = ((14.0 / CELL) as u32, (6.0 / CELL) as u32);
    let at = |i: u32, j: u32| Vec3::new(i as f32 * CELL - 7.0, 0.0, j as f32 * CELL - 3.0);
    let vertices = (0..=wide).flat_map(|i| (0..=deep).map(move |j| at(i, j))).collect();
    let faces = (0..wide)
        .flat_map(|i| (0..deep).map(move |j| (i, j)))
        .flat_map(|(i, j)| {
            let corner = |i: u32, j: u32| i * (deep + 1) + j;
            let [a, b, c, d] = [corner(i, j), corner(i, j + 1), corner(i + 1, j + 1), corner(i + 1, j)];
            [[a, b, c], [a, c, d]]
        });
    TriMesh::new(vertices, faces.collect()).expect("a valid mesh")
}

/// How a cube slides that begins with the speed for [`WAY`]: its acceleration in the second second, as a part of what
/// friction should give, and how far it gets.
fn slide(contacts: Contacts, turn: f32) -> (f32, f32) {
    let mut world = World::new(contacts);
    world
        .app
        .insert_resource(Gravity((Vec3::NEG_Y * GRAVITY).adjust_precision()));
    let mesh = floor();
    let vertices = mesh.vertices().iter().map(|v| v.adjust_precision()).collect();
    let mut floor = world.app.world_mut().spawn((
        RigidBody::Static,
        Collider::trimesh(vertices, mesh.triangles().to_vec()),
        Transform::default(),
        Friction::new(FRICTION.adjust_precision()),
    ));
    if contacts == Contacts::Exact {
        floor.insert(ExactTrimesh);
    }
    let mut cube = Body::new(Shape::Cube, Vec3::new(-5.03, 0.5, 0.07), Quat::from_rotation_y(turn));
    cube.velocity = Vec3::X * (2.0 * FRICTION * GRAVITY * WAY).sqrt();
    cube.friction = Surface::new(FRICTION);
    let cube = world.add(&cube);
    world.begin();
    let [mut first, mut second] = [0.0; 2];
    for step in 1..=4 * HZ {
        world.step();
        match step {
            HZ => first = world.velocity(cube).x,
            _ if step == 2 * HZ => second = world.velocity(cube).x,
            _ => {}
        }
    }
    ((first - second) / (FRICTION * GRAVITY), world.position(cube).x + 5.03)
}

#[test]
fn a_cube_slides_ten_metres_over_triangles() {
    for turn in [0.0, 0.3, 0.785] {
        let (acceleration, way) = slide(Contacts::Exact, turn);
        let (avian, avian_way) = slide(Contacts::Avian, turn);
        println!(
            "turned by {turn}: acceleration {:+.3} %, {way:.3} m; with Avian's contacts {:+.0} %, {avian_way:.3} m",
            100.0 * (acceleration - 1.0),
            100.0 * (avian - 1.0)
        );
        assert!(
            (acceleration - 1.0).abs() < 0.01,
            "{acceleration} of what friction gives"
        );
        assert!((way / WAY - 1.0).abs() < 0.01, "{way} m");
    }
}

#[test]
fn a_ball_rolls_down_a_slope() {
    for degrees in [5.0_f64, 20.0] {
        let speed = |contacts| {
            let (mut scene, turn) = slope(degrees.to_radians());
            scene.add(Body::new(
                Shape::Ball,
                turn * (Vec3::Y * 0.5),
                Quat::from_rotation_z(0.4),
            ));
            let mut world = World::of(contacts, &scene);
            world.steps(2 * HZ);
            f64::from(world.velocity(world.bodies[1]).length())
        };
        let wanted = 2.0 * 5.0 / 7.0 * f64::from(GRAVITY) * degrees.to_radians().sin();
        let [exact, avian] = [Contacts::Exact, Contacts::Avian].map(|contacts| speed(contacts) / wanted - 1.0);
        println!(
            "{degrees} degrees: {:+.2} %; with Avian's contacts {:+.1} %",
            100.0 * exact,
            100.0 * avian
        );
        assert!(exact.abs() < 0.01, "{exact}");
    }
}

#[test]
fn a_cube_stays_on_a_slope_that_friction_holds() {
    let (mut scene, turn) = slope(20.0_f64.to_radians());
    scene.add(Body::new(
        Shape::Cube,
        turn * (Vec3::Y * 0.5),
        turn * Quat::from_rotation_y(0.5),
    ));
    let mut world = World::of(Contacts::Exact, &scene);
    world.steps(HZ);
    let from = world.position(world.bodies[1]);
    world.steps(10 * HZ);
    let creep = world.position(world.bodies[1]).distance(from);
    println!("creeps by {:.1} mm in 10 s", 1e3 * creep);
    // Avian's soft contacts creep a little.
    assert!(creep < 0.025, "{creep} m");
}
