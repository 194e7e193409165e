//! What is told in the log, by entity and name: once, and again only after it was mended.

use crate::app::{Sim, resting, sorted};
use crate::log::{self, take as told};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;
use tracing::Level;

#[track_caller]
fn assert_told(entity: Entity, name: &str, words: &[&str]) {
    let told = told();
    assert_eq!(told.len(), 1, "{told:?}");
    let start = format!("{entity} \"{name}\"");
    assert!(told[0].starts_with(&start), "{told:?} does not begin with {start}");
    for word in words {
        assert!(told[0].contains(word), "{told:?} does not say {word}");
    }
}

#[test]
fn what_does_not_do_what_it_says_is_told_by_entity_and_name() {
    if log::ran_alone("warnings::what_does_not_do_what_it_says_is_told_by_entity_and_name") {
        return;
    }
    log::keep(&[Level::WARN, Level::ERROR]);
    components();
    without_collider();
    planes();
    long_ways();
    hooks();
    faults();
    crowds();
    same_keys();
    deep_overlaps();
    #[cfg(feature = "bevy_mesh")]
    without_meshes();
}

/// What stays deep in another is told, what comes apart is not.
fn deep_overlaps() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    // A press whose plates leave a cube two thirds of its height.
    for (name, y) in [("floor", -0.5), ("press", 1.16)] {
        sim.spawn((
            Name::new(name),
            RigidBody::Static,
            cube.clone(),
            Transform::from_xyz(0.0, y, 0.0).with_scale(Vec3::new(20.0, 1.0, 20.0)),
        ));
    }
    sim.spawn((
        Name::new("squeezed"),
        RigidBody::Dynamic,
        cube.clone(),
        Transform::from_xyz(0.0, 0.33, 0.0),
    ));
    // Two cubes that were spawned in each other, on the press.
    for x in [4.0, 4.5] {
        sim.spawn((RigidBody::Dynamic, cube.clone(), Transform::from_xyz(x, 2.2, 0.0)));
    }
    sim.step(128);
    let lines = told();
    assert_eq!(lines.len(), 2, "{lines:?}");
    for (line, plate) in lines.iter().zip(["floor", "press"]) {
        assert!(line.contains(plate) && line.contains("squeezed"), "{line}");
        assert!(line.contains("do not come apart"), "{line}");
    }
    sim.step(128);
    assert_eq!(told(), [""; 0]);
}

/// A key that appears twice counts for one collider or plane; another one is told.
fn same_keys() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    let keyed = |name: &str, x: f32| (StableKey(7), Name::new(name.to_string()), resting(&cube, Vec3::X * x));
    let pair = [sim.spawn(keyed("twin", 0.0)), sim.spawn(keyed("twin", 5.0))];
    sim.step(3);
    let [first, second] = sorted(pair[0], pair[1]);
    assert_told(second, "twin", &["StableKey 7", "key of its own"]);
    assert_eq!(sim.report().bodies, 2);
    sim.set(second, StableKey(8));
    sim.step(3);
    assert_eq!(told(), [""; 0]);
    // A plane with a taken key is reported too.
    let plane = (
        StableKey(7),
        Name::new("ground"),
        PlaneCollider::through(Vec3::NEG_Y * 9.0, Vec3::Y),
    );
    let plane = sim.spawn(plane);
    sim.step(3);
    assert_told(plane, "ground", &["StableKey 7"]);
    sim.world().despawn(first);
    // Two colliders on children have the key of their body.
    let body = sim.spawn((RigidBody::Dynamic, StableKey(9), Transform::from_xyz(0.0, 9.0, 0.0)));
    let parts = [0.0, 3.0].map(|x| {
        let part = (
            cube.clone(),
            Name::new("part"),
            Transform::from_xyz(x, 0.0, 0.0),
            ChildOf(body),
        );
        sim.spawn(part)
    });
    sim.step(3);
    let [_, second] = sorted(parts[0], parts[1]);
    assert_told(second, "part", &["StableKey 9", "has that of its body"]);
}

