//! What is told about collisions: messages, events, lists and the resource.

use crate::app::{Sim, ball_like, end_of, place, resting, sorted, start_of};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;
use bevy_faceoff::types::stage::Stage;
use std::time::Duration;

/// Events that observers saw: whether it began, the observed entity, the other one.
#[derive(Resource, Default)]
struct Seen(Vec<(bool, Entity, Entity)>);

fn watch(sim: &mut Sim) {
    sim.world().init_resource::<Seen>();
    sim.app
        .add_observer(|event: On<CollisionStart>, mut seen: ResMut<Seen>| {
            seen.0.push((true, event.collider1, event.collider2));
        });
    sim.app.add_observer(|event: On<CollisionEnd>, mut seen: ResMut<Seen>| {
        seen.0.push((false, event.collider1, event.collider2));
    });
}

fn seen(sim: &mut Sim) -> Vec<(bool, Entity, Entity)> {
    std::mem::take(&mut sim.world().resource_mut::<Seen>().0)
}

/// A resting cube at the origin and another that flies through it.
fn passing(sim: &mut Sim) -> [Entity; 2] {
    sim.world().insert_resource(Response::None);
    let cube = sim.mesh(&shapes::cube(1.0));
    [
        sim.spawn(resting(&cube, Vec3::ZERO)),
        sim.spawn(ball_like(&cube, Vec3::new(-2.0, 0.2, 0.1), Vec3::X * 4.0)),
    ]
}

#[test]
fn a_touch_is_told_once_when_it_begins_and_once_when_it_ends() {
    let mut sim = Sim::new();
    let [one, other] = passing(&mut sim);
    let pair = sorted(one, other);
    sim.step(8);
    assert!(sim.started.is_empty() && sim.ended.is_empty());
    sim.step(16);
    assert_eq!(sim.started, [start_of(pair)]);
    assert!(sim.ended.is_empty());
    sim.step(60);
    assert_eq!(sim.started.len(), 1);
    assert_eq!(sim.ended, [end_of(pair)]);
}

#[test]
fn messages_name_what_was_spawned_first_whoever_was_spawned_with_what() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    // Different archetypes, so that the order of queries is not the order of entities.
    let one = sim.spawn((resting(&cube, Vec3::ZERO), Sensor));
    let two = sim.spawn(resting(&cube, Vec3::splat(0.1)));
    let three = sim.spawn((resting(&cube, Vec3::splat(0.2)), Sensor, Mass(1.0)));
    sim.step(1);
    let pairs: Vec<_> = sim.started.iter().map(|s| [s.collider1, s.collider2]).collect();
    let mut wanted = vec![sorted(one, two), sorted(one, three), sorted(two, three)];
    wanted.sort_by_key(|pair| pair.map(|entity| place(&entity)));
    assert_eq!(pairs, wanted);
    assert_eq!(sim.touching(), wanted);
}

#[test]
fn observers_hear_of_entities_that_ask_for_it_and_of_no_others() {
    let mut sim = Sim::new();
    watch(&mut sim);
    let [still, flying] = passing(&mut sim);
    sim.set(flying, CollisionEventsEnabled);
    sim.step(80);
    assert_eq!(seen(&mut sim), [(true, flying, still), (false, flying, still)]);
    assert_eq!((sim.started.len(), sim.ended.len()), (1, 1));
}

#[test]
fn observers_hear_of_both_entities_if_both_ask() {
    let mut sim = Sim::new();
    watch(&mut sim);
    let [still, flying] = passing(&mut sim);
    sim.set(flying, CollisionEventsEnabled);
    sim.set(still, CollisionEventsEnabled);
    sim.step(80);
    let seen = seen(&mut sim);
    assert_eq!(seen.len(), 4);
    for event in [
        (true, still, flying),
        (true, flying, still),
        (false, still, flying),
        (false, flying, still),
    ] {
        assert!(seen.contains(&event), "{seen:?}");
    }
}

#[test]
fn an_observer_of_one_entity_hears_its_collisions_with_itself_first() {
    let mut sim = Sim::new();
    let [still, flying] = passing(&mut sim);
    sim.world().init_resource::<Seen>();
    sim.set(still, CollisionEventsEnabled);
    sim.set(flying, CollisionEventsEnabled);
    sim.world()
        .entity_mut(flying)
        .observe(|event: On<CollisionStart>, mut seen: ResMut<Seen>| {
            seen.0.push((true, event.collider1, event.collider2));
        });
    sim.step(80);
    assert_eq!(seen(&mut sim), [(true, flying, still)]);
}

