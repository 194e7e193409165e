//! A level of many static bodies: a step reads what moves, notices what is changed, and has the bits of one that reads
//! all.

use crate::app::Sim;
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;

/// A level and what moves in it.
struct Level {
    sim: Sim,
    cube: MeshCollider,
    torus: MeshCollider,
    /// Static cubes, which are the floor.
    tiles: Vec<Entity>,
    /// A node without a collider above static ones.
    node: Entity,
    rails: Vec<Entity>,
    /// Bodies that are their only collider.
    rocks: Vec<Entity>,
    /// A static body with two colliders below it.
    hut: Entity,
    /// A body that moves, with two colliders below it, and one of these.
    car: Entity,
    wheel: Entity,
    /// Whether all is read in every step.
    reads_all: bool,
}

impl Level {
    fn new(reads_all: bool) -> Self {
        let mut sim = Sim::new();
        sim.world().insert_resource(Gravity::default());
        let cube = sim.mesh(&shapes::cube(1.0));
        let torus = sim.mesh(&shapes::torus_240());
        let tile = |i: i32| Transform::from_xyz((i % 10) as f32, -0.5, (i / 10) as f32);
        let tiles = (0..100).map(|i| sim.spawn((RigidBody::Static, cube.clone(), tile(i))));
        let tiles = tiles.collect();
        let node = sim.spawn(Transform::from_xyz(0.0, 0.2, 0.0));
        let rail = |i: i32| Transform::from_xyz(3.0 * i as f32, 0.0, 4.0).with_scale(Vec3::new(0.2, 0.2, 3.0));
        let rails = (0..4).map(|i| sim.spawn((cube.clone(), rail(i), ChildOf(node))));
        let rails = rails.collect();
        let rock = |i: i32| {
            Transform::from_xyz(
                0.3 + 1.7 * (i % 5) as f32,
                1.0 + 0.2 * i as f32,
                0.4 + 1.9 * (i / 5) as f32,
            )
            .with_scale(Vec3::splat(0.6))
        };
        let rocks = (0..20).map(|i| sim.spawn((RigidBody::Dynamic, torus.clone(), rock(i))));
        let rocks = rocks.collect();
        let car = sim.spawn((
            RigidBody::Dynamic,
            Transform::from_xyz(5.0, 3.0, 5.0),
            LinearVelocity(Vec3::X),
        ));
        let hut = sim.spawn((RigidBody::Static, Transform::from_xyz(2.0, 0.1, 7.0)));
        for x in [0.0, 1.0] {
            let wall = Transform::from_xyz(x, 0.0, 0.0).with_scale(Vec3::splat(0.5));
            sim.spawn((cube.clone(), wall, ChildOf(hut)));
        }
        let part = |x: f32| Transform::from_xyz(x, 0.0, 0.0).with_scale(Vec3::splat(0.4));
        let wheel = sim.spawn((cube.clone(), part(-0.4), ChildOf(car)));
        sim.spawn((cube.clone(), part(0.4), ChildOf(car)));
        let lift = Transform::from_xyz(8.0, 0.5, 8.0).with_scale(Vec3::new(2.0, 0.2, 2.0));
        sim.spawn((RigidBody::Kinematic, cube.clone(), lift, LinearVelocity(0.2 * Vec3::Y)));
        Self {
            sim,
            cube,
            torus,
            tiles,
            node,
            rails,
            rocks,
            hut,
            car,
            wheel,
            reads_all,
        }
    }

    /// Runs so many steps, and returns how many colliders the last one has read or, because they are dormant, left out.
    /// Bodies that something has roused are not read either.
    fn step(&mut self, count: usize) -> usize {
        for _ in 0..count {
            if self.reads_all {
                let mut meshes = self.sim.world().resource_mut::<Assets<CollisionMesh>>();
                meshes.set_changed();
            }
            self.sim.step(1);
        }
        let report = self.sim.report();
        report.colliders_read + report.dormant
    }

    /// Poses and velocities of all bodies, and what touches.
    fn state(&mut self) -> impl PartialEq + std::fmt::Debug + use<> {
        type Moving = (
            Entity,
            &'static Transform,
            &'static LinearVelocity,
            &'static AngularVelocity,
            &'static Sleeping,
        );
        let world = self.sim.world();
        let mut bodies: Vec<_> = (world.query::<Moving>().iter(world))
            .map(|(entity, transform, velocity, spin, sleeping)| (entity, *transform, velocity.0, spin.0, sleeping.0))
            .collect();
        bodies.sort_by_key(|body| body.0);
        let touching: Vec<_> = self.sim.touching();
        (bodies, touching)
    }
}