/// A crowd that loses pairs: an error names one of its bodies, and the report counts them until they are apart.
fn crowds() {
    let mut sim = Sim::new();
    sim.world().insert_resource(Response::None);
    sim.world().insert_resource(StepLimits {
        body_pairs: 50,
        ..default()
    });
    let cube = sim.mesh(&shapes::cube(1.0));
    let aside = sim.spawn(resting(&cube, Vec3::Y * 50.0));
    let crowd: Vec<Entity> = (0..30).map(|_| sim.spawn(resting(&cube, Vec3::ZERO))).collect();
    for _ in 0..3 {
        sim.step(1);
        let crowded = sim.report().crowded_bodies;
        assert!((10..=30).contains(&crowded), "{crowded}");
    }
    let errors = told();
    assert_eq!(errors.len(), 1, "{errors:?}");
    assert!(errors[0].contains("StepLimits"), "{errors:?}");
    assert!(!errors[0].contains(&aside.to_string()), "{errors:?}");
    assert!(
        crowd
            .iter()
            .any(|body| errors[0].contains(&format!("one of them is {body} at"))),
        "{errors:?}"
    );
    for (i, &body) in crowd.iter().enumerate() {
        let place = Transform::from_xyz(3.0 * i as f32, 0.0, 0.0);
        sim.world().entity_mut(body).insert(place);
    }
    sim.step(1);
    assert_eq!(sim.report().crowded_bodies, 0);
    assert_eq!(told(), [""; 0]);
}

/// Numbers that count as others.
fn components() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    let body = sim.spawn((resting(&cube, Vec3::ZERO), Name::new("crate")));
    sim.step(2);
    assert_eq!(told(), [""; 0]);
    let breaks: [(&str, fn(&mut EntityWorldMut, f32), f32); 8] = [
        ("Restitution", |body, x| add(body, Restitution::new(x)), 1.5),
        ("Restitution", |body, x| add(body, Restitution::new(x)), -0.5),
        ("Friction", |body, x| add(body, Friction::new(x)), -1.0),
        ("LinearDamping", |body, x| add(body, LinearDamping(x)), -2.0),
        ("AngularDamping", |body, x| add(body, AngularDamping(x)), -2.0),
        ("MaxLinearSpeed", |body, x| add(body, MaxLinearSpeed(x)), -3.0),
        ("MaxAngularSpeed", |body, x| add(body, MaxAngularSpeed(x)), -3.0),
        (
            "MaxAngularSpeed",
            |body, x| add(body, MaxAngularSpeed(x)),
            f32::NEG_INFINITY,
        ),
    ];
    for (name, set, bad) in breaks {
        for _ in 0..2 {
            // Another bad number is no news.
            for bad in [bad, 2.0 * bad] {
                set(&mut sim.world().entity_mut(body), bad);
                sim.step(5);
            }
            assert_told(body, "crate", &[name, &bad.to_string()]);
            assert_eq!(sim.report().bodies, 1, "it goes on");
            assert!(sim.rejected.is_empty());
            set(&mut sim.world().entity_mut(body), 0.5);
            sim.step(5);
            assert_eq!(told(), [""; 0], "{name}: mending is not told");
        }
    }
    // Two at once are both told.
    sim.set(body, (LinearDamping(-1.0), AngularDamping(-1.0)));
    sim.step(3);
    assert_eq!(told().len(), 2);
}

fn add(body: &mut EntityWorldMut, component: impl Bundle) {
    body.insert(component);
}

