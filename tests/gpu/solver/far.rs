//! What single precision alone would lose.

use super::shapes::Shape;
use super::twin::{Apart, all, both};
use super::world::{World, check};
use bevy_faceoff::gpu::device::Gpu;
use glam::{DVec3, Vec3};

const BALL: Shape = Shape::Sphere(0.5);

pub fn slow_motion_far_from_the_origin(gpu: &Gpu) {
    for distance in [0.0, 1.0, 1.0e3, 5.0e4, 2.0e6] {
        let at = DVec3::new(distance, -distance, 0.3 * distance);
        let make = || {
            let mut world = World::new();
            let ball = world.dynamic(BALL, 1.0, at);
            world.motion(ball).linear_velocity = Vec3::new(1.0e-3, 2.0e-4, -3.0e-3);
            world
        };
        let (_, twin) = both(gpu, make, 2.0);
        let moved = twin.world.center(0) - at;
        let wanted = DVec3::new(2.0e-3, 4.0e-4, -6.0e-3);
        // A carry may round once, by half a digit of a coarse part that grows.
        check(
            &format!("{distance} m away: off by, metres"),
            moved.distance(wanted),
            0.0,
            1.0e-8 + 1.0e-13 * distance,
        );
    }
}

pub fn slow_turns_are_not_lost(gpu: &Gpu) {
    let make = || {
        let mut world = World::new();
        let ball = world.dynamic(BALL, 1.0, DVec3::ZERO);
        world.motion(ball).rotation = glam::DQuat::from_scaled_axis(DVec3::new(0.4, 0.5, 0.6));
        world.motion(ball).angular_velocity = Vec3::new(1.0e-6, 2.0e-6, -1.0e-6);
        world
    };
    let (_, twin) = both(gpu, make, 2.0);
    let (start, end) = (
        make().bodies.motions[0].rotation,
        twin.world.bodies.motions[0].rotation.normalize(),
    );
    let turned = 2.0 * (end * start.conjugate()).xyz();
    let wanted = DVec3::new(2.0e-6, 4.0e-6, -2.0e-6);
    check("off by, radians", turned.distance(wanted), 0.0, 1.0e-9);
}

pub fn a_box_on_a_floor_far_away(gpu: &Gpu) {
    let at = DVec3::new(5.0e4, 0.0, -5.0e4);
    let make = || {
        let mut world = World::heavy();
        world.floor(0.0);
        world.motion(0).center = at;
        world.dynamic(Shape::Box(DVec3::splat(0.5)), 1.0, at + DVec3::Y * 0.52);
        world
    };
    let (cpu, twin) = both(gpu, make, 2.0);
    Apart::of(&cpu, &twin.world).check("box", all(1.0e-4));
}
