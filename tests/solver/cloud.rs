//! Conservation of momentum and energy by many bodies that collide in a closed system.

use super::shapes::Shape;
use super::world::{World, check_below};
use glam::{DVec3, Vec3};

/// 500 balls of mixed sizes that fly towards each other.
pub fn cloud(restitution: f32) -> World {
    let mut world = World::new();
    let mut random = fastrand::Rng::with_seed(11);
    let mut number = move || random.f64() - 0.5;
    for i in 0..500 {
        let at = DVec3::new((i % 8) as f64, (i / 8 % 8) as f64, (i / 64) as f64) - 3.5;
        let radius = 0.35 + 0.2 * number();
        let shape = Shape::Sphere(radius);
        let mass = (radius * radius * radius * 8.0) as f32;
        let ball = world.dynamic(shape, mass, 1.1 * at + DVec3::new(number(), number(), number()) * 0.1);
        let inward = -0.6 * at + DVec3::new(number(), number(), number()) * 4.0;
        world.motion(ball).linear_velocity = inward.as_vec3();
        world.motion(ball).angular_velocity = Vec3::new(number() as f32, number() as f32, number() as f32) * 8.0;
        world.bodies.bodies[ball].restitution = restitution;
        world.bodies.bodies[ball].friction = 0.3;
    }
    world
}

#[test]
fn a_cloud_of_balls_keeps_momentum_and_gains_no_energy() {
    for restitution in [0.0, 0.5, 1.0] {
        let mut world = cloud(restitution);
        let before = world.measure();
        let (mut linear, mut angular, mut kinetic, mut touching) = (0.0f64, 0.0f64, 0.0f64, 0);
        for _ in 0..1000 {
            world.step(1);
            let now = world.measure();
            linear = linear.max((now.linear - before.linear).length() / before.size);
            angular = angular.max((now.angular - before.angular).length() / before.size);
            kinetic = kinetic.max(now.kinetic / before.kinetic);
            touching += world.manifolds.points.iter().filter(|p| p.separation < 0.01).count();
        }
        println!(
            "cloud, restitution {restitution}: {:.0} us per step, {} touching on average, {:.3} of the energy left",
            world.time_solving.as_secs_f64() * 1.0e3,
            touching / 1000,
            world.measure().kinetic / before.kinetic
        );
        assert!(touching > 1000, "{touching}");
        check_below("linear momentum, drift over the sum of sizes", linear, 1.0e-4);
        check_below(
            "angular momentum, drift over the sum of sizes times 1 m",
            angular,
            1.0e-4,
        );
        check_below("kinetic energy at most, of the first", kinetic, 1.01);
    }
}

pub fn boxes_that_tumble_into_each_other_keep_momentum() {
    let mut world = World::new();
    let mut random = fastrand::Rng::with_seed(5);
    let mut number = move || random.f64() - 0.5;
    for i in 0..64 {
        let at = DVec3::new((i % 4) as f64, (i / 4 % 4) as f64, (i / 16) as f64) - 1.5;
        let cube = world.dynamic(Shape::Box(DVec3::new(0.3, 0.4, 0.5)), 1.0, 1.5 * at);
        world.motion(cube).linear_velocity = (-1.0 * at).as_vec3();
        world.motion(cube).angular_velocity = Vec3::new(number() as f32, number() as f32, number() as f32) * 6.0;
        world.bodies.bodies[cube].restitution = 0.5;
    }
    let before = world.measure();
    let (mut linear, mut angular, mut kinetic) = (0.0f64, 0.0f64, 0.0f64);
    for _ in 0..400 {
        world.step(1);
        let now = world.measure();
        linear = linear.max((now.linear - before.linear).length() / before.size);
        angular = angular.max((now.angular - before.angular).length() / before.size);
        kinetic = kinetic.max(now.kinetic / before.kinetic);
    }
    check_below("linear momentum, drift over the sum of sizes", linear, 1.0e-4);
    check_below(
        "angular momentum, drift over the sum of sizes times 1 m",
        angular,
        1.0e-4,
    );
    check_below("kinetic energy at most, of the first", kinetic, 1.01);
}

/// Three hundred balls and boxes that fall onto a floor.
pub fn heap() -> World {
    let mut world = World::heavy();
    world.settings.sleeping = true;
    world.floor(0.0);
    let mut random = fastrand::Rng::with_seed(4);
    for i in 0..300 {
        let at = DVec3::new((i % 6) as f64, 1.0 + (i / 36) as f64, (i / 6 % 6) as f64) * 1.05;
        let at = at + DVec3::new(random.f64(), random.f64(), random.f64()) * 0.1;
        let shape = if i % 3 == 0 {
            Shape::Box(DVec3::splat(0.4))
        } else {
            Shape::Sphere(0.5)
        };
        let body = world.dynamic(shape, 1.0, at);
        world.bodies.bodies[body].restitution = 0.3;
    }
    world
}
