//! Clocks that stand still and steps by hand: what is on its way is published, and what waits for the next step is not
//! used up.

use super::readback::{active, app, both, opening, poses};
use crate::app::{STEP, Sim, ball_like};
use crate::gpu::Test;
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::plugin::settings::LATENCY;
use bevy_faceoff::prelude::*;

pub const TESTS: &[Test] = &[
    ("nothing_moves_until_the_kernels_are_compiled", ready),
    ("a_step_by_hand_is_waited_for", by_hand),
    ("who_steps_by_hand_alone_gets_the_device_too", ready_by_hand),
    ("a_paused_clock_publishes_what_is_on_its_way", paused),
    ("a_clock_without_speed_publishes_what_is_on_its_way", stopped),
    ("all_is_published_while_time_stands_still", virtual_paused),
];

/// A body that flies along x, a metre a step.
fn flyer(readback: Readback) -> (Sim, Entity) {
    let mut sim = app(Backend::Gpu, readback);
    let torus = sim.mesh(&shapes::torus_240());
    let body = sim.spawn(ball_like(&torus, Vec3::ZERO, Vec3::X * 64.0));
    (sim, body)
}

/// Where the body is after the last step, whether its components say so or not.
fn reached(sim: &mut Sim, body: Entity) -> f32 {
    let snapshot = Snapshot::take(sim.world());
    let (_, motion) = snapshot.bodies().find(|&(entity, _)| entity == body).unwrap();
    motion.position.x
}

fn by_hand(_: &Gpu) {
    for readback in [Readback::Lockstep, Readback::Latent, Readback::Resident] {
        let (mut sim, body) = flyer(readback);
        sim.step(5);
        sim.world().resource_mut::<Time<Virtual>>().pause();
        for steps in 6..9 {
            sim.world().run_schedule(FaceoffStep);
            assert_eq!(reached(&mut sim, body), steps as f32, "{readback:?}");
            assert_eq!(sim.report().in_flight, 0, "{readback:?}");
            if readback != Readback::Resident {
                assert_eq!(sim.position(body).x, steps as f32, "{readback:?}");
            }
        }
        sim.world().resource_mut::<Time<Virtual>>().unpause();
        sim.step(LATENCY + 1);
        assert_eq!(reached(&mut sim, body), (8 + LATENCY + 1) as f32, "{readback:?}");
    }
}

fn ready(_: &Gpu) {
    let mut sim = opening(Backend::Gpu, Readback::Latent);
    let torus = sim.mesh(&shapes::torus_240());
    let body = sim.spawn(ball_like(&torus, Vec3::ZERO, Vec3::X));
    assert_eq!(active(&sim), "opening");
    let mut told = Vec::new();
    for _ in 0..3000 {
        sim.step(1);
        told.extend(sim.world().resource_mut::<Messages<BackendReady>>().drain());
        if !told.is_empty() {
            break;
        }
        assert_eq!(sim.position(body), Vec3::ZERO);
        assert_eq!(sim.report().step, 0);
        std::thread::sleep(STEP);
    }
    // The first step ran in the update that told.
    sim.step(LATENCY);
    assert_eq!(sim.position(body).x, 1.0 / 64.0);
    told.extend(sim.world().resource_mut::<Messages<BackendReady>>().drain());
    assert_eq!(told.len(), 1);
    assert_eq!(told[0].active, *sim.app.world().resource::<ActiveBackend>());
}

fn ready_by_hand(_: &Gpu) {
    let mut sim = opening(Backend::Gpu, Readback::Latent);
    let torus = sim.mesh(&shapes::torus_240());
    let body = sim.spawn(ball_like(&torus, Vec3::ZERO, Vec3::X * 64.0));
    for _ in 0..3000 {
        sim.world().run_schedule(FaceoffStep);
        if active(&sim) != "opening" {
            break;
        }
        assert_eq!((sim.position(body).x, sim.report().step), (0.0, 0));
        std::thread::sleep(STEP);
    }
    assert_eq!(active(&sim), "gpu");
    assert_eq!((sim.position(body).x, sim.report().step), (1.0, 1));
    assert_eq!(sim.world().resource::<Time<Physics>>().elapsed(), STEP);
    assert_eq!(sim.world().resource_mut::<Messages<BackendReady>>().drain().count(), 1);
}

