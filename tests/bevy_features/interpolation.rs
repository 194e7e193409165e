//! Frames between steps.

use crate::app::{DT, STEP, Sim, ball_like, resting};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::plugin::interpolation::{
    NoTransformEasing, RotationInterpolation, TransformInterpolation, TranslationInterpolation,
};
use bevy_faceoff::prelude::*;
use std::time::Duration;

/// 240 frames a second, about four to a step.
const FRAME: Duration = Duration::from_nanos(4_166_667);

/// An app that draws 240 frames a second.
fn fast() -> Sim {
    let mut sim = Sim::new();
    sim.world().insert_resource(TimeUpdateStrategy::ManualDuration(FRAME));
    sim
}

fn pose(sim: &Sim, body: Entity) -> Transform {
    sim.get(body)
}

#[test]
fn a_straight_flight_is_drawn_evenly() {
    let mut sim = fast();
    let cube = sim.mesh(&shapes::cube(1.0));
    let flyer = sim.spawn((ball_like(&cube, Vec3::ZERO, Vec3::X), TransformInterpolation));
    sim.set(flyer, AngularVelocity(2.0 * Vec3::X));
    let plain = sim.spawn(ball_like(&cube, Vec3::Y * 9.0, Vec3::X));
    let (mut stood, mut steps) = (0, 0);
    let mut before = [flyer, plain].map(|body| pose(&sim, body));
    for frame in 0..480 {
        sim.step(1);
        let now = [flyer, plain].map(|body| pose(&sim, body));
        let [moved, plainly] = [0, 1].map(|i| now[i].translation.x - before[i].translation.x);
        // From the second step on there are two poses to draw between.
        if frame > 16 {
            let wanted = FRAME.as_secs_f32();
            assert!((moved / wanted - 1.0).abs() < 1e-2, "frame {frame}: {moved} m");
            let turned = before[0].rotation.angle_between(now[0].rotation);
            assert!(
                (turned / (2.0 * wanted) - 1.0).abs() < 5e-2,
                "frame {frame}: {turned} rad"
            );
            // One step late at most.
            let late = (now[1].translation.x - now[0].translation.x) / DT;
            assert!((-1e-3..1.001).contains(&late), "frame {frame}: {late} steps late");
        }
        stood += usize::from(plainly == 0.0);
        steps += usize::from(plainly > 0.0);
        before = now;
    }
    assert!(stood > 300 && steps > 100, "without it the body stands and jumps");
}

#[test]
fn what_is_placed_appears_there_at_once() {
    #[derive(Resource)]
    struct Target(Option<(Entity, bool)>);
    const THERE: Vec3 = Vec3::new(0.0, 50.0, 0.0);
    fn place(mut target: ResMut<Target>, mut commands: Commands) {
        if let Some((body, marked)) = target.0.take() {
            let mut body = commands.entity(body);
            body.insert(Transform::from_translation(THERE));
            if marked {
                body.insert(Teleport);
            }
        }
    }
    let schedules: [(&str, fn(&mut App)); _] = [
        ("Update", |app| _ = app.add_systems(Update, place)),
        ("FixedUpdate", |app| _ = app.add_systems(FixedUpdate, place)),
        ("FixedLast", |app| _ = app.add_systems(FixedLast, place)),
    ];
    for (name, add_system) in schedules {
        let mut sim = fast();
        sim.app.insert_resource(Target(None));
        add_system(&mut sim.app);
        let cube = sim.mesh(&shapes::cube(1.0));
        for kind in [RigidBody::Dynamic, RigidBody::Kinematic] {
            let body = sim.spawn((ball_like(&cube, Vec3::ZERO, Vec3::X), TransformInterpolation));
            sim.set(body, kind);
            sim.step(40);
            sim.world().resource_mut::<Target>().0 = Some((body, true));
            let mut arrived = false;
            for _ in 0..20 {
                sim.step(1);
                let height = pose(&sim, body).translation.y;
                // Halfway between equal heights is rounded.
                let is_there = (height - THERE.y).abs() < 1e-4;
                assert!(height == 0.0 || is_there, "placed in {name}: {height}");
                assert!(!arrived || is_there);
                arrived = is_there;
            }
            assert!(arrived);
            sim.world().despawn(body);
        }
    }
}

