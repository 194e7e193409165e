//! Snapshots that are written and read: they continue to the bit, also in another world, and damaged ones do no harm.

use crate::app::{Sim, assert_near, ball_like, resting};
use crate::stable_keys::{Named, Order};
use bevy::ecs::entity::{EntityHashMap, MapEntities};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;
use serde_json::Value;

/// Steps after which a part of the pile sleeps.
const ASLEEP: usize = 420;

fn after(steps: usize, order: Order, keys: bool) -> Named {
    let mut world = Named::new(order, keys);
    for number in 0..steps {
        world.step(number);
    }
    world
}

fn through_text(snapshot: &Snapshot) -> Snapshot {
    ron::from_str(&ron::to_string(snapshot).unwrap()).unwrap()
}

/// The entities of the second world by those of the first.
fn map(one: &Named, other: &Named) -> EntityHashMap<Entity> {
    let entities = one.entity_of.iter().map(|&(name, entity)| (entity, other.entity(name)));
    entities.collect()
}

#[test]
fn a_snapshot_that_was_written_continues_to_the_bit() {
    for steps in [100, ASLEEP] {
        let mut world = after(steps, Order::Plain, false);
        let taken = Snapshot::take(world.sim.world());
        let read = through_text(&taken);
        assert_eq!(read, taken, "after {steps} steps");
        let mut go_on = |snapshot: &Snapshot| {
            assert_eq!(snapshot.restore(world.sim.world()), []);
            world.sim.started.clear();
            world.sim.ended.clear();
            let mut bodies = Vec::new();
            for number in steps..steps + 60 {
                world.step(number);
                bodies.push((world.bodies(), world.hits()));
            }
            (bodies, world.told())
        };
        assert!(go_on(&taken) == go_on(&read), "after {steps} steps");
    }
}

#[test]
fn a_snapshot_continues_in_another_world_with_the_same_keys() {
    for steps in [100, ASLEEP] {
        let mut one = after(steps, Order::Plain, true);
        let mut snapshot = through_text(&Snapshot::take(one.sim.world()));
        // As after loading a scene: the bodies are there, and no step was.
        let mut other = Named::new(Order::Mixed, true);
        snapshot.map_entities(&mut map(&one, &other));
        assert_eq!(snapshot.restore(other.sim.world()), []);
        one.sim.started.clear();
        one.sim.ended.clear();
        let sleeping = one.sim.report().sleeping;
        assert!(steps < ASLEEP || sleeping > 10, "{sleeping} sleep");
        for number in steps..steps + 200 {
            for world in [&mut one, &mut other] {
                world.step(number);
            }
            assert_eq!(one.bodies(), other.bodies(), "step {number}");
            assert_eq!(one.hits(), other.hits(), "step {number}");
            assert_eq!(one.told(), other.told(), "step {number}");
            if number == steps && sleeping > 10 {
                assert!(other.sim.report().sleeping > 10, "they stay asleep");
            }
        }
    }
}

/// Without keys the bodies of the other world may come in another order. Poses and velocities are right all the same.
#[test]
fn a_snapshot_continues_in_another_world_without_keys() {
    let mut one = after(ASLEEP, Order::Plain, false);
    let mut snapshot = Snapshot::take(one.sim.world());
    let mut other = Named::new(Order::Mixed, false);
    snapshot.map_entities(&mut map(&one, &other));
    assert_eq!(snapshot.restore(other.sim.world()), []);
    assert_eq!(other.bodies(), one.bodies());
    for number in ASLEEP..ASLEEP + 30 {
        for world in [&mut one, &mut other] {
            world.step(number);
        }
    }
    for (one, other) in one.bodies().iter().zip(other.bodies()) {
        assert!(one.1[0].distance(other.1[0]) < 0.02, "{one:?} {other:?}");
    }
    // Back again is as if nothing had been.
    let mut snapshot = Snapshot::take(one.sim.world());
    let before = snapshot.clone();
    snapshot.map_entities(&mut map(&one, &other));
    assert_ne!(snapshot, before);
    snapshot.map_entities(&mut map(&other, &one));
    assert_eq!(snapshot, before);
}

/// A cube on another one on a plane, spawned in this order or in the opposite one. Returns them from below.
fn stack(upwards: bool) -> (Sim, [Entity; 3]) {
    let mut sim = Sim::new();
    sim.world().insert_resource(Gravity::default());
    let cube = sim.mesh(&shapes::cube(1.0));
    let mut stack = [Entity::PLACEHOLDER; 3];
    let order = if upwards { [0, 1, 2] } else { [2, 1, 0] };
    for level in order {
        stack[level] = match level {
            0 => sim.spawn(PlaneCollider::default()),
            _ => sim.spawn(resting(&cube, Vec3::Y * (level as f32 - 0.5))),
        };
    }
    (sim, stack)
}

