//! A scene: meshes as the product and as the oracle see them, bodies, half-spaces; and stepping it on either side.

use crate::oracle::body::{self, Mesh, World};
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::TriMesh;
use bevy_faceoff::projection::{BakeSettings, Progress, bake_pool};
use bevy_faceoff::state::{Body, Plane, StepConfig};
use bevy_faceoff::step::StepState;
use bevy_faceoff::step::gpu::GpuStep;
use bevy_faceoff::types::stage::Stage;
use std::sync::Arc;

/// One mesh, for both sides.
#[derive(Clone)]
pub struct Shape {
    pub baked: CollisionMesh,
    pub truth: Arc<Mesh>,
}

impl Shape {
    /// With a face table of so many degrees, drawn with so many pixels, if there is to be one.
    pub fn new(name: &str, mesh: &TriMesh, table: Option<(u32, u32)>) -> Self {
        assert_eq!(mesh.dropped(), 0, "{name}: faces are told by their numbers");
        let baked = match table {
            None => CollisionMesh::new(mesh),
            Some((degrees, image)) => {
                let settings = BakeSettings {
                    faces: true,
                    degrees,
                    image,
                    ..BakeSettings::default()
                };
                CollisionMesh::bake(mesh, settings, bake_pool(), &Progress::default()).expect("nobody cancels")
            }
        };
        let truth = Mesh::new(name, mesh.vertices().to_vec(), mesh.triangles().to_vec());
        Self { baked, truth }
    }
}

/// What a step starts from.
#[derive(Clone, Default)]
pub struct Scene {
    /// By slot.
    pub shapes: Vec<Shape>,
    pub bodies: Vec<Body>,
    pub planes: Vec<Plane>,
    pub config: StepConfig,
}

impl Scene {
    /// A state that has never been stepped.
    pub fn state(&self) -> StepState {
        let mut state = StepState::default();
        for shape in &self.shapes {
            state.input.meshes.add(shape.baked.clone());
        }
        self.fill(&mut state);
        state
    }

    /// Bodies anew into a state that knows the meshes, as a caller does every step.
    pub fn fill(&self, state: &mut StepState) {
        state.input.config = self.config;
        state.input.planes.clone_from(&self.planes);
        state.input.bodies.clear();
        for body in &self.bodies {
            state.input.bodies.push(body, &state.input.meshes).expect("a good body");
        }
    }

    /// Takes the bodies' new poses and velocities.
    pub fn take(&mut self, state: &StepState) {
        for (i, body) in self.bodies.iter_mut().enumerate() {
            body.position = state.input.bodies.position[i];
            body.rotation = state.input.bodies.rotation[i];
            body.linear_velocity = state.input.bodies.linear_velocity[i];
            body.angular_velocity = state.input.bodies.angular_velocity[i];
        }
    }

    /// One step on the CPU.
    pub fn on_cpu(&self) -> StepState {
        let mut state = self.state();
        step_on_cpu(&mut state);
        state
    }

    /// One step on the device.
    pub fn on_gpu(&self, step: &mut GpuStep) -> StepState {
        let mut state = self.state();
        step.run(&mut state).unwrap();
        state
    }

    /// A body's triangles where they truly are.
    pub fn world(&self, i: u32) -> World {
        let body = &self.bodies[i as usize];
        let truth = body::Body {
            mesh: self.shapes[body.mesh as usize].truth.clone(),
            translation: body.position,
            rotation: body.rotation,
            scale: body.scale,
        };
        truth.world()
    }
}

/// All five stages.
pub fn step_on_cpu(state: &mut StepState) {
    for stage in Stage::ALL {
        bevy_faceoff::step::cpu::run(stage, state);
    }
}
