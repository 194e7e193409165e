//! Meshes on meshes: resting, stacked, linked, poured.

use crate::world::{GAP, World};
use bevy_faceoff::components::RigidBody;
use bevy_faceoff::geometry::shapes;
use glam::{DVec3, Quat, Vec3};

#[test]
fn a_cube_rests_on_a_mesh() {
    let mut world = World::new();
    let cube = world.mesh(&shapes::cube(1.0));
    world.floor(cube);
    let at = Vec3::new(0.3, 0.5 + GAP, 0.2);
    let body = world.add(RigidBody::Dynamic, cube, Vec3::ONE, at, Quat::from_rotation_y(0.4));
    let start = world.center(body);
    world.seconds(20);
    let moved = world.center(body).distance(start);
    println!("moved {moved:.6} m in 20 s");
    assert!(moved < 1.0e-3, "{moved}");
}

#[test]
fn ten_cubes_stay_on_each_other() {
    let mut world = World::new();
    let cube = world.mesh(&shapes::cube(1.0));
    world.floor(cube);
    let stack: Vec<usize> = (0..10)
        .map(|i| {
            let at = Vec3::Y * (0.5 + GAP + (1.0 + GAP) * i as f32);
            let turn = Quat::from_rotation_y(0.1 * i as f32);
            world.add(RigidBody::Dynamic, cube, Vec3::ONE, at, turn)
        })
        .collect();
    let start: Vec<DVec3> = stack.iter().map(|&i| world.center(i)).collect();
    world.seconds(20);
    let moved = stack.iter().zip(&start).map(|(&i, s)| world.center(i).distance(*s));
    let most = moved.fold(0.0, f64::max);
    println!(
        "moved {most:.6} m in 20 s, deepest {}, fastest {}",
        world.deepest(),
        world.fastest()
    );
    assert!(most < 0.01 && world.fastest() < 1.0e-3, "{most}");
}

#[test]
fn a_chain_of_rings_hangs_still() {
    let mut world = World::new();
    let ring = world.mesh(&shapes::ring());
    let count = 50;
    for i in 0..count {
        let kind = if i == 0 { RigidBody::Static } else { RigidBody::Dynamic };
        let turn = Quat::from_rotation_y(if i % 2 == 0 { 0.0 } else { std::f32::consts::FRAC_PI_2 });
        world.add(kind, ring, Vec3::ONE, Vec3::NEG_Y * (0.74 * i as f32), turn);
    }
    world.seconds(10);
    let links = (1..count).map(|i| world.center(i - 1).distance(world.center(i)));
    let longest = links.fold(0.0, f64::max);
    let (deepest, fastest) = (world.deepest(), world.fastest());
    println!("after 10 s: longest link {longest:.4} m, deepest {deepest:.5} m, fastest {fastest:.4} m/s");
    // Two diameters of the tube less than that of the ring, and the gap: 0.76 m and a little.
    assert!((0.74..0.79).contains(&longest), "{longest}");
    assert!(deepest < 0.02, "{deepest}");
    assert!(fastest < 0.3, "{fastest}");
}

#[test]
fn bodies_poured_into_a_bin_come_to_rest() {
    for (name, mesh, count, seconds) in [
        ("tori", shapes::torus_240(), 40, 6),
        ("knots", shapes::knot_1120(), 12, 6),
    ] {
        let mut world = World::new();
        let cube = world.mesh(&shapes::cube(1.0));
        let poured = world.mesh(&mesh);
        world.floor(cube);
        for (scale, at) in [
            (Vec3::new(1.0, 30.0, 6.0), Vec3::new(-2.0, 15.0, 0.0)),
            (Vec3::new(1.0, 30.0, 6.0), Vec3::new(2.0, 15.0, 0.0)),
            (Vec3::new(6.0, 30.0, 1.0), Vec3::new(0.0, 15.0, -2.0)),
            (Vec3::new(6.0, 30.0, 1.0), Vec3::new(0.0, 15.0, 2.0)),
        ] {
            world.add(RigidBody::Static, cube, scale, at, Quat::IDENTITY);
        }
        let mut random = fastrand::Rng::with_seed(3);
        for i in 0..count {
            let side = if i % 2 == 0 { 0.54 } else { -0.54 };
            let at = Vec3::new(1.6 * (random.f32() - 0.5), 0.8 + 0.9 * (i / 2) as f32, side);
            let turn = Quat::from_scaled_axis(Vec3::new(random.f32(), random.f32(), random.f32()) * 3.0);
            world.add(RigidBody::Dynamic, poured, Vec3::splat(0.8), at, turn);
        }
        let mut deepest = 0.0f32;
        for _ in 0..64 * seconds {
            world.step();
            deepest = deepest.max(world.deepest());
        }
        let (still_deep, fastest) = (world.deepest(), world.fastest());
        println!("{name}: deepest on the way {deepest:.4} m, then {still_deep:.4} m, fastest {fastest:.4} m/s");
        for i in 5..5 + count {
            let c = world.center(i);
            assert!(c.x.abs() < 1.5 && c.z.abs() < 1.5 && c.y > 0.0, "{name} {i} is at {c}");
        }
        // The last ones land with 18 m/s.
        assert!(still_deep < 0.01 && deepest < 0.2, "{name}: {still_deep}, {deepest}");
        assert!(fastest < 0.1, "{name}: {fastest}");
    }
}
