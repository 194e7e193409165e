//! Bodies that move by more than their size per step, shot at a thin plate.

use crate::world::World;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::state::{Body, BodyParams};
use bevy_faceoff::types::body::RigidBody;
use glam::{Quat, Vec3};

const DT: f32 = 1.0 / 64.0;

fn unit(random: &mut fastrand::Rng) -> Vec3 {
    loop {
        let v = Vec3::from_array([0; 3].map(|_| 2.0 * random.f32() - 1.0));
        if (0.01..1.0).contains(&v.length_squared()) {
            return v.normalize();
        }
    }
}

/// Shoots `tries` bullets of diameter 1 at a plate in the plane z = 0, at `sizes` diameters per step, and counts those
/// that are on the other side a few steps later. They rotate by up to `spin` radians per step.
pub fn passed(bullet: &TriMesh, sizes: f32, spin: f32, tries: usize, continuous: bool) -> usize {
    let mut random = fastrand::Rng::with_seed(sizes as u64);
    let mut world = World::new();
    world.state.input.config.gravity = Vec3::ZERO;
    let (mesh, cube) = (world.mesh(bullet), world.mesh(&shapes::cube(1.0)));
    let mut bullets = Vec::new();
    for try_ in 0..tries {
        // The pairs are far from each other.
        let home = Vec3::new((try_ % 32) as f32, (try_ / 32) as f32, 0.0) * 4.0e3;
        let thin = Vec3::new(3.0e3, 3.0e3, 0.01);
        world.add(RigidBody::Static, cube, thin, home, Quat::IDENTITY);
        // At an angle of at least 17 degrees to the plate, from any distance within the path of one step.
        let mut way = unit(&mut random);
        way.z = -way.z.abs().max(0.3);
        let way = way.normalize();
        let speed = sizes / DT;
        let start = home - way * (1.0 / way.z.abs() + sizes * random.f32());
        let body = Body {
            linear_velocity: way * speed,
            angular_velocity: unit(&mut random) * spin * random.f32() / DT,
            params: BodyParams {
                continuous,
                ..BodyParams::default()
            },
            ..Body::at_rest(mesh, start, Quat::from_scaled_axis(unit(&mut random) * 3.0), Vec3::ONE)
        };
        world.state.input.bodies.push(&body, &world.state.input.meshes).unwrap();
        bullets.push(world.state.input.bodies.len() - 1);
    }
    for _ in 0..4 {
        world.step();
    }
    let behind = bullets.iter().filter(|&&i| world.center(i).z < 0.0);
    behind.count()
}

#[test]
fn no_bullet_passes_a_thin_plate() {
    for (name, bullet, spin, tries) in [
        ("ball", shapes::ball_320(), 10.0, 300),
        ("torus", shapes::torus_240(), 0.0, 100),
        ("torus that spins", shapes::torus_240(), 10.0, 100),
        ("cube that spins", shapes::cube(0.577), 10.0, 100),
    ] {
        for sizes in [5.0, 50.0, 500.0] {
            let passed = passed(&bullet, sizes, spin, tries, true);
            println!("{name}, {sizes} sizes per step: {passed} of {tries} pass");
            assert_eq!(passed, 0, "{name}, {sizes} sizes per step");
        }
    }
}

#[test]
fn without_continuous_collision_nearly_all_pass() {
    let passed = passed(&shapes::ball_320(), 50.0, 10.0, 100, false);
    assert!(passed > 50, "{passed} of 100");
}

/// Size of the plates for small bullets, metres.
const PLATE: f64 = 400.0;
/// Direction of their flight.
pub const WAY: Vec3 = Vec3::new(-0.953, -0.286, -0.0953);

/// A plate of 1 cm in the plane x = 0.
pub fn plate(kind: RigidBody, velocity: Vec3, spin: Vec3) -> Body {
    Body {
        kind,
        linear_velocity: velocity,
        angular_velocity: spin,
        ..Body::at_rest(
            0,
            Vec3::ZERO,
            Quat::IDENTITY,
            Vec3::new(0.01, PLATE as f32, PLATE as f32),
        )
    }
}

/// Shoots a bullet of 2 cm without friction from x = 2 at `plate`. Returns whether the bullet got through within half a
/// second, and the velocities of the bullet and of the plate.
pub fn shoot(plate: Body, bullet: &TriMesh, velocity: Vec3, spin: Vec3) -> (bool, [Vec3; 2]) {
    let mut world = World::weightless();
    let (cube, bullet) = (world.mesh(&shapes::cube(1.0)), world.mesh(bullet));
    let plate = world.put(&Body { mesh: cube, ..plate });
    let mut body = Body {
        linear_velocity: velocity,
        angular_velocity: spin,
        ..Body::at_rest(bullet, Vec3::new(2.0, 0.6, 0.2), Quat::IDENTITY, Vec3::ONE)
    };
    body.params.continuous = true;
    body.params.friction.coefficient = 0.0;
    let bullet = world.put(&body);
    let seen_from_plate = |world: &World| {
        let turned = world.state.input.bodies.rotation[plate].as_dquat();
        turned.inverse() * (world.center(bullet) - world.center(plate))
    };
    let mut before = seen_from_plate(&world);
    let mut through = false;
    for _ in 0..32 {
        world.step();
        let after = seen_from_plate(&world);
        if before.x > 0.0 && after.x <= 0.0 {
            // It may also have slid around the edge.
            let there = before.lerp(after, before.x / (before.x - after.x));
            through |= there.y.abs().max(there.z.abs()) < 0.5 * PLATE;
        }
        before = after;
    }
    (through, [bullet, plate].map(|i| world.velocity(i)))
}

