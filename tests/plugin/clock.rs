//! Steps per update, several apps, and repeatability.

use crate::app::{DT, STEP, Sim, ball_like};
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
        for f in c.faces.unwrap() {
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

/// A body that flies along x at 64 m/s, a metre a step.
fn flyer() -> (Sim, Entity) {
    let mut sim = Sim::new();
    let torus = sim.mesh(&shapes::torus_240());
    let body = sim.spawn(ball_like(&torus, Vec3::ZERO, Vec3::X * 64.0));
    (sim, body)
}

fn physics(sim: &mut Sim) -> Mut<'_, Time<Physics>> {
    sim.world().resource_mut()
}

#[test]
fn a_step_by_hand_is_as_long_as_the_fixed_timestep_whatever_clock_is_paused() {
    let (mut sim, body) = flyer();
    sim.step(1);
    let pauses: [fn(&mut Sim); 3] = [
        |_| {},
        |sim| physics(sim).pause(),
        |sim| sim.world().resource_mut::<Time<Virtual>>().pause(),
    ];
    for (i, pause) in pauses.into_iter().enumerate() {
        pause(&mut sim);
        let (x, steps) = (sim.position(body).x, sim.report().step);
        for k in 1..=3 {
            sim.world().run_schedule(FaceoffStep);
            assert_eq!(sim.position(body).x, x + k as f32, "pause {i}");
            assert_eq!(sim.report().step, steps + k);
        }
    }
    sim.step(3);
    assert_eq!(sim.position(body).x, 10.0, "paused");
    // What is left of the steps by hand is no wish for another one.
    sim.world().resource_mut::<Time<Virtual>>().unpause();
    sim.step(3);
    assert_eq!(sim.position(body).x, 10.0, "still paused");
    physics(&mut sim).unpause();
    sim.step(1);
    assert_eq!(sim.position(body).x, 11.0);
    assert_eq!(physics(&mut sim).elapsed(), STEP * 11);
}

#[test]
fn steps_by_hand_are_those_of_the_clock_to_the_bit() {
    let (mut by_clock, mut by_hand) = (Sim::new(), Sim::new());
    let (bodies, others) = (crowd(&mut by_clock), crowd(&mut by_hand));
    by_hand.world().resource_mut::<Time<Virtual>>().pause();
    by_clock.step(40);
    for _ in 0..40 {
        by_hand.world().run_schedule(FaceoffStep);
    }
    assert_eq!(bits(&by_clock, &bodies), bits(&by_hand, &others));
}

#[test]
fn physics_pauses_alone_and_steps_when_asked() {
    #[derive(Resource, Default)]
    struct Ticks(u32);
    let (mut sim, body) = flyer();
    sim.app
        .init_resource::<Ticks>()
        .add_systems(FixedUpdate, |mut ticks: ResMut<Ticks>| ticks.0 += 1);
    physics(&mut sim).step_once();
    sim.step(1);
    assert_eq!(sim.position(body).x, 1.0, "a clock that runs needs no wishes");
    physics(&mut sim).pause();
    assert!(physics(&mut sim).is_paused());
    sim.step(4);
    assert_eq!((sim.position(body).x, sim.report().step), (1.0, 1));
    assert_eq!(sim.app.world().resource::<Ticks>().0, 5, "the game goes on");
    assert_eq!(physics(&mut sim).delta(), Duration::ZERO);
    // One step, then two in one tick, then one of another length as with any clock.
    for (ask, x) in [(1, 2.0), (2, 4.0)] {
        (0..ask).for_each(|_| physics(&mut sim).step_once());
        sim.step(3);
        assert_eq!(sim.position(body).x, x);
    }
    physics(&mut sim).advance_by(STEP / 2);
    sim.step(3);
    assert_eq!(sim.position(body).x, 4.5);
    assert_eq!(physics(&mut sim).elapsed(), STEP * 9 / 2);
    physics(&mut sim).step_once();
    physics(&mut sim).unpause();
    sim.step(2);
    assert_eq!(sim.position(body).x, 6.5, "the wish is dropped");
    assert_eq!(physics(&mut sim).delta(), STEP);
}

