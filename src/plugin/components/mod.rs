//! What a user spawns and reads.

mod dynamics;

pub use dynamics::*;

use crate::asset::CollisionMesh;
use crate::types::settings::Culling;
use bevy::prelude::*;

/// The shape of a body. Without a [`RigidBody`] beside it the body is static.
#[derive(Component, Reflect, Clone, Debug, PartialEq, Eq)]
#[reflect(Component, Debug, PartialEq)]
#[require(Transform)]
pub struct MeshCollider(pub Handle<CollisionMesh>);

/// A half-space that dynamic bodies bounce off: the points `p` with `normal . p < distance` are solid.
///
/// On an entity of its own, not on a body, if need be with [`Friction`] and [`Restitution`]. Planes are fixed in the world: a `Transform` on the same entity has no effect. They do not look at
/// [`CollisionLayers`]. Touching one is told like touching a body: by [`Collisions`](crate::plugin::collisions::Collisions), messages,
/// events and [`CollidingEntities`].
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Debug, PartialEq)]
pub struct PlaneCollider {
    /// Points out of the solid side; need not have unit length.
    pub normal: Vec3,
    /// Distance of the surface from the origin along the unit normal, in metres.
    pub distance: f32,
}

impl PlaneCollider {
    /// The plane through `point` with the solid side against `normal`.
    pub fn through(point: Vec3, normal: Vec3) -> Self {
        let normal = normal.normalize_or_zero();
        Self {
            normal,
            distance: normal.dot(point),
        }
    }
}

/// A body that reports collisions and is not pushed by them. It touches what it overlaps or has inside, asleep or not, at the
/// beginning of a step. What passes it within one step is seen only if that body, or the sensor if it is the one that moves,
/// has [`ContinuousCollision`], and with [`Response::Contacts`](crate::types::settings::Response).
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Component, Default, Debug, PartialEq)]
pub struct Sensor;

/// Overrules the world's [`Culling`] for this body: which of its triangles take part in tests. The other body of a pair
/// chooses among its own.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Deref, DerefMut)]
#[reflect(Component, Default, Debug, PartialEq)]
pub struct BodyCulling(pub Culling);

/// The entities a body touches, in ascending order; kept up to date where the component is present. They stay for as long as
/// [`EventHysteresis`](crate::plugin::settings::EventHysteresis) says after the last touch.
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq, Eq, Deref)]
#[reflect(Component, Default, Debug, PartialEq)]
pub struct CollidingEntities(pub(crate) Vec<Entity>);

/// Makes [`CollisionStart`](crate::plugin::events::CollisionStart) and [`CollisionEnd`](crate::plugin::events::CollisionEnd) reach
/// observers of this entity; as messages they are always written.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Component, Default, Debug, PartialEq)]
pub struct CollisionEventsEnabled;
