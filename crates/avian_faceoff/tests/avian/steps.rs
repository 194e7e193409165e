//! Several steps of Avian in one run of its schedule.

use crate::world::{Contacts, HZ, World};
use avian_faceoff::prelude::*;
use avian3d::math::AdjustPrecision;
use avian3d::prelude::*;
use bevy::prelude::*;
use bevy_faceoff::testing::scenes::{Body, Scene, Shape};

/// A cube of 1 kg in flight.
fn cube(steps: u32) -> (World, Entity) {
    let mut world = World::new(Contacts::Exact);
    world
        .app
        .add_plugins(PhysicsStepsPlugin::new(steps))
        .insert_resource(SubstepCount(6 / steps));
    let mut scene = Scene::weightless();
    scene.add(Body::new(Shape::Cube, Vec3::ZERO, Quat::IDENTITY));
    world.fill(&scene);
    let cube = world.bodies[0];
    world.begin();
    (world, cube)
}

/// Pushes the cube for one run.
fn push(mut forces: Query<Forces>, mut pushed: Local<bool>) {
    if !std::mem::replace(&mut *pushed, true) {
        for mut forces in &mut forces {
            forces.apply_force(Vec3::new(0.0, 64.0, 0.0).adjust_precision());
            forces.apply_local_force(Vec3::new(32.0, 0.0, 0.0).adjust_precision());
        }
    }
}

#[test]
fn forces_act_for_as_long() {
    for steps in [1, 2, 3] {
        let (mut world, cube) = cube(steps);
        world.app.add_systems(FixedUpdate, push);
        world.steps(4);
        let velocity = world.velocity(cube);
        // 64 N on 1 kg for a 64th of a second.
        assert!(
            velocity.distance(Vec3::new(0.5, 1.0, 0.0)) < 1e-4,
            "{velocity} with {steps} steps"
        );
    }
}

#[test]
fn time_passes_as_fast() {
    for steps in [1, 2, 3] {
        let (mut world, cube) = cube(steps);
        world.app.world_mut().get_mut::<LinearVelocity>(cube).expect("a body").0 = Vec3::X.adjust_precision();
        world
            .app
            .world_mut()
            .resource_mut::<Time<Physics>>()
            .set_relative_speed(0.5);
        world.steps(HZ);
        let way = world.position(cube).x;
        assert!((way - 0.5).abs() < 1e-4, "{way} m with {steps} steps");
        let clock = world.app.world().resource::<Time<Physics>>();
        assert_eq!(clock.relative_speed(), 0.5);
        assert!(
            (clock.elapsed_secs() - 0.5).abs() < 1e-4,
            "{:?} with {steps} steps",
            clock.elapsed()
        );
        let delta = clock.delta_secs() * HZ as f32;
        assert!(
            (delta - 0.5).abs() < 1e-4,
            "the last run took {delta} with {steps} steps"
        );
        world.app.world_mut().resource_mut::<Time<Physics>>().pause();
        // Avian does one more step.
        world.step();
        let way = world.position(cube).x;
        world.steps(4);
        assert_eq!(world.position(cube).x, way, "time stands still");
        world.app.world_mut().resource_mut::<Time<Physics>>().unpause();
        world.app.insert_resource(PhysicsSteps(0));
        world.steps(2);
        assert!(world.position(cube).x > way);
    }
}