#[test]
fn nobody_hears_events_without_asking_and_messages_come_all_the_same() {
    let mut sim = Sim::new();
    watch(&mut sim);
    passing(&mut sim);
    sim.step(80);
    assert_eq!(seen(&mut sim), []);
    assert_eq!((sim.started.len(), sim.ended.len()), (1, 1));
}

#[test]
fn planes_are_told_like_bodies() {
    let mut sim = Sim::new();
    watch(&mut sim);
    let cube = sim.mesh(&shapes::cube(1.0));
    let plane = sim.spawn((
        PlaneCollider::through(Vec3::NEG_Y, Vec3::Y),
        Restitution::new(1.0),
        CollidingEntities::default(),
        CollisionEventsEnabled,
    ));
    let body = sim.spawn((ball_like(&cube, Vec3::ZERO, Vec3::NEG_Y), CollidingEntities::default()));
    let mut listed = false;
    for _ in 0..100 {
        sim.step(1);
        let lists = [plane, body].map(|e| sim.get::<CollidingEntities>(e).to_vec());
        assert_eq!(lists[0].is_empty(), lists[1].is_empty());
        if !lists[0].is_empty() {
            assert_eq!(lists, [vec![body], vec![plane]]);
            listed = true;
        }
    }
    assert!(listed);
    let pair = sorted(plane, body);
    assert_eq!(sim.started, [start_of(pair)]);
    assert_eq!(sim.ended, [end_of(pair)]);
    assert_eq!(seen(&mut sim), [(true, plane, body), (false, plane, body)]);
    assert!(sim.collisions().is_empty(), "`Collisions` holds pairs of bodies");
}

#[test]
fn despawning_one_of_two_that_touch_ends_the_touch_for_the_other() {
    for first in [true, false] {
        let mut sim = Sim::new();
        watch(&mut sim);
        let [one, other] = passing(&mut sim);
        sim.set(one, (CollisionEventsEnabled, CollidingEntities::default()));
        sim.set(other, (CollisionEventsEnabled, CollidingEntities::default()));
        sim.step(32);
        assert!(sim.touch(one, other));
        seen(&mut sim);
        let (gone, left) = if first { (one, other) } else { (other, one) };
        sim.world().despawn(gone);
        sim.step(1);
        let pair = sorted(one, other);
        assert_eq!(sim.ended, [end_of(pair)]);
        assert_eq!(seen(&mut sim), [(false, left, gone)]);
        assert!(sim.get::<CollidingEntities>(left).is_empty());
        sim.step(5);
        assert_eq!(sim.ended.len(), 1);
    }
}

#[test]
fn an_observer_may_despawn_both_bodies_of_a_collision() {
    let mut sim = Sim::new();
    watch(&mut sim);
    let [one, other] = passing(&mut sim);
    sim.app
        .add_observer(|event: On<CollisionStart>, mut commands: Commands| {
            for entity in [event.collider1, event.collider2] {
                commands.entity(entity).try_despawn();
            }
        });
    sim.set(one, CollisionEventsEnabled);
    sim.set(other, CollisionEventsEnabled);
    sim.step(80);
    let world = sim.app.world();
    assert!(world.get_entity(one).is_err() && world.get_entity(other).is_err());
    assert_eq!((sim.started.len(), sim.ended.len()), (1, 1));
    assert_eq!(sim.report().bodies, 0);
    assert!(sim.collisions().is_empty());
}

#[test]
fn a_reused_entity_index_is_not_mistaken_for_the_old_body() {
    let mut sim = Sim::new();
    let [one, other] = passing(&mut sim);
    sim.step(32);
    let mesh: MeshCollider = sim.get(one);
    sim.world().despawn(one);
    let new = sim.spawn(resting(&mesh, Vec3::ZERO));
    sim.step(1);
    assert_ne!(new, one);
    assert!(sim.touch(new, other));
    assert_eq!((sim.started.len(), sim.ended.len()), (2, 1));
    assert!([sim.ended[0].collider1, sim.ended[0].collider2].contains(&one));
    assert!([sim.started[1].collider1, sim.started[1].collider2].contains(&new));
}

