//! What a user can set.

use bevy::prelude::*;

/// Acceleration of every dynamic body in metres per second squared. Default `(0, -9.81, 0)`.
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq, Deref, DerefMut)]
#[reflect(Resource, Default, Debug, PartialEq)]
pub struct Gravity(pub Vec3);

impl Default for Gravity {
    fn default() -> Self {
        Self(Vec3::NEG_Y * 9.81)
    }
}

/// How the triangles of a pair are chosen that are tested against each other.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Resource, Default, Debug, PartialEq)]
#[non_exhaustive]
pub enum Culling {
    /// Conservative culls only: every intersecting pair of faces is found.
    #[default]
    Exact,
}

/// Where the five stages run.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Resource, Default, Debug, PartialEq)]
#[non_exhaustive]
pub enum Backend {
    /// The best backend there is; at present always the CPU.
    #[default]
    Auto,
    /// The CPU, on a thread pool of the plugin's own.
    Cpu,
}

/// What happens to bodies that touch.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Resource, Default, Debug, PartialEq)]
pub enum Response {
    /// Collisions are found and reported, nothing is pushed; bodies still move by their velocities.
    None,
    /// One impulse with [`Restitution`](crate::components::Restitution) per touching pair and step.
    #[default]
    Impulse,
}
