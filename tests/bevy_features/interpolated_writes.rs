//! Interpolated bodies whose `Transform` others write.

use crate::app::{DT, STEP, Sim, assert_near, ball_like, resting};
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::plugin::interpolation::TransformInterpolation;
use bevy_faceoff::prelude::*;
use bevy_transform_interpolation::TransformEasingSystems;
use std::time::Duration;

/// An app that draws 240 frames a second, about four to a step.
fn fast() -> Sim {
    let mut sim = Sim::new();
    let frame = Duration::from_nanos(4_166_667);
    sim.world().insert_resource(TimeUpdateStrategy::ManualDuration(frame));
    sim
}

/// An interpolated cube that flies at 1 m/s.
fn flyer(sim: &mut Sim) -> Entity {
    let cube = sim.mesh(&shapes::cube(1.0));
    sim.spawn((ball_like(&cube, Vec3::ZERO, Vec3::X), TransformInterpolation))
}

/// Runs frames until this many more steps have run.
fn run_steps(sim: &mut Sim, steps: u64) {
    let last = sim.report().step + steps;
    while sim.report().step < last {
        sim.step(1);
    }
}

#[test]
fn a_body_that_is_turned_in_every_frame_flies_on() {
    #[derive(Resource)]
    struct Turn(fn(&mut Transform));
    fn look(turn: Res<Turn>, mut bodies: Query<&mut Transform, With<RigidBody>>) {
        for mut transform in &mut bodies {
            turn.0(&mut transform);
        }
    }
    fn turn_more(transform: &mut Transform) {
        transform.rotate_y(0.01);
    }
    fn turn_to_the_same(transform: &mut Transform) {
        let Transform { rotation, .. } = *transform;
        transform.rotation = rotation;
    }
    let flight = |schedule: &dyn Fn(&mut App), turn: fn(&mut Transform)| {
        let mut sim = fast();
        let frame = Duration::from_secs_f64(1.0 / 60.0);
        sim.world().insert_resource(TimeUpdateStrategy::ManualDuration(frame));
        sim.world().insert_resource(Turn(turn));
        schedule(&mut sim.app);
        let body = flyer(&mut sim);
        sim.step(60);
        sim.app.world_mut().run_schedule(FixedFirst);
        let (steps, way) = (sim.report().step as f32, sim.position(body).x);
        assert!((way / (steps * DT) - 1.0).abs() < 1e-3, "{way} m in {steps} steps");
        let (axis, angle) = sim.get::<Transform>(body).rotation.to_axis_angle();
        axis.y * angle
    };
    let in_update = |app: &mut App| {
        app.add_systems(Update, look);
    };
    let before_steps = |app: &mut App| {
        let before = RunFixedMainLoopSystems::BeforeFixedMainLoop;
        app.add_systems(RunFixedMainLoop, look.in_set(before));
    };
    let turns = [(turn_to_the_same as fn(&mut Transform), 0.0), (turn_more, 0.6)];
    for (turn, wanted) in turns {
        for angle in [flight(&in_update, turn), flight(&before_steps, turn)] {
            assert!((angle - wanted).abs() < 1e-3, "it is turned by {angle}");
        }
    }
}

const THERE: Vec3 = Vec3::new(0.0, 50.0, 0.0);
const ELSEWHERE: Vec3 = Vec3::new(0.0, 0.0, 70.0);

/// Adds a system that calls `act` once.
fn once(sim: &mut Sim, schedule: impl ScheduleLabel, act: impl FnMut(&mut World) + Send + Sync + 'static) {
    let mut act = Some(act);
    sim.app.add_systems(schedule, move |world: &mut World| {
        if let Some(mut act) = act.take() {
            act(world);
        }
    });
}

