//! Loads that passes alone do not hold: taut chains, and light bodies between heavy ones.

use crate::world::World;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::state::Body;
use bevy_faceoff::testing::scenes::chain::{chain, linking_number};
use bevy_faceoff::testing::scenes::{RING_LINE, RING_TUBE};
use bevy_faceoff::types::body::RigidBody;
use bevy_faceoff::types::material::Friction;
use glam::{DQuat, DVec3, Mat3, Quat, Vec3};
use std::f32::consts::FRAC_PI_2;
use std::f64::consts::{PI, TAU};

/// How far linked rings are apart when they are taut.
const LINK: f32 = (2.0 * (RING_LINE - RING_TUBE)) as f32;

/// The sum of kinetic and potential energy of all bodies that move, joules.
fn energy(world: &World) -> f64 {
    let bodies = &world.state.input.bodies;
    let gravity = world.state.input.config.gravity;
    let moving = (0..bodies.len()).filter(|&i| bodies.kind[i] == RigidBody::Dynamic);
    moving
        .map(|i| {
            let mass = bodies.inverse_mass[i].recip();
            let turn = Mat3::from_quat(bodies.rotation[i]);
            let spin = turn.transpose() * bodies.angular_velocity[i];
            let inertia = bodies.local_inverse_inertia[i].inverse();
            let kinetic = 0.5 * (mass * bodies.linear_velocity[i].length_squared() + spin.dot(inertia * spin));
            f64::from(kinetic) - f64::from(mass) * bodies.frame[i].center.dot(gravity.as_dvec3())
        })
        .sum()
}

fn assert_linked(world: &World, count: usize, when: &str) {
    let ring = |i: usize| {
        let frame = &world.state.input.bodies.frame[i];
        (frame.center, DQuat::from_mat3(&frame.rotation))
    };
    for i in 1..count {
        assert_eq!(
            linking_number(ring(i - 1), ring(i)).abs(),
            1,
            "{when}: rings {} and {i}",
            i - 1
        );
    }
}

