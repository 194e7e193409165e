//! Steps per update, several apps, and repeatability.

use crate::app::{STEP, Sim, ball_like};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;
use std::time::Duration;

fn clock(sim: &mut Sim, update: Duration) {
    sim.world().insert_resource(TimeUpdateStrategy::ManualDuration(update));
}

/// Tori in a box, so crowded that every step has collisions.
fn crowd(sim: &mut Sim) -> Vec<Entity> {
    let torus = sim.mesh(&shapes::torus_240());
    for normal in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z] {
        sim.spawn((PlaneCollider::through(normal * -2.0, normal), Restitution::new(1.0)));
    }
    let mut random = fastrand::Rng::with_seed(7);
    let mut between = move |low: f32, high: f32| low + (high - low) * random.f32();
    (0..60)
        .map(|_| {
            let [position, velocity, turn] = [2.0, 1.5, 3.0].map(|r| Vec3::from_array([0; 3].map(|_| between(-r, r))));
            let body = sim.spawn(ball_like(&torus, position, velocity));
            sim.world().get_mut::<Transform>(body).unwrap().rotation = Quat::from_scaled_axis(turn);
            body
        })
        .collect()
}

/// All that a step writes, as bits.
fn bits(sim: &Sim, bodies: &[Entity]) -> Vec<u32> {
    let mut words = Vec::new();
    for &body in bodies {
        let pose = sim.get::<Transform>(body);
        words.extend(pose.translation.to_array());
        words.extend(pose.rotation.to_array());
        words.extend(sim.velocity(body).to_array());
        words.extend(sim.spin(body).to_array());
    }
    for c in sim.collisions().iter() {
        words.extend(c.contact.point.to_array());
        words.extend(c.contact.normal.to_array());
        for f in c.faces {
            words.extend([f32::from_bits(f.a), f32::from_bits(f.b)]);
            words.extend(f.start.to_array());
            words.extend(f.end.to_array());
        }
    }
    words.into_iter().map(f32::to_bits).collect()
}

fn run(threads: usize, steps: usize) -> (Vec<u32>, Vec<CollisionStart>) {
    let mut sim = Sim::with_threads(threads);
    let bodies = crowd(&mut sim);
    sim.step(steps);
    assert!(sim.started.len() > 50, "only {} collisions", sim.started.len());
    assert!(!sim.collisions().is_empty());
    (bits(&sim, &bodies), sim.started)
}

#[test]
fn two_runs_give_the_same_bits() {
    assert_eq!(run(2, 120), run(2, 120));
}

#[test]
fn one_thread_and_two_give_the_same_bits() {
    assert_eq!(run(1, 120), run(2, 120));
}

#[test]
fn four_steps_in_one_update_equal_four_updates_of_one() {
    let mut one = Sim::new();
    let mut four = Sim::new();
    let (bodies, others) = (crowd(&mut one), crowd(&mut four));
    clock(&mut four, STEP * 4);
    one.step(40);
    four.step(10);
    assert_eq!(four.report().step, 40);
    assert_eq!(bits(&one, &bodies), bits(&four, &others));
    assert_eq!(one.started, four.started);
    assert_eq!(one.ended, four.ended);
}

#[test]
fn an_update_shorter_than_a_step_runs_none_and_keeps_all_results() {
    let mut sim = Sim::new();
    let bodies = crowd(&mut sim);
    sim.step(1);
    let before = bits(&sim, &bodies);
    let (started, report) = (sim.started.len(), sim.report().step);
    clock(&mut sim, Duration::ZERO);
    sim.step(3);
    clock(&mut sim, STEP / 4);
    sim.step(3);
    assert_eq!(sim.report().step, report);
    assert_eq!(bits(&sim, &bodies), before);
    assert_eq!(sim.started.len(), started);
    sim.step(1);
    assert_eq!(sim.report().step, report + 1, "four quarters make a step");
    assert_ne!(bits(&sim, &bodies), before);
}

#[test]
fn a_paused_clock_holds_all_bodies_until_it_goes_on() {
    let mut sim = Sim::new();
    let bodies = crowd(&mut sim);
    sim.step(2);
    let before = bits(&sim, &bodies);
    sim.world().resource_mut::<Time<Virtual>>().pause();
    sim.step(5);
    assert_eq!(bits(&sim, &bodies), before);
    sim.world().resource_mut::<Time<Virtual>>().unpause();
    sim.step(1);
    assert_ne!(bits(&sim, &bodies), before);
}

#[test]
fn an_app_without_bodies_or_meshes_steps_and_reports_nothing() {
    let mut sim = Sim::new();
    sim.step(3);
    let report = sim.report();
    assert_eq!((report.step, report.bodies, report.sphere_pairs), (3, 0, 0));
    assert!(sim.collisions().is_empty());
    sim.spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y));
    sim.step(1);
    assert_eq!(sim.report().step, 4);
    assert!(sim.collisions().is_empty() && sim.started.is_empty() && sim.rejected.is_empty());
}

#[test]
fn two_apps_in_one_process_do_not_disturb_each_other() {
    let (alone, _) = run(1, 60);
    let mut one = Sim::new();
    let mut other = Sim::with_threads(2);
    let (bodies, others) = (crowd(&mut one), crowd(&mut other));
    other.world().insert_resource(Gravity::default());
    for _ in 0..60 {
        one.step(1);
        other.step(1);
    }
    assert_eq!(bits(&one, &bodies), alone);
    assert_ne!(bits(&other, &others), alone);
    drop(other);
    one.step(1);
    assert_eq!(one.report().step, 61);
}

#[test]
fn the_pool_has_as_many_threads_as_asked_for() {
    for threads in [1, 2, 3] {
        assert_eq!(
            bevy_faceoff::plugin::threads(Sim::with_threads(threads).app.world()),
            threads
        );
    }
    assert_eq!(bevy_faceoff::plugin::threads(App::new().world()), 0);
    assert!(bevy_faceoff::plugin::threads(Sim::with_threads(0).app.world()) > 0);
}