#[test]
fn colliding_entities_lists_whoever_is_touched_in_ascending_order() {
    let mut sim = Sim::new().exact();
    sim.world().insert_resource(Response::None);
    let cube = sim.mesh(&shapes::cube(1.0));
    let mut others = vec![sim.spawn(resting(&cube, Vec3::X * 0.5))];
    let middle = sim.spawn((
        cube.clone(),
        Transform::from_translation(Vec3::splat(0.1)),
        CollidingEntities::default(),
    ));
    others.push(sim.spawn(resting(&cube, Vec3::Y * 0.5)));
    others.push(sim.spawn(resting(&cube, Vec3::Z * -0.5)));
    let apart = sim.spawn((resting(&cube, Vec3::X * 5.0), CollidingEntities::default()));
    sim.step(1);
    others.sort_by_key(place);
    assert_eq!(*sim.get::<CollidingEntities>(middle), others);
    assert!(sim.get::<CollidingEntities>(apart).is_empty());
    let leaving = others.remove(1);
    sim.set(leaving, Transform::from_xyz(0.0, 50.0, 0.0));
    sim.set(apart, Transform::from_xyz(0.0, 50.5, 0.0));
    sim.step(1);
    assert_eq!(*sim.get::<CollidingEntities>(middle), others);
    assert_eq!(*sim.get::<CollidingEntities>(apart), [leaving]);
    // The list of an entity that gets the component later is there after the next step.
    sim.set(leaving, CollidingEntities::default());
    sim.step(1);
    assert_eq!(*sim.get::<CollidingEntities>(leaving), [apart]);
}

#[test]
fn collisions_are_found_by_either_order_and_by_entity() {
    let mut sim = Sim::new();
    sim.world().insert_resource(Response::None);
    let cube = sim.mesh(&shapes::cube(1.0));
    let one = sim.spawn(resting(&cube, Vec3::ZERO));
    let two = sim.spawn(resting(&cube, Vec3::new(0.9, 0.1, 0.2)));
    let three = sim.spawn(resting(&cube, Vec3::new(-0.9, 0.2, 0.1)));
    let far = sim.spawn(resting(&cube, Vec3::splat(40.0)));
    sim.step(1);
    let collisions = sim.collisions();
    assert_eq!(collisions.len(), 2);
    let (there, back) = (collisions.get(one, two).unwrap(), collisions.get(two, one).unwrap());
    assert_eq!((there.collider1, there.collider2), (back.collider1, back.collider2));
    assert_eq!(there.contact, back.contact);
    let towards = sim.position(there.collider2) - sim.position(there.collider1);
    assert!(there.contact.normal.x * towards.x > 0.8, "from the first to the second");
    let listed = there.faces.unwrap();
    assert!(!there.contained && !listed.is_empty());
    assert!(listed.iter().all(|f| f.a < 12 && f.b < 12));
    assert!(collisions.get(two, three).is_none() && collisions.get(one, far).is_none());
    assert!(collisions.get(one, one).is_none());
    assert!(collisions.get(Entity::PLACEHOLDER, one).is_none());
    assert_eq!(collisions.of(one).count(), 2);
    assert_eq!(collisions.of(two).count(), 1);
    assert_eq!(collisions.of(far).count(), 0);
    let faces: usize = collisions.iter().map(|c| c.faces.unwrap().len()).sum();
    let report = sim.report();
    assert_eq!((report.touching_pairs, report.face_pairs), (2, faces));
    assert!(report.sphere_pairs >= 2 && report.triangle_tests as usize >= faces);
    assert_eq!(report.bodies, 4);
}

#[test]
fn faces_are_listed_from_the_step_that_is_asked_for_them() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    let one = sim.spawn((resting(&cube, Vec3::ZERO), Sensor));
    let two = sim.spawn((resting(&cube, Vec3::splat(0.3)), Sensor));
    sim.spawn(PlaneCollider::through(Vec3::Y * -0.4, Vec3::Y));
    for asked in [false, true, false] {
        sim.world().insert_resource(FaceLists(asked));
        sim.step(1);
        let counted = sim.report().face_pairs;
        assert!(counted > 0);
        let listed = sim.collisions().get(one, two).unwrap().faces.map(<[FacePair]>::len);
        assert_eq!(listed, asked.then_some(counted));
        assert!(sim.collisions().len() > 1, "one of them is in the half-space too");
        assert!(sim.collisions().iter().all(|hit| hit.faces.is_some() == asked));
    }
    assert_eq!(FaceLists::default(), FaceLists(false));
}

#[test]
fn a_body_inside_a_closed_one_is_contained() {
    let mut sim = Sim::new();
    let (large, small) = (sim.mesh(&shapes::cube(2.0)), sim.mesh(&shapes::torus_240()));
    let outer = sim.spawn((resting(&large, Vec3::ZERO), Sensor));
    let inner = sim.spawn((resting(&small, Vec3::splat(0.1)), Sensor));
    sim.step(1);
    let collision = sim.collisions().get(outer, inner).unwrap();
    assert!(collision.contained && collision.faces.unwrap().is_empty());
    sim.set(inner, Transform::from_xyz(3.0, 0.0, 0.0));
    sim.step(1);
    assert!(!sim.touch(outer, inner));
    sim.set(inner, Transform::from_xyz(1.0, 0.0, 0.0));
    sim.step(1);
    let collision = sim.collisions().get(outer, inner).unwrap();
    assert!(!collision.contained && !collision.faces.unwrap().is_empty());
}

