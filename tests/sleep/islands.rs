//! Which bodies fall asleep, and what wakes them.

use crate::solver::shapes::Shape;
use crate::solver::world::World;
use bevy_faceoff::sleep::cpu::Sleeper;
use bevy_faceoff::types::body::{ExternalForces, RigidBody};
use glam::{DVec3, Vec3};

const CUBE: Shape = Shape::Box(DVec3::splat(0.5));
const GAP: f64 = 0.00866;

/// A stack of five on a floor (body 0), and another body far away.
fn stack() -> World {
    let mut world = World::heavy();
    world.settings.sleeping = true;
    world.floor(0.0);
    for i in 0..5 {
        world.dynamic(CUBE, 1.0, DVec3::Y * (0.5 + GAP + i as f64 * (1.0 + GAP)));
    }
    world.dynamic(CUBE, 1.0, DVec3::new(10.0, 0.5 + GAP, 0.0));
    world
}

fn asleep(world: &World) -> Vec<usize> {
    (0..world.shapes.len())
        .filter(|&i| world.bodies.sleep[i].asleep)
        .collect()
}

const STACK: [usize; 5] = [1, 2, 3, 4, 5];
const ALL: [usize; 6] = [1, 2, 3, 4, 5, 6];

fn sleeping_stack() -> World {
    let mut world = stack();
    world.seconds(2.0);
    assert_eq!(asleep(&world), ALL);
    world
}

#[test]
fn a_stack_falls_asleep_and_stays() {
    let mut world = sleeping_stack();
    let motions = world.bodies.motions.clone();
    world.seconds(10.0);
    assert_eq!(asleep(&world), ALL);
    assert_eq!(world.bodies.motions, motions);
    assert!(STACK.iter().all(|&i| world.velocity(i) == Vec3::ZERO));
    assert!(Sleeper::is_inactive(&world.bodies, 1, 2) && Sleeper::is_inactive(&world.bodies, 0, 1));
    assert!(!Sleeper::is_inactive(&world.bodies, 0, 0));
}

#[test]
fn a_stack_that_wakes_continues_as_if_it_had_not_slept() {
    let mut world = stack();
    // Below the sleep speed a stack still moves by fractions of a millimetre.
    world.settings.sleeping = false;
    world.seconds(3.0);
    world.settings.sleeping = true;
    world.seconds(2.0);
    assert_eq!(asleep(&world), ALL);
    let top = world.center(5);
    for sleep in &mut world.bodies.sleep {
        *sleep = Default::default();
    }
    world.settings.sleeping = false;
    world.seconds(1.0);
    assert!(world.center(5).distance(top) < 1.0e-4, "{}", world.center(5) - top);
}

#[test]
fn a_hit_wakes_the_whole_stack_and_nothing_else() {
    let mut world = sleeping_stack();
    let ball = world.dynamic(Shape::Sphere(0.3), 1.0, DVec3::new(-2.0, 4.5, 0.0));
    world.motion(ball).linear_velocity = Vec3::X * 5.0;
    world.bodies.bodies[ball].gravity_scale = 0.0;
    world.step(8);
    assert_eq!(asleep(&world), ALL, "not yet there");
    world.step(30);
    assert_eq!(asleep(&world), [6]);
    assert!(world.center(5).x > 0.05, "it was pushed");
}

#[test]
fn impulses_forces_and_velocities_wake() {
    let wakes: [fn(&mut World); 3] = [
        |world| world.bodies.forces[3].impulse = Vec3::X * 0.1,
        |world| world.bodies.forces[3].torque = Vec3::X * 0.1,
        |world| world.motion(3).linear_velocity = Vec3::X * 0.1,
    ];
    for wake in wakes {
        let mut world = sleeping_stack();
        wake(&mut world);
        world.step(1);
        assert_eq!(asleep(&world), [6]);
        world.bodies.forces[3] = ExternalForces::default();
        world.seconds(3.0);
        assert_eq!(asleep(&world), ALL, "and it falls asleep again");
    }
}

#[test]
fn what_woke_stays_awake_until_the_next_substep() {
    let mut world = sleeping_stack();
    world.settings.sleep_time = 0.0;
    // It hardly moves, but it moves.
    world.motion(3).linear_velocity = Vec3::X * 1.0e-3;
    world.collision_substeps = Some(1);
    world.step(1);
    assert_eq!(asleep(&world), [6]);
    world.step(1);
    assert_eq!(asleep(&world), ALL);
}

#[test]
fn a_stack_wakes_when_its_support_is_taken_away() {
    let mut world = sleeping_stack();
    // The lowest box is moved away.
    world.motion(1).center.x = 50.0;
    world.step(2);
    assert_eq!(asleep(&world), [6]);
    world.seconds(0.2);
    assert!(world.velocity(3).y < -1.0, "{}", world.velocity(3));
}

