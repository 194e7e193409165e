//! Bodies with stable keys: results do not depend on entities.

use crate::app::Sim;
use bevy::ecs::entity::EntityHashMap;
use bevy::prelude::*;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::prelude::*;

/// The key of the kinematic bodies, and of the body that wakes the others.
const PADDLE: u64 = 300;
const LIFT: u64 = 301;
const HAMMER: u64 = 10;

/// A world whose bodies have names, which are numbers.
pub struct Named {
    pub sim: Sim,
    pub entity_of: Vec<(u64, Entity)>,
    name_of: EntityHashMap<u64>,
}

/// How a world comes to be.
#[derive(Clone, Copy, PartialEq)]
pub enum Order {
    /// All is spawned in the order of names.
    Plain,
    /// In the opposite order, with other entities before and between, some of which are gone: entities that were used
    /// before are used again.
    Mixed,
}

/// All of a collision but for its entities.
#[derive(Debug, PartialEq)]
pub struct Hit {
    names: [u64; 4],
    contact: [Vec3; 2],
    points: Vec<String>,
    faces: usize,
    impulse: f32,
}

impl Named {
    /// A pile of rings and cubes on a floor between walls, a body of two cubes, a paddle and a lift. `keys` says
    /// whether the names are stable keys.
    pub fn new(order: Order, keys: bool) -> Self {
        let mut sim = Sim::new();
        sim.world().insert_resource(Gravity(Vec3::NEG_Y * 9.81));
        let mut named = Self {
            sim,
            entity_of: Vec::new(),
            name_of: EntityHashMap::default(),
        };
        let mesh = |sim: &mut Sim, mesh: TriMesh, size: f32| {
            let vertices = mesh.vertices().iter().map(|v| *v * size).collect();
            sim.mesh(&TriMesh::new(vertices, mesh.triangles().to_vec()).unwrap())
        };
        // Meshes are numbered in the order in which bodies with them are found.
        let torus = mesh(&mut named.sim, shapes::torus_240(), 0.3);
        let cube = mesh(&mut named.sim, shapes::cube(1.0), 0.25);
        let plank = mesh(&mut named.sim, shapes::cube(1.0), 1.2);

        let mut names: Vec<u64> = (0..5).chain(HAMMER..HAMMER + 24).chain(100..112).collect();
        names.extend([200, PADDLE, LIFT]);
        if order == Order::Mixed {
            let dummies: Vec<_> = (0..60).map(|_| named.sim.spawn(Name::new("a dummy"))).collect();
            for dummy in dummies.into_iter().step_by(2) {
                named.sim.world().despawn(dummy);
            }
            names.reverse();
        }
        for name in names {
            named.spawn(name, keys, [&torus, &cube, &plank]);
            if order == Order::Mixed && name % 3 == 0 {
                named.sim.spawn(Transform::default());
            }
        }
        named.entity_of.sort_unstable();
        named
    }