/// Bodies that touch go on to touch where their entities, and so the two halves of each pair, come in the other order.
#[test]
fn nothing_is_told_of_what_touches_before_and_after_a_snapshot_was_mapped() {
    for steps in [20, 200] {
        let (mut one, before) = stack(true);
        one.step(steps);
        assert_eq!(one.touching().len(), 2, "after {steps} steps");
        let mut snapshot = Snapshot::take(one.world());
        let (mut other, after) = stack(false);
        for pair in [0, 1] {
            let ascends = |stack: &[Entity; 3]| stack[pair] < stack[pair + 1];
            assert_ne!(ascends(&before), ascends(&after));
        }
        let mut map: EntityHashMap<Entity> = before.into_iter().zip(after).collect();
        snapshot.map_entities(&mut map);
        assert_eq!(through_text(&snapshot), snapshot);
        assert_eq!(snapshot.restore(other.world()), []);
        other.step(30);
        assert_eq!(other.touching().len(), 2, "after {steps} steps");
        assert_eq!((other.started, other.ended), (vec![], vec![]), "after {steps} steps");
    }
}

/// A collision that has not ended yet ends in the same step as without a snapshot.
#[test]
fn a_collision_lingers_after_a_snapshot_as_without() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(0.2));
    for side in [-1.0, 1.0] {
        sim.spawn(ball_like(&cube, Vec3::X * 0.3 * side, Vec3::X * -8.0 * side));
    }
    let mut steps = 0;
    while sim.started.is_empty() || !sim.touching().is_empty() {
        sim.step(1);
        steps += 1;
        assert!(steps < 30, "they meet and part");
    }
    // Now their bounding spheres do not overlap.
    sim.step(3);
    let snapshot = Snapshot::take(sim.world());
    let mut steps_to_end = || {
        assert_eq!(sim.ended, []);
        let steps = (1..30).find(|_| {
            sim.step(1);
            !sim.ended.is_empty()
        });
        sim.ended.clear();
        snapshot.restore(sim.world());
        steps
    };
    let without = steps_to_end();
    assert!(without.is_some_and(|steps| steps > 1), "{without:?}");
    assert_eq!(steps_to_end(), without);
}

#[test]
fn a_snapshot_says_what_is_wrong_with_it() {
    let mut world = after(100, Order::Plain, true);
    let taken = Snapshot::take(world.sim.world());
    let value = serde_json::to_value(&taken).unwrap();
    let damages: [(&str, &dyn Fn(&mut Value)); 12] = [
        ("format 77", &|value| value["format"] = 77.into()),
        ("0 is not an entity", &|value| value["asleep"] = vec![0].into()),
        ("0 is not an entity", &|value| value["bodies"][3][0] = 0.into()),
        ("states of bodies for", &|value| {
            drop(list(&mut value["memory"]["bodies"]).pop())
        }),
        ("keys of colliders are not in ascending order", &|value| {
            list(&mut value["memory"]["keys"]).swap(3, 4);
        }),
        ("bodies of colliders name something", &|value| {
            value["memory"]["bodies"][5]["body"] = 4_000_000_000_u32.into();
        }),
        ("pairs with impulses are not in ascending order", &|value| {
            list(&mut value["memory"]["warm"]["pairs"]).swap(3, 4);
        }),
        ("pairs with impulses name something", &|value| {
            value["memory"]["warm"]["pairs"][0]["first"] = u32::MAX.into();
        }),
        ("impulses contain a number", &|value| {
            value["memory"]["warm"]["points"][2]["normal_impulse"] = 1.0e300.into();
        }),
        ("pairs with contact points name something", &|value| {
            value["manifolds"]["pairs"][1]["point_count"] = u32::MAX.into();
        }),
        ("pairs with contact points are not in ascending order", &|value| {
            list(&mut value["manifolds"]["pairs"]).swap(3, 4);
        }),
        ("contact points contain a number", &|value| {
            value["manifolds"]["points"][2]["separation"] = 1.0e300.into();
        }),
    ];
    for (says, damage) in damages {
        let mut value = value.clone();
        damage(&mut value);
        let error = serde_json::from_value::<Snapshot>(value).unwrap_err().to_string();
        assert!(error.contains(says), "{error} does not say {says}");
    }
}

fn list(value: &mut Value) -> &mut Vec<Value> {
    value.as_array_mut().unwrap()
}

/// Whatever is read is an error or can be restored, and steps go on without a panic.
#[test]
fn a_damaged_snapshot_does_no_harm() {
    let mut world = after(ASLEEP, Order::Plain, false);
    let taken = Snapshot::take(world.sim.world());
    let value = serde_json::to_value(&taken).unwrap();
    let (mut read, mut refused) = (0, 0);
    for seed in 0..600 {
        let mut random = fastrand::Rng::with_seed(seed);
        let mut value = value.clone();
        for _ in 0..random.usize(1..4) {
            damage(&mut value, &mut random);
        }
        let Ok(mut snapshot) = serde_json::from_value::<Snapshot>(value) else {
            refused += 1;
            continue;
        };
        read += 1;
        if random.bool() {
            snapshot.map_entities(&mut map(&world, &world));
        }
        snapshot.restore(world.sim.world());
        world.sim.step(2);
    }
    assert!(read > 50 && refused > 50, "{read} read, {refused} refused");
    // What was damaged is whole again.
    taken.restore(world.sim.world());
    assert_eq!(Snapshot::take(world.sim.world()), taken);
}

