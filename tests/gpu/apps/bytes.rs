//! How many bytes pass between the CPU and the GPU: what systems change, and what the app asks for.

use crate::app::{Sim, ball_like};
use crate::gpu::Test;
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::prelude::*;
use bevy_faceoff::types::gpu_work::GpuWork;

pub const TESTS: &[Test] = &[
    ("who_moves_by_physics_alone_is_not_uploaded", physics_alone),
    ("who_is_written_is_uploaded", written),
    ("nothing_runs_while_all_sleep", all_asleep),
    ("faces_are_read_back_only_where_asked_for", face_lists),
];

const COUNT: usize = 400;

/// Bodies far from each other, in flight, and as many that stand still.
fn flock(readback: Readback, response: Response) -> (Sim, Vec<Entity>) {
    let mut sim = super::readback::app(Backend::Gpu, readback);
    sim.world().insert_resource(response);
    let torus = sim.mesh(&shapes::torus_240());
    let bodies = (0..COUNT)
        .map(|i| {
            let position = 3.0 * Vec3::new((i % 20) as f32, 0.0, (i / 20) as f32);
            let body = sim.spawn(ball_like(&torus, position, Vec3::Y));
            sim.set(body, AngularVelocity(Vec3::X));
            let still = sim.spawn(ball_like(&torus, position - 100.0 * Vec3::Y, Vec3::ZERO));
            sim.set(still, RigidBody::Static);
            body
        })
        .collect();
    (sim, bodies)
}

fn work(sim: &Sim) -> GpuWork {
    sim.report().gpu.expect("the step ran on the GPU")
}

fn physics_alone(_: &Gpu) {
    for response in [Response::Impulse, Response::None, Response::Contacts] {
        for readback in [Readback::Latent, Readback::Resident] {
            let (mut sim, bodies) = flock(readback, response);
            sim.step(8);
            for _ in 0..5 {
                sim.step(1);
                let GpuWork {
                    uploaded_bytes,
                    read_back_bytes,
                    ..
                } = work(&sim);
                assert!(uploaded_bytes < 1024, "{response:?} {readback:?}: {uploaded_bytes}");
                if readback == Readback::Resident {
                    assert!(read_back_bytes < 1024, "{response:?}: {read_back_bytes}");
                }
            }
            // They do fly.
            let snapshot = Snapshot::take(sim.world());
            let (_, motion) = snapshot.bodies().find(|(entity, _)| *entity == bodies[7]).unwrap();
            assert!(motion.position.y.abs() > 0.05, "{}", motion.position);
        }
    }
}

/// Cubes on a floor fall asleep. Then nothing is asked of the GPU, until a system wakes one.
fn all_asleep(_: &Gpu) {
    for readback in [Readback::Lockstep, Readback::Latent, Readback::Resident] {
        let mut sim = super::readback::app(Backend::Gpu, readback);
        sim.world().insert_resource(Response::Contacts);
        sim.world().insert_resource(Gravity(Vec3::NEG_Y * 9.81));
        let cube = sim.mesh(&shapes::cube(1.0));
        sim.spawn((cube.clone(), Transform::from_scale(Vec3::new(20.0, 1.0, 20.0))));
        let bodies = [-3.0, 0.0, 3.0].map(|x| {
            let at = Transform::from_xyz(x, 1.001, 0.0);
            sim.spawn((RigidBody::Dynamic, cube.clone(), at))
        });
        let mut idle = 0;
        for _ in 0..100 {
            sim.step(1);
            let Some(work) = sim.report().gpu else { continue };
            if (work.dispatches, work.read_back_bytes, work.uploaded_bytes) == (0, 0, 0) {
                assert_eq!(sim.report().sleeping, 3);
                idle += 1;
            }
        }
        assert!(idle > 20, "{readback:?}: {idle}, {:?}", work(&sim));
        if readback != Readback::Resident {
            assert_eq!(sim.collisions().len(), 3, "those asleep touch as before");
        }
        sim.set(bodies[0], LinearVelocity(Vec3::Y * 3.0));
        sim.step(8);
        assert!(work(&sim).dispatches > 0);
        let snapshot = Snapshot::take(sim.world());
        let height = |body| {
            let (_, motion) = snapshot.bodies().find(|(entity, _)| *entity == body).unwrap();
            motion.position.y
        };
        assert!(height(bodies[0]) > 1.1, "{readback:?}: {}", height(bodies[0]));
        assert!((height(bodies[1]) - 1.0).abs() < 0.01);
    }
}

