//! bevy_faceoff: contacts between meshes, on the CPU, by default settings but for sleep.

use super::mass::Mass;
use super::world::{State, World};
use crate::scene::STEP;
use bevy_faceoff::state::{Body, BodyParams, StepConfig};
use bevy_faceoff::step::StepState;
use bevy_faceoff::testing::scenes::Scene;
use bevy_faceoff::types::body::RigidBody;
use bevy_faceoff::types::settings::Response;
use bevy_faceoff::types::solver_settings::SolverSettings;
use bevy_faceoff::types::stage::Stage;

/// The stages without an app.
pub struct Faceoff(StepState);

impl Faceoff {
    /// A world that is ready for its first step.
    pub fn new(scene: &Scene) -> Self {
        let mut state = StepState::default();
        state.input.config = StepConfig {
            dt: STEP.as_secs_f32(),
            gravity: scene.gravity,
            response: Response::Contacts,
            solver: SolverSettings {
                sleeping: false,
                ..SolverSettings::default()
            },
            ..StepConfig::default()
        };
        for body in &scene.bodies {
            let mesh = state.input.meshes.add(body.shape.mesh().clone());
            let mass = Mass::of(body);
            let body = Body {
                kind: if body.fixed {
                    RigidBody::Static
                } else {
                    RigidBody::Dynamic
                },
                linear_velocity: body.velocity,
                angular_velocity: body.spin,
                mass: Some(mass.mass as f32),
                inertia: Some(mass.inertia.as_mat3()),
                restitution: body.restitution,
                params: BodyParams {
                    friction: body.friction,
                    ..BodyParams::default()
                },
                ..Body::at_rest(mesh, body.position, body.rotation, body.scale)
            };
            state
                .input
                .bodies
                .push(&body, &state.input.meshes)
                .expect("a usable body");
        }
        Self(state)
    }
}

impl World for Faceoff {
    fn step(&mut self) {
        for stage in Stage::ALL {
            bevy_faceoff::step::cpu::run(stage, &mut self.0);
        }
    }

    fn states(&self) -> Vec<State> {
        let bodies = &self.0.input.bodies;
        let states = (0..bodies.len()).map(|i| State {
            center: bodies.frame[i].center,
            rotation: bodies.rotation[i].as_dquat().normalize(),
            velocity: bodies.linear_velocity[i].as_dvec3(),
            spin: bodies.angular_velocity[i].as_dvec3(),
        });
        states.collect()
    }
}
