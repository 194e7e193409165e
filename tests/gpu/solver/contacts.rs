//! One body that touches another.

use super::shapes::Shape;
use super::twin::{Apart, Twin, all, both};
use super::world::{World, check};
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::types::body::{LockedAxes, RigidBody};
use bevy_faceoff::types::material::CombineRule;
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
        Apart::of(&cpu, &twin.world).check(what, all(1.0e-4));
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
        Apart::of(&cpu, &twin.world).check(&format!("friction {friction}"), all(1.0e-4));
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
    Apart::of(&cpu, &twin.world).check("slope", all(1.0e-4));
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
        Apart::of(&cpu, &twin.world).check(&format!("restitution {restitution}"), all(1.0e-4));
    }
}

/// Their normal turns until they touch.
pub fn balls_meet_off_their_centres(gpu: &Gpu) {
    for (restitution, sideways) in [(0.0, 0.7), (0.5, 0.3), (1.0, 0.5)] {
        let make = || {
            let mut world = World::new();
            let a = world.dynamic(BALL, 1.0, DVec3::X * -1.0);
            let b = world.dynamic(BALL, 4.0, DVec3::new(1.0, sideways, 0.0));
            world.motion(a).linear_velocity = Vec3::X * 2.0;
            world.motion(b).linear_velocity = Vec3::X * -1.0;
            for i in [a, b] {
                world.bodies.bodies[i].restitution = restitution;
            }
            world
        };
        let (cpu, twin) = both(gpu, make, 1.0);
        Apart::of(&cpu, &twin.world).check(&format!("{sideways} off"), all(1.0e-4));
    }
}

pub fn impulses_are_those_that_hold_a_box(gpu: &Gpu) {
    let mut world = World::heavy();
    world.collision_substeps = Some(1);
    world.floor(0.0);
    world.dynamic(CUBE, 3.0, DVec3::Y * 0.50866);
    let mut twin = Twin::new(gpu, world);
    twin.step(128);
    let sum: f32 = twin.solver.impulses().unwrap().iter().sum();
    check("newton seconds per step", sum as f64, 3.0 * 9.81 / 64.0, 0.005);
}

/// Anchors rotate with the body until the moment of the impact.
pub fn a_brick_tumbles_and_bounces(gpu: &Gpu) {
    let make = || {
        let mut world = World::heavy();
        world.floor(0.0);
        let brick = world.dynamic(Shape::Box(DVec3::new(0.6, 0.3, 0.2)), 2.0, DVec3::Y * 1.2);
        world.motion(brick).rotation = DQuat::from_scaled_axis(DVec3::new(0.4, 0.7, -0.3));
        world.motion(brick).angular_velocity = Vec3::new(5.0, -8.0, 6.0);
        for i in [0, brick] {
            world.bodies.bodies[i].restitution = 0.7;
        }
        world
    };
    let (cpu, twin) = both(gpu, make, 0.75);
    Apart::of(&cpu, &twin.world).check("brick", all(1.0e-4));
}

/// Bodies that cannot move or turn as they like, do not push at all, or are moved by what they lie on.
pub fn bodies_of_all_kinds_touch(gpu: &Gpu) {
    let make = || {
        let mut world = World::heavy();
        world.floor(0.0);
        let sledge = world.dynamic(CUBE, 1.0, DVec3::Y * 0.505);
        world.bodies.bodies[sledge].locked_axes = LockedAxes::TRANSLATION_X | LockedAxes::ROTATION;
        let ball = world.dynamic(Shape::Sphere(0.4), 1.0, DVec3::new(-1.5, 0.6, 0.0));
        world.motion(ball).linear_velocity = Vec3::new(5.0, 0.0, 0.3);
        let wheel = world.dynamic(CUBE, 2.0, DVec3::new(0.0, 0.9, 4.0));
        world.bodies.bodies[wheel].locked_axes = LockedAxes::ROTATION_X | LockedAxes::ROTATION_Y;
        world.motion(wheel).rotation = DQuat::from_rotation_z(0.5);
        let platform = Shape::Box(DVec3::new(3.0, 0.25, 3.0));
        let platform = world.immovable(platform, RigidBody::Kinematic, DVec3::new(20.0, 3.0, 0.0));
        world.motion(platform).linear_velocity = Vec3::new(1.0, 0.0, 0.5);
        world.motion(platform).angular_velocity = Vec3::Y * 0.6;
        let carried = world.dynamic(CUBE, 1.0, DVec3::new(21.0, 3.76, 0.0));
        world.motion(carried).rotation = DQuat::from_rotation_y(0.2);
        let ghost = world.dynamic(CUBE, 1.0, DVec3::new(0.2, 1.2, 0.1));
        world.bodies.bodies[ghost].solid = false;
        for i in [sledge, ball] {
            world.bodies.bodies[i].restitution = 0.8;
            world.bodies.bodies[i].restitution_combine = CombineRule::Max;
            world.bodies.bodies[i].friction_combine = CombineRule::Multiply;
        }
        world
    };
    let (cpu, twin) = both(gpu, make, 1.0);
    Apart::of(&cpu, &twin.world).check("all kinds", all(3.0e-4));
    assert!(twin.world.center(6).y < -2.0, "what is not solid falls through");
}

/// What is remembered of shorter or longer substeps is scaled.
pub fn substeps_of_changing_length(gpu: &Gpu) {
    let mut cpu = World::heavy();
    cpu.floor(0.0);
    for i in 0..3 {
        cpu.dynamic(CUBE, 1.0, DVec3::Y * (0.50866 + 1.00866 * f64::from(i)));
    }
    let mut twin = Twin::new(gpu, World::heavy());
    twin.world.bodies = cpu.bodies.clone();
    twin.world.shapes = cpu.shapes.clone();
    twin.put();
    for i in 0..64 {
        for world in [&mut cpu, &mut twin.world] {
            world.dt = [1.0 / 64.0, 1.0 / 128.0, 1.0 / 60.0][i % 3];
            world.collision_substeps = Some([1, 2, 5][i / 10 % 3]);
        }
        cpu.step(1);
        twin.step(1);
    }
    Apart::of(&cpu, &twin.world).check("stack", all(3.0e-4));
}