#[test]
fn physics_runs_slower_and_faster_than_the_game() {
    #[derive(Resource, Default)]
    struct Seen(Vec<(Duration, Duration)>);
    for (speed, steps, moved) in [
        (0.25, 1, 0.25),
        (0.0, 0, 0.0),
        (1.0, 1, 1.0),
        (2.0, 2, 2.0),
        (2.5, 3, 2.5),
    ] {
        let (mut sim, body) = flyer();
        let look = |time: Res<Time>, fixed: Res<Time<Fixed>>, mut seen: ResMut<Seen>| {
            seen.0.push((time.delta(), fixed.delta()));
        };
        let between = look.after(FaceoffSystems::Integrate).before(FaceoffSystems::Publish);
        sim.app
            .init_resource::<Seen>()
            .add_systems(FaceoffStep, (between, look.in_set(FaceoffSystems::Respond)))
            .add_systems(
                FixedPostUpdate,
                (|time: Res<Time>| assert_eq!(time.delta(), STEP)).after(FaceoffStep),
            );
        physics(&mut sim).set_relative_speed(speed);
        sim.step(8);
        assert_eq!(sim.report().step, 8 * steps, "at {speed}");
        assert!(
            (sim.position(body).x - 8.0 * moved).abs() < 1e-4,
            "at {speed}: {}",
            sim.position(body)
        );
        let elapsed = physics(&mut sim).elapsed_secs_f64();
        assert!((elapsed - 8.0 * f64::from(moved) / 64.0).abs() < 1e-6);
        let seen = std::mem::take(&mut sim.world().resource_mut::<Seen>().0);
        assert_eq!(seen.len() as u64, 2 * 8 * steps);
        for (step, fixed) in seen {
            assert_eq!(fixed, STEP, "the game's clock is left alone");
            assert!(step <= STEP, "no step is longer than the timestep: {step:?}");
            assert!((step.as_secs_f32() * steps as f32 - moved * DT).abs() < 1e-7);
        }
        for bad in [-1.0, f32::NAN, f32::INFINITY] {
            physics(&mut sim).set_relative_speed(bad);
            assert_eq!(physics(&mut sim).relative_speed(), speed);
        }
    }
}

#[test]
fn twice_the_speed_gives_the_same_bits_in_half_the_ticks() {
    let (mut one, mut two) = (Sim::new(), Sim::new());
    let (bodies, others) = (crowd(&mut one), crowd(&mut two));
    physics(&mut two).set_relative_speed(2.0);
    one.step(40);
    two.step(20);
    assert_eq!(bits(&one, &bodies), bits(&two, &others));
}

#[test]
fn a_run_condition_of_the_set_holds_the_steps() {
    #[derive(Resource)]
    struct Playing(bool);
    let (mut sim, body) = flyer();
    sim.app
        .insert_resource(Playing(false))
        .configure_sets(FixedPostUpdate, FaceoffStep.run_if(|playing: Res<Playing>| playing.0));
    sim.step(3);
    assert_eq!((sim.position(body).x, sim.report().step), (0.0, 0));
    sim.world().resource_mut::<Playing>().0 = true;
    sim.step(3);
    assert_eq!(sim.position(body).x, 3.0);
}

#[test]
fn a_speed_without_end_is_refused_and_one_too_small_makes_no_step() {
    let (mut sim, body) = flyer();
    for speed in [f32::MAX, 101.0, -1.0, f32::NAN, f32::INFINITY] {
        physics(&mut sim).set_relative_speed(speed);
        assert_eq!(physics(&mut sim).relative_speed(), 1.0);
    }
    physics(&mut sim).set_relative_speed(1.0e-30);
    sim.step(3);
    assert_eq!((sim.position(body).x, sim.report().step), (0.0, 0));
}

/// A saved scene may hold any number.
#[test]
fn a_speed_that_was_set_by_reflection_is_checked() {
    for speed in [f64::NAN, -1.0, f64::INFINITY] {
        let mut sim = Sim::new();
        let mut time = sim.world().resource_mut::<Time<Physics>>();
        *time.path_mut::<f64>("context.speed").unwrap() = speed;
        sim.step(2);
        let time = sim.world().resource::<Time<Physics>>();
        assert_eq!((time.relative_speed(), time.elapsed()), (1.0, 2 * STEP), "{speed}");
    }
}
