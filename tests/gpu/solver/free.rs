//! Single bodies that touch nothing.

use super::shapes::Shape;
use super::twin::{Apart, Twin, all, both};
use super::world::{World, check};
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::solver::CollisionSubstep;
use bevy_faceoff::types::body::{LockedAxes, RigidBody};
use glam::{DQuat, DVec3, Mat3, Quat, Vec3};

const BRICK: Shape = Shape::Box(DVec3::new(1.0, 0.5, 0.2));

/// A brick whose inertia is not diagonal in its own axes.
fn skewed(mut world: World) -> World {
    let turn = Mat3::from_quat(Quat::from_scaled_axis(Vec3::new(0.5, 0.2, 0.9)));
    let body = world.dynamic(BRICK, 3.0, DVec3::new(1.0, 2.0, 3.0));
    let inertia = turn * BRICK.inertia(3.0) * turn.transpose();
    world.bodies.bodies[body].inverse_inertia = inertia.inverse();
    world.motion(body).rotation = DQuat::from_scaled_axis(DVec3::new(0.3, -0.2, 0.8));
    world.motion(body).linear_velocity = Vec3::new(0.5, 2.0, -1.0);
    world
}

pub fn a_free_body_turns_the_same(gpu: &Gpu) {
    for spin in [
        Vec3::new(1.0, 2.0, 3.0),
        Vec3::new(8.0, 0.1, 8.0),
        Vec3::new(0.0, 20.0, 0.3),
    ] {
        let make = || {
            let mut world = skewed(World::heavy());
            world.collision_substeps = Some(1);
            world.motion(0).angular_velocity = spin;
            world
        };
        let (cpu, twin) = both(gpu, make, 1.0);
        // A part of what it turned by in a second.
        let limit = 1.0e-5 * spin.length() as f64;
        Apart::of(&cpu, &twin.world).check(&format!("spin {spin}"), all(limit));
        let (before, after) = (make().measure(), twin.world.measure());
        let drift = (after.kinetic - cpu.measure().kinetic).abs() / before.kinetic;
        assert!(drift < 1.0e-4, "energy apart by {drift}");
    }
}

/// Several radians in a collision substep: nothing about rotations may rely on small angles.
pub fn a_needle_that_spins_madly_stays_bounded(gpu: &Gpu) {
    let mut world = World::new();
    world.collision_substeps = Some(1);
    world.dynamic(Shape::Box(DVec3::new(1.0, 0.05, 0.06)), 0.1, DVec3::ZERO);
    world.motion(0).angular_velocity = Vec3::new(300.0, 4.0, 7.0);
    let before = world.measure();
    let mut twin = Twin::new(gpu, world);
    for _ in 0..16 {
        twin.step(8);
        let now = twin.world.measure();
        check("energy, relative", now.kinetic / before.kinetic, 1.0, 1.0e-3);
        let drift = (now.angular - before.angular).length() / before.angular.length();
        check("angular momentum, relative drift", drift, 0.0, 1.0e-3);
    }
}

pub fn forces_and_limits_do_the_same(gpu: &Gpu) {
    let acts: [(&str, fn(&mut World)); 6] = [
        ("force", |world| {
            world.bodies.forces[0].add_force_at(Vec3::Y * 3.0, Vec3::new(1.5, 2.0, 3.1), Vec3::new(1.0, 2.0, 3.0));
        }),
        ("impulse", |world| {
            world.bodies.forces[0].impulse = Vec3::new(1.0, 2.0, 3.0);
            world.bodies.forces[0].angular_impulse = Vec3::new(0.3, 0.2, 0.1);
        }),
        ("gravity scale", |world| world.bodies.bodies[0].gravity_scale = -0.5),
        ("damping", |world| {
            world.bodies.bodies[0].linear_damping = 0.7;
            world.bodies.bodies[0].angular_damping = 1.3;
            world.motion(0).angular_velocity = Vec3::new(1.0, -4.0, 2.0);
        }),
        ("strong damping", |world| {
            world.bodies.bodies[0].linear_damping = 1.0e4;
            world.bodies.bodies[0].angular_damping = 300.0;
            world.motion(0).angular_velocity = Vec3::new(1.0, -4.0, 2.0);
        }),
        ("speed limits", |world| {
            world.bodies.bodies[0].max_linear_speed = 3.0;
            world.bodies.bodies[0].max_angular_speed = 2.0;
            world.motion(0).angular_velocity = Vec3::new(3.0, 4.0, 0.0);
        }),
    ];
    for (what, act) in acts {
        let make = || {
            let mut world = skewed(World::heavy());
            act(&mut world);
            world
        };
        let (cpu, twin) = both(gpu, make, 1.0);
        Apart::of(&cpu, &twin.world).check(what, all(1.0e-5));
    }
}

pub fn locked_axes_do_the_same(gpu: &Gpu) {
    for locked in [
        LockedAxes::ROTATION_X | LockedAxes::ROTATION_Y,
        LockedAxes::ROTATION_Z | LockedAxes::TRANSLATION_X,
        LockedAxes::ROTATION,
        LockedAxes::TRANSLATION,
        LockedAxes::ROTATION | LockedAxes::TRANSLATION,
    ] {
        let make = || {
            let mut world = skewed(World::heavy());
            world.bodies.bodies[0].locked_axes = locked;
            world.bodies.forces[0].torque = Vec3::new(1.0, 2.0, 3.0);
            world.motion(0).angular_velocity = Vec3::new(1.0, -2.0, 3.0);
            world
        };
        let (cpu, twin) = both(gpu, make, 1.0);
        Apart::of(&cpu, &twin.world).check(&format!("{locked:?}"), all(1.0e-5));
    }
}

pub fn kinematic_and_static_bodies(gpu: &Gpu) {
    let make = || {
        let mut world = World::heavy();
        world.settings.sleeping = true;
        for kind in [RigidBody::Kinematic, RigidBody::Static] {
            let body = world.immovable(BRICK, kind, DVec3::Y);
            world.motion(body).linear_velocity = Vec3::new(1.0, 2.0, 3.0);
            world.motion(body).angular_velocity = Vec3::new(3.0, 2.0, 1.0);
        }
        let asleep = world.dynamic(BRICK, 1.0, DVec3::Z * 10.0);
        world.bodies.sleep[asleep].asleep = true;
        world
    };
    let mut cpu = make();
    let mut twin = Twin::new(gpu, make());
    for _ in 0..64 {
        // Without contacts, and without the sleeper.
        let collision_substep = CollisionSubstep {
            dt: cpu.dt,
            substeps: 8,
            gravity: cpu.gravity,
        };
        cpu.solve(&collision_substep);
        twin.solve(&collision_substep);
    }
    Apart::of(&cpu, &twin.world).check("kinematic, static, asleep", all(1.0e-5));
    assert_eq!(twin.world.center(1), DVec3::Y);
    assert_eq!(twin.world.center(2), DVec3::Z * 10.0);
}
