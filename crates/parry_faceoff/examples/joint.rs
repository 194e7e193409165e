//! A knot on a spherical joint swings against another knot: `cargo run --release --example joint`.

use parry_faceoff::bevy_faceoff::{asset::CollisionMesh, geometry::shapes};
use parry_faceoff::parry::math::Vector;
use parry_faceoff::parry::shape::SharedShape;
use parry_faceoff::{ExactDispatcher, ExactMesh};
use rapier3d::prelude::{ColliderBuilder, PhysicsWorld, RigidBodyBuilder, SphericalJointBuilder};

fn main() {
    let mut world = PhysicsWorld::new();
    world.narrow_phase.set_query_dispatcher(ExactDispatcher);
    world.gravity = Vector::new(0.0, -9.81, 0.0);

    let knot = ExactMesh::from_baked(CollisionMesh::new(&shapes::knot_1120())).expect("a valid mesh");
    let knot = SharedShape::new(knot);
    let obstacle = world.insert_body(RigidBodyBuilder::fixed().translation(Vector::new(0.0, 1.0, 0.0)));
    world.insert_collider(ColliderBuilder::new(knot.clone()), Some(obstacle));

    let hook = world.insert_body(RigidBodyBuilder::fixed().translation(Vector::new(0.0, 2.0, 0.0)));
    let swinging = world.insert_body(RigidBodyBuilder::dynamic().translation(Vector::new(1.0, 2.0, 0.0)));
    world.insert_collider(ColliderBuilder::new(knot), Some(swinging));
    let joint = SphericalJointBuilder::new().local_anchor2(Vector::new(-1.0, 0.0, 0.0));
    world.insert_impulse_joint(hook, swinging, joint);

    for step in 1..=180 {
        world.step();
        if step % 15 == 0 {
            let at = world.bodies[swinging].translation();
            let points: usize = world
                .contact_pairs()
                .flat_map(|pair| pair.manifolds())
                .map(|m| m.points.len())
                .sum();
            println!(
                "{:.2} s: the knot is at {at:.2}, with {points} contact points",
                step as f32 / 60.0
            );
        }
    }
}
