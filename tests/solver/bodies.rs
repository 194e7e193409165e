//! Single bodies: forces, locked axes, damping, speed limits, and invalid input.

use super::shapes::Shape;
use super::world::{World, check};
use bevy_faceoff::manifolds::{Manifold, ManifoldPoint};
use bevy_faceoff::solver::SolverBody;
use bevy_faceoff::types::body::{LockedAxes, RigidBody};
use glam::{DQuat, DVec3, Vec3};

const CUBE: Shape = Shape::Box(DVec3::splat(0.5));
const BRICK: Shape = Shape::Box(DVec3::new(1.0, 0.5, 0.2));

fn single(shape: Shape, mass: f32) -> World {
    let mut world = World::new();
    world.dynamic(shape, mass, DVec3::ZERO);
    world
}

pub fn free_fall() {
    let mut world = World::heavy();
    world.dynamic(CUBE, 2.0, DVec3::ZERO);
    world.bodies.bodies[0].gravity_scale = 0.5;
    world.seconds(2.0);
    check("speed", world.velocity(0).y as f64, -9.81, 1.0e-4);
    // Semi-implicit Euler is half a substep ahead.
    check("height", world.center(0).y, -9.81, 0.02);
}

pub fn damping_decays_exponentially() {
    let mut world = single(BRICK, 1.0);
    world.bodies.bodies[0].linear_damping = 0.7;
    world.bodies.bodies[0].angular_damping = 1.3;
    world.motion(0).linear_velocity = Vec3::X * 4.0;
    world.motion(0).angular_velocity = Vec3::Z * 5.0;
    world.seconds(2.0);
    check("linear", world.velocity(0).x as f64, 4.0 * (-1.4f64).exp(), 1.0e-4);
    check("angular", world.spin(0).z as f64, 5.0 * (-2.6f64).exp(), 1.0e-4);
    check("path", world.center(0).x, 4.0 / 0.7 * (1.0 - (-1.4f64).exp()), 0.01);
}

pub fn speed_limits_hold() {
    let mut world = World::heavy();
    world.dynamic(CUBE, 1.0, DVec3::ZERO);
    world.bodies.bodies[0].max_linear_speed = 3.0;
    world.bodies.bodies[0].max_angular_speed = 2.0;
    world.motion(0).angular_velocity = Vec3::new(3.0, 4.0, 0.0);
    world.seconds(2.0);
    check("linear", world.velocity(0).length() as f64, 3.0, 1.0e-5);
    check(
        "angular",
        (world.spin(0) - Vec3::new(1.2, 1.6, 0.0)).length() as f64,
        0.0,
        1.0e-5,
    );
    check("path", world.center(0).y, -3.0 * 2.0 + 9.0 / (2.0 * 9.81), 0.02);
}

pub fn a_force_at_a_point_pushes_and_turns() {
    let mut world = single(CUBE, 2.0);
    let center = world.center(0);
    world.bodies.forces[0].add_force_at(Vec3::Y * 3.0, Vec3::X * 0.5, center.as_vec3());
    world.seconds(0.5);
    // Speed is F t / m; the moment of inertia of the cube is m / 6.
    check("speed", world.velocity(0).y as f64, 0.75, 1.0e-4);
    check("spin", world.spin(0).z as f64, 1.5 * 0.5 / (2.0 / 6.0), 1.0e-4);
}

pub fn an_impulse_at_a_point_works_once() {
    let mut world = single(CUBE, 2.0);
    let center = world.center(0);
    world.bodies.forces[0].add_impulse_at(Vec3::Y * 3.0, Vec3::X * 0.5, center.as_vec3());
    world.step(1);
    check("speed", world.velocity(0).y as f64, 1.5, 1.0e-6);
    check("spin", world.spin(0).z as f64, 4.5, 1.0e-5);
    assert!(world.bodies.forces[0].is_zero());
    world.step(10);
    check("speed", world.velocity(0).y as f64, 1.5, 1.0e-6);
}

pub fn locked_translation_resists_impulses() {
    let mut world = World::heavy();
    world.floor(0.0);
    let cube = world.dynamic(CUBE, 1.0, DVec3::Y * 0.505);
    world.bodies.bodies[cube].locked_axes = LockedAxes::TRANSLATION_X | LockedAxes::ROTATION;
    let ball = world.dynamic(Shape::Sphere(0.4), 1.0, DVec3::new(-2.0, 0.6, 0.0));
    world.motion(ball).linear_velocity = Vec3::new(5.0, 0.0, 0.3);
    for i in [cube, ball] {
        world.bodies.bodies[i].restitution = 1.0;
        world.bodies.bodies[i].friction = 0.0;
    }
    world.bodies.bodies[0].friction = 0.0;
    world.seconds(0.5);
    assert_eq!(world.center(cube).x, 0.0);
    assert_eq!(world.motion(cube).rotation, DQuat::IDENTITY);
    assert!(
        world.velocity(ball).x < -4.0,
        "it rebounds from a body that does not move: {}",
        world.velocity(ball)
    );
}

pub fn the_bearing_of_a_locked_axis_balances_moments_about_it() {
    let mut world = single(BRICK, 1.0);
    world.motion(0).rotation = DQuat::from_euler(glam::EulerRot::XYZ, 0.4, 0.3, 0.2);
    world.bodies.bodies[0].locked_axes = LockedAxes::ROTATION_X | LockedAxes::ROTATION_Y;
    world.bodies.forces[0].angular_impulse = Vec3::new(1.0, 2.0, 3.0);
    // For rotation about a fixed axis only the moment of inertia about it counts, not the products of inertia.
    let turn = world.motion(0).rotation.as_quat();
    let axis = turn.conjugate() * Vec3::Z;
    let moment = axis.dot(BRICK.inertia(1.0) * axis);
    world.step(1);
    check(
        "spin",
        world.spin(0).z as f64,
        (3.0 / moment) as f64,
        1.0e-4 * (3.0 / moment) as f64,
    );
    let spin = world.spin(0).z;
    world.seconds(5.0);
    assert_eq!(world.spin(0), Vec3::Z * spin);
}

