//! Results that are read two steps later, or stay on the GPU: they are those of steps that wait, two steps later, and
//! what users write in between is neither lost nor overwritten.

use crate::app::{DEVICE, STEP, Sim, ball_like, resting};
use crate::gpu::Test;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::gpu::layout::{Body as DeviceBody, Moved};
use bevy_faceoff::gpu::readback::read_words;
use bevy_faceoff::plugin::settings::LATENCY;
use bevy_faceoff::prelude::*;

pub const TESTS: &[Test] = &[
    ("results_are_those_of_waiting_steps_two_steps_later", same_later),
    ("lists_that_are_too_short_are_made_longer_in_flight", overflow),
    ("what_users_write_is_neither_lost_nor_overwritten", writes),
    ("bodies_and_meshes_come_and_go_in_flight", churn),
    ("a_body_that_leaves_and_returns_gets_no_old_result", returns),
    ("a_lost_device_loses_no_body", lost),
    ("energy_is_told_where_results_are_waited_for", energy),
    ("resident_bodies_move_on_the_gpu_alone", resident),
    ("a_snapshot_brings_everything_back", snapshots),
    ("poses_after_a_snapshot_are_those_of_the_bodies_told", restored_poses),
];

/// An app whose clock stands still until the device is ready.
pub fn app(backend: Backend, readback: Readback) -> Sim {
    let mut sim = opening(backend, readback);
    await_device(&mut sim);
    sim
}

/// An app whose device may not be ready yet.
pub fn opening(backend: Backend, readback: Readback) -> Sim {
    let mut sim = Sim::with_step(StepPlugin {
        backend,
        threads: 1,
        readback,
        ..default()
    });
    sim.world().insert_resource(Response::Impulse);
    sim
}

/// Steps until the device is ready.
pub fn await_device(sim: &mut Sim) {
    while active(sim) == "opening" {
        std::thread::sleep(STEP);
        sim.step(1);
    }
}

pub fn active(sim: &Sim) -> &'static str {
    sim.app.world().resource::<ActiveBackend>().name()
}

/// Two equal apps: on a GPU that is waited for, and on one that is not.
pub fn both() -> [Sim; 2] {
    [Readback::Lockstep, Readback::Latent].map(|readback| app(Backend::Gpu, readback))
}

/// Bodies in a cube of this size, with random velocities.
fn crowd(sim: &mut Sim, count: usize, size: f32) -> Vec<Entity> {
    let torus = sim.mesh(&shapes::torus_240());
    let mut random = fastrand::Rng::with_seed(5);
    let mut point = move |size: f32| size * (Vec3::from_array([0; 3].map(|_| random.f32())) - 0.5);
    sim.spawn((
        PlaneCollider::through(Vec3::Y * -0.6 * size, Vec3::Y),
        Restitution::new(0.5),
    ));
    (0..count)
        .map(|i| {
            let body = sim.spawn(ball_like(&torus, point(size), point(2.0)));
            let spin = AngularVelocity(point(3.0));
            sim.set(body, spin);
            if i % 10 == 0 {
                sim.set(body, RigidBody::Kinematic);
            }
            body
        })
        .collect()
}

pub type Pose = (Entity, Transform, LinearVelocity, AngularVelocity);

pub fn poses(sim: &mut Sim) -> Vec<Pose> {
    let world = sim.world();
    let mut query = world.query_filtered::<(Entity, &Transform, &LinearVelocity, &AngularVelocity), With<RigidBody>>();
    let mut poses: Vec<_> = query.iter(world).map(|(e, t, v, w)| (e, *t, *v, *w)).collect();
    poses.sort_unstable_by_key(|&(entity, ..)| entity);
    poses
}

/// What a step told of collisions, to the last bit.
fn told(sim: &Sim) -> String {
    let collisions: Vec<_> = sim.collisions().iter().collect();
    let report = sim.report();
    format!("{collisions:?} {} {}", report.sphere_pairs, report.triangle_tests)
}