    fn spawn(&mut self, name: u64, keys: bool, [torus, cube, plank]: [&MeshCollider; 3]) {
        let place = |i: u64| {
            let [x, z] = [i % 3, i / 3 % 2].map(|k| 0.5 * (k as f32) - 0.4);
            let turn = Quat::from_rotation_x(0.7 * i as f32);
            Transform::from_xyz(x, 0.4 + 0.35 * (i / 6) as f32, z).with_rotation(turn)
        };
        let entity = match name {
            0 => self.sim.spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y)),
            1..5 => {
                let side = [Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z][name as usize - 1];
                self.sim.spawn(PlaneCollider::through(0.9 * side, -side))
            }
            HAMMER..100 => self
                .sim
                .spawn((RigidBody::Dynamic, torus.clone(), place(name - HAMMER))),
            100..112 => self
                .sim
                .spawn((RigidBody::Dynamic, cube.clone(), place(name - 100 + 24))),
            200 => self.sim.spawn((
                RigidBody::Dynamic,
                Transform::from_xyz(0.1, 3.2, 0.2),
                CollidingEntities::default(),
            )),
            PADDLE => self.sim.spawn((
                RigidBody::Kinematic,
                plank.clone(),
                Transform::from_xyz(0.0, 0.05, 0.0).with_scale(Vec3::new(1.0, 0.1, 0.1)),
                AngularVelocity(Vec3::Y),
            )),
            _ => self.sim.spawn((
                RigidBody::Kinematic,
                plank.clone(),
                Transform::from_xyz(1.0, 0.0, 0.0).with_scale(Vec3::new(0.5, 0.1, 1.0)),
            )),
        };
        self.call(name, entity, keys);
        if name == 200 {
            for (name, x) in [(201, -0.2), (202, 0.2)] {
                let part = self
                    .sim
                    .spawn((cube.clone(), Transform::from_xyz(x, 0.0, 0.0), ChildOf(entity)));
                self.call(name, part, keys);
            }
        }
    }

    fn call(&mut self, name: u64, entity: Entity, keys: bool) {
        if keys {
            self.sim.set(entity, StableKey(name));
        }
        self.entity_of.push((name, entity));
        self.name_of.insert(entity, name);
    }

    pub fn entity(&self, name: u64) -> Entity {
        let at = self.entity_of.binary_search_by_key(&name, |&(name, _)| name);
        self.entity_of[at.unwrap()].1
    }

    /// One step, before which game logic moves the lift, stops the paddle and wakes the pile.
    pub fn step(&mut self, number: usize) {
        if number < 150 {
            let height = 0.2 * (number as f32 / 20.0).sin();
            let lift = self.entity(LIFT);
            let mut lift = self.sim.world().get_mut::<Transform>(lift).unwrap();
            lift.translation.y = height;
        }
        if number == 200 {
            self.sim.set(self.entity(PADDLE), AngularVelocity(Vec3::ZERO));
        }
        if number == 700 {
            let push = ExternalForces {
                impulse: Vec3::new(0.05, 0.1, 0.02),
                ..default()
            };
            self.sim.set(self.entity(HAMMER), push);
        }
        self.sim.step(1);
    }

    /// The components of all bodies.
    pub fn bodies(&self) -> Vec<(u64, [Vec3; 3], Quat, bool)> {
        let world = self.sim.app.world();
        let bodies = self.entity_of.iter().filter_map(|&(name, entity)| {
            world.get::<RigidBody>(entity)?;
            let transform = world.get::<Transform>(entity)?;
            let velocities = [self.sim.velocity(entity), self.sim.spin(entity)];
            let vectors = [transform.translation, velocities[0], velocities[1]];
            let asleep = world.get::<Sleeping>(entity)?.0;
            Some((name, vectors, transform.rotation, asleep))
        });
        bodies.collect()
    }

    /// All collisions, in order.
    pub fn hits(&self) -> Vec<Hit> {
        let hits = self.sim.collisions().iter().map(|hit| Hit {
            names: [hit.collider1, hit.collider2, hit.body1, hit.body2].map(|entity| self.name_of[&entity]),
            contact: [hit.contact.point, hit.contact.normal],
            points: hit.points.iter().map(|point| format!("{point:?}")).collect(),
            faces: hit.faces.unwrap().len(),
            impulse: hit.impulse,
        });
        hits.collect()
    }

    /// The names in all messages so far, in order.
    pub fn told(&self) -> [Vec<[u64; 4]>; 2] {
        let names = |entities: [Entity; 4]| entities.map(|entity| self.name_of[&entity]);
        let started = self.sim.started.iter();
        let started = started.map(|it| names([it.collider1, it.collider2, it.body1, it.body2]));
        let ended = self.sim.ended.iter();
        let ended = ended.map(|it| names([it.collider1, it.collider2, it.body1, it.body2]));
        [started.collect(), ended.collect()]
    }

    /// What the compound touches, in order.
    fn touched(&self) -> Vec<u64> {
        let touched = self.sim.get::<CollidingEntities>(self.entity(200));
        touched.iter().map(|entity| self.name_of[entity]).collect()
    }
}

pub fn worlds_with_the_same_keys_stay_equal_to_the_bit() {
    let (hits, slept) = worlds_with_the_same_keys_stay_equal_for(1000);
    assert!(hits > 60 && slept > 30, "{hits} collisions, {slept} asleep");
}

/// Returns the largest numbers of collisions and of bodies asleep.
pub fn worlds_with_the_same_keys_stay_equal_for(steps: usize) -> (usize, usize) {
    let mut worlds = [Order::Plain, Order::Mixed].map(|order| Named::new(order, true));
    assert_ne!(worlds[0].entity_of, worlds[1].entity_of);
    let (mut slept, mut hits) = (0, 0);
    for number in 0..steps {
        for world in &mut worlds {
            world.step(number);
        }
        let [one, other] = &worlds;
        assert_eq!(one.bodies(), other.bodies(), "step {number}");
        assert_eq!(one.hits(), other.hits(), "step {number}");
        assert_eq!(one.told(), other.told(), "step {number}");
        assert_eq!(one.touched(), other.touched(), "step {number}");
        let manifolds = |world: &Named| -> Vec<_> {
            let manifolds = world.sim.collisions().manifolds();
            let named = manifolds.map(|(a, b, points)| (world.name_of[&a], world.name_of[&b], points.to_vec()));
            named.collect()
        };
        assert_eq!(manifolds(one), manifolds(other), "step {number}");
        hits = one.hits().len().max(hits);
        slept = one.sim.report().sleeping.max(slept);
        if number == 705 {
            assert!(one.sim.report().sleeping < slept, "a part of the pile wakes");
        }
    }
    (hits, slept)
}

/// The control: what makes the worlds equal are the keys.
pub fn without_keys_entities_matter() {
    let mut worlds = [Order::Plain, Order::Mixed].map(|order| Named::new(order, false));
    for number in 0..150 {
        for world in &mut worlds {
            world.step(number);
        }
    }
    assert_ne!(worlds[0].bodies(), worlds[1].bodies());
}

/// A collider is found by its entity whatever its key.
pub fn collisions_are_found_by_entities() {
    let mut world = Named::new(Order::Mixed, true);
    for number in 0..100 {
        world.step(number);
    }
    let collisions = world.sim.collisions();
    assert!(collisions.len() > 20);
    for hit in collisions.iter() {
        let found = collisions.get(hit.collider2, hit.collider1).expect("it is there");
        assert_eq!(
            (found.collider1, found.collider2, found.contact.point),
            (hit.collider1, hit.collider2, hit.contact.point)
        );
        assert!(collisions.of(hit.body1).any(|it| it.collider2 == hit.collider2));
    }
}
