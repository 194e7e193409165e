//! A body as the caller describes it: the input of [`Bodies::push`](super::bodies::Bodies::push).

use crate::types::body::{CollisionLayers, ExternalForces, LockedAxes, RigidBody};
use crate::types::hooks::ActiveCollisionHooks;
use crate::types::material::{CombineRule, Friction};
use crate::types::settings::Culling;
use glam::{Mat3, Quat, Vec3};

/// One body; [`Bodies::push`](super::bodies::Bodies::push) validates it and derives the rest.
#[derive(Clone, Copy, Debug)]
pub struct Body {
    /// Slot in the [`MeshArena`](super::mesh_arena::MeshArena).
    pub mesh: u32,
    /// Dynamic, kinematic or static.
    pub kind: RigidBody,
    /// Position of the mesh's origin, metres.
    pub position: Vec3,
    /// Quaternion of any length but zero.
    pub rotation: Quat,
    /// Scale along the mesh's own axes.
    pub scale: Vec3,
    /// Velocity of the centre of mass, m/s.
    pub linear_velocity: Vec3,
    /// Angular velocity in world axes, rad/s.
    pub angular_velocity: Vec3,
    /// Kilograms; `None` computes it from the density.
    pub mass: Option<f32>,
    /// Kilograms per cubic metre.
    pub density: f32,
    /// Inertia tensor about the centre of mass in the body's own axes, kg m^2; `None` computes it from mass and shape.
    pub inertia: Option<Mat3>,
    /// Coefficient of restitution, 0 to 1.
    pub restitution: f32,
    /// Factor on gravity.
    pub gravity_scale: f32,
    /// Collision filter.
    pub layers: CollisionLayers,
    /// Whether the body only reports contacts and exchanges no impulses.
    pub sensor: bool,
    /// Which of its triangles are tested.
    pub culling: Culling,
    /// Solver parameters.
    pub params: BodyParams,
}

/// Solver parameters of a body, for [`Response::Contacts`](crate::types::settings::Response::Contacts). Each field
/// means what the component of the same name documents.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyParams {
    /// Coulomb friction coefficient and its combine rule.
    pub friction: Friction,
    /// Combine rule of the restitution.
    pub restitution_combine: CombineRule,
    /// Linear damping, 1/s.
    pub linear_damping: f32,
    /// Angular damping, 1/s.
    pub angular_damping: f32,
    /// Largest speed, m/s.
    pub max_linear_speed: f32,
    /// Largest angular speed, rad/s.
    pub max_angular_speed: f32,
    /// Locked translations and rotations.
    pub locked_axes: LockedAxes,
    /// External forces and torques. Impulses act once, in the coming step.
    pub forces: ExternalForces,
    /// Whether the body may fall asleep.
    pub can_sleep: bool,
    /// Wakes the body at the start of the step.
    pub woken: bool,
    /// Continuous collision detection: the body stops at its first time of impact within a step, and follows the
    /// obstacle for the rest of the step.
    pub continuous: bool,
    /// Which hooks are called for pairs with the collider.
    pub hooks: ActiveCollisionHooks,
    /// Whether the body must be read in every step, also while it sleeps, because its pose depends on other things.
    pub always_read: bool,
}

impl Default for BodyParams {
    fn default() -> Self {
        Self {
            friction: Friction::default(),
            restitution_combine: CombineRule::default(),
            linear_damping: 0.0,
            angular_damping: 0.0,
            max_linear_speed: f32::INFINITY,
            max_angular_speed: f32::INFINITY,
            locked_axes: LockedAxes::NONE,
            forces: ExternalForces::default(),
            can_sleep: true,
            woken: false,
            continuous: false,
            hooks: ActiveCollisionHooks::NONE,
            always_read: false,
        }
    }
}

/// Pose and velocities of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Motion {
    /// Position of the mesh's origin, metres.
    pub position: Vec3,
    /// Unit quaternion.
    pub rotation: Quat,
    /// Velocity of the centre of mass, m/s.
    pub linear_velocity: Vec3,
    /// Angular velocity in world axes, rad/s.
    pub angular_velocity: Vec3,
}

impl Body {
    /// A dynamic body at rest with default parameters.
    pub fn at_rest(mesh: u32, position: Vec3, rotation: Quat, scale: Vec3) -> Self {
        Self {
            mesh,
            kind: RigidBody::Dynamic,
            position,
            rotation,
            scale,
            linear_velocity: Vec3::ZERO,
            angular_velocity: Vec3::ZERO,
            mass: None,
            density: 1.0,
            inertia: None,
            restitution: 0.0,
            gravity_scale: 1.0,
            layers: CollisionLayers::default(),
            sensor: false,
            culling: Culling::Exact,
            params: BodyParams::default(),
        }
    }

    /// Pose and velocities of the body.
    pub fn motion(&self) -> Motion {
        Motion {
            position: self.position,
            rotation: self.rotation,
            linear_velocity: self.linear_velocity,
            angular_velocity: self.angular_velocity,
        }
    }
}