/// Changes a random part.
fn damage(mut value: &mut Value, random: &mut fastrand::Rng) {
    loop {
        let stops = random.u8(0..8) == 0;
        match value {
            Value::Array(values) if stops || values.is_empty() => {
                let at = random.usize(0..=values.len());
                match (values.get(at).cloned(), random.u8(0..3)) {
                    (Some(same), 0) => values.insert(at, same),
                    (Some(_), 1) => drop(values.remove(at)),
                    (Some(_), _) => values.swap(0, at),
                    (None, _) => values.clear(),
                }
                return;
            }
            Value::Array(values) => {
                let at = random.usize(0..values.len());
                value = &mut values[at];
            }
            Value::Object(fields) => {
                let at = random.usize(0..fields.len());
                value = fields.values_mut().nth(at).unwrap();
            }
            _ => {
                let others = [
                    Value::from(0),
                    Value::from(1),
                    Value::from(u32::MAX),
                    Value::from(u64::MAX),
                    Value::from(-1.0e30),
                    Value::from(1.0e300),
                    Value::from(true),
                    Value::from("Dynamic"),
                    Value::Null,
                ];
                *value = others[random.usize(0..others.len())].clone();
                return;
            }
        }
    }
}

/// Its platform goes back by the way of seconds.
#[test]
fn a_character_goes_on_from_a_snapshot() {
    for (is_body, is_child) in [(true, false), (false, false), (true, true), (false, true)] {
        let mut sim = Sim::new();
        sim.world().insert_resource(Gravity::default());
        let cube = sim.mesh(&shapes::cube(1.0));
        let platform = sim.spawn((
            RigidBody::Kinematic,
            cube,
            Transform::from_xyz(0.0, -0.5, 0.0).with_scale(Vec3::new(9.0, 1.0, 9.0)),
            LinearVelocity(Vec3::new(0.5, 0.25, 0.0)),
        ));
        let character = sim.spawn((Character::new(0.3, 0.5), Transform::from_xyz(0.5, 0.81, 0.0)));
        if is_body {
            sim.set(character, RigidBody::Kinematic);
        }
        if is_child {
            let parent = sim.spawn(Transform::from_xyz(0.25, 0.0, 0.5));
            sim.set(character, ChildOf(parent));
        }
        // It comes to the platform with its velocity in the world, until the game sets another one.
        sim.step(4);
        sim.set(character, Character::new(0.3, 0.5));
        sim.step(60);
        let state = |sim: &mut Sim| {
            (
                sim.position(character),
                sim.get::<Character>(character).velocity,
                sim.get::<CharacterGround>(character),
            )
        };
        let before = state(&mut sim);
        assert_eq!(before.2.unwrap().collider, platform);
        let snapshot = Snapshot::take(sim.world());
        let written = ron::to_string(&snapshot).unwrap();
        let goes_on = |sim: &mut Sim| {
            [1, 1, 62].map(|steps| {
                sim.step(steps);
                state(sim)
            })
        };
        let after = goes_on(&mut sim);
        assert_near(after[2].0, before.0 + Vec3::new(0.5, 0.25, 0.0), 1e-3);
        sim.step(128);
        for snapshot in [snapshot, ron::from_str(&written).unwrap()] {
            assert_eq!(snapshot.restore(sim.world()), []);
            assert_eq!(state(&mut sim), before);
            assert_eq!(goes_on(&mut sim), after);
        }
        // Who came later stays where it is, also if the platform goes back.
        let on_it = sim.position(platform) + Vec3::new(2.0, 1.31, 0.0);
        let late = sim.spawn((Character::new(0.3, 0.5), Transform::from_translation(on_it)));
        sim.step(60);
        let at = sim.position(late);
        let snapshot: Snapshot = ron::from_str(&written).unwrap();
        snapshot.restore(sim.world());
        sim.step(1);
        assert_near(sim.position(late), at, 0.02);
        sim.world().despawn(character);
        let snapshot: Snapshot = ron::from_str(&written).unwrap();
        assert_eq!(snapshot.restore(sim.world()), [character]);
    }
}

/// NaN in a pose is that of a body like any other: the step leaves it out and says so.
#[test]
fn a_pose_that_is_not_finite_is_reported() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    let body = sim.spawn(resting(&cube, Vec3::new(0.5, 0.25, 77.5)));
    sim.step(2);
    let text = ron::to_string(&Snapshot::take(sim.world())).unwrap();
    let damaged = text.replacen("77.5", "NaN", 1);
    assert_ne!(text, damaged);
    let snapshot: Snapshot = ron::from_str(&damaged).unwrap();
    assert_eq!(snapshot.restore(sim.world()), []);
    sim.step(2);
    assert_eq!(sim.rejected.len(), 1);
    assert_eq!(sim.rejected[0].entity, body);
}