pub fn a_heavy_ball_pushes_a_light_one_away() {
    let mut world = World::new();
    world.collision_substeps = Some(8);
    let light = world.dynamic(Shape::Sphere(0.5), 1.0, DVec3::ZERO);
    let heavy = world.dynamic(Shape::Sphere(0.5), 100.0, DVec3::X * -1.5);
    world.motion(heavy).linear_velocity = Vec3::X * 2.0;
    for i in [light, heavy] {
        world.bodies.bodies[i].restitution = 1.0;
    }
    world.seconds(1.0);
    check("light", world.velocity(light).x as f64, 2.0 * 200.0 / 101.0, 0.02);
    check("heavy", world.velocity(heavy).x as f64, 2.0 * 99.0 / 101.0, 0.005);
}

pub fn nothing_moves_a_static_body_and_nothing_stops_a_kinematic_one() {
    let mut world = World::heavy();
    let wall = world.immovable(CUBE, RigidBody::Static, DVec3::X * 1.5);
    let ram = world.immovable(CUBE, RigidBody::Kinematic, DVec3::X * -1.0);
    world.motion(ram).linear_velocity = Vec3::X * 0.5;
    world.motion(ram).angular_velocity = Vec3::X * 0.5;
    world.motion(wall).linear_velocity = Vec3::ONE;
    let ball = world.dynamic(Shape::Sphere(0.3), 1.0, DVec3::ZERO);
    world.seconds(1.0);
    assert_eq!(world.center(wall), DVec3::X * 1.5);
    check("ram", world.center(ram).x, -0.5, 1.0e-6);
    let turned = world.motion(ram).rotation.angle_between(DQuat::from_rotation_x(0.5));
    check("turned", turned, 0.0, 1.0e-5);
    assert!(world.center(ball).is_finite());
}

pub fn invalid_input_is_ignored() {
    let mut world = World::heavy();
    world.floor(0.0);
    let cube = world.dynamic(CUBE, 1.0, DVec3::Y * 0.505);
    let lost = world.dynamic(CUBE, 1.0, DVec3::Y * 3.0);
    world.motion(lost).linear_velocity = Vec3::NAN;
    let weightless = world.dynamic(CUBE, 1.0, DVec3::new(5.0, 1.0, 0.0));
    world.bodies.bodies[weightless] = SolverBody {
        inverse_mass: f32::INFINITY,
        inverse_inertia: glam::Mat3::NAN,
        ..world.bodies.bodies[weightless]
    };
    let odd = world.dynamic(CUBE, 1.0, DVec3::new(-5.0, 0.505, 0.0));
    world.bodies.bodies[odd].radius = f32::NAN;
    world.bodies.bodies[odd].friction = f32::NAN;
    world.bodies.bodies[odd].linear_damping = f32::NAN;
    world.bodies.bodies[odd].max_linear_speed = f32::NAN;
    let point = |normal: Vec3, separation: f32| ManifoldPoint {
        anchors: [Vec3::ZERO, Vec3::NEG_Y * 0.5],
        normal,
        separation,
        curvature_radii: [0.0, f32::INFINITY],
        bulge: 0.0,
        normal_rotation: 0.0,
        faces: [0, 0],
    };
    for _ in 0..64 {
        world.detect(1.0 / 64.0);
        let first = world.manifolds.points.len() as u32;
        let bad = [
            point(Vec3::NAN, -0.1),
            point(Vec3::ZERO, -0.1),
            point(Vec3::Y, f32::NAN),
            point(Vec3::Y * f32::INFINITY, -0.1),
        ];
        world.manifolds.points.extend(bad);
        let pair = |bodies: [usize; 2], first_point, point_count| Manifold {
            bodies: bodies.map(|i| i as u32),
            first_point,
            point_count,
        };
        world.manifolds.pairs.extend([
            pair([cube, weightless], first, 4),
            pair([cube, cube], first, 1),
            pair([cube, 77], first, 1),
            pair([usize::MAX, 77], first, 1),
            pair([cube, odd], first + 4, 9),
            pair([cube, odd], u32::MAX, u32::MAX),
            pair([cube, lost], first + 4, 0),
        ]);
        let collision_substep = bevy_faceoff::solver::CollisionSubstep {
            dt: world.dt,
            substeps: 8,
            gravity: world.gravity,
        };
        world.solve(&collision_substep);
    }
    check("the cube rests", world.center(cube).y, 0.5 + 0.000866, 0.005);
    assert_eq!(world.center(lost), DVec3::Y * 3.0);
    assert_eq!(
        world.center(weightless),
        DVec3::new(5.0, 1.0, 0.0),
        "moves as a kinematic one at rest"
    );
    assert!(world.center(odd).is_finite(), "{:?}", world.bodies.motions[odd]);

    let before = world.bodies.motions.clone();
    for dt in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        let collision_substep = bevy_faceoff::solver::CollisionSubstep {
            dt,
            substeps: 0,
            gravity: world.gravity,
        };
        world.solve(&collision_substep);
    }
    assert_eq!(format!("{before:?}"), format!("{:?}", world.bodies.motions));
}
