//! Scenes of bevy_faceoff in rapier, with exact meshes or with rapier's own.

use bevy_faceoff::testing::scenes::{Body, Scene, Shape};
use parry_faceoff::parry::math::{Pose, Rotation, Vector};
use parry_faceoff::parry::shape::{SharedShape, TriMeshFlags};
use parry_faceoff::{ExactDispatcher, ExactMesh, bevy_faceoff};
#[cfg(feature = "rapier")]
pub use rapier3d as rapier;
#[cfg(not(feature = "rapier"))]
pub use rapier3d_of_bevy_rapier as rapier;

use rapier::prelude::*;
use std::sync::mpsc::{Sender, channel};

/// Steps per second.
pub const HZ: usize = 64;

/// Who finds contacts between meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contacts {
    Exact,
    /// rapier, with the flags it recommends.
    Stock,
}

/// A scene in rapier.
pub struct Moved {
    pub world: PhysicsWorld,
    /// In the scene's order.
    pub bodies: Vec<RigidBodyHandle>,
}

pub fn vector(v: glam::Vec3) -> Vector {
    Vector::from_array(v.to_array())
}

/// An empty world with exact contacts.
pub fn world() -> PhysicsWorld {
    let mut world = PhysicsWorld::new();
    world.narrow_phase = NarrowPhase::with_query_dispatcher(ExactDispatcher);
    world.gravity = Vector::new(0.0, -9.81, 0.0);
    world.integration_parameters.dt = 1.0 / HZ as f32;
    world
}

/// A mesh of the scenes, scaled.
pub fn exact(shape: Shape, scale: glam::Vec3) -> ExactMesh {
    let mesh = ExactMesh::from_baked(shape.mesh().clone()).expect("a valid mesh");
    mesh.scaled(vector(scale)).expect("a valid scale")
}

pub fn shape(contacts: Contacts, body: &Body) -> SharedShape {
    let exact = exact(body.shape, body.scale);
    match contacts {
        Contacts::Exact => SharedShape::new(exact),
        Contacts::Stock => {
            let surface = exact.surface();
            let (vertices, triangles) = (surface.vertices().to_vec(), surface.indices().to_vec());
            SharedShape::trimesh_with_flags(vertices, triangles, TriMeshFlags::FIX_INTERNAL_EDGES)
                .expect("a valid mesh")
        }
    }
}

/// Sends the collision events of a step.
#[cfg(feature = "rapier")]
pub fn collector(collisions: Sender<CollisionEvent>) -> ChannelEventCollector {
    ChannelEventCollector::new(collisions, channel().0, channel().0)
}

/// Sends the collision events of a step.
#[cfg(not(feature = "rapier"))]
pub fn collector(collisions: Sender<CollisionEvent>) -> ChannelEventCollector {
    ChannelEventCollector::new(collisions, channel().0)
}

/// What a hook may modify.
#[cfg(feature = "rapier")]
pub fn solver_contacts<'a>(context: &'a mut ContactModificationContext) -> &'a mut Vec<SolverContact> {
    context.rigid_mut().expect("rigid bodies").solver_contacts
}

/// What a hook may modify.
#[cfg(not(feature = "rapier"))]
pub fn solver_contacts<'a>(context: &'a mut ContactModificationContext) -> &'a mut Vec<SolverContact> {
    context.solver_contacts
}

impl Moved {
    pub fn new(contacts: Contacts, scene: &Scene) -> Self {
        let mut world = world();
        world.gravity = vector(scene.gravity);
        let bodies = scene.bodies.iter().map(|body| {
            let kind = if body.fixed {
                RigidBodyBuilder::fixed()
            } else {
                RigidBodyBuilder::dynamic()
            };
            let rotation = Rotation::from_array(body.rotation.to_array());
            let new = kind
                .pose(Pose::from_parts(vector(body.position), rotation))
                .linvel(vector(body.velocity))
                .angvel(vector(body.spin))
                .can_sleep(false);
            let handle = world.insert_body(new);
            let collider = ColliderBuilder::new(shape(contacts, body))
                .density(body.density)
                .friction(body.friction.coefficient)
                .restitution(body.restitution);
            world.insert_collider(collider, Some(handle));
            handle
        });
        let bodies = bodies.collect();
        Self { world, bodies }
    }

    pub fn step(&mut self, steps: usize) {
        for _ in 0..steps {
            self.world.step();
        }
    }

    pub fn position(&self, body: usize) -> glam::Vec3 {
        glam::Vec3::from_array(self.world.bodies[self.bodies[body]].translation().to_array())
    }

    pub fn rotation(&self, body: usize) -> glam::Quat {
        glam::Quat::from_array(self.world.bodies[self.bodies[body]].rotation().to_array())
    }

    pub fn velocity(&self, body: usize) -> glam::Vec3 {
        glam::Vec3::from_array(self.world.bodies[self.bodies[body]].linvel().to_array())
    }
}
