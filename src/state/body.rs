//! A body as a caller describes it, before the step derives anything.

use crate::types::body::{CollisionLayers, ExternalForces, LockedAxes, RigidBody};
use crate::types::material::{CombineRule, Friction};
use crate::types::settings::Culling;
use glam::{Mat3, Quat, Vec3};

/// What a caller knows about a body; [`Bodies::push`] derives the rest.
#[derive(Clone, Copy, Debug)]
pub struct Body {
    /// Slot in the [`MeshArena`].
    pub mesh: u32,
    /// How the body moves.
    pub kind: RigidBody,
    /// Where the mesh's origin lies.
    pub position: Vec3,
    /// Need not have unit length, but must not be zero.
    pub rotation: Quat,
    /// Scale along the mesh's own axes.
    pub scale: Vec3,
    /// m/s.
    pub linear_velocity: Vec3,
    /// rad/s.
    pub angular_velocity: Vec3,
    /// Kilograms; `None` for what follows from the density.
    pub mass: Option<f32>,
    /// Kilograms per cubic metre.
    pub density: f32,
    /// Inertia tensor about the centre of mass in the body's own axes, kg m^2; `None` for what follows from mass and shape.
    pub inertia: Option<Mat3>,
    /// 0 to 1.
    pub restitution: f32,
    /// Factor on gravity.
    pub gravity_scale: f32,
    /// Who collides with whom.
    pub layers: CollisionLayers,
    /// Whether the body only reports.
    pub sensor: bool,
    /// Which of its triangles take part in tests.
    pub culling: Culling,
    /// How it answers.
    pub params: BodyParams,
}

/// How a body answers contacts and forces, with [`Response::Contacts`]. The components of these names say what each means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyParams {
    /// Coulomb's coefficient, and the rule for pairs.
    pub friction: Friction,
    /// The rule for pairs of the body's restitution.
    pub restitution_combine: CombineRule,
    /// 1/s.
    pub linear_damping: f32,
    /// 1/s.
    pub angular_damping: f32,
    /// m/s.
    pub max_linear_speed: f32,
    /// rad/s.
    pub max_angular_speed: f32,
    /// Where it does not move.
    pub locked_axes: LockedAxes,
    /// What acts on it. Impulses act in the step that begins.
    pub forces: ExternalForces,
    /// Whether it may fall asleep.
    pub can_sleep: bool,
    /// Whether it is to be awake at the beginning of the step.
    pub woken: bool,
    /// Whether it is stopped by what it meets within a step, and carried by it for the rest.
    pub continuous: bool,
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
        }
    }
}

/// Where a body is and how it moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Where the mesh's origin lies.
    pub position: Vec3,
    /// Unit quaternion.
    pub rotation: Quat,
    /// Velocity of the centre of mass, m/s.
    pub linear_velocity: Vec3,
    /// World axes, rad/s.
    pub angular_velocity: Vec3,
}

impl Body {
    /// A body that no one moves, at `position`.
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

    /// Where it is and how it moves.
    pub fn motion(&self) -> Motion {
        Motion {
            position: self.position,
            rotation: self.rotation,
            linear_velocity: self.linear_velocity,
            angular_velocity: self.angular_velocity,
        }
    }
}