#[test]
fn a_body_is_placed_right_after_a_teleport_or_its_spawn() {
    for is_teleported in [true, false] {
        let mut sim = fast();
        let cube = sim.mesh(&shapes::cube(1.0));
        #[derive(Component)]
        struct Placed;
        if is_teleported {
            sim.spawn((resting(&cube, Vec3::ZERO), TransformInterpolation, Placed));
            run_steps(&mut sim, 3);
        }
        once(&mut sim, FixedUpdate, move |world| {
            let bodies: Vec<_> = world.query_filtered::<Entity, With<Placed>>().iter(world).collect();
            for &body in &bodies {
                (world.entity_mut(body)).insert((Transform::from_translation(THERE), Teleport));
            }
            if bodies.is_empty() {
                world.spawn((resting(&cube, THERE), TransformInterpolation, Placed));
            }
        });
        run_steps(&mut sim, 1);
        let world = sim.app.world_mut();
        let mut placed = world.query_filtered::<&mut Transform, With<Placed>>();
        let mut transform = placed.single_mut(world).unwrap();
        assert_eq!(transform.translation, THERE);
        transform.translation = ELSEWHERE;
        for _ in 0..12 {
            sim.step(1);
            let world = sim.app.world_mut();
            let found = placed.single(world).unwrap().translation;
            assert_eq!(found, ELSEWHERE, "teleported before: {is_teleported}");
        }
    }
}

#[test]
fn what_is_written_after_the_step_counts() {
    fn pin(mut bodies: Query<&mut Transform, With<RigidBody>>) {
        for mut transform in &mut bodies {
            transform.translation = THERE;
        }
    }
    let mut sim = fast();
    let pin = pin.after(TransformEasingSystems::UpdateEnd);
    sim.app.add_systems(FixedLast, pin);
    let body = flyer(&mut sim);
    // It comes there smoothly.
    run_steps(&mut sim, 2);
    for _ in 0..30 {
        sim.step(1);
        assert_near(sim.position(body), THERE, 1e-4);
    }
    // Two steps a frame.
    (sim.world()).insert_resource(TimeUpdateStrategy::ManualDuration(2 * STEP));
    for _ in 0..5 {
        sim.step(1);
        assert_near(sim.position(body), THERE, 1e-4);
    }
}

#[test]
fn the_step_before_the_last_can_be_restored() {
    #[derive(Resource, Default)]
    struct Steps(Vec<(Snapshot, Vec<Vec3>)>);
    fn keep(world: &mut World) {
        let snapshot = Snapshot::take(world);
        let mut bodies = world.query_filtered::<&Transform, With<TransformInterpolation>>();
        let places = bodies.iter(world).map(|transform| transform.translation).collect();
        world.resource_mut::<Steps>().0.push((snapshot, places));
    }
    for frame in [STEP, STEP / 4] {
        let mut sim = Sim::new();
        sim.world().insert_resource(TimeUpdateStrategy::ManualDuration(frame));
        sim.world().init_resource::<Steps>();
        sim.app.add_systems(FixedLast, keep);
        flyer(&mut sim);
        let walker = sim.spawn((Character::new(0.3, 0.5), Transform::from_translation(THERE)));
        sim.set(walker, TransformInterpolation);
        sim.app.add_systems(FixedUpdate, |mut walkers: Query<&mut Character>| {
            for mut walker in &mut walkers {
                walker.velocity = Vec3::X;
            }
        });
        run_steps(&mut sim, 10);
        let [.., (before, _), (_, last)] = &sim.world().resource::<Steps>().0[..] else {
            panic!("there were steps")
        };
        let (before, last) = (before.clone(), last.clone());
        before.restore(sim.world());
        run_steps(&mut sim, 1);
        let (_, again) = sim.world().resource::<Steps>().0.last().unwrap();
        assert_eq!(*again, last);
    }
}

#[test]
fn a_body_that_changes_its_parent_flies_on() {
    const APART: Vec3 = Vec3::new(100.0, 0.0, 0.0);
    let mut sim = fast();
    let parent = sim.spawn(Transform::from_translation(APART));
    let body = flyer(&mut sim);
    run_steps(&mut sim, 3);
    let drawn = |sim: &Sim| {
        let above = sim.app.world().get::<ChildOf>(body).map_or(Vec3::ZERO, |_| APART);
        (sim.position(body) + above).x
    };
    let watch = |sim: &mut Sim| {
        for _ in 0..12 {
            sim.step(1);
            let x = drawn(sim);
            assert!((0.0..1.0).contains(&x), "it flashes at {x}");
        }
    };
    once(&mut sim, FixedUpdate, move |world| {
        let mut body = world.entity_mut(body);
        body.get_mut::<Transform>().unwrap().translation -= APART;
        body.insert(ChildOf(parent));
    });
    watch(&mut sim);
    once(&mut sim, FixedUpdate, move |world| {
        let mut body = world.entity_mut(body);
        body.get_mut::<Transform>().unwrap().translation += APART;
        body.remove::<ChildOf>();
    });
    watch(&mut sim);
}
