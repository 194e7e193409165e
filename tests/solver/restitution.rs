//! Restitution: outgoing speeds by Newton's law, and conserved quantities.

use super::shapes::Shape;
use super::world::{World, check};
use bevy_faceoff::types::body::RigidBody;
use bevy_faceoff::types::material::CombineRule;
use glam::{DVec3, Vec3};

const BALL: Shape = Shape::Sphere(0.5);

/// Two balls of these masses collide along x at 3 m/s, `sideways` off the line of centres, without friction.
fn meet(masses: [f32; 2], restitution: f32, sideways: f64) -> (World, Vec3) {
    let mut world = World::new();
    let a = world.dynamic(BALL, masses[0], DVec3::new(-1.0, 0.0, 0.0));
    let b = world.dynamic(BALL, masses[1], DVec3::new(1.0, sideways, 0.0));
    world.motion(a).linear_velocity = Vec3::X * 2.0;
    world.motion(b).linear_velocity = Vec3::X * -1.0;
    for i in [a, b] {
        world.bodies.bodies[i].restitution = restitution;
        world.bodies.bodies[i].friction = 0.0;
    }
    // The normal at the moment of contact, a rest offset apart.
    let along = (1.005f64.powi(2) - sideways * sideways).sqrt();
    let normal = DVec3::new(along, sideways, 0.0).normalize().as_vec3();
    let before = world.measure();
    world.seconds(1.5);
    let after = world.measure();
    assert!((after.linear - before.linear).length() < 1.0e-5 * before.size);
    assert!((after.angular - before.angular).length() < 1.0e-4 * before.size);
    (world, normal)
}

pub fn balls_leave_by_their_restitution_head_on_and_oblique() {
    for restitution in [0.0, 0.5, 1.0] {
        for (masses, sideways) in [([1.0, 1.0], 0.0), ([1.0, 1.0], 0.6), ([1.0, 4.0], 0.3)] {
            let (world, n) = meet(masses, restitution, sideways);
            let closing = 3.0 * n.x;
            let size = (1.0 + restitution) * closing / (1.0 / masses[0] + 1.0 / masses[1]);
            let wanted = [
                Vec3::X * 2.0 - n * (size / masses[0]),
                Vec3::X * -1.0 + n * (size / masses[1]),
            ];
            for (i, wanted) in wanted.iter().enumerate() {
                let error = (world.velocity(i) - *wanted).length() / closing;
                check(
                    &format!("e {restitution}, {sideways} off, ball {i} of {masses:?}: error over closing speed"),
                    error as f64,
                    0.0,
                    0.01,
                );
            }
        }
    }
}

pub fn a_ball_that_bounces_on_a_floor_keeps_its_height() {
    let mut world = World::heavy();
    world.floor(0.0);
    world.bodies.bodies[0].restitution = 1.0;
    let ball = world.dynamic(BALL, 1.0, DVec3::Y * 1.5);
    world.bodies.bodies[ball].restitution = 1.0;
    let mut tops = Vec::new();
    let mut rising = false;
    for _ in 0..64 * 5 {
        world.step(1);
        let up = world.velocity(ball).y > 0.0;
        if rising && !up {
            tops.push(world.center(ball).y);
        }
        rising = up;
    }
    assert!(tops.len() >= 4, "{tops:?}");
    println!("tops {tops:?}");
    for (i, top) in tops.iter().enumerate() {
        // In the collision substep of the impact the acceleration by gravity is lost: half a percent of the speed.
        check("height of the top", *top, 1.5, 0.012 * (i + 1) as f64);
    }
}

pub fn a_flat_box_bounces_without_turning() {
    let mut world = World::heavy();
    world.floor(0.0);
    world.bodies.bodies[0].restitution = 0.6;
    let cube = world.dynamic(Shape::Box(DVec3::splat(0.5)), 1.0, DVec3::Y * 1.5);
    world.bodies.bodies[cube].restitution = 0.6;
    let mut speed = 0.0f32;
    while world.velocity(cube).y <= 0.0 {
        speed = -world.velocity(cube).y;
        world.step(1);
        assert!(speed < 10.0);
    }
    let fallen = (2.0 * 9.81 * (1.0 - 0.0005 * 3.0f32.sqrt())).sqrt();
    check("impact", speed as f64, fallen as f64, 0.2);
    check(
        "outgoing",
        world.velocity(cube).y as f64,
        0.6 * fallen as f64,
        0.03 * fallen as f64,
    );
    assert!(world.spin(cube).length() < 1.0e-3, "{}", world.spin(cube));
}

pub fn slow_impacts_do_not_bounce() {
    let mut world = World::new();
    let wall = world.immovable(BALL, RigidBody::Static, DVec3::ZERO);
    let ball = world.dynamic(BALL, 1.0, DVec3::X * 1.1);
    world.motion(ball).linear_velocity = Vec3::X * -0.4;
    for i in [wall, ball] {
        world.bodies.bodies[i].restitution = 1.0;
    }
    world.seconds(2.0);
    check("speed", world.velocity(ball).length() as f64, 0.0, 0.01);
}

pub fn the_stronger_rule_combines() {
    use CombineRule::*;
    let combined = |a, b, x, y| CombineRule::combine([a, b], [x, y]);
    assert_eq!(combined(Average, Average, 0.2, 0.6), 0.4);
    assert_eq!(combined(Average, Min, 0.2, 0.6), 0.2);
    assert_eq!(combined(Multiply, Min, 0.5, 0.5), 0.25);
    assert_eq!(combined(Max, Multiply, 0.2, 0.6), 0.6);
    assert!((combined(GeometricMean, Average, 0.4, 0.9) - 0.6).abs() < 1.0e-6);
    assert_eq!(combined(Max, Max, f32::NAN, -3.0), 0.0);
}

pub fn a_fast_ball_does_not_get_through_a_thin_wall() {
    for speed in [5.0f32, 20.0, 60.0, 200.0] {
        let mut world = World::new();
        let wall = Shape::Box(DVec3::new(0.02, 2.0, 2.0));
        world.immovable(wall, RigidBody::Static, DVec3::ZERO);
        let ball = world.dynamic(Shape::Sphere(0.1), 1.0, DVec3::new(-3.017, 0.03, 0.05));
        world.motion(ball).linear_velocity = Vec3::new(speed, 0.0, 0.0);
        let mut farthest = f64::NEG_INFINITY;
        for _ in 0..64 {
            world.step(1);
            farthest = farthest.max(world.center(ball).x);
        }
        // Part of the speed remains after the first substep.
        let slack = 0.002 + speed as f64 * 1.0e-4;
        check(
            &format!("{speed} m/s: the farthest its centre came"),
            farthest,
            -0.12,
            slack,
        );
    }
}