/// A link: two half rings, joined by straight parts.
fn link() -> TriMesh {
    const ARC: usize = 9;
    const SIDES: usize = 10;
    let [radius, straight, tube] = [0.4f64, 0.5, 0.1];
    let section = |i: usize| {
        let turn = PI * (i % ARC) as f64 / (ARC - 1) as f64 + if i < ARC { 0.0 } else { PI };
        let out = DVec3::new(turn.cos(), turn.sin(), 0.0);
        let side = if i < ARC { 0.5 } else { -0.5 };
        let center = radius * out + DVec3::Y * side * straight;
        (0..SIDES).map(move |j| {
            let around = TAU * j as f64 / SIDES as f64;
            (center + tube * (around.cos() * out + around.sin() * DVec3::Z)).as_vec3()
        })
    };
    let points = (0..2 * ARC).flat_map(section).collect();
    let corner = |i: usize, j: usize| (i % (2 * ARC) * SIDES + j % SIDES) as u32;
    let quads = (0..2 * ARC).flat_map(|i| (0..SIDES).map(move |j| (i, j)));
    let faces = quads.flat_map(|(i, j)| {
        let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    TriMesh::new(points, faces.collect()).unwrap()
}

/// Lets a chain of `count` links between two fixed ones fall and swing. It has hardly any slack. Returns the most
/// energy that it has above the start, over the most kinetic energy.
fn excess(count: usize, friction: f32, rate: f32, seconds: f32) -> f64 {
    // A link's length between its neighbours, less than a millimetre.
    const PITCH: f32 = 2.0 * (0.4 - 0.1) + 0.5 - 0.001;
    let mut world = World::new();
    world.state.input.config.dt = rate.recip();
    let mesh = world.mesh(&link());
    for i in 0..count + 2 {
        // Along x; every other one lies.
        let turn = Quat::from_rotation_x(FRAC_PI_2 * (i % 2) as f32) * Quat::from_rotation_z(FRAC_PI_2);
        let kind = if i == 0 || i > count {
            RigidBody::Static
        } else {
            RigidBody::Dynamic
        };
        let body = world.add(kind, mesh, Vec3::ONE, Vec3::X * (PITCH * i as f32), turn);
        world.state.input.bodies.params[body].friction = Friction::new(friction);
    }
    let start = energy(&world);
    let (mut most, mut kinetic) = (0.0f64, 0.0f64);
    let height = |world: &World| (0..count + 2).map(|i| world.center(i).y).sum::<f64>();
    let weight = 9.81 / f64::from(world.state.input.bodies.inverse_mass[1]);
    let first = height(&world);
    for _ in 0..(seconds * rate) as u32 {
        world.step();
        let above = energy(&world) - start;
        most = most.max(above);
        kinetic = kinetic.max(above - weight * (height(&world) - first));
    }
    println!(
        "{count} links, friction {friction}, {rate} Hz: {:.2e} of {kinetic:.2} J above the start; deepest {:.2} %",
        most / kinetic,
        100.0 * world.deepest()
    );
    assert!(world.deepest() < 0.01);
    most / kinetic
}

#[test]
fn a_taut_chain_gains_no_energy() {
    for (friction, rate) in [(0.3, 64.0), (0.5, 30.0), (0.5, 64.0), (0.5, 240.0)] {
        assert!(excess(16, friction, rate, 3.0) < 1.0e-3, "{friction} {rate}");
    }
    for (count, friction) in [(32, 0.3), (64, 0.3), (64, 0.5)] {
        assert!(excess(count, friction, 64.0, 2.0) < 1.0e-3, "{count} {friction}");
    }
}

/// A ring hangs in a fixed one, and a load of `ratio` times its mass hangs in it.
fn hanging(ratio: f32, friction: f32) -> World {
    let mut scene = chain(3, LINK - 0.001);
    scene.bodies[2].density *= ratio;
    for body in &mut scene.bodies {
        body.friction = Friction::new(friction);
    }
    World::of(&scene)
}

#[test]
fn a_light_ring_holds_a_heavy_one() {
    for (ratio, friction) in [(1000.0, 0.3), (1000.0, 0.5), (10000.0, 0.5)] {
        let mut world = hanging(ratio, friction);
        let start = world.center(2);
        for _ in 0..320 {
            world.step();
        }
        let sunk = (start - world.center(2)).length();
        println!(
            "ratio {ratio}, friction {friction}: moved {sunk:.5} m, deepest {:.3} %",
            100.0 * world.deepest()
        );
        assert_linked(&world, 3, "hanging");
        assert!(sunk < 0.01, "{ratio} {friction}: {sunk}");
    }
}

#[test]
fn a_chain_of_a_hundred_holds_a_load_of_a_thousand() {
    let mut scene = chain(100, LINK - 0.001);
    scene.bodies[99].density *= 1000.0;
    let mut world = World::of(&scene);
    let (start, mut most) = (energy(&world), f64::NEG_INFINITY);
    for _ in 0..320 {
        world.step();
        most = most.max(energy(&world) - start);
    }
    assert_linked(&world, 100, "chain");
    let length = world.center(0).distance(world.center(99));
    let wanted = f64::from(99.0 * LINK);
    println!(
        "{length:.4} m of {wanted:.4}, {most:.2} J above the start, fastest {:.4} m/s, deepest {:.2} %",
        world.fastest(),
        100.0 * world.deepest()
    );
    assert!((length / wanted - 1.0).abs() < 0.01);
    assert!(most <= 0.0);
}

#[test]
fn a_cube_stands_below_one_of_a_thousand_times_its_mass() {
    for friction in [0.0, 0.5] {
        let mut world = World::new();
        let cube = world.mesh(&shapes::cube(1.0));
        world.add(
            RigidBody::Static,
            cube,
            Vec3::new(20.0, 1.0, 20.0),
            Vec3::NEG_Y * 0.5,
            Quat::IDENTITY,
        );
        world.add(RigidBody::Dynamic, cube, Vec3::ONE, Vec3::Y * 0.6, Quat::IDENTITY);
        world.add(
            RigidBody::Dynamic,
            cube,
            Vec3::splat(10.0),
            Vec3::Y * 6.4,
            Quat::IDENTITY,
        );
        for i in 0..3 {
            world.state.input.bodies.params[i].friction = Friction::new(friction);
        }
        // Without friction nothing keeps it from drifting.
        for _ in 0..if friction > 0.0 { 640 } else { 128 } {
            world.step();
        }
        let [small, large] = [1, 2].map(|i| world.center(i));
        println!("friction {friction}: {small:.4} {large:.4} {:.5} m/s", world.fastest());
        assert!(small.x.hypot(small.z) < 0.05, "{small}");
        assert!(
            (small.y - 0.5).abs() < 0.005 && (large.y - 6.0).abs() < 0.01,
            "{small} {large}"
        );
    }
}

/// Cubes of 1 m below ones of 10 times their edge, and towers of 5 cubes of a centimetre, all far from each other. The
/// centres of the first two cubes after a second.
fn beside(heavy: usize, towers: usize) -> [DVec3; 2] {
    let mut world = World::new();
    let cube = world.mesh(&shapes::cube(1.0));
    for i in 0..heavy + towers {
        let at = Vec3::X * 40.0 * i as f32;
        let block = Vec3::new(20.0, 1.0, 20.0);
        world.add(RigidBody::Static, cube, block, at - Vec3::Y * 0.5, Quat::IDENTITY);
    }
    for i in 0..heavy {
        let at = Vec3::X * 40.0 * i as f32;
        world.add(RigidBody::Dynamic, cube, Vec3::ONE, at + Vec3::Y * 0.51, Quat::IDENTITY);
        world.add(
            RigidBody::Dynamic,
            cube,
            Vec3::splat(10.0),
            at + Vec3::Y * 6.02,
            Quat::IDENTITY,
        );
    }
    for i in heavy..heavy + towers {
        for k in 0..5 {
            let at = Vec3::new(40.0 * i as f32, 0.01 * (0.5 + k as f32), 0.0);
            world.add(RigidBody::Dynamic, cube, Vec3::splat(0.01), at, Quat::IDENTITY);
        }
    }
    for _ in 0..64 {
        world.step();
    }
    [0, 1].map(|i| world.center(heavy + towers + i))
}

#[test]
fn a_heavy_load_moves_alike_whatever_is_beside_it() {
    let alone = beside(1, 0);
    assert_eq!(beside(4, 0), alone, "beside others like it");
    assert_eq!(beside(4, 4), alone, "beside some that need more substeps");
}

#[test]
fn a_small_box_holds_a_safe_that_falls_on_it() {
    for density in [8.0, 100.0, 1000.0] {
        let mut world = World::new();
        let cube = world.mesh(&shapes::cube(1.0));
        let floor = Vec3::new(20.0, 1.0, 20.0);
        world.add(RigidBody::Static, cube, floor, Vec3::NEG_Y * 0.5, Quat::IDENTITY);
        let small = world.add(
            RigidBody::Dynamic,
            cube,
            Vec3::splat(0.4),
            Vec3::Y * 0.2,
            Quat::IDENTITY,
        );
        let safe = world.put(&Body {
            density,
            ..Body::at_rest(cube, Vec3::Y * 1.6, Quat::IDENTITY, Vec3::splat(2.0))
        });
        world.seconds(5);
        let [small, safe] = [small, safe].map(|i| world.center(i));
        println!(
            "ratio {}: {small:.4} {safe:.4} {:.4} m/s",
            125.0 * density,
            world.fastest()
        );
        assert!(
            (small.y - 0.2).abs() < 0.002 && (safe.y - 1.4).abs() < 0.004,
            "{small} {safe}"
        );
        assert!(world.fastest() < 0.01);
    }
}
