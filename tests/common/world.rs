//! A world of bodies and planes that advances by whole steps.

use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::TriMesh;
#[cfg(feature = "gpu")]
use bevy_faceoff::gpu::device::Gpu;
#[cfg(feature = "gpu")]
use bevy_faceoff::state::StepInput;
use bevy_faceoff::state::{Body, BodyParams, StepConfig};
use bevy_faceoff::step::StepState;
#[cfg(feature = "gpu")]
use bevy_faceoff::step::gpu::GpuStep;
use bevy_faceoff::testing::scenes::{self, Scene};
use bevy_faceoff::types::body::RigidBody;
use bevy_faceoff::types::settings::Response;
use bevy_faceoff::types::solver_settings::SolverSettings;
use bevy_faceoff::types::stage::Stage;
use glam::{DVec3, Quat, Vec3};
#[cfg(feature = "gpu")]
use std::cell::RefCell;
use std::collections::HashMap;

#[cfg(feature = "gpu")]
thread_local! {
    /// The device of the worlds that this thread makes. Without one they run on the CPU.
    static GPU: RefCell<Option<Gpu>> = const { RefCell::new(None) };
}

/// Runs a test whose worlds run on this device.
#[cfg(feature = "gpu")]
#[allow(dead_code, reason = "the tests on a device call it")]
pub fn on_device(gpu: &Gpu, test: impl FnOnce()) {
    GPU.set(Some(gpu.clone()));
    test();
    GPU.set(None);
}

pub struct World {
    pub state: StepState,
    /// The stages on a device. Without them it runs on the CPU.
    #[cfg(feature = "gpu")]
    pub device: Option<GpuStep>,
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
        Self {
            state,
            #[cfg(feature = "gpu")]
            device: GPU.with_borrow(|gpu| gpu.clone().map(|gpu| GpuStep::new(gpu).unwrap())),
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
        if let Some(device) = &mut self.device {
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
        for i in (0..bodies.len()).filter(|&i| bodies.parts.iter().all(|part| part.collider != i as u32)) {
            let arm = (bodies.scale[i] * meshes[bodies.mesh[i]].mesh.mass.center).as_dvec3();
            let frame = &mut bodies.frame[i];
            frame.rotation = glam::DMat3::from_quat(bodies.rotation[i].as_dquat().normalize());
            frame.position = bodies.position[i].as_dvec3();
            frame.center = frame.position + frame.rotation * arm;
            frame.body_center = frame.center;
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