/// Runs both apps and compares each step of the first with that of the second `LATENCY` steps later.
///
/// `act` tells which body it put somewhere: that one is there at once, on both sides.
fn compare(sims: &mut [Sim; 2], steps: usize, mut act: impl FnMut(&mut Sim, usize) -> Option<Entity>) {
    let [waits, latent] = sims;
    let mut history = Vec::new();
    let mut placed = Vec::new();
    for step in 0..steps {
        let of_both = [&mut *waits, &mut *latent].map(|sim| {
            let placed = act(sim, step);
            sim.step(1);
            placed
        });
        assert_eq!(of_both[0], of_both[1]);
        placed.push(of_both[0]);
        history.push((told(waits), poses(waits)));
        if step >= LATENCY {
            let (told_then, poses_then) = &history[step - LATENCY];
            assert!(told(latent) == *told_then, "collisions of step {step} differ");
            let now = poses(latent);
            // Bodies that came or went since are not the same on both sides.
            for pose in poses_then {
                let placed = placed[step + 1 - LATENCY..].contains(&Some(pose.0));
                if let Some(found) = now.iter().find(|found| found.0 == pose.0 && !placed) {
                    assert_eq!(found, pose, "step {step}");
                }
            }
        }
    }
    assert_eq!(latent.report().in_flight, LATENCY);
    assert_eq!(waits.report().in_flight, 0);
}

fn same_later(_: &Gpu) {
    let mut sims = both();
    let [one, other] = sims.each_mut().map(|sim| crowd(sim, 60, 4.0));
    assert_eq!(one, other);
    compare(&mut sims, 40, |_, _| None);
    let [waits, latent] = &mut sims;
    assert!(waits.started.len() > 20, "{}", waits.started.len());
    // The last two steps' messages are still to come.
    assert!(waits.started.starts_with(&latent.started));
    assert!(waits.ended.starts_with(&latent.ended));
    assert!(waits.started.len() - latent.started.len() < 20);
}

fn overflow(_: &Gpu) {
    let mut sims = both();
    for sim in &mut sims {
        // More of everything than there is room for at first, once they come near each other.
        for body in crowd(sim, 300, 20.0) {
            let velocity = -0.4 * sim.position(body);
            sim.set(body, (LinearVelocity(velocity), RigidBody::Dynamic));
        }
        sim.app.insert_resource(Response::None);
        sim.app.insert_resource(TimeUpdateStrategy::ManualDuration(STEP));
        sim.app.insert_resource(Time::<Fixed>::from_duration(STEP));
    }
    compare(&mut sims, 12, |sim, step| {
        // Ten steps in one, so that lists grow from step to step.
        if step == 0 {
            for body in poses(sim) {
                let velocity = 10.0 * body.2.0;
                sim.set(body.0, LinearVelocity(velocity));
            }
        }
        None
    });
    let report = sims[1].report();
    // There was room for 4096 at first.
    assert!(report.face_pairs > 5000, "{report:?}");
}