/// Overlapping bodies that do not react, with lists of faces from the fifth step on.
fn face_lists(_: &Gpu) {
    for response in [Response::Impulse, Response::None, Response::Contacts] {
        for readback in [Readback::Lockstep, Readback::Latent] {
            let mut sim = super::readback::app(Backend::Gpu, readback);
            sim.world().insert_resource(response);
            sim.world().insert_resource(FaceLists(false));
            let torus = sim.mesh(&shapes::torus_240());
            let [one, two] = [0.0, 0.4].map(|x| {
                let body = sim.spawn(ball_like(&torus, Vec3::X * x, Vec3::ZERO));
                sim.set(body, Sensor);
                body
            });
            let mut seen = Vec::new();
            for step in 0..12 {
                if step == 5 {
                    sim.world().insert_resource(FaceLists(true));
                }
                sim.step(1);
                if let Some(hit) = sim.collisions().get(one, two) {
                    let (listed, counted) = (hit.faces.map(<[FacePair]>::len), sim.report().face_pairs);
                    assert!(counted > 0);
                    assert_eq!(listed.unwrap_or(counted), counted);
                    let work = work(&sim);
                    assert_eq!(work.lists.face_pairs.length as usize, listed.unwrap_or(0));
                    seen.push((listed.is_some(), hit.contact, counted, work.read_back_bytes));
                }
            }
            let (without, with) = seen.split_at(seen.partition_point(|&(listed, ..)| !listed));
            assert!(
                without.len() >= 5 && with.len() >= 4,
                "{response:?} {readback:?}: {seen:?}"
            );
            assert!(with.iter().all(|&(listed, ..)| listed), "{seen:?}");
            let (last, first) = (without.last().unwrap(), with.last().unwrap());
            assert_eq!((last.1, last.2), (first.1, first.2), "the same is found");
            // Room for 4096 faces of 40 bytes at least.
            assert!(last.3 + 4096 * 40 <= first.3, "{response:?} {readback:?}: {seen:?}");
        }
    }
}

/// A write reaches the GPU, with those around it at most, and others stay as they are.
fn written(_: &Gpu) {
    for response in [Response::Impulse, Response::Contacts] {
        let [mut waits, mut latent] =
            [Readback::Lockstep, Readback::Latent].map(|readback| flock(readback, response).0);
        let mut uploaded = 0;
        for step in 0..16 {
            for sim in [&mut waits, &mut latent] {
                if step == 6 {
                    let world = sim.world();
                    let mut moving = world.query::<(&RigidBody, &mut LinearVelocity)>();
                    let (_, mut velocity) = moving
                        .iter_mut(world)
                        .find(|(kind, _)| **kind == RigidBody::Dynamic)
                        .unwrap();
                    velocity.0 += Vec3::Z;
                }
                sim.step(1);
            }
            uploaded += if step >= 8 { work(&latent).uploaded_bytes } else { 0 };
        }
        assert!((500..16_000).contains(&uploaded), "{uploaded}");
        // Both have published the same number of steps then.
        latent.step(bevy_faceoff::plugin::settings::LATENCY);
        let [one, other] = [&mut waits, &mut latent].map(|sim| {
            let world = sim.world();
            let mut query = world.query::<(Entity, &Transform, &LinearVelocity)>();
            let mut all: Vec<_> = query.iter(world).map(|(e, t, v)| (e, *t, *v)).collect();
            all.sort_unstable_by_key(|&(entity, ..)| entity);
            all
        });
        // With contacts the numbers of collision substeps may differ.
        for ((entity, pose, velocity), (same, other_pose, other_velocity)) in one.iter().zip(&other) {
            assert_eq!(entity, same);
            let apart = pose.translation.distance(other_pose.translation);
            assert!(apart < 1.0e-5, "{response:?}, {entity}: {apart}");
            assert_eq!(velocity, other_velocity, "{response:?}, {entity}");
        }
        assert!(one.iter().any(|(.., velocity)| velocity.0.z == 1.0));
    }
}