#[test]
fn a_kinematic_body_that_starts_to_move_wakes_the_bodies_on_it() {
    let mut world = World::heavy();
    world.settings.sleeping = true;
    let platform = Shape::Box(DVec3::new(3.0, 0.25, 3.0));
    let platform = world.immovable(platform, RigidBody::Kinematic, DVec3::Y * -0.25);
    let cube = world.dynamic(CUBE, 1.0, DVec3::Y * (0.5 + GAP));
    world.seconds(2.0);
    assert_eq!(asleep(&world), [cube]);
    world.motion(platform).linear_velocity = Vec3::X * 0.02;
    world.seconds(2.0);
    assert_eq!(
        asleep(&world),
        [0; 0],
        "the bodies that it carries move, however slow it is"
    );
    assert!((world.velocity(cube).x - 0.02).abs() < 1.0e-3);
}

#[test]
fn a_thrown_body_does_not_fall_asleep_at_the_top_of_its_path() {
    for scale in [1.0f32, 0.1] {
        let mut world = World::heavy();
        world.settings.sleeping = true;
        let ball = world.dynamic(Shape::Sphere(0.5), 1.0, DVec3::ZERO);
        world.bodies.bodies[ball].gravity_scale = scale;
        world.motion(ball).linear_velocity = Vec3::Y * 2.0;
        for _ in 0..64 * 5 {
            world.step(1);
            assert!(!world.bodies.sleep[ball].asleep);
        }
        assert!(world.velocity(ball).y < -2.0);
    }
}

/// On a slope that is a little steeper than its friction holds, a cube of any size gains 0.0878 m/s each second.
#[test]
fn a_cube_that_is_accelerated_slowly_does_not_fall_asleep() {
    let slope = 0.5f64.atan();
    let acceleration = 9.81 * (slope.sin() - 0.49 * slope.cos());
    for edge in [0.05, 1.0, 20.0] {
        let mut world = World::heavy();
        world.settings.sleeping = true;
        let floor = world.floor(slope);
        let up = world.bodies.motions[floor].rotation * DVec3::Y;
        let cube = world.dynamic(Shape::Box(DVec3::splat(0.5 * edge)), 1.0, up * 0.5 * edge * 1.0017);
        world.motion(cube).rotation = world.bodies.motions[floor].rotation;
        for body in &mut world.bodies.bodies {
            body.friction = 0.49;
        }
        let start = world.center(cube);
        for _ in 0..4 * 64 {
            world.step(1);
            assert!(!world.bodies.sleep[cube].asleep, "edge {edge}");
        }
        let way = world.center(cube).distance(start);
        let wanted = 0.5 * acceleration * 16.0;
        assert!(
            (way - wanted).abs() < 0.03 * wanted,
            "edge {edge}: {way} m, not {wanted} m"
        );
    }
}

#[test]
fn what_touches_nothing_sleeps_only_if_it_does_not_move() {
    for (speed, spin) in [(0.049, 0.0), (0.0, 0.05), (0.0005, 0.0), (0.0, 0.0)] {
        let mut world = World::new();
        world.settings.sleeping = true;
        let cube = world.dynamic(CUBE, 1.0, DVec3::ZERO);
        world.motion(cube).linear_velocity = Vec3::X * speed;
        world.motion(cube).angular_velocity = Vec3::Y * spin;
        world.seconds(5.0);
        assert_eq!(world.bodies.sleep[cube].asleep, speed == 0.0 && spin == 0.0);
        assert_eq!(world.velocity(cube), Vec3::X * speed);
    }
}

#[test]
fn sleep_can_be_switched_off() {
    let mut world = sleeping_stack();
    world.settings.sleeping = false;
    world.step(1);
    assert_eq!(asleep(&world), [0; 0]);
    world.seconds(3.0);
    assert_eq!(asleep(&world), [0; 0]);
}

/// Two cubes a few millimetres apart come to rest at different times. Neither keeps the other awake.
#[test]
fn neighbours_that_do_not_touch_let_each_other_sleep() {
    let mut world = World::heavy();
    world.settings.sleeping = true;
    world.floor(0.0);
    let beside = world.settings.rest_offset as f64 * 3f64.sqrt() * 6.0;
    world.dynamic(CUBE, 1.0, DVec3::Y * 0.5);
    world.dynamic(CUBE, 1.0, DVec3::new(1.0 + beside, 0.7, 0.0));
    world.seconds(3.0);
    assert_eq!(asleep(&world), [1, 2]);
    world.seconds(1.0);
    assert_eq!(asleep(&world), [1, 2]);
}