fn writes(_: &Gpu) {
    let mut sim = app(Backend::Gpu, Readback::Latent);
    let torus = sim.mesh(&shapes::torus_240());
    let body = sim.spawn(ball_like(&torus, Vec3::ZERO, Vec3::X));
    sim.step(5);
    // Three steps of results in five.
    assert_eq!(sim.position(body).x, 3.0 / 64.0);

    let place = Vec3::new(0.0, 10.0, 0.0);
    sim.set(body, Transform::from_translation(place));
    for steps in 1..=6 {
        sim.step(1);
        let since = (steps as f32 - LATENCY as f32).max(0.0) / 64.0;
        assert_eq!(sim.position(body), place + Vec3::X * since, "{steps} steps later");
    }

    // Two pushes, one step apart, before the results of the first are there.
    let push = |sim: &mut Sim, push| sim.world().get_mut::<LinearVelocity>(body).unwrap().0 += push;
    push(&mut sim, Vec3::Y * 2.0);
    sim.step(1);
    assert_eq!(sim.velocity(body), Vec3::new(1.0, 2.0, 0.0));
    push(&mut sim, Vec3::Z);
    for _ in 0..6 {
        sim.step(1);
        assert_eq!(sim.velocity(body), Vec3::new(1.0, 2.0, 1.0));
    }
    let start = sim.position(body);
    sim.step(64);
    assert_eq!(sim.position(body) - start, Vec3::new(1.0, 2.0, 1.0));

    // Gravity goes on while a push is on its way.
    sim.app.insert_resource(Gravity(Vec3::NEG_Y * 64.0));
    sim.step(4);
    let before = sim.velocity(body);
    assert_eq!(before, Vec3::new(1.0, 0.0, 1.0));
    push(&mut sim, Vec3::Y * 100.0);
    sim.step(4);
    assert_eq!(sim.velocity(body), Vec3::new(1.0, 96.0, 1.0));

    // Properties that the step does not change hold from the next step on.
    sim.app.insert_resource(Gravity(Vec3::ZERO));
    sim.step(3);
    sim.set(body, RigidBody::Static);
    // Where the body is and not where it is seen.
    let there = sim.position(body) + sim.velocity(body) * LATENCY as f32 / 64.0;
    sim.step(6);
    assert!(sim.position(body).distance(there) < 1.0e-5);
    let there = sim.position(body);
    sim.set(body, RigidBody::Dynamic);
    sim.step(4);
    assert_eq!(sim.position(body) - there, sim.velocity(body) * 2.0 / 64.0);
}

fn churn(_: &Gpu) {
    let mut sims = both();
    let cube = shapes::cube(0.8);
    for sim in &mut sims {
        crowd(sim, 30, 3.0);
    }
    compare(&mut sims, 40, |sim, step| {
        let bodies = poses(sim);
        let (first, last) = (bodies[0].0, bodies[bodies.len() - 1].0);
        let place = Vec3::new(0.1 * step as f32 - 2.0, 0.2, 0.0);
        match step % 6 {
            0 => {
                sim.world().despawn(first);
            }
            1 => {
                let mesh = sim.get::<MeshCollider>(last);
                sim.spawn(ball_like(&mesh, place, Vec3::NEG_X));
            }
            2 => {
                let mesh = sim.mesh(&cube);
                sim.set(last, mesh);
            }
            3 => {
                sim.set(last, Transform::from_translation(place));
                return Some(last);
            }
            4 => {
                let mesh = sim.mesh(&cube);
                sim.spawn(resting(&mesh, place));
            }
            _ => {}
        }
        None
    });
    assert!(sims[0].started.len() > 20);
}

fn returns(_: &Gpu) {
    let mut sim = app(Backend::Gpu, Readback::Latent);
    let torus = sim.mesh(&shapes::torus_240());
    let other = sim.spawn(ball_like(&torus, Vec3::Y * 9.0, Vec3::Z));
    let body = sim.spawn(ball_like(&torus, Vec3::ZERO, Vec3::X));
    sim.step(4);
    sim.world().entity_mut(body).remove::<MeshCollider>();
    sim.step(1);
    sim.set(body, (torus.clone(), Transform::from_xyz(0.0, 4.0, 0.0)));
    sim.step(2);
    assert_eq!(sim.position(body), Vec3::Y * 4.0);
    sim.step(1);
    assert_eq!(sim.position(body), Vec3::new(1.0 / 64.0, 4.0, 0.0));
    assert_eq!(sim.position(other).z, 6.0 / 64.0);
    // Numbers move up when a body before this one goes.
    sim.world().despawn(other);
    let third = sim.spawn(ball_like(&torus, Vec3::Y * -9.0, Vec3::Z));
    sim.step(3);
    assert_eq!(sim.position(body), Vec3::new(4.0 / 64.0, 4.0, 0.0));
    assert_eq!(sim.position(third), Vec3::new(0.0, -9.0, 1.0 / 64.0));
}

