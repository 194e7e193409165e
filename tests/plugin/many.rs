//! Hundreds of random steps in which bodies come, go and change.

use crate::app::{Sim, place, sorted};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;
use std::collections::BTreeSet;

struct Random(fastrand::Rng);

impl Random {
    fn vector(&mut self, reach: f32) -> Vec3 {
        Vec3::from_array([0; 3].map(|_| (self.0.f32() * 2.0 - 1.0) * reach))
    }

    fn pose(&mut self) -> Transform {
        let sign = |s: f32| if s < 0.0 { s - 0.3 } else { s + 0.3 };
        Transform {
            translation: self.vector(2.5),
            rotation: Quat::from_scaled_axis(self.vector(3.0)),
            scale: Vec3::from_array(self.vector(1.0).to_array().map(sign)),
        }
    }

    fn kind(&mut self) -> RigidBody {
        [
            RigidBody::Dynamic,
            RigidBody::Dynamic,
            RigidBody::Kinematic,
            RigidBody::Static,
        ][self.0.usize(0..4)]
    }
}

/// What messages have told so far: the pairs that touch.
#[derive(Default)]
struct Told {
    pairs: BTreeSet<[Entity; 2]>,
    starts: usize,
}

impl Told {
    /// Takes the messages of one step, each of which must change something.
    fn take(&mut self, sim: &mut Sim) {
        for CollisionEnd {
            collider1, collider2, ..
        } in sim.ended.drain(..)
        {
            assert!(self.pairs.remove(&[collider1, collider2]), "an end without a start");
        }
        for CollisionStart {
            collider1, collider2, ..
        } in sim.started.drain(..)
        {
            assert!(place(&collider1) < place(&collider2));
            assert!(self.pairs.insert([collider1, collider2]), "a second start");
            self.starts += 1;
        }
    }
}

fn change(sim: &mut Sim, random: &mut Random, bodies: &mut Vec<Entity>, meshes: &[MeshCollider]) {
    let pick = |random: &mut Random, bodies: &[Entity]| bodies[random.0.usize(0..bodies.len())];
    let what = if bodies.len() < 10 { 0 } else { random.0.usize(0..12) };
    match what {
        0..3 => {
            for _ in 0..random.0.usize(1..8) {
                let mesh = meshes[random.0.usize(0..meshes.len())].clone();
                let body = sim.spawn((
                    random.kind(),
                    mesh,
                    random.pose(),
                    LinearVelocity(random.vector(2.0)),
                    AngularVelocity(random.vector(2.0)),
                    Restitution::new(random.0.f32()),
                    CollidingEntities::default(),
                ));
                bodies.push(body);
            }
        }
        3..5 => {
            for _ in 0..random.0.usize(1..8) {
                let body = bodies.swap_remove(random.0.usize(0..bodies.len()));
                sim.world().despawn(body);
            }
        }
        5 => {
            let (body, pose) = (pick(random, bodies), random.pose());
            sim.set(body, pose);
        }
        6 => {
            let (body, kind) = (pick(random, bodies), random.kind());
            sim.set(body, kind);
        }
        7 => {
            let body = pick(random, bodies);
            sim.set(body, Sensor);
        }
        8 => {
            let (body, mesh) = (pick(random, bodies), random.0.usize(0..meshes.len()));
            sim.set(body, meshes[mesh].clone());
        }
        9 => {
            let mesh = match random.0.usize(0..3) {
                0 => shapes::torus_240(),
                1 => shapes::cube(1.0),
                _ => shapes::ring(),
            };
            let id = meshes[random.0.usize(0..meshes.len())].0.id();
            let mut assets = sim.world().resource_mut::<Assets<CollisionMesh>>();
            assets.insert(id, CollisionMesh::new(&mesh)).unwrap();
        }
        10 => {
            let body = pick(random, bodies);
            sim.world().entity_mut(body).remove::<(RigidBody, Sensor)>();
        }
        _ => {
            let (body, broken) = (pick(random, bodies), random.0.bool());
            let scale = if broken { Vec3::ZERO } else { Vec3::ONE };
            sim.world().get_mut::<Transform>(body).unwrap().scale = scale;
        }
    }
}

fn check(sim: &Sim, told: &Told, bodies: &[Entity], planes: &[Entity]) {
    let alive: BTreeSet<Entity> = bodies.iter().copied().collect();
    let touching: BTreeSet<[Entity; 2]> = sim.touching().into_iter().map(|[a, b]| sorted(a, b)).collect();
    assert_eq!(touching.len(), sim.collisions().len());
    assert_eq!(told.pairs, touching, "messages and `Collisions` differ");
    for pair in &told.pairs {
        assert!(
            pair.iter().all(|e| alive.contains(e) || planes.contains(e)),
            "a stale pair"
        );
    }
    for &body in bodies {
        let list = sim.get::<CollidingEntities>(body);
        let others = told.pairs.iter().filter(|p| p.contains(&body));
        let others = others.map(|p| if p[0] == body { p[1] } else { p[0] });
        let mut wanted: Vec<Entity> = others.collect::<BTreeSet<_>>().into_iter().collect();
        wanted.sort_by_key(place);
        assert_eq!(*list, wanted);
    }
    for c in sim.collisions().iter() {
        assert!(c.contact.point.is_finite());
        assert!((c.contact.normal.length() - 1.0).abs() < 1e-4);
        if planes.contains(&c.collider2) {
            assert!(alive.contains(&c.collider1), "the body comes first");
        } else {
            assert_eq!(sorted(c.collider1, c.collider2), [c.collider1, c.collider2]);
        }
    }
}

#[test]
fn five_hundred_steps_of_coming_and_going_leave_no_stale_pair() {
    for seed in [1, 2] {
        let mut random = Random(fastrand::Rng::with_seed(seed));
        let mut sim = Sim::with_threads(2).exact();
        let meshes = [
            sim.mesh(&shapes::torus_240()),
            sim.mesh(&shapes::cube(1.0)),
            sim.mesh(&shapes::ring()),
        ];
        let planes = [Vec3::Y, Vec3::NEG_Y].map(|n| sim.spawn(PlaneCollider::through(n * -3.0, n)));
        let (mut bodies, mut told) = (Vec::new(), Told::default());
        for _ in 0..500 {
            change(&mut sim, &mut random, &mut bodies, &meshes);
            sim.step(1);
            told.take(&mut sim);
            check(&sim, &told, &bodies, &planes);
        }
        assert!(told.starts > 200, "only {} collisions", told.starts);
        for body in bodies.drain(..) {
            sim.world().despawn(body);
        }
        sim.step(1);
        told.take(&mut sim);
        assert!(told.pairs.is_empty());
        check(&sim, &told, &[], &planes);
    }
}