pub fn small_ball() -> TriMesh {
    shapes::ball(0.01, 2)
}

fn small_torus() -> TriMesh {
    let torus = shapes::torus_240();
    let vertices = torus.vertices().iter().map(|vertex| *vertex * 0.02).collect();
    TriMesh::new(vertices, torus.triangles().to_vec()).unwrap()
}

#[test]
fn no_bullet_passes_a_moving_plate() {
    for (name, plate) in [
        ("comes", plate(RigidBody::Kinematic, Vec3::X * 0.5, Vec3::ZERO)),
        ("comes faster", plate(RigidBody::Kinematic, Vec3::X * 1.5, Vec3::ZERO)),
        ("goes away", plate(RigidBody::Kinematic, Vec3::X * -0.5, Vec3::ZERO)),
        ("slides", plate(RigidBody::Kinematic, Vec3::Y * 0.5, Vec3::ZERO)),
        (
            "comes by its inertia",
            plate(RigidBody::Dynamic, Vec3::X * 0.5, Vec3::ZERO),
        ),
        ("does not move", plate(RigidBody::Static, Vec3::ZERO, Vec3::ZERO)),
    ] {
        for number in 1..=20 {
            let speed = 20.0 * number as f32;
            let (through, [bullet, plate]) = shoot(plate, &small_ball(), WAY * speed, Vec3::ZERO);
            assert!(!through, "at {speed} m/s, the plate {name}");
            // It is not moving through the plate either: the slowest bullet had 19 m/s.
            let parting = bullet.x - plate.x;
            assert!(parting > -0.5, "{parting} m/s from {speed} m/s, the plate {name}");
        }
    }
}

#[test]
fn no_bullet_passes_a_rotating_plate() {
    for spin in [0.05, -0.05] {
        for number in 1..=20 {
            let speed = 20.0 * number as f32;
            let plate = plate(RigidBody::Kinematic, Vec3::ZERO, Vec3::Z * spin);
            let (through, _) = shoot(plate, &small_ball(), WAY * speed, Vec3::ZERO);
            assert!(!through, "at {speed} m/s, turning at {spin}");
        }
    }
}

#[test]
fn no_spinning_bullet_passes_a_fixed_plate() {
    let mut random = fastrand::Rng::with_seed(3);
    for (name, bullet) in [
        ("ball", small_ball()),
        ("cube", shapes::cube(0.01)),
        ("torus", small_torus()),
    ] {
        for number in 0..24 {
            let speed = 1500.0 + 120.0 * number as f32;
            let spin = unit(&mut random) * 500.0;
            let plate = plate(RigidBody::Static, Vec3::ZERO, Vec3::ZERO);
            let (through, _) = shoot(plate, &bullet, WAY * speed, spin);
            assert!(!through, "{name} at {speed} m/s with spin {spin}");
        }
    }
}

/// A door closes onto a wall, both 1 cm thick, with a fast bullet between them.
#[test]
fn a_bullet_between_a_door_and_a_wall_stays_there_until_it_is_crushed() {
    for speed in [0.0, 5.0, 50.0, 300.0] {
        let mut world = World::weightless();
        let (cube, ball) = (world.mesh(&shapes::cube(1.0)), world.mesh(&small_ball()));
        world.put(&Body {
            mesh: cube,
            ..plate(RigidBody::Static, Vec3::ZERO, Vec3::ZERO)
        });
        let door = world.put(&Body {
            mesh: cube,
            position: Vec3::X * 0.3,
            ..plate(RigidBody::Kinematic, Vec3::X * -0.5, Vec3::ZERO)
        });
        let mut bullet = Body {
            linear_velocity: Vec3::X * speed,
            restitution: 1.0,
            ..Body::at_rest(ball, Vec3::X * 0.05, Quat::IDENTITY, Vec3::ONE)
        };
        bullet.params.continuous = true;
        let bullet = world.put(&bullet);
        for _ in 0..40 {
            world.step();
            let [of_bullet, of_door] = [bullet, door].map(|i| world.center(i).x);
            assert!(of_bullet > 0.0, "through the wall at {speed} m/s");
            // Half of the door's thickness and the bullet's radius.
            let room = of_door > 0.03;
            assert!(!room || of_bullet < of_door, "through the door at {speed} m/s");
        }
    }
}