fn energy(_: &Gpu) {
    let measure = |backend, readback| {
        let mut sim = app(backend, readback);
        sim.world().insert_resource(MeasureEnergy(true));
        sim.world().insert_resource(Gravity::default());
        // Its centre of mass is not its origin.
        let cube = shapes::cube(1.0);
        let aside = cube.vertices().iter().map(|v| *v + Vec3::X).collect();
        let aside = sim.mesh(&TriMesh::new(aside, cube.triangles().to_vec()).unwrap());
        let motion = (LinearVelocity(Vec3::X), AngularVelocity(Vec3::new(1.0, 2.0, 3.0)));
        sim.spawn((resting(&aside, Vec3::Y), Mass(2.0), motion));
        let part = |x: f32| (aside.clone(), Transform::from_xyz(x, 1.0, 0.0));
        let at = Transform::from_xyz(9.0, 0.0, 0.0);
        sim.spawn((
            RigidBody::Dynamic,
            Mass(3.0),
            motion,
            at,
            children![part(0.0), part(2.0)],
        ));
        sim.step(10);
        sim.report().energy
    };
    let cpu = measure(Backend::Cpu, Readback::Auto).unwrap();
    let gpu = measure(Backend::Gpu, Readback::Lockstep).unwrap();
    for [on_cpu, on_gpu] in [[cpu.kinetic, gpu.kinetic], [cpu.potential, gpu.potential]] {
        assert!(
            on_cpu > 1.0 && (on_cpu - on_gpu).abs() < 1e-4 * on_cpu,
            "{cpu:?} {gpu:?}"
        );
    }
    for late in [Readback::Latent, Readback::Resident] {
        assert_eq!(measure(Backend::Gpu, late), None);
    }
}

fn lost(_: &Gpu) {
    DEVICE.set(None);
    let mut sim = app(Backend::Gpu, Readback::Latent);
    let torus = sim.mesh(&shapes::torus_240());
    let body = sim.spawn(ball_like(&torus, Vec3::ZERO, Vec3::X));
    sim.step(10);
    assert_eq!(sim.position(body).x, 8.0 / 64.0);
    let gpu = bevy_faceoff::plugin::gpu(sim.app.world()).unwrap();
    gpu.device.destroy();
    // Results that had arrived before are published first.
    let mut failures = 0;
    for _ in 0..=LATENCY {
        sim.step(1);
        failures += sim.world().resource_mut::<Messages<BackendFailed>>().drain().count();
        if failures > 0 {
            break;
        }
    }
    assert_eq!(failures, 1);
    assert_eq!(active(&sim), "gpu");
    // The step that failed ran again, from where the component was.
    let start = sim.position(body).x;
    assert!(start >= 8.0 / 64.0);
    sim.step(9);
    assert_eq!(sim.position(body).x, start + 8.0 / 64.0);
}