#[test]
fn systems_in_the_step_see_its_results_at_once() {
    #[derive(Resource, Default)]
    struct Counts(Vec<usize>);
    let mut sim = Sim::new();
    passing(&mut sim);
    sim.world().init_resource::<Counts>();
    sim.app.add_systems(
        FaceoffStep,
        (|mut read: MessageReader<CollisionStart>, collisions: Res<Collisions>, mut counts: ResMut<Counts>| {
            if read.read().count() > 0 {
                counts.0.push(collisions.len());
            }
        })
        .after(FaceoffSystems::Publish),
    );
    sim.step(80);
    assert_eq!(sim.world().resource::<Counts>().0, [1]);
}

#[test]
fn a_report_names_its_stages() {
    let mut report = StepReport::default();
    report.stages[Stage::TriangleTest as usize] = Duration::from_millis(3);
    let text = format!("{report:?}");
    for stage in Stage::ALL {
        assert!(text.contains(&format!("{stage:?}: ")), "{text}");
    }
    assert!(text.contains("TriangleTest: 3ms"), "{text}");
    assert!(text.contains("waits: 0"), "{text}");
}

/// Most stages on the thread pool, and most pairs, of any of 64 steps with two threads.
fn most_parallel_stages(spawn: impl Fn(&mut Sim)) -> (u32, usize) {
    let mut sim = Sim::with_threads(2);
    spawn(&mut sim);
    let (mut stages, mut pairs) = (0, 0);
    for _ in 0..64 {
        sim.step(1);
        stages = stages.max(sim.report().parallel_stages);
        pairs = pairs.max(sim.report().sphere_pairs);
    }
    (stages, pairs)
}

#[test]
fn small_steps_wake_no_thread() {
    let cubes = |count: usize| {
        move |sim: &mut Sim| {
            sim.spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y));
            let cube = sim.mesh(&shapes::cube(1.0));
            for i in 0..count {
                sim.spawn(resting(&cube, Vec3::new(0.0, 0.6 + 1.1 * i as f32, 0.0)));
            }
        }
    };
    assert_eq!(most_parallel_stages(cubes(1)), (0, 0));
    assert_eq!(most_parallel_stages(cubes(10)), (0, 9));
    let (stages, pairs) = most_parallel_stages(|sim| {
        let torus = sim.mesh(&shapes::torus_240());
        for i in 0..125 {
            let at = Vec3::new((i % 5) as f32, (i / 25) as f32, (i / 5 % 5) as f32);
            sim.spawn(resting(&torus, 0.5 * at));
        }
    });
    assert!(stages > 0, "{pairs} pairs");
}

/// The number of collision substeps of a step in which something small flies at 100 m/s, beside a cube that lies on a
/// wide floor.
fn substeps_beside(bullet: Transform, velocity: Vec3) -> u32 {
    let mut sim = Sim::new();
    let (cube, ball) = (sim.mesh(&shapes::cube(1.0)), sim.mesh(&shapes::ball(0.025, 2)));
    sim.spawn((
        cube.clone(),
        Transform::from_xyz(0.0, -0.5, 0.0).with_scale(Vec3::new(500.0, 1.0, 500.0)),
    ));
    sim.spawn(resting(&cube, Vec3::Y * 0.501));
    sim.spawn((RigidBody::Dynamic, ball, bullet, LinearVelocity(velocity)));
    sim.step(1);
    sim.report().collision_substeps
}

#[test]
fn a_body_that_can_meet_nothing_does_not_divide_the_step() {
    let fast = Vec3::X * 100.0;
    let far = Transform::from_xyz(100.0, 50.0, 0.0);
    assert_eq!(substeps_beside(far, fast), 1, "within the bounding sphere of the floor");
    assert_eq!(substeps_beside(far, -fast), 1);
    let near = Transform::from_xyz(-3.0, 0.5, 0.0);
    assert_eq!(substeps_beside(near, fast), 8, "it hits the cube within two steps");
    assert_eq!(
        substeps_beside(Transform::from_xyz(100.0, 1.0, 0.0), Vec3::NEG_Y * 100.0),
        8,
        "it hits the floor"
    );
    let thin = Transform::from_xyz(100.0, 50.0, 0.0).with_scale(Vec3::new(1.0, 0.01, 1.0));
    assert_eq!(substeps_beside(thin, fast), 1);
}
