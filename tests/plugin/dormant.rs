//! Bodies asleep near which nothing is awake: a step does nothing for them, and has the bits of one that reads all.

use crate::app::Sim;
use bevy::prelude::*;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::prelude::*;

/// Heaps that fall asleep, and what happens to them.
struct Heaps {
    sim: Sim,
    meshes: Vec<MeshCollider>,
    /// Static tiles, which are the floor.
    tiles: Vec<Entity>,
    bodies: Vec<Entity>,
    /// Whether all is read in every step, so that no body is ever dormant.
    reads_all: bool,
}

impl Heaps {
    fn new(reads_all: bool) -> Self {
        let mut sim = Sim::new();
        sim.world().insert_resource(Gravity::default());
        let flat = |v: &Vec3| *v * Vec3::new(1.0, 0.1, 1.0);
        let cube = shapes::cube(1.0);
        let plate = cube.vertices().iter().map(flat).collect();
        let plate = TriMesh::new(plate, cube.triangles().to_vec()).unwrap();
        let forms = [&cube, &shapes::torus_240(), &plate, &shapes::ball_320()];
        let meshes: Vec<_> = forms.into_iter().map(|form| sim.mesh(form)).collect();
        let tile =
            |i: i32| Transform::from_xyz(4.0 * (i % 6) as f32, -2.0, 4.0 * (i / 6) as f32).with_scale(Vec3::splat(4.0));
        let tiles = (0..36).map(|i| sim.spawn((RigidBody::Static, meshes[0].clone(), tile(i))));
        let tiles = tiles.collect();
        sim.spawn((
            RigidBody::Static,
            meshes[0].clone(),
            Transform::from_xyz(10.0, 1.0, 10.0),
            Sensor,
        ));
        sim.spawn(PlaneCollider {
            normal: Vec3::X,
            distance: -1.9,
        });
        let mut heaps = Self {
            sim,
            meshes,
            tiles,
            bodies: Vec::new(),
            reads_all,
        };
        for i in 0..120 {
            let heap = i / 4;
            let at = Vec3::new(
                3.7 * (heap % 6) as f32 + 0.4,
                0.6 + 0.9 * (i % 4) as f32,
                4.0 * (heap / 6) as f32 + 1.0,
            );
            heaps.throw(i, at, Vec3::ZERO, ());
        }
        heaps
    }

    /// Throws a body of one of the forms.
    fn throw(&mut self, number: usize, at: Vec3, velocity: Vec3, more: impl Bundle) {
        let place = Transform::from_translation(at).with_scale(Vec3::splat(0.4 + 0.05 * (number % 5) as f32));
        let mesh = self.meshes[number % self.meshes.len()].clone();
        let body = (
            RigidBody::Dynamic,
            mesh,
            place,
            LinearVelocity(velocity),
            AngularDamping(6.0),
            more,
        );
        let body = self.sim.spawn(body);
        self.bodies.push(body);
    }

    fn step(&mut self, count: usize) {
        for _ in 0..count {
            if self.reads_all {
                let mut meshes = self.sim.world().resource_mut::<Assets<CollisionMesh>>();
                meshes.set_changed();
            }
            self.sim.step(1);
        }
    }

    /// Poses, velocities, all that touches, and what was told of it.
    fn state(&mut self) -> Vec<String> {
        let report = self.sim.report();
        let counts = [
            report.touching_pairs,
            report.contact_points,
            report.sleeping,
            report.bodies,
        ];
        let substeps = (report.collision_substeps, report.mean_collision_substeps);
        let mut all = vec![format!("{counts:?} {substeps:?}")];
        for &id in &self.bodies {
            let body = self.sim.app.world().entity(id);
            let place = body.get::<Transform>();
            let velocities = (body.get::<LinearVelocity>(), body.get::<AngularVelocity>());
            let others = (body.get::<Sleeping>(), body.get::<CollidingEntities>());
            all.push(format!("{id} {place:?} {velocities:?} {others:?}"));
        }
        let collisions = self.sim.collisions();
        all.extend(collisions.iter().map(|it| format!("{it:?}")));
        for collision in collisions.iter() {
            let [one, other] = [collision.collider1, collision.collider2];
            let found = collisions.get(other, one).map(|it| format!("{it:?}"));
            assert_eq!(found, Some(format!("{collision:?}")));
        }
        all.extend(collisions.manifolds().map(|it| format!("{it:?}")));
        all.extend(self.sim.started.drain(..).map(|it| format!("{it:?}")));
        all.extend(self.sim.ended.drain(..).map(|it| format!("{it:?}")));
        all
    }
}

