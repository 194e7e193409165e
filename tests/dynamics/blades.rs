//! Bodies that rotate sweep up balls: kinematic and dynamic blades, a flipper.

use crate::ccd::shapes::cuboid;
use crate::world::World;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::state::{Body, BodyParams};
use bevy_faceoff::types::body::RigidBody;
use glam::{Quat, Vec3};

/// Adds a ball at rest.
fn ball(world: &mut World, radius: f64, at: Vec3, continuous: bool) -> usize {
    let mesh = world.mesh(&shapes::ball(radius, 3));
    world.put(&Body {
        params: BodyParams {
            continuous,
            ..BodyParams::default()
        },
        ..Body::at_rest(mesh, at, Quat::IDENTITY, Vec3::ONE)
    })
}

/// The largest speed that a ball at rest gets from a blade of 4 m that sweeps it up, over the speed of the blade's tip.
fn swept_up(kind: RigidBody, spin: f32, at: f32, continuous: bool) -> f32 {
    let mut world = World::weightless();
    let blade = world.mesh(&cuboid(Vec3::new(4.0, 0.4, 0.05)));
    world.put(&Body {
        kind,
        angular_velocity: Vec3::Y * spin,
        mass: Some(1000.0),
        ..Body::at_rest(blade, Vec3::ZERO, Quat::IDENTITY, Vec3::ONE)
    });
    let ball = ball(&mut world, 0.15, Vec3::new(at, 0.0, -1.0), continuous);
    let mut fastest: f32 = 0.0;
    for _ in 0..64 {
        world.step();
        fastest = fastest.max(world.velocity(ball).length());
    }
    fastest / (2.0 * spin)
}

#[test]
fn a_blade_gives_a_ball_no_more_than_its_own_speed() {
    for kind in [RigidBody::Kinematic, RigidBody::Dynamic] {
        for spin in [20.0, 60.0] {
            for at in [0.5, 1.0, 1.5] {
                for continuous in [false, true] {
                    let speed = swept_up(kind, spin, at, continuous);
                    // A bead that leaves a rod has the square root of 2 times the speed of the tip, at most.
                    assert!(
                        (0.9..1.42).contains(&speed),
                        "{kind:?}, {spin} rad/s, {at} m, {continuous}: {speed}"
                    );
                }
            }
        }
    }
}

/// The speed of a ball that lies on a flipper, 0.3 m from its axis, after the flipper has turned for so many steps and
/// stopped.
fn flipped(spin: f32, steps: u32, continuous: bool) -> f32 {
    let mut world = World::new();
    let flipper = world.mesh(&cuboid(Vec3::new(1.2, 0.1, 0.2)));
    let flipper = world.put(&Body {
        kind: RigidBody::Kinematic,
        ..Body::at_rest(flipper, Vec3::ZERO, Quat::IDENTITY, Vec3::ONE)
    });
    let ball = ball(&mut world, 0.05, Vec3::new(0.3, 0.1005, 0.0), continuous);
    for step in 0..6 + steps {
        let is_turning = step >= 6;
        world.state.input.bodies.angular_velocity[flipper] = if is_turning { Vec3::Z * spin } else { Vec3::ZERO };
        world.step();
    }
    world.velocity(ball).length()
}

#[test]
fn a_flipper_throws_a_ball_at_the_speed_of_its_surface() {
    for steps in [1, 2, 3] {
        for spin in [5.0, 17.3, 30.0] {
            let speeds = [false, true].map(|continuous| flipped(spin, steps, continuous));
            let least = 0.95 * 0.3 * spin;
            // It leaves beyond the tip if it slides there.
            let most = 1.42 * 0.6 * spin;
            let message = format!("{spin} rad/s for {steps} steps: {speeds:?}");
            assert!(speeds.iter().all(|speed| (least..most).contains(speed)), "{message}");
            assert!((speeds[1] / speeds[0] - 1.0).abs() < 0.15, "{message}");
        }
    }
}