/// A body that moves and has no collider.
fn without_collider() {
    for kind in [RigidBody::Dynamic, RigidBody::Kinematic, RigidBody::Static] {
        let mut sim = Sim::new();
        let cube = sim.mesh(&shapes::cube(1.0));
        let late = sim.spawn((kind, Name::new("late")));
        sim.step(50);
        sim.set(late, cube.clone());
        let never = sim.spawn((kind, Name::new("never")));
        sim.step(50);
        assert_eq!(told(), [""; 0], "a collider may come later");
        sim.step(100);
        if kind == RigidBody::Static {
            assert_eq!(told(), [""; 0], "what stands still needs none");
            continue;
        }
        assert_told(never, "never", &["without a collider", "MeshCollider"]);
        sim.set(never, cube);
        sim.step(5);
        sim.world().entity_mut(never).remove::<MeshCollider>();
        sim.step(100);
        assert_told(never, "never", &["without a collider"]);
    }
}

fn planes() {
    let mut sim = Sim::new();
    let plane = || PlaneCollider::through(Vec3::ZERO, Vec3::Y);
    sim.spawn((plane(), RigidBody::Static, Name::new("ground")));
    sim.step(100);
    assert_eq!(told(), [""; 0], "planes are static");
    for kind in [RigidBody::Dynamic, RigidBody::Kinematic] {
        let lift = sim.spawn((plane(), kind, Name::new("lift")));
        sim.step(100);
        assert_told(lift, "lift", &["RigidBody", "PlaneCollider"]);
    }
    let floor = sim.spawn((plane(), Restitution::new(2.0), Name::new("floor")));
    sim.step(10);
    assert_told(floor, "floor", &["Restitution", "2"]);
    sim.spawn((plane(), Sensor, Name::new("area")));
    sim.step(10);
    assert_eq!(told(), [""; 0]);
}

/// A platform that jumps home is told once. With `Teleport` it is not told.
fn long_ways() {
    for teleports in [false, true] {
        let mut sim = Sim::new();
        let cube = sim.mesh(&shapes::cube(1.0));
        let platform = sim.spawn((RigidBody::Kinematic, cube, Transform::default(), Name::new("platform")));
        sim.step(1);
        for x in [20.0, -20.0, 20.0] {
            sim.set(platform, Transform::from_xyz(x, 0.0, 0.0));
            if teleports {
                sim.set(platform, Teleport);
            }
            sim.step(2);
        }
        if teleports {
            assert_eq!(told(), [""; 0]);
        } else {
            assert_told(platform, "platform", &["20 m", "Teleport"]);
        }
    }
}

/// Hooks that nobody answers.
fn hooks() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    let body = sim.spawn((
        resting(&cube, Vec3::ZERO),
        ActiveCollisionHooks::ALL,
        Name::new("ghost"),
    ));
    sim.step(3);
    assert_told(body, "ghost", &["ActiveCollisionHooks", "CollisionHooksPlugin"]);
}

/// What takes a body out has its name too.
fn faults() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    let heavy = sim.spawn((resting(&cube, Vec3::ZERO), Mass(f32::INFINITY), Name::new("anvil")));
    sim.step(3);
    assert_told(heavy, "anvil", &["Mass is infinite", "RigidBody::Static"]);
    // So large that the sheared mesh has no finite coordinates.
    let far = sim.spawn(Transform::from_scale(Vec3::new(1.0, 1e30, 1.0)));
    let parent = sim.spawn((Transform::from_scale(Vec3::new(1.0, 1e30, 1.0)), ChildOf(far)));
    let turned = Transform::from_rotation(Quat::from_rotation_z(0.5));
    let child = sim.spawn((cube.clone(), turned, ChildOf(parent), Name::new("wheel")));
    for _ in 0..100 {
        std::thread::sleep(std::time::Duration::from_millis(5));
        sim.step(1);
    }
    assert_told(child, "wheel", &["shears its mesh", "scale it alone"]);
}

/// Bevy's meshes are there only with its plugin for them.
#[cfg(feature = "bevy_mesh")]
fn without_meshes() {
    let mut sim = Sim::new();
    let handle = Handle::<Mesh>::default();
    let body = sim.spawn((RigidBody::Dynamic, MeshColliderFrom(handle), Name::new("drawn")));
    sim.step(100);
    assert_told(body, "drawn", &["MeshColliderFrom", "Assets<Mesh>", "MeshPlugin"]);
}
