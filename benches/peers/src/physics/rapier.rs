//! rapier3d, by default settings but for sleep, the length of a step and where the engine says so, with one of four
//! kinds of shapes.

use super::mass::Mass;
use super::world::{Engine, State, World};
use crate::rapier::vector;
use crate::scene::STEP;
use crate::timing::time;
use bevy::math::{DQuat, DVec3, Vec3};
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::testing::scenes::{BIN_WALL, Body, Scene, Shape};
use parry_faceoff::{ExactDispatcher, ExactMesh};
use rapier3d::math::{Matrix, Pose, Rotation};
use rapier3d::prelude::{
    ColliderBuilder, MassProperties, PhysicsWorld, RigidBodyBuilder, RigidBodyHandle, SharedShape, TriMeshFlags,
};
use std::collections::HashMap;
use std::sync::{LazyLock, Mutex};

/// The scene in rapier.
pub struct Rapier {
    world: PhysicsWorld,
    /// Each with its centre of mass from its origin, in its own axes.
    bodies: Vec<(RigidBodyHandle, DVec3)>,
    lost: usize,
}

impl Rapier {
    /// A world that is ready for its first step. It works on the thread pool of its caller.
    pub fn new(engine: Engine, scene: &Scene) -> Self {
        let mut world = PhysicsWorld::new();
        world.gravity = vector(scene.gravity);
        world.integration_parameters.dt = STEP.as_secs_f32();
        if matches!(engine, Engine::RapierFaceoff | Engine::RapierFaceoffFresh) {
            world.narrow_phase.set_query_dispatcher(ExactDispatcher);
        }
        world.integration_parameters.contact_recycling = engine != Engine::RapierFaceoffFresh;
        let bodies = scene.bodies.iter().map(|body| {
            let kind = if body.fixed {
                RigidBodyBuilder::fixed()
            } else {
                RigidBodyBuilder::dynamic()
            };
            let rotation = Rotation::from_array(body.rotation.to_array());
            let handle = world.insert_body(
                kind.pose(Pose::from_parts(vector(body.position), rotation))
                    .linvel(vector(body.velocity))
                    .angvel(vector(body.spin))
                    .can_sleep(false),
            );
            let mass = Mass::of(body);
            let inertia = Matrix::from_cols_array(&mass.inertia.as_mat3().to_cols_array());
            let mass_properties =
                MassProperties::with_inertia_matrix(vector(mass.center.as_vec3()), mass.mass as f32, inertia);
            let collider = ColliderBuilder::new(shape(engine, body))
                .mass_properties(mass_properties)
                .friction(body.friction.coefficient)
                .restitution(body.restitution);
            world.insert_collider(collider, Some(handle));
            (handle, mass.center)
        });
        let bodies = bodies.collect();
        Self { world, bodies, lost: 0 }
    }
}

impl World for Rapier {
    fn step(&mut self) {
        self.world.step();
        // What was lost is told once only.
        self.lost += self.world.quarantine().bodies().len();
    }

    fn states(&self) -> Vec<State> {
        let wide = |v: [f32; 3]| Vec3::from_array(v).as_dvec3();
        let states = self.bodies.iter().map(|&(handle, center)| {
            let body = &self.world.bodies[handle];
            let rotation = DQuat::from_array(body.rotation().to_array().map(f64::from)).normalize();
            State {
                center: wide(body.translation().to_array()) + rotation * center,
                rotation,
                velocity: wide(body.linvel().to_array()),
                spin: wide(body.angvel().to_array()),
            }
        });
        states.collect()
    }

    fn lost(&self) -> usize {
        self.lost
    }
}

/// Shapes are costly to make, and of few kinds.
type Made = HashMap<(Engine, Shape, [u32; 3]), SharedShape>;

fn shape(engine: Engine, body: &Body) -> SharedShape {
    static MADE: LazyLock<Mutex<Made>> = LazyLock::new(Mutex::default);
    let key = (engine, body.shape, body.scale.to_array().map(f32::to_bits));
    // The lock is not held while shapes are made: that may never end.
    if let Some(made) = MADE.lock().ok().and_then(|made| made.get(&key).cloned()) {
        return made;
    }
    let new = make(engine, body.shape, body.scale);
    if let Ok(mut made) = MADE.lock() {
        made.insert(key, new.clone());
    }
    new
}

fn make(engine: Engine, shape: Shape, scale: Vec3) -> SharedShape {
    let half = 0.5 * scale;
    match (engine, shape) {
        (Engine::Primitives, Shape::Ball) => SharedShape::ball(half.x),
        (Engine::Primitives | Engine::Parts, Shape::Cube) => SharedShape::cuboid(half.x, half.y, half.z),
        (Engine::Primitives | Engine::Parts, Shape::Bin) => bin(scale),
        (Engine::RapierFaceoff | Engine::RapierFaceoffFresh, _) => SharedShape::new(exact(shape.mesh(), scale)),
        _ => {
            let mesh = &shape.mesh().mesh;
            let vertices: Vec<_> = mesh.vertices().iter().map(|&v| vector(v * scale)).collect();
            let triangles = mesh.triangles().to_vec();
            if engine == Engine::Parts {
                let (seconds, parts) = time(|| SharedShape::convex_decomposition(&vertices, &triangles));
                let count = parts.as_compound().map_or(1, |compound| compound.shapes().len());
                eprintln!("{shape:?}: V-HACD makes {count} convex parts in {seconds:.2} s");
                parts
            } else {
                SharedShape::trimesh_with_flags(vertices, triangles, TriMeshFlags::FIX_INTERNAL_EDGES)
                    .expect("a valid mesh")
            }
        }
    }
}

fn exact(mesh: &CollisionMesh, scale: Vec3) -> ExactMesh {
    let mesh = ExactMesh::from_baked(mesh.clone());
    mesh.and_then(|mesh| mesh.scaled(vector(scale))).expect("a valid mesh")
}

/// A floor and four walls.
fn bin(scale: Vec3) -> SharedShape {
    let outer = 0.5 + BIN_WALL;
    let middle = 0.5 + 0.5 * BIN_WALL;
    let boxes = [
        (Vec3::NEG_Y * 0.5 * BIN_WALL, Vec3::new(outer, 0.5 * BIN_WALL, outer)),
        (Vec3::new(middle, 0.5, 0.0), Vec3::new(0.5 * BIN_WALL, 0.5, outer)),
        (Vec3::new(-middle, 0.5, 0.0), Vec3::new(0.5 * BIN_WALL, 0.5, outer)),
        (Vec3::new(0.0, 0.5, middle), Vec3::new(0.5, 0.5, 0.5 * BIN_WALL)),
        (Vec3::new(0.0, 0.5, -middle), Vec3::new(0.5, 0.5, 0.5 * BIN_WALL)),
    ];
    let parts = boxes.map(|(at, half)| {
        let half = half * scale;
        let pose = Pose::from_parts(vector(at * scale), Rotation::IDENTITY);
        (pose, SharedShape::cuboid(half.x, half.y, half.z))
    });
    SharedShape::compound(parts.to_vec())
}
