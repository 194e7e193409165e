//! A nut on a bolt: that of the scene `nut`, and one of external meshes if they are beside the checkout. The thread of these is so
//! thin that a step has eight collision substeps, the most of default settings. It takes a quarter of a second with two threads,
//! so the longer test is ignored by default.

use crate::world::World;
use bevy_faceoff::state::{Body, BodyParams};
use bevy_faceoff::testing::external;
use bevy_faceoff::testing::scenes::thread;
use bevy_faceoff::types::body::RigidBody;
use bevy_faceoff::types::material::Friction;
use glam::{Quat, Vec3};
use std::f64::consts::TAU;

/// Steps in which the nut falls onto the thread and accelerates.
const SETTLING: u32 = 16;

/// A nut on the thread of a bolt that stands upright, where the two do not touch. The nut is body 1.
struct Thread {
    world: World,
    /// The bolt's axis, upward.
    axis: Vec3,
    /// Metres per revolution.
    pitch: f64,
    /// Radians per second about the axis. A right-hand thread moves the nut down.
    speed: f32,
}

/// The scene `nut`, whose thread is coarse.
fn coarse() -> Thread {
    let mut scene = thread::nut_on_bolt();
    scene.bodies[1].spin = Vec3::ZERO;
    Thread {
        world: World::of(&scene),
        axis: Vec3::Y,
        pitch: f64::from(thread::PITCH),
        speed: -3.0,
    }
}

/// A steel nut, five revolutions above the bottom of the thread: ISO 261, M16.
fn fine(friction: f32) -> Option<Thread> {
    let [nut, bolt] = external::nut_and_bolt()?;
    let mut world = World::new();
    world.state.input.config.gravity = Vec3::NEG_Z * 9.81;
    let [bolt, nut] = [bolt, nut].map(|mesh| world.state.input.meshes.add(mesh));
    for (kind, mesh, at) in [
        (RigidBody::Static, bolt, Vec3::ZERO),
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
    Some(Thread {
        world,
        axis: Vec3::Z,
        pitch: 0.002,
        speed: -6.0,
    })
}

/// Rotates the nut by `turns` revolutions, with a torque that keeps the speed, and checks how far it moves down.
fn spun(thread: Thread, turns: f64) {
    let Thread {
        mut world,
        axis,
        pitch,
        speed,
    } = thread;
    let height = |world: &World| world.center(1).dot(axis.as_dvec3());
    let (nut, mut turned, mut step) = (1, 0.0f64, 0u32);
    let mut start = None;
    let mut farthest_off = 0.0f64;
    let travel = loop {
        let bodies = &mut world.state.input.bodies;
        let inertia = axis.dot(bodies.local_inverse_inertia[nut] * axis).recip();
        let missing = speed - bodies.angular_velocity[nut].dot(axis);
        bodies.params[nut].forces.torque = axis * (0.5 * 64.0 * inertia * missing);
        let before = bodies.rotation[nut];
        world.step();
        let change = world.state.input.bodies.rotation[nut] * before.conjugate();
        turned += 2.0 * f64::from(change.xyz().dot(axis)).atan2(f64::from(change.w)) / TAU;
        step += 1;
        if step % 8 == 0 {
            println!("step {step}: turned by {turned:.3}");
        }
        // Four times as many steps as needed.
        let limit = f64::from(SETTLING) + 4.0 * 64.0 * turns * TAU / f64::from(speed.abs());
        assert!(f64::from(step) < limit, "it got stuck after {turned} turns");
        if step == SETTLING {
            start = Some((turned, height(&world)));
        }
        if let Some((turned_then, height_then)) = start {
            let (turned, travel) = (turned - turned_then, height(&world) - height_then);
            farthest_off = farthest_off.max((travel - pitch * turned).abs());
            if turned.abs() >= turns {
                break travel / turned;
            }
        }
    };
    let error = travel / pitch - 1.0;
    println!(
        "{:.4} mm per turn, {:+.2} % off, over {turns} turns in {step} steps; never farther than {:.4} mm from the \
         thread's line",
        1.0e3 * travel,
        100.0 * error,
        1.0e3 * farthest_off
    );
    assert!(error.abs() < 0.05, "{travel} m per turn");
    // An error of one revolution would be ten times as large.
    assert!(farthest_off < 0.1 * pitch, "{farthest_off}");
}

/// The coarse thread, which needs no external mesh.
#[test]
fn a_nut_goes_down_a_coarse_thread() {
    spun(coarse(), 1.0);
}

/// `cargo test --release --test stages -- --ignored --nocapture smooth_nut`
/// (1.9994 mm per turn, never farther than 0.0047 mm from the thread's line).
#[test]
#[ignore = "takes 20 s"]
fn a_smooth_nut_goes_down_its_thread() {
    if let Some(thread) = fine(0.0) {
        spun(thread, 1.0);
    }
}

/// 1.979 mm per turn, never farther than 0.0066 mm from the thread's line.
#[test]
fn a_rough_nut_goes_down_its_thread() {
    if let Some(thread) = fine(0.1) {
        spun(thread, 0.25);
    }
}