/// Cubes that fall on a floor and on each other.
fn pile(sim: &mut Sim, interpolated: bool) -> Vec<Entity> {
    sim.world().insert_resource(Gravity::default());
    sim.spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y));
    let cube = sim.mesh(&shapes::cube(1.0));
    (0..6)
        .map(|i| {
            let place = Vec3::new(0.3 * (i % 2) as f32, 1.0 + 1.5 * i as f32, 0.1 * i as f32);
            let body = sim.spawn(resting(&cube, place));
            if interpolated {
                sim.set(body, TransformInterpolation);
            }
            body
        })
        .collect()
}

#[test]
fn steps_are_the_same_to_the_bit() {
    let mut every_step = Sim::new();
    let mut drawn = fast();
    let plain = pile(&mut every_step, false);
    let smooth = pile(&mut drawn, true);
    every_step.step(200);
    while drawn.report().step < 200 {
        drawn.step(1);
    }
    // The next tick begins by showing the poses of the last step.
    drawn.app.world_mut().run_schedule(FixedFirst);
    assert_eq!(drawn.report().step, 200);
    for (plain, smooth) in plain.iter().zip(&smooth) {
        assert_eq!(pose(&every_step, *plain), pose(&drawn, *smooth));
        assert_eq!(every_step.velocity(*plain), drawn.velocity(*smooth));
    }
    assert!(every_step.started.len() > 5);
    assert_eq!(every_step.started, drawn.started);
    assert_eq!(every_step.ended, drawn.ended);
}

/// What is drawn between two steps is no placement, which would end touches at once.
#[test]
fn a_bouncing_ball_starts_and_ends_no_collision_more_often() {
    let ends = |interpolate: fn(&mut EntityWorldMut)| {
        let mut sim = fast();
        sim.world().insert_resource(Gravity::default());
        sim.spawn((PlaneCollider::through(Vec3::ZERO, Vec3::Y), Restitution::new(1.0)));
        let ball = sim.mesh(&shapes::ball(0.5, 3));
        sim.world().insert_resource(EventHysteresis(0.5));
        // It flies for a fifth of a second.
        let ball = sim.spawn(ball_like(&ball, Vec3::Y * 0.55, Vec3::ZERO));
        interpolate(&mut sim.world().entity_mut(ball));
        while sim.report().step < 150 {
            sim.step(1);
        }
        assert!(
            sim.position(ball).y > 0.51 || sim.velocity(ball).y.abs() > 0.5,
            "it bounces"
        );
        (sim.started.len(), sim.ended.len())
    };
    let interpolations: [fn(&mut EntityWorldMut); _] = [
        |_| {},
        |ball| _ = ball.insert(TransformInterpolation),
        |ball| _ = ball.insert(TranslationInterpolation),
        |ball| _ = ball.insert(RotationInterpolation),
    ];
    for interpolate in interpolations {
        assert_eq!(ends(interpolate), (1, 0));
    }
}

#[test]
fn all_bodies_are_interpolated_if_that_is_asked_for() {
    let mut app = App::new();
    let plugins = FaceoffHeadlessPlugins::default().set(InterpolationPlugin::interpolate_all());
    app.add_plugins((MinimalPlugins, plugins));
    let mut sim = Sim::of(app);
    sim.world()
        .insert_resource(TimeUpdateStrategy::ManualDuration(STEP / 2));
    let cube = sim.mesh(&shapes::cube(1.0));
    let body = sim.spawn(ball_like(&cube, Vec3::ZERO, Vec3::X));
    let without = sim.spawn((ball_like(&cube, Vec3::Y * 9.0, Vec3::X), NoTransformEasing));
    sim.step(11);
    let [body, without] = [body, without].map(|body| sim.position(body).x / DT);
    assert!((without - without.round()).abs() < 1e-3, "{without}");
    assert!((body - body.round()).abs() > 0.4, "{body}");
}
