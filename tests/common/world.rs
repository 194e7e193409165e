//! A world of bodies and planes that advances by whole steps.

use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::TriMesh;
#[cfg(feature = "gpu")]
use bevy_faceoff::state::StepInput;
use bevy_faceoff::state::{Body, BodyParams, StepConfig};
use bevy_faceoff::step::StepState;
use bevy_faceoff::testing::scenes::{self, Scene};
use bevy_faceoff::types::body::RigidBody;
use bevy_faceoff::types::settings::Response;
use bevy_faceoff::types::solver_settings::SolverSettings;
use bevy_faceoff::types::stage::Stage;
use glam::{DVec3, Quat, Vec3};
use std::collections::HashMap;

/// The device on which worlds run in turn, if they do not run on the CPU.
#[cfg(feature = "gpu")]
pub static DEVICE: std::sync::Mutex<Option<bevy_faceoff::step::gpu::GpuStep>> = std::sync::Mutex::new(None);

pub struct World {
    pub state: StepState,
    /// Whether it runs on the CPU even if there is a device.
    #[cfg(feature = "gpu")]
    pub on_cpu: bool,
}

impl World {
    /// A world with gravity, without sleep.
    pub fn new() -> Self {
        let mut state = StepState::default();
        state.input.config = StepConfig {
            gravity: Vec3::NEG_Y * 9.81,
            response: Response::Contacts,
            solver: SolverSettings {
                sleeping: false,
                ..SolverSettings::default()
            },
            ..state.input.config
        };
        #[cfg(feature = "gpu")]
        if let Some(device) = DEVICE.lock().unwrap().as_mut() {
            device.forget();
        }
        Self {
            state,
            #[cfg(feature = "gpu")]
            on_cpu: false,
        }
    }

    /// A world with the gravity and the bodies of a scene.
    pub fn of(scene: &Scene) -> Self {
        let mut world = Self::new();
        world.state.input.config.gravity = scene.gravity;
        let mut slots = HashMap::new();
        for body in &scene.bodies {
            let mut add = || world.state.input.meshes.add(body.shape.mesh().clone());
            let mesh = *slots.entry(body.shape).or_insert_with(&mut add);
            world.put(&Body {
                kind: if body.fixed {
                    RigidBody::Static
                } else {
                    RigidBody::Dynamic
                },
                linear_velocity: body.velocity,
                angular_velocity: body.spin,
                restitution: body.restitution,
                density: body.density,
                params: BodyParams {
                    friction: body.friction,
                    ..BodyParams::default()
                },
                ..Body::at_rest(mesh, body.position, body.rotation, body.scale)
            });
        }
        world
    }

    /// A world without gravity.
    pub fn weightless() -> Self {
        let mut world = Self::new();
        world.state.input.config.gravity = Vec3::ZERO;
        world
    }

    pub fn mesh(&mut self, mesh: &TriMesh) -> u32 {
        self.state.input.meshes.add(CollisionMesh::new(mesh))
    }

    pub fn add(&mut self, kind: RigidBody, mesh: u32, scale: Vec3, position: Vec3, rotation: Quat) -> usize {
        self.put(&Body {
            kind,
            ..Body::at_rest(mesh, position, rotation, scale)
        })
    }

    pub fn put(&mut self, body: &Body) -> usize {
        self.state.input.bodies.push(body, &self.state.input.meshes).unwrap();
        self.state.input.bodies.len() - 1
    }

    pub fn step(&mut self) {
        #[cfg(feature = "gpu")]
        if let Some(device) = DEVICE.lock().unwrap().as_mut().filter(|_| !self.on_cpu) {
            device.run(&mut self.state).unwrap();
            self.place_frames();
            return;
        }
        for stage in Stage::ALL {
            bevy_faceoff::step::cpu::run(stage, &mut self.state);
        }
    }

    /// Updates the double-precision poses from the single-precision ones, as the plugin does between steps.
    #[cfg(feature = "gpu")]
    pub fn place_frames(&mut self) {
        let StepInput { bodies, meshes, .. } = &mut self.state.input;
        for i in 0..bodies.len() {
            let arm = (bodies.scale[i] * meshes[bodies.mesh[i]].mesh.mass.center).as_dvec3();
            let frame = &mut bodies.frame[i];
            frame.rotation = glam::DMat3::from_quat(bodies.rotation[i].as_dquat().normalize());
            frame.position = bodies.position[i].as_dvec3();
            frame.center = frame.position + frame.rotation * arm;
            bodies.center[i] = frame.center.as_vec3();
        }
    }

    pub fn center(&self, i: usize) -> DVec3 {
        self.state.input.bodies.frame[i].center
    }

    pub fn velocity(&self, i: usize) -> Vec3 {
        self.state.input.bodies.linear_velocity[i]
    }

    pub fn deepest(&self) -> f32 {
        -self
            .state
            .results
            .manifolds
            .points
            .iter()
            .map(|p| p.separation)
            .fold(0.0, f32::min)
    }

    pub fn fastest(&self) -> f32 {
        let velocities = self.state.input.bodies.linear_velocity.iter();
        velocities.map(|v| v.length()).fold(0.0, f32::max)
    }

    pub fn seconds(&mut self, count: u32) {
        for _ in 0..64 * count {
            self.step();
        }
    }

    /// A static box whose top is at 0.
    pub fn floor(&mut self, cube: u32) {
        self.add(
            RigidBody::Static,
            cube,
            Vec3::new(40.0, 1.0, 40.0),
            Vec3::NEG_Y * 0.5,
            Quat::IDENTITY,
        );
    }
}

/// A uniformly distributed rotation.
pub fn any_turn(random: &mut fastrand::Rng) -> Quat {
    scenes::any_turn(&mut || random.f32())
}

/// The gap that a resting cube of edge 1 keeps.
pub const GAP: f32 = 0.000866;
