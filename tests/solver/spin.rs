//! Free rotation of bodies.

use super::shapes::Shape;
use super::world::{World, check, check_below};
use glam::{DQuat, DVec3, Mat3, Vec3};

const BRICK: Shape = Shape::Box(DVec3::new(1.0, 0.5, 0.2));

#[test]
fn free_rotation_keeps_angular_momentum_and_energy_for_a_minute() {
    for spin in [
        Vec3::new(1.0, 2.0, 3.0),
        Vec3::new(8.0, 0.1, 8.0),
        Vec3::new(0.0, 20.0, 0.3),
    ] {
        let mut world = World::new();
        world.collision_substeps = Some(1);
        let body = world.dynamic(BRICK, 3.0, DVec3::new(1.0, 2.0, 3.0));
        world.motion(body).angular_velocity = spin;
        world.motion(body).rotation = DQuat::from_rotation_x(0.3);
        let before = world.measure();
        let (mut drift, mut energy) = (0.0f64, 0.0f64);
        for _ in 0..64 * 60 {
            world.step(1);
            let now = world.measure();
            drift = drift.max((now.angular - before.angular).length() / before.angular.length());
            energy = energy.max((now.kinetic / before.kinetic - 1.0).abs());
        }
        check_below(&format!("{spin}: angular momentum, relative drift"), drift, 1.0e-3);
        check_below("energy, relative drift", energy, 0.01);
    }
}

#[test]
fn the_middle_axis_flips() {
    // Dzhanibekov effect: rotation about the axis of the intermediate moment of inertia (y here) is unstable.
    let flips = |size: f64, spin: Vec3, axis: DVec3| {
        let mut world = World::new();
        let brick = Shape::Box(size * DVec3::new(1.0, 0.5, 0.2));
        let body = world.dynamic(brick, size.powi(3) as f32, DVec3::ZERO);
        world.motion(body).angular_velocity = spin;
        let (mut flips, mut up) = (0, true);
        for _ in 0..64 * 30 {
            world.step(1);
            let height = (world.motion(body).rotation * axis).dot(axis);
            if height.abs() > 0.8 && up != (height > 0.0) {
                (flips, up) = (flips + 1, height > 0.0);
            }
        }
        flips
    };
    // From a splinter of a millimetre to a mountain.
    for size in [1.0e-3, 1.0, 1.0e3] {
        let middle = flips(size, Vec3::new(0.01, 5.0, 0.01), DVec3::Y);
        println!("flips about the middle axis in 30 s: {middle}");
        assert!(middle >= 4, "{size} m: {middle}");
        assert_eq!(flips(size, Vec3::new(5.0, 0.01, 0.01), DVec3::X), 0);
        assert_eq!(flips(size, Vec3::new(0.01, 0.01, 5.0), DVec3::Z), 0);
    }
}

#[test]
fn a_flip_takes_the_time_of_eulers_equations() {
    // Reference in double precision, with tiny steps, in the body's axes.
    let spin = DVec3::new(0.05, 4.0, 0.0);
    let inertia = BRICK.inertia(1.0).as_dmat3();
    let inverse = inertia.inverse();
    let slope = |w: DVec3| inverse * (inertia * w).cross(w);
    let (mut w, h, mut time) = (spin, 1.0e-4, 0.0);
    while w.y > 0.0 {
        let k1 = slope(w);
        let k2 = slope(w + k1 * (0.5 * h));
        let k3 = slope(w + k2 * (0.5 * h));
        let k4 = slope(w + k3 * h);
        w += (k1 + 2.0 * k2 + 2.0 * k3 + k4) * (h / 6.0);
        time += h;
    }
    let mut world = World::new();
    let body = world.dynamic(BRICK, 1.0, DVec3::ZERO);
    world.motion(body).angular_velocity = spin.as_vec3();
    let mut steps = 0;
    loop {
        world.step(1);
        steps += 1;
        let motion = world.motion(body);
        if (motion.rotation.conjugate() * motion.angular_velocity.as_dvec3()).y <= 0.0 {
            break;
        }
        assert!(steps < 6400);
    }
    check("time of the first flip", steps as f64 / 64.0, time, 0.03 * time);
}

#[test]
fn a_slender_body_that_spins_very_fast_stays_bounded() {
    let mut world = World::new();
    world.collision_substeps = Some(1);
    let needle = Shape::Box(DVec3::new(1.0, 0.05, 0.06));
    let body = world.dynamic(needle, 0.1, DVec3::ZERO);
    world.motion(body).angular_velocity = Vec3::new(300.0, 4.0, 7.0);
    let before = world.measure();
    for _ in 0..640 {
        world.step(1);
        let now = world.measure();
        assert!(
            now.kinetic < 1.05 * before.kinetic,
            "{} {}",
            now.kinetic,
            before.kinetic
        );
    }
    check("energy, relative", world.measure().kinetic / before.kinetic, 1.0, 0.05);
    let drift = (world.measure().angular - before.angular).length() / before.angular.length();
    check_below("angular momentum, relative drift", drift, 1.0e-2);
}

#[test]
fn a_ball_keeps_its_spin_to_the_bit() {
    let mut world = World::new();
    let ball = world.dynamic(Shape::Sphere(0.5), 1.0, DVec3::ZERO);
    let spin = Vec3::new(1.0, 2.0, 3.0);
    world.motion(ball).angular_velocity = spin;
    world.seconds(10.0);
    assert_eq!(world.spin(ball), spin);
    let wanted = DQuat::from_scaled_axis(spin.as_dvec3() * 10.0);
    check_below(
        "error of the rotation, radians",
        world.motion(ball).rotation.angle_between(wanted),
        1.0e-4,
    );
}

#[test]
fn a_body_with_mixed_moments_keeps_its_momentum() {
    // A tensor that is not diagonal in the body's own axes.
    let turn = Mat3::from_quat(glam::Quat::from_scaled_axis(Vec3::new(0.5, 0.2, 0.9)));
    let mut world = World::new();
    let body = world.dynamic(BRICK, 1.0, DVec3::ZERO);
    let inertia = turn * BRICK.inertia(1.0) * turn.transpose();
    world.bodies.bodies[body].inverse_inertia = inertia.inverse();
    world.motion(body).angular_velocity = Vec3::new(3.0, 1.0, -2.0);
    let before = world.measure();
    world.seconds(20.0);
    let after = world.measure();
    let drift = (after.angular - before.angular).length() / before.angular.length();
    check_below("angular momentum, relative drift", drift, 1.0e-3);
    check("energy, relative", after.kinetic / before.kinetic, 1.0, 0.01);
}