fn paused(_: &Gpu) {
    for readback in [Readback::Lockstep, Readback::Latent, Readback::Resident] {
        let is_resident = readback == Readback::Resident;
        let (mut sim, body) = flyer(readback);
        let zone = sim.mesh(&shapes::cube(0.5));
        // Entered as the fifth step begins.
        sim.spawn((zone, Transform::from_xyz(4.6, 0.0, 0.0), Sensor));
        sim.step(5);
        sim.world().resource_mut::<Time<Physics>>().pause();
        sim.step(1);
        assert_eq!(sim.report().in_flight, 0, "{readback:?}");
        let steps = sim.report().step;
        assert_eq!(sim.started.len(), usize::from(!is_resident), "{readback:?}");
        let shown = |sim: &Sim| if is_resident { None } else { Some(sim.position(body).x) };
        let wanted = |x: f32| Some(x).filter(|_| !is_resident);
        assert_eq!(shown(&sim), wanted(5.0), "{readback:?}");
        sim.step(3);
        assert_eq!(sim.report().step, steps, "{readback:?}");

        // What waits for the clock is not used up.
        let push = ExternalForces {
            impulse: Vec3::Y,
            ..default()
        };
        sim.set(body, push);
        sim.step(2);
        assert_eq!(sim.get::<ExternalForces>(body), push);
        sim.world().resource_mut::<Time<Physics>>().step_once();
        sim.step(2);
        assert_eq!(sim.get::<ExternalForces>(body), ExternalForces::default());
        assert_eq!(shown(&sim), wanted(6.0), "{readback:?}");
        assert_eq!(reached(&mut sim, body), 6.0, "{readback:?}");
        assert_eq!(sim.report().in_flight, 0);

        let mut time = sim.world().resource_mut::<Time<Physics>>();
        time.unpause();
        time.set_relative_speed(0.5);
        sim.step(4);
        assert_eq!(reached(&mut sim, body), 8.0, "{readback:?}");
    }
}

fn stopped(_: &Gpu) {
    for readback in [Readback::Lockstep, Readback::Latent] {
        let (mut sim, body) = flyer(readback);
        sim.step(5);
        sim.world().resource_mut::<Time<Physics>>().set_relative_speed(0.0);
        sim.step(1);
        assert_eq!(sim.report().in_flight, 0, "{readback:?}");
        assert_eq!(sim.position(body).x, 5.0, "{readback:?}");
    }
}

fn virtual_paused(_: &Gpu) {
    for response in [Response::Impulse, Response::Contacts] {
        let mut sims = both();
        let bodies = sims.each_mut().map(|sim| {
            sim.app.insert_resource(response);
            let torus = sim.mesh(&shapes::torus_240());
            // They begin to touch in the fifth step.
            let x = 1.5 + 4.5 / 64.0;
            sim.spawn((torus.clone(), RigidBody::Static));
            sim.spawn(ball_like(&torus, Vec3::X * x, Vec3::NEG_X))
        });
        assert_eq!(bodies[0], bodies[1]);
        let [waits, latent] = &mut sims;
        waits.step(6);
        latent.step(6);
        assert_eq!(latent.report().in_flight, LATENCY);
        let published = latent.report().step;
        latent.world().resource_mut::<Time<Virtual>>().pause();
        // What is said while time stands still is not lost.
        let acting = ExternalForces {
            impulse: Vec3::Y,
            ..default()
        };
        latent.set(bodies[1], acting);
        latent.step(LATENCY + 3);
        assert_eq!(latent.report().step, published + LATENCY as u64, "{response:?}");
        assert_eq!(latent.report().in_flight, 0);
        assert_eq!(latent.started, waits.started);
        assert_eq!(poses(latent), poses(waits));
        assert_eq!(latent.get::<ExternalForces>(bodies[1]).impulse, Vec3::Y);

        latent.world().resource_mut::<Time<Virtual>>().unpause();
        latent.set(bodies[1], ExternalForces::default());
        waits.step(6);
        latent.step(6 + LATENCY);
        assert_eq!(poses(latent), poses(waits), "{response:?}");
        assert_eq!(latent.started, waits.started);
        assert_eq!(latent.ended, waits.ended);
    }
}
