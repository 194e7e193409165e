//! Friction: sticking, sliding, rolling, and bodies carried by others.

use super::shapes::Shape;
use super::world::{World, check, check_below};
use bevy_faceoff::types::body::RigidBody;
use glam::{DQuat, DVec3, Vec3};

const CUBE: Shape = Shape::Box(DVec3::splat(0.5));

/// A shape on a slope of this angle, a rest offset above it. All coefficients of friction are 0.5.
fn on_slope(shape: Shape, degrees: f64) -> (World, usize, DVec3) {
    let mut world = World::heavy();
    let slope = degrees.to_radians();
    world.floor(slope);
    let gap = 0.001 * shape.radius() as f64;
    let up = DQuat::from_rotation_z(slope) * DVec3::Y;
    let body = world.dynamic(shape, 2.0, up * (0.5 + gap));
    world.motion(body).rotation = DQuat::from_rotation_z(slope);
    // Down the slope.
    (world, body, DQuat::from_rotation_z(slope) * DVec3::NEG_X)
}

pub fn a_box_sticks_to_a_slope_below_the_friction_angle() {
    // atan(0.5) is 26.57 degrees.
    for degrees in [10.0, 20.0, 25.0] {
        let (mut world, cube, _) = on_slope(CUBE, degrees);
        let start = world.center(cube);
        world.seconds(10.0);
        let slid = world.center(cube).distance(start);
        check_below(&format!("{degrees} degrees: slid in 10 s, metres"), slid, 1.0e-3);
    }
}

pub fn a_box_slides_down_a_slope_above_the_friction_angle() {
    for degrees in [28.0f64, 35.0, 45.0] {
        let (mut world, cube, down) = on_slope(CUBE, degrees);
        world.seconds(0.5);
        let before = world.velocity(cube).as_dvec3().dot(down);
        world.seconds(1.0);
        let found = world.velocity(cube).as_dvec3().dot(down) - before;
        let wanted = 9.81 * (degrees.to_radians().sin() - 0.5 * degrees.to_radians().cos());
        check(
            &format!("{degrees} degrees: acceleration"),
            found,
            wanted,
            0.03 * wanted,
        );
        check_below(
            "turned, radians",
            world
                .motion(cube)
                .rotation
                .angle_between(DQuat::from_rotation_z(degrees.to_radians())),
            0.01,
        );
    }
}

pub fn a_ball_rolls_down_a_slope_without_sliding() {
    for degrees in [5.0f64, 10.0, 20.0] {
        let (mut world, ball, down) = on_slope(Shape::Sphere(0.5), degrees);
        world.seconds(0.5);
        let before = world.velocity(ball).as_dvec3().dot(down);
        world.seconds(1.0);
        let after = world.velocity(ball).as_dvec3().dot(down);
        let wanted = 5.0 / 7.0 * 9.81 * degrees.to_radians().sin();
        check(
            &format!("{degrees} degrees: acceleration"),
            after - before,
            wanted,
            0.03 * wanted,
        );
        let slip = after - 0.505 * world.spin(ball).length() as f64;
        check_below("slips, m/s", slip.abs(), 0.02 * after);
    }
}

pub fn a_ball_that_slides_comes_to_roll_at_five_sevenths_of_its_speed() {
    let mut world = World::heavy();
    world.floor(0.0);
    let ball = world.dynamic(Shape::Sphere(0.5), 1.0, DVec3::Y * 0.505);
    world.motion(ball).linear_velocity = Vec3::X * 3.0;
    world.seconds(1.5);
    check("speed", world.velocity(ball).x as f64, 3.0 * 5.0 / 7.0, 0.03);
    check("spin", world.spin(ball).z as f64 * -0.5, 3.0 * 5.0 / 7.0, 0.04);
    let then = world.velocity(ball).x;
    world.seconds(2.0);
    check("it rolls on", world.velocity(ball).x as f64, then as f64, 0.02);
}

