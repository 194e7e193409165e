//! rapier3d: whole steps.

use crate::engine::{Contacts, Engine, THREADS};
use crate::scene::{STEP, Scene};
use crate::timing::time;
use bevy::math::Vec3;
use parry_faceoff::{ExactDispatcher, ExactMesh};
use rapier3d::math::{Pose, Rotation, Vector};
use rapier3d::prelude::{ColliderBuilder, ColliderHandle, PhysicsWorld, RigidBodyBuilder, SharedShape};
use std::collections::HashMap;

/// The scene in rapier with default settings, except those of the scene: no gravity, no friction, elastic bodies that
/// never sleep, and the same step length.
pub struct Rapier {
    world: PhysicsWorld,
    indices: HashMap<ColliderHandle, u32>,
}

impl Rapier {
    /// A world that is ready for its first step.
    pub fn new(scene: &Scene, contacts: Contacts) -> Self {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        world.integration_parameters.dt = STEP.as_secs_f32();
        world.configure_thread_pool(THREADS).expect("threads to work on");
        if contacts == Contacts::Exact {
            world.narrow_phase.set_query_dispatcher(ExactDispatcher);
        }
        let exact = ExactMesh::from_baked(scene.mesh.clone()).expect("a valid mesh");
        let mut indices = HashMap::new();
        for (body, index) in scene.bodies.iter().zip(0..) {
            let shape = match contacts {
                Contacts::Own => {
                    let (vertices, triangles) = scene.scaled_mesh(body);
                    SharedShape::trimesh(vertices.map(vector).collect(), triangles).expect("a valid mesh")
                }
                Contacts::Exact => SharedShape::new(exact.scaled(vector(body.pose.scale)).expect("a valid mesh")),
            };
            let rotation = Rotation::from_array(body.pose.rotation.to_array());
            let handle = world.insert_body(
                RigidBodyBuilder::dynamic()
                    .pose(Pose::from_parts(vector(body.pose.translation), rotation))
                    .linvel(vector(body.velocity))
                    .can_sleep(false),
            );
            let collider = world.insert_collider(
                ColliderBuilder::new(shape).friction(0.0).restitution(scene.restitution),
                Some(handle),
            );
            indices.insert(collider, index);
        }
        for (center, size) in scene.walls() {
            let wall = ColliderBuilder::cuboid(size.x, size.y, size.z).translation(vector(center));
            world.insert_collider(wall.friction(0.0).restitution(scene.restitution), None);
        }
        Self { world, indices }
    }
}

impl Engine for Rapier {
    fn step(&mut self) -> f64 {
        time(|| self.world.step()).0
    }

    /// The pairs with contacts that rapier's solver uses, including separated ones within its prediction distance.
    fn touching(&mut self) -> Vec<[u32; 2]> {
        let pairs = self.world.contact_pairs().filter(|pair| pair.has_any_active_contact());
        pairs
            .filter_map(|pair| Some([*self.indices.get(&pair.collider1)?, *self.indices.get(&pair.collider2)?]))
            .collect()
    }
}

/// Converts a vector to rapier's type.
pub fn vector(v: Vec3) -> Vector {
    Vector::from(v.to_array())
}
