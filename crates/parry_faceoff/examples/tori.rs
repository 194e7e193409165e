//! Tori fall into a box of rapier's cuboids: `cargo run --release --example tori`.

use parry_faceoff::bevy_faceoff::geometry::shapes;
use parry_faceoff::parry::math::Vector;
use parry_faceoff::parry::shape::SharedShape;
use parry_faceoff::{ExactDispatcher, ExactMesh, bevy_faceoff::asset::CollisionMesh};
use rapier3d::prelude::{ColliderBuilder, PhysicsWorld, RigidBodyBuilder};

fn main() {
    let mut world = PhysicsWorld::new();
    world.narrow_phase.set_query_dispatcher(ExactDispatcher);
    world.gravity = Vector::new(0.0, -9.81, 0.0);
    // The floor and the walls are rapier's own shapes.
    world.insert_collider(
        ColliderBuilder::cuboid(4.0, 0.5, 4.0).translation(Vector::new(0.0, -0.5, 0.0)),
        None,
    );
    for (x, z) in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
        let wall = ColliderBuilder::cuboid(0.5 + 2.0 * f32::abs(z), 10.0, 0.5 + 2.0 * f32::abs(x));
        world.insert_collider(wall.translation(Vector::new(2.0 * x, 10.0, 2.0 * z)), None);
    }

    // All tori share a mesh.
    let torus = CollisionMesh::new(&shapes::torus_240());
    let torus = SharedShape::new(ExactMesh::from_baked(torus).expect("a valid mesh"));
    for i in 0..40 {
        let at = Vector::new(
            0.6 * (i % 3) as f32 - 0.6,
            1.0 + 0.5 * i as f32,
            0.6 * (i / 3 % 3) as f32 - 0.6,
        );
        let turn = Vector::new(i as f32, 0.7 * i as f32, 0.0);
        let body = world.insert_body(RigidBodyBuilder::dynamic().translation(at).rotation(turn));
        world.insert_collider(ColliderBuilder::new(torus.clone()), Some(body));
    }

    for second in 1..=6 {
        for _ in 0..60 {
            world.step();
        }
        let touching = world.contact_pairs().filter(|pair| pair.has_any_active_contact());
        let deepest = world
            .contact_pairs()
            .filter_map(|pair| Some(pair.find_deepest_contact()?.1.dist));
        let deepest = deepest.fold(0.0, f32::min);
        println!(
            "{second} s: {} pairs touch, the deepest overlap is {:.2} mm",
            touching.count(),
            -1e3 * deepest
        );
    }
}