/// Something that happens to heaps.
type Happening = (&'static str, fn(&mut Heaps));

const HAPPENINGS: &[Happening] = &[
    ("nothing", |_| {}),
    ("a body falls onto a heap", |heaps| {
        heaps.throw(0, Vec3::new(4.1, 4.0, 1.0), Vec3::ZERO, ());
    }),
    ("a ball flies past two heaps", |heaps| {
        heaps.throw(3, Vec3::new(-1.0, 0.8, 1.2), Vec3::new(20.0, 2.0, 0.0), ());
    }),
    ("a plate hits a heap fast", |heaps| {
        heaps.throw(2, Vec3::new(8.0, 0.5, 7.0), Vec3::new(-25.0, 0.0, 3.0), ());
    }),
    ("a bullet hits a heap", |heaps| {
        let velocity = Vec3::new(90.0, 0.0, 80.0);
        heaps.throw(7, Vec3::new(1.0, 0.6, 1.5), velocity, ContinuousCollision);
    }),
    ("a bullet is hit by another", |heaps| {
        heaps.throw(
            11,
            Vec3::new(0.0, 6.0, 9.0),
            Vec3::new(60.0, 0.0, 0.0),
            ContinuousCollision,
        );
        heaps.throw(
            12,
            Vec3::new(9.0, 6.1, 9.0),
            Vec3::new(-60.0, -30.0, 5.0),
            ContinuousCollision,
        );
    }),
    ("a light ball is thrown by heavier ones within a step", |heaps| {
        // From the first to the last its speed grows eightfold, by more than a step reckons with at its beginning.
        for (i, mass) in [1000.0, 50.0, 2.0, 0.1].into_iter().enumerate() {
            let (speed, height) = (if i == 0 { -50.0 } else { 0.0 }, 8.0 - 1.102 * i as f32);
            let more = (Mass(mass), Restitution::new(1.0), GravityScale(0.0));
            heaps.throw(3, Vec3::new(4.1, height, 9.0), Vec3::new(0.0, speed, 0.0), more);
        }
    }),
    ("a sleeper is pushed", |heaps| {
        let body = heaps.bodies[17];
        let push = ExternalForces {
            impulse: 3.0 * Vec3::Y,
            ..default()
        };
        heaps.sim.set(body, push);
    }),
    ("a sleeper is thrown", |heaps| {
        let body = heaps.bodies[40];
        heaps.sim.set(body, LinearVelocity(Vec3::new(4.0, 3.0, 1.0)));
    }),
    ("a sleeper is carried away", |heaps| {
        let body = heaps.bodies[61];
        let at = Transform::from_xyz(5.0, 9.0, 5.0).with_scale(Vec3::splat(0.5));
        heaps.sim.set(body, at);
    }),
    ("a sleeper goes", |heaps| {
        let body = heaps.bodies.remove(33);
        heaps.sim.world().despawn(body);
    }),
    ("two sleepers change places with new ones", |heaps| {
        for at in [20, 70] {
            let body = heaps.bodies.remove(at);
            let place = heaps.sim.position(body);
            heaps.sim.world().despawn(body);
            heaps.throw(at, place, Vec3::ZERO, ());
        }
    }),
    ("a sleeper lists what it touches", |heaps| {
        for at in [5, 6, 7, 90] {
            let body = heaps.bodies[at];
            heaps.sim.set(body, CollidingEntities::default());
        }
    }),
    ("a sleeper grows", |heaps| {
        let body = heaps.bodies[50];
        heaps.sim.world().get_mut::<Transform>(body).unwrap().scale *= 1.3;
    }),
    ("a sleeper becomes static", |heaps| {
        let body = heaps.bodies[77];
        heaps.sim.set(body, RigidBody::Static);
    }),
    ("and is dynamic again", |heaps| {
        let body = heaps.bodies[77];
        heaps.sim.set(body, RigidBody::Dynamic);
    }),
    ("a tile goes", |heaps| {
        let tile = heaps.tiles.pop().unwrap();
        heaps.sim.world().despawn(tile);
    }),
    ("a tile moves", |heaps| {
        let tile = heaps.tiles[14];
        heaps.sim.world().get_mut::<Transform>(tile).unwrap().translation.y -= 0.3;
    }),
    ("a tile is in a heap", |heaps| {
        let tile = heaps.tiles[20];
        let at = Vec3::new(7.8, 0.1, 5.0);
        heaps.sim.world().get_mut::<Transform>(tile).unwrap().translation = at;
    }),
    ("tiles become slippery and bouncy", |heaps| {
        for at in [7, 8, 9] {
            let tile = heaps.tiles[at];
            heaps.sim.set(tile, (Friction::new(0.05), Restitution::new(0.8)));
        }
        heaps.throw(0, Vec3::new(4.6, 3.0, 6.5), Vec3::ZERO, ());
    }),
    ("a tile is a sensor", |heaps| {
        let tile = heaps.tiles[2];
        heaps.sim.set(tile, Sensor);
    }),
    ("a lift comes", |heaps| {
        let plate = heaps.meshes[2].clone();
        let at = Transform::from_xyz(7.0, -0.2, 7.0).with_scale(Vec3::new(3.0, 1.0, 3.0));
        let lift = (RigidBody::Kinematic, plate, at, LinearVelocity(0.3 * Vec3::Y));
        heaps.sim.spawn(lift);
    }),
    ("a second plane comes", |heaps| {
        heaps.sim.spawn(PlaneCollider {
            normal: Vec3::Y,
            distance: 0.1,
        });
    }),
    ("it is colder on the moon", |heaps| {
        heaps.sim.world().insert_resource(Gravity(Vec3::new(0.0, -1.6, 0.0)));
    }),
    ("friction settings change", |heaps| {
        heaps.sim.world().resource_mut::<SolverSettings>().rest_offset *= 0.9;
    }),
    ("a snapshot is taken and restored", |heaps| {
        let snapshot = Snapshot::take(heaps.sim.world());
        heaps.step(3);
        let gone = snapshot.restore(heaps.sim.world());
        assert!(gone.is_empty());
    }),
    ("a sleeper gets a part", |heaps| {
        let body = heaps.bodies[25];
        let part = Transform::from_xyz(0.0, 1.2, 0.0).with_scale(Vec3::splat(0.5));
        let mesh = heaps.meshes[0].clone();
        heaps.sim.spawn((mesh, part, ChildOf(body)));
    }),
    ("a collider is disabled", |heaps| {
        let body = heaps.bodies[30];
        heaps.sim.set(body, ColliderDisabled);
    }),
    ("and enabled", |heaps| {
        let body = heaps.bodies[30];
        heaps.sim.world().entity_mut(body).remove::<ColliderDisabled>();
    }),
    ("a wave of balls", |heaps| {
        for i in 0..20 {
            let at = Vec3::new(1.1 * i as f32, 3.0, 22.0);
            heaps.throw(4 * i + 3, at, Vec3::new(0.0, -4.0, -12.0 - i as f32), ());
        }
    }),
];

fn assert_same([few, all]: [&mut Heaps; 2], when: &str) {
    let [few, all] = [few.state(), all.state()];
    for (one, other) in few.iter().zip(&all) {
        assert_eq!(one, other, "{when}");
    }
    assert_eq!(few.len(), all.len(), "{when}");
}

/// Both worlds are equal after every step.
fn play(steps: usize, rest: usize, order: impl Fn(usize) -> usize) {
    let (mut few, mut all) = (Heaps::new(false), Heaps::new(true));
    for step in 0..rest {
        few.step(1);
        all.step(1);
        if step % 20 == 0 {
            assert_same([&mut few, &mut all], &format!("step {step}"));
        }
    }
    assert!(few.sim.report().dormant > 60, "{:?}", few.sim.report());
    assert_eq!(all.sim.report().dormant, 0);
    let (mut dormant, mut changes) = (0, 0);
    for number in 0..HAPPENINGS.len() {
        let (name, happen) = HAPPENINGS[order(number)];
        happen(&mut few);
        happen(&mut all);
        for step in 0..steps {
            let before = few.sim.report().dormant;
            few.step(1);
            all.step(1);
            assert_same([&mut few, &mut all], &format!("{name}, step {step}"));
            let now = few.sim.report().dormant;
            dormant += now;
            changes += usize::from(before != now);
        }
    }
    // What is compared has dormant bodies most of the time, and others become dormant and are roused.
    let mean = dormant / (steps * HAPPENINGS.len());
    assert!(mean > 40 && changes > 50, "{mean} dormant, {changes} changes");
}

#[test]
fn a_step_has_the_bits_of_one_that_reads_all() {
    play(30, 400, |number| number);
}

#[test]
fn whatever_the_order_of_what_happens() {
    play(30, 400, |number| (7 * number + 3) % HAPPENINGS.len());
}

#[test]
fn a_step_reads_what_is_awake_or_near_to_it() {
    let mut heaps = Heaps::new(false);
    heaps.step(500);
    let total = heaps.bodies.len();
    let report = heaps.sim.report();
    assert_eq!(
        (report.colliders_read, report.dormant, report.sleeping),
        (0, total, total)
    );
    assert!(report.touching_pairs > 100 && report.contact_points > 400, "{report:?}");
    heaps.throw(0, Vec3::new(4.1, 9.0, 1.0), Vec3::ZERO, ());
    heaps.step(5);
    assert_eq!(heaps.sim.report().colliders_read, 1);
    // It falls onto one heap of four.
    for _ in 0..200 {
        heaps.step(1);
        let read = heaps.sim.report().colliders_read;
        assert!(read <= 12, "{read}");
    }
    // Bodies at rest are never marked as changed.
    heaps.step(200);
    let tick = heaps.sim.world().change_tick();
    heaps.step(3);
    let world = heaps.sim.world();
    let now = world.change_tick();
    let mut all = world.query::<(Ref<Transform>, Ref<LinearVelocity>)>();
    let mut written = all.iter(world).filter(|(transform, velocity)| {
        let is_new = |last: bevy::ecs::change_detection::Tick| last.is_newer_than(tick, now);
        is_new(transform.last_changed()) || is_new(velocity.last_changed())
    });
    assert_eq!(written.next().map(|_| ()), None);
}

#[test]
fn a_fast_body_between_sleepers_makes_steps_read_only_those_it_may_reach() {
    let mut sim = Sim::new();
    sim.world().insert_resource(Gravity::default());
    sim.spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y));
    let cube = sim.mesh(&shapes::cube(1.0));
    let ball = sim.mesh(&shapes::ball(0.25, 2));
    for i in 0..256 {
        let place = Transform::from_xyz(2.0 * (i % 16) as f32, 0.5005, 2.0 * (i / 16) as f32);
        sim.spawn((RigidBody::Dynamic, cube.clone(), place));
    }
    sim.step(120);
    assert_eq!(sim.report().dormant, 256);
    let place = Transform::from_xyz(1.0, 0.3, -1.0);
    let rolls = LinearVelocity(Vec3::new(0.0, 0.0, 20.0));
    let ball = sim.spawn((RigidBody::Dynamic, ball, place, rolls));
    for _ in 0..90 {
        sim.step(1);
        let report = sim.report();
        let read = report.colliders_read;
        assert!(read <= 40, "{read}");
    }
    // It has rolled past all of them, divided into collision substeps, and has moved none.
    assert!(sim.app.world().get::<Transform>(ball).unwrap().translation.z > 20.0);
}
