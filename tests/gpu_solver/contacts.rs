//! One body that touches another.

use crate::shapes::Shape;
use crate::twin::{Apart, Twin, all, both};
use crate::world::{World, check};
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::stages::solver::CombineRule;
use glam::{DQuat, DVec3, Vec3};

const CUBE: Shape = Shape::Box(DVec3::splat(0.5));
const BALL: Shape = Shape::Sphere(0.5);

pub fn a_cube_on_a_half_space(gpu: &Gpu) {
    for (what, tilt, height) in [("flat", 0.0, 0.51), ("dropped", 0.0, 0.7), ("on an edge", 0.3, 0.75)] {
        let make = || {
            let mut world = World::heavy();
            world.floor(0.0);
            let cube = world.dynamic(CUBE, 2.0, DVec3::Y * height);
            world.motion(cube).rotation = DQuat::from_rotation_y(0.4) * DQuat::from_rotation_z(tilt);
            world
        };
        let (cpu, twin) = both(gpu, make, 1.0);
        Apart::of(&cpu, &twin.world).check(what, all(1.0e-3));
    }
}

pub fn a_ball_rolls(gpu: &Gpu) {
    for friction in [0.5, 0.05] {
        let make = || {
            let mut world = World::heavy();
            world.floor(-0.2);
            let ball = world.dynamic(BALL, 1.0, DVec3::new(0.0, 0.52, 0.0));
            world.bodies.bodies[ball].friction = friction;
            world.bodies.bodies[ball].friction_combine = CombineRule::Min;
            world.motion(ball).linear_velocity = Vec3::new(1.0, 0.0, 0.5);
            world
        };
        let (cpu, twin) = both(gpu, make, 1.0);
        // It rolls a few metres.
        Apart::of(&cpu, &twin.world).check(&format!("friction {friction}"), all(1.0e-3));
    }
}

pub fn a_box_slides_down_a_slope(gpu: &Gpu) {
    let make = || {
        let mut world = World::heavy();
        world.floor(0.5);
        let slope = DQuat::from_rotation_z(0.5);
        let cube = world.dynamic(CUBE, 1.0, slope * (DVec3::Y * 0.51));
        world.motion(cube).rotation = slope;
        for i in [0, cube] {
            world.bodies.bodies[i].friction = 0.2;
        }
        world
    };
    let (cpu, twin) = both(gpu, make, 1.0);
    Apart::of(&cpu, &twin.world).check("slope", all(1.0e-3));
}

pub fn balls_bounce(gpu: &Gpu) {
    for restitution in [0.5, 1.0] {
        let make = || {
            let mut world = World::heavy();
            world.floor(0.0);
            let ball = world.dynamic(BALL, 1.0, DVec3::Y * 0.8);
            let other = world.dynamic(BALL, 3.0, DVec3::new(3.0, 0.8, 0.2));
            world.motion(other).linear_velocity = Vec3::X * -4.0;
            for i in [0, ball, other] {
                world.bodies.bodies[i].restitution = restitution;
            }
            world.bodies.bodies[ball].restitution_combine = CombineRule::GeometricMean;
            world
        };
        let (cpu, twin) = both(gpu, make, 1.0);
        Apart::of(&cpu, &twin.world).check(&format!("restitution {restitution}"), all(5.0e-3));
    }
}

pub fn overlapping_balls_part(gpu: &Gpu) {
    for apart in [0.0, 0.5, 0.97] {
        let make = || {
            let mut world = World::new();
            world.dynamic(BALL, 1.0, DVec3::ZERO);
            world.dynamic(BALL, 2.0, DVec3::new(apart, 1.0e-9, 0.0));
            world
        };
        let (cpu, twin) = both(gpu, make, 1.5);
        Apart::of(&cpu, &twin.world).check(&format!("{apart} apart"), all(1.0e-3));
        let gap = twin.world.center(0).distance(twin.world.center(1)) - 1.0;
        assert!(gap > 0.0, "{apart}: still {gap} deep");
    }
}

pub fn impulses_are_those_that_hold_a_box(gpu: &Gpu) {
    let mut world = World::heavy();
    world.detections = Some(1);
    world.floor(0.0);
    world.dynamic(CUBE, 3.0, DVec3::Y * 0.50866);
    let mut twin = Twin::new(gpu, world);
    twin.step(128);
    let sum: f32 = twin.solver.impulses().unwrap().iter().sum();
    check("newton seconds per step", sum as f64, 3.0 * 9.81 / 64.0, 0.005);
}