pub fn a_box_stops_after_the_distance_that_friction_allows() {
    let mut world = World::heavy();
    world.floor(0.0);
    let cube = world.dynamic(CUBE, 1.0, DVec3::Y * (0.5 + 0.000866));
    world.motion(cube).linear_velocity = Vec3::X * 2.0;
    world.seconds(2.0);
    let way = 2.0 * 2.0 / (2.0 * 0.5 * 9.81);
    check("distance", world.center(cube).x, way, 0.02 * way);
    check("speed", world.velocity(cube).length() as f64, 0.0, 1.0e-3);
}

pub fn a_platform_carries_a_box() {
    let mut world = World::heavy();
    let platform = Shape::Box(DVec3::new(3.0, 0.25, 3.0));
    let platform = world.immovable(platform, RigidBody::Kinematic, DVec3::Y * -0.25);
    let cube = world.dynamic(CUBE, 1.0, DVec3::Y * (0.5 + 0.000866));
    world.seconds(0.25);
    world.motion(platform).linear_velocity = Vec3::new(1.0, 0.0, 0.5);
    world.seconds(2.0);
    let wanted = Vec3::new(1.0, 0.0, 0.5);
    check(
        "carried, m/s",
        (world.velocity(cube) - wanted).length() as f64,
        0.0,
        1.0e-3,
    );
    // It slips until friction has accelerated it to the platform's speed.
    let v = wanted.length() as f64;
    let slip = (world.center(cube) - world.center(platform)) * DVec3::new(1.0, 0.0, 1.0);
    check("slip", slip.length(), v * v / (2.0 * 0.5 * 9.81), 0.02);
    check(
        "the platform keeps its speed",
        (world.velocity(platform) - wanted).length() as f64,
        0.0,
        0.0,
    );
}

pub fn a_turntable_carries_a_box() {
    let mut world = World::heavy();
    let table = Shape::Box(DVec3::new(3.0, 0.25, 3.0));
    let table = world.immovable(table, RigidBody::Kinematic, DVec3::Y * -0.25);
    // One revolution in ten seconds; 0.39 m/s^2 at the box.
    world.motion(table).angular_velocity = Vec3::Y * std::f32::consts::TAU * 0.1;
    let cube = world.dynamic(CUBE, 1.0, DVec3::new(1.0, 0.5 + 0.000866, 0.0));
    world.motion(cube).linear_velocity = Vec3::Z * -std::f32::consts::TAU * 0.1;
    world.motion(cube).angular_velocity = world.spin(table);
    world.seconds(10.0);
    let apart = (world.center(cube) - DVec3::X) * DVec3::new(1.0, 0.0, 1.0);
    check("offset after a revolution, metres", apart.length(), 0.0, 0.03);
}

pub fn a_slab_tips_over_its_edge_as_a_pendulum_does() {
    // Contact points are fixed to the bodies until the next detection, so accuracy depends on the number of collision
    // substeps.
    for (collision_substeps, tolerance) in [(1, 0.03), (8, 0.01)] {
        let mut world = World::heavy();
        world.collision_substeps = Some(collision_substeps);
        world.floor(0.0);
        let half = DVec3::new(0.05, 0.5, 0.5);
        let slab = world.dynamic(Shape::Box(half), 1.0, DVec3::ZERO);
        for body in &mut world.bodies.bodies {
            body.friction = 3.0;
        }
        let tilt = DQuat::from_rotation_z(-0.3);
        world.motion(slab).rotation = tilt;
        let start = DVec3::Y * 0.001 * half.length() - tilt * DVec3::new(0.05, -0.5, 0.0);
        world.motion(slab).center = start;
        while (world.motion(slab).rotation * DVec3::Y).y > 0.6 {
            world.step(1);
        }
        let about_edge = (0.05f64.powi(2) + 0.25) * 4.0 / 3.0;
        let wanted = (2.0 * 9.81 * (start.y - world.center(slab).y) / about_edge).sqrt();
        check(
            &format!("{collision_substeps} collision substeps: rad/s"),
            -world.spin(slab).z as f64,
            wanted,
            tolerance * wanted,
        );
    }
}
