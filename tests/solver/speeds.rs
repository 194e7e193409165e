//! How the number of collision substeps follows from speeds.

use super::shapes::Shape;
use super::world::World;
use bevy_faceoff::solver::speeds::Speeds;
use bevy_faceoff::types::body::RigidBody;
use glam::{DVec3, Vec3};

#[test]
fn faster_and_thinner_bodies_get_more_collision_substeps() {
    let mut world = World::new();
    let settings = world.settings;
    world.dynamic(Shape::Sphere(0.5), 1.0, DVec3::ZERO);
    let collision_substeps = |world: &World| {
        Speeds::of(&world.bodies, world.dt, |_| false).collision_substeps(&settings, &world.bodies, world.dt)
    };
    assert_eq!(collision_substeps(&world), 1, "at rest");
    world.motion(0).linear_velocity = Vec3::X * 1000.0;
    assert_eq!(collision_substeps(&world), 1, "there is no relative motion");
    world.immovable(Shape::Sphere(0.5), RigidBody::Static, DVec3::X);
    world.motion(0).linear_velocity = Vec3::X * 15.5;
    assert_eq!(
        collision_substeps(&world),
        1,
        "just below a quarter of its diameter per step"
    );
    world.motion(0).linear_velocity = Vec3::X * 16.5;
    assert_eq!(collision_substeps(&world), 2);
    world.motion(0).angular_velocity = Vec3::X * 33.0;
    assert_eq!(collision_substeps(&world), 3, "rotation counts");
    world.immovable(Shape::Box(DVec3::new(5.0, 0.05, 5.0)), RigidBody::Static, DVec3::ZERO);
    assert_eq!(
        collision_substeps(&world),
        8,
        "a thin wall counts, and there is a limit"
    );
    world.motion(0).linear_velocity = Vec3::NAN;
    assert!((1..=8).contains(&collision_substeps(&world)));
    assert_eq!(
        [1, 2, 3, 8].map(|n| settings.substeps_per_collision_substep(n)),
        [8, 4, 3, 1]
    );
}