fn resident(_: &Gpu) {
    let [mut waits, mut sim] = [Readback::Lockstep, Readback::Resident].map(|readback| app(Backend::Gpu, readback));
    let [one, other] = [&mut waits, &mut sim].map(|sim| crowd(sim, 40, 3.0));
    assert_eq!(one, other);
    let start = poses(&mut sim);
    let mut reports = Vec::new();
    for step in 0..20 {
        if step == 10 {
            for sim in [&mut waits, &mut sim] {
                sim.set(one[5], Transform::from_xyz(0.0, 0.3, 0.0));
            }
        }
        waits.step(1);
        sim.step(1);
        reports.push((waits.report().touching_pairs, waits.report().face_pairs));
        if step >= LATENCY {
            let report = sim.report();
            assert_eq!((report.touching_pairs, report.face_pairs), reports[step - LATENCY]);
        }
    }
    assert!(reports.iter().all(|&(pairs, _)| pairs > 0));
    let mut end = poses(&mut sim);
    let moved = end.iter().position(|pose| pose.0 == one[5]).unwrap();
    end[moved].1 = start[moved].1;
    assert_eq!(start, end, "components stay as users left them");
    assert!(sim.collisions().is_empty() && sim.started.is_empty());

    let snapshot = Snapshot::take(sim.world());
    let wanted = poses(&mut waits);
    assert_eq!(snapshot.bodies().len(), wanted.len());
    for ((entity, motion), pose) in snapshot.bodies().zip(&wanted) {
        assert_eq!(entity, pose.0);
        assert_eq!(
            (motion.position, motion.rotation),
            (pose.1.translation, pose.1.rotation)
        );
        assert_eq!((motion.linear_velocity, motion.angular_velocity), (pose.2.0, pose.3.0));
    }

    // Buffers on the device hold these poses, and one step of motion lies between the two buffers.
    let world = sim.app.world();
    let gpu = bevy_faceoff::plugin::gpu(world).unwrap();
    let (buffers, entities) = bevy_faceoff::plugin::poses(world).unwrap();
    let entities: Vec<Entity> = entities.collect();
    let vector = |words: &[u32]| Vec3::from_array([0, 1, 2].map(|k| f32::from_bits(words[k])));
    let [stride_before, stride_after] = [size_of::<DeviceBody>(), size_of::<Moved>()].map(|bytes| bytes / 4);
    let before = read_words(gpu, buffers.previous, stride_before * entities.len()).unwrap();
    let after = read_words(gpu, buffers.current, stride_after * entities.len()).unwrap();
    assert_eq!(buffers.bodies as usize, entities.len());
    for (i, entity) in entities.iter().enumerate() {
        let pose = wanted.iter().find(|pose| pose.0 == *entity).unwrap();
        let position = vector(&after[stride_after * i..]);
        assert_eq!(position, pose.1.translation);
        let step = position - vector(&before[stride_before * i..]);
        assert!((step - pose.2.0 / 64.0).length() < 0.1, "{step}");
        assert!(step != Vec3::ZERO);
    }
}

fn snapshots(_: &Gpu) {
    for (backend, readback) in [
        (Backend::Cpu, Readback::Latent),
        (Backend::Gpu, Readback::Lockstep),
        (Backend::Gpu, Readback::Latent),
        (Backend::Gpu, Readback::Resident),
    ] {
        let mut sim = app(backend, readback);
        let bodies = crowd(&mut sim, 40, 3.0);
        sim.step(10);
        let start = Snapshot::take(sim.world());
        sim.step(10);
        let end = Snapshot::take(sim.world());
        assert_ne!(start, end);
        assert_eq!(start.restore(sim.world()), []);
        assert_eq!(Snapshot::take(sim.world()), start, "{backend:?} {readback:?}");
        sim.step(10);
        assert_eq!(
            Snapshot::take(sim.world()).bodies().collect::<Vec<_>>(),
            end.bodies().collect::<Vec<_>>(),
            "{backend:?} {readback:?}"
        );
        // What users write after the last step is in it.
        sim.set(bodies[0], Transform::from_xyz(7.0, 7.0, 7.0));
        let snapshot = Snapshot::take(sim.world());
        let (_, motion) = snapshot.bodies().find(|&(entity, _)| entity == bodies[0]).unwrap();
        assert_eq!(motion.position, Vec3::splat(7.0));
        sim.world().despawn(bodies[1]);
        assert_eq!(snapshot.restore(sim.world()), [bodies[1]]);
        sim.step(4);
        assert!(sim.position(bodies[0]).distance(Vec3::splat(7.0)) < 0.5);
    }
}

fn restored_poses(_: &Gpu) {
    let mut sim = app(Backend::Gpu, Readback::Resident);
    crowd(&mut sim, 5, 3.0);
    sim.step(4);
    let snapshot = Snapshot::take(sim.world());
    let counts = |sim: &Sim| {
        let (poses, entities) = bevy_faceoff::plugin::poses(sim.app.world()).unwrap();
        (poses.bodies as usize, entities.count())
    };
    assert_eq!(counts(&sim), (5, 5));
    snapshot.restore(sim.world());
    let (bodies, entities) = counts(&sim);
    assert_eq!(bodies, entities);
    sim.step(1);
    assert_eq!(counts(&sim), (5, 5));
}