/// A change, and the number of colliders that a step reads after it.
type Change = (&'static str, fn(&mut Level), usize);

/// 20 rocks, two colliders of the car, and the lift.
const MOVING: usize = 23;

const CHANGES: &[Change] = &[
    ("nothing", |_| {}, MOVING),
    (
        "a tile is moved",
        |level| {
            let tile = level.tiles[44];
            level.sim.set(tile, Transform::from_xyz(4.0, -0.3, 4.0));
        },
        MOVING,
    ),
    (
        "a tile is written in place",
        |level| {
            let tile = level.tiles[45];
            level.sim.world().get_mut::<Transform>(tile).unwrap().translation.y -= 0.2;
        },
        MOVING,
    ),
    (
        "a tile gets friction",
        |level| {
            let tile = level.tiles[33];
            level.sim.set(tile, Friction::new(0.0));
        },
        MOVING,
    ),
    (
        "and loses it",
        |level| {
            let tile = level.tiles[33];
            level.sim.world().entity_mut(tile).remove::<Friction>();
        },
        MOVING,
    ),
    (
        "a tile is disabled",
        |level| {
            let tile = level.tiles[22];
            level.sim.set(tile, ColliderDisabled);
        },
        MOVING,
    ),
    (
        "and enabled",
        |level| {
            let tile = level.tiles[22];
            level.sim.world().entity_mut(tile).remove::<ColliderDisabled>();
        },
        MOVING,
    ),
    (
        "a tile goes",
        |level| {
            let tile = level.tiles.remove(11);
            level.sim.world().despawn(tile);
        },
        MOVING,
    ),
    (
        "a tile goes and another comes",
        |level| {
            let tile = level.tiles.remove(50);
            level.sim.world().despawn(tile);
            let cube = level.cube.clone();
            let tile = level
                .sim
                .spawn((RigidBody::Static, cube, Transform::from_xyz(1.0, 0.3, 5.0)));
            level.tiles.push(tile);
        },
        MOVING,
    ),
    (
        "what is above the rails is moved",
        |level| {
            let node = level.node;
            level.sim.world().get_mut::<Transform>(node).unwrap().translation.y += 0.3;
        },
        MOVING,
    ),
    (
        "a hut is moved",
        |level| {
            let hut = level.hut;
            level.sim.world().get_mut::<Transform>(hut).unwrap().translation.x += 0.4;
        },
        MOVING,
    ),
    (
        "a wall of it goes",
        |level| {
            let hut = level.hut;
            let wall = level.sim.world().get::<Children>(hut).unwrap()[0];
            level.sim.world().despawn(wall);
        },
        MOVING,
    ),
    (
        "a rail is scaled",
        |level| {
            let rail = level.rails[1];
            level.sim.world().get_mut::<Transform>(rail).unwrap().scale.y = 2.0;
        },
        MOVING,
    ),
    (
        "a rail is taken from its node",
        |level| {
            let rail = level.rails[2];
            level.sim.world().entity_mut(rail).remove::<ChildOf>();
        },
        MOVING,
    ),
    (
        "a rock goes",
        |level| {
            let rock = level.rocks.remove(3);
            level.sim.world().despawn(rock);
        },
        MOVING - 1,
    ),
    (
        "a rock comes",
        |level| {
            let torus = level.torus.clone();
            let rock = level
                .sim
                .spawn((RigidBody::Dynamic, torus, Transform::from_xyz(2.0, 4.0, 2.0)));
            level.rocks.push(rock);
        },
        MOVING,
    ),
    (
        "a rock is static",
        |level| {
            let rock = level.rocks[0];
            level.sim.set(rock, RigidBody::Static);
        },
        MOVING - 1,
    ),
    (
        "and dynamic",
        |level| {
            let rock = level.rocks[0];
            level.sim.set(rock, RigidBody::Dynamic);
        },
        MOVING,
    ),
    (
        "a rock is kinematic",
        |level| {
            let rock = level.rocks[1];
            level.sim.set(rock, RigidBody::Kinematic);
        },
        MOVING,
    ),
    (
        "a rock is no body",
        |level| {
            let rock = level.rocks[2];
            level.sim.world().entity_mut(rock).remove::<RigidBody>();
        },
        MOVING - 1,
    ),
    (
        "a tile moves",
        |level| {
            let tile = level.tiles[70];
            level.sim.set(tile, RigidBody::Dynamic);
        },
        MOVING,
    ),
    (
        "a rock has a key",
        |level| {
            let rock = level.rocks[5];
            level.sim.set(rock, StableKey(7));
        },
        MOVING,
    ),
    (
        "a rock has another centre",
        |level| {
            let rock = level.rocks[6];
            level.sim.set(rock, CenterOfMass(Vec3::new(0.1, 0.0, 0.0)));
        },
        MOVING,
    ),
    (
        "a rock is below another entity",
        |level| {
            let (rock, node) = (level.rocks[7], level.node);
            level.sim.set(rock, ChildOf(node));
        },
        MOVING,
    ),
    (
        "a wheel turns",
        |level| {
            let wheel = level.wheel;
            level.sim.world().get_mut::<Transform>(wheel).unwrap().rotate_y(0.4);
        },
        MOVING,
    ),
    (
        "the car has a third collider",
        |level| {
            let (car, cube) = (level.car, level.cube.clone());
            let place = Transform::from_xyz(0.0, 0.5, 0.0).with_scale(Vec3::splat(0.3));
            level.sim.spawn((cube, place, ChildOf(car)));
        },
        MOVING + 1,
    ),
    (
        "the car loses a wheel",
        |level| {
            let wheel = level.wheel;
            level.sim.world().entity_mut(wheel).remove::<ChildOf>();
        },
        MOVING,
    ),
    (
        "a rock is thrown",
        |level| {
            let rock = level.rocks[8];
            level.sim.set(rock, LinearVelocity(Vec3::new(3.0, 4.0, 0.0)));
        },
        MOVING,
    ),
    (
        "a plane comes",
        |level| {
            level.sim.spawn(PlaneCollider {
                normal: Vec3::Y,
                distance: 0.4,
            });
        },
        MOVING,
    ),
    (
        "gravity is reversed",
        |level| {
            level.sim.world().insert_resource(Gravity(4.0 * Vec3::Y));
        },
        MOVING,
    ),
    (
        "the car goes",
        |level| {
            let car = level.car;
            level.sim.world().despawn(car);
        },
        MOVING - 2,
    ),
    (
        "a rock wakes up disabled",
        |level| {
            let rock = level.rocks[9];
            level.sim.set(rock, RigidBodyDisabled);
        },
        MOVING - 3,
    ),
    (
        "and is enabled",
        |level| {
            let rock = level.rocks[9];
            level.sim.world().entity_mut(rock).remove::<RigidBodyDisabled>();
        },
        MOVING - 2,
    ),
];

#[test]
fn what_is_static_is_read_when_it_changes() {
    let (mut few, mut all) = (Level::new(false), Level::new(true));
    let total = all.step(3);
    assert_eq!(few.step(3), MOVING);
    assert!(total > 120, "{total}");
    for (name, change, moving) in CHANGES {
        let read = [&mut few, &mut all].map(|level| {
            change(level);
            level.step(1);
            level.step(11)
        });
        assert!(read[0] <= *moving, "{name}: {read:?}");
        assert!(read[1] > 115, "{name}: {read:?}");
        assert_eq!(few.state(), all.state(), "{name}");
    }
}

#[test]
fn bullets_come_and_go_beside_a_level_that_is_not_read() {
    let mut level = Level::new(false);
    level.step(3);
    let cube = level.cube.clone();
    let mut last = Vec::new();
    for i in 0..100 {
        let place = Transform::from_xyz(-5.0, 1.0 + 0.01 * i as f32, 5.0).with_scale(Vec3::splat(0.1));
        // What has nothing to do with collisions comes and goes too.
        let other = level
            .sim
            .spawn((Transform::default(), ChildOf(last.last().copied().unwrap_or(level.car))));
        level.sim.world().despawn(other);
        let bullet = (RigidBody::Dynamic, cube.clone(), place, LinearVelocity(40.0 * Vec3::X));
        last.push(level.sim.spawn(bullet));
        if last.len() > 5 {
            let first = last.remove(0);
            level.sim.world().despawn(first);
        }
        let read = level.step(1);
        assert!(read <= MOVING + last.len() && read > last.len(), "{read}");
    }
}
