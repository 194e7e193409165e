//! A nut on a bolt, with external meshes, if they are beside the checkout. At 64 Hz with default settings and 8
//! substeps the thread is so thin that a step has five or six collision substeps of two substeps each. A step takes
//! a third of a second with one thread, so the longer test is ignored by default.

use crate::world::World;
use bevy_faceoff::state::{Body, BodyParams};
use bevy_faceoff::testing::external;
use bevy_faceoff::types::body::RigidBody;
use bevy_faceoff::types::material::Friction;
use glam::{Quat, Vec3};
use std::f64::consts::TAU;

/// Metres per revolution: ISO 261, M16.
const PITCH: f64 = 0.002;
/// Radians per second about z. A right-hand thread moves the nut down.
const SPEED: f32 = -6.0;
/// Steps in which the nut falls onto the thread and accelerates.
const SETTLING: u32 = 16;

/// A steel nut on the thread of a bolt that stands upright, where the two do not touch.
fn nut_on_bolt(friction: f32) -> Option<World> {
    let [nut, bolt] = external::nut_and_bolt()?;
    let mut world = World::new();
    world.state.input.config.gravity = Vec3::NEG_Z * 9.81;
    let [bolt, nut] = [bolt, nut].map(|mesh| world.state.input.meshes.add(mesh));
    for (kind, mesh, at) in [
        (RigidBody::Static, bolt, Vec3::ZERO),
        // Five revolutions above the bottom of the thread.
        (RigidBody::Dynamic, nut, Vec3::Z * 0.01),
    ] {
        world.put(&Body {
            kind,
            density: 7800.0,
            params: BodyParams {
                friction: Friction::new(friction),
                ..BodyParams::default()
            },
            ..Body::at_rest(mesh, at, Quat::IDENTITY, Vec3::ONE)
        });
    }
    Some(world)
}

/// Rotates the nut by `turns` revolutions, with a torque that keeps the speed, and checks how far it moves down.
fn spun(friction: f32, turns: f64) {
    let Some(mut world) = nut_on_bolt(friction) else {
        return;
    };
    let (nut, mut turned, mut step) = (1, 0.0f64, 0u32);
    let mut start = None;
    let mut farthest_off = 0.0f64;
    let travel = loop {
        let bodies = &mut world.state.input.bodies;
        let inertia = bodies.local_inverse_inertia[nut].z_axis.z.recip();
        let missing = SPEED - bodies.angular_velocity[nut].z;
        bodies.params[nut].forces.torque = Vec3::Z * (0.5 * 64.0 * inertia * missing);
        let before = bodies.rotation[nut];
        world.step();
        let change = world.state.input.bodies.rotation[nut] * before.conjugate();
        turned += 2.0 * f64::from(change.z).atan2(f64::from(change.w)) / TAU;
        step += 1;
        if step % 8 == 0 {
            println!("step {step}: turned by {turned:.3}");
        }
        // Four times as many steps as needed.
        let limit = f64::from(SETTLING) + 4.0 * 64.0 * turns * TAU / f64::from(SPEED.abs());
        assert!(f64::from(step) < limit, "it got stuck after {turned} turns");
        if step == SETTLING {
            start = Some((turned, world.center(nut).z));
        }
        if let Some((turned_then, height)) = start {
            let (turned, travel) = (turned - turned_then, world.center(nut).z - height);
            farthest_off = farthest_off.max((travel - PITCH * turned).abs());
            if turned.abs() >= turns {
                break travel / turned;
            }
        }
    };
    let error = travel / PITCH - 1.0;
    println!(
        "friction {friction}: {:.4} mm per turn, {:+.2} % off, over {turns} turns in {step} steps; never farther than \
         {:.4} mm from the thread's line",
        1.0e3 * travel,
        100.0 * error,
        1.0e3 * farthest_off
    );
    assert!(error.abs() < 0.05, "{travel} m per turn");
    // An error of one revolution would be ten times as large.
    assert!(farthest_off < 0.1 * PITCH, "{farthest_off}");
}

/// `cargo test --release --test stages -- --ignored --nocapture smooth_nut`
/// (2.01 mm per turn over 0.4 turns, never farther than 0.015 mm from the thread's line).
#[test]
#[ignore = "takes minutes"]
fn a_smooth_nut_goes_down_its_thread() {
    spun(0.0, 1.0);
}

/// 1.986 mm per turn, never farther than 0.0042 mm from the thread's line.
#[test]
fn a_rough_nut_goes_down_its_thread() {
    spun(0.1, 0.25);
}
