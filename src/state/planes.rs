//! Planes that are solid on one side.

use crate::types::body::{CollisionLayers, RigidBody};
use crate::types::hooks::ActiveCollisionHooks;
use crate::types::material::{CombineRule, Friction};
use glam::Vec3;

/// A plane: the points `p` with `normal . p < distance` are solid.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Plane {
    /// Unit vector out of the solid side.
    pub normal: Vec3,
    /// Signed distance of the surface from the origin, metres.
    pub distance: f32,
    /// Coefficient of restitution, 0 to 1.
    pub restitution: f32,
    /// Combine rule of the restitution.
    pub restitution_combine: CombineRule,
    /// Coulomb friction coefficient and its combine rule.
    pub friction: Friction,
    /// Whether the plane detects bodies inside without pushing them out.
    pub sensor: bool,
    /// Collision filter.
    pub layers: CollisionLayers,
    /// Which hooks are called for pairs with the plane.
    pub hooks: ActiveCollisionHooks,
}

impl Default for Plane {
    /// The ground at height 0.
    fn default() -> Self {
        Self {
            normal: Vec3::Y,
            distance: 0.0,
            restitution: 0.0,
            restitution_combine: CombineRule::default(),
            friction: Friction::default(),
            sensor: false,
            layers: CollisionLayers::default(),
            hooks: ActiveCollisionHooks::NONE,
        }
    }
}

impl Plane {
    /// Whether the plane detects bodies of this kind with these layers: a sensor detects all that move, a solid plane
    /// dynamic ones.
    pub(crate) fn detects(&self, kind: RigidBody, layers: CollisionLayers) -> bool {
        let is_detected = match kind {
            RigidBody::Dynamic => true,
            RigidBody::Kinematic => self.sensor,
            RigidBody::Static => false,
        };
        is_detected && layers.interacts_with(self.layers)
    }
}
