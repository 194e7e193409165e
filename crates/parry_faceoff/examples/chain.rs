//! A chain of linked rings hangs from a fixed one: `cargo run --release --example chain`.

use parry_faceoff::bevy_faceoff::{asset::CollisionMesh, geometry::shapes};
use parry_faceoff::parry::math::Vector;
use parry_faceoff::parry::shape::SharedShape;
use parry_faceoff::{ExactDispatcher, ExactMesh};
use rapier3d::prelude::{ColliderBuilder, PhysicsWorld, RigidBodyBuilder};

const RINGS: usize = 10;

fn main() {
    let mut world = PhysicsWorld::new();
    world.narrow_phase.set_query_dispatcher(ExactDispatcher);
    world.gravity = Vector::new(0.0, -9.81, 0.0);

    // Rings about z, 0.88 m wide with a tube of 0.12 m.
    let ring = ExactMesh::from_baked(CollisionMesh::new(&shapes::ring())).expect("a valid mesh");
    let ring = SharedShape::new(ring);
    let mut bodies = Vec::new();
    for i in 0..RINGS {
        let kind = if i == 0 {
            RigidBodyBuilder::fixed()
        } else {
            RigidBodyBuilder::dynamic()
        };
        let quarter = std::f32::consts::FRAC_PI_2 * (i % 2) as f32;
        let body = kind
            .translation(Vector::new(0.0, -0.74 * i as f32, 0.0))
            .rotation(Vector::new(0.0, quarter, 0.0));
        let body = world.insert_body(body);
        world.insert_collider(ColliderBuilder::new(ring.clone()), Some(body));
        bodies.push(body);
    }

    for second in 1..=10 {
        for _ in 0..60 {
            world.step();
        }
        let [first, last] = [bodies[0], bodies[RINGS - 1]].map(|body| world.bodies[body].translation());
        println!("{second} s: the chain is {:.3} m long", first.distance(last));
    }
}
