//! What a user spawns and reads.

mod dynamics;

pub use dynamics::*;

use crate::asset::CollisionMesh;
use crate::settings::Culling;
use bevy::prelude::*;

/// How a body moves. Pairs are tested if one of the two is dynamic, or one a [`Sensor`] and one kinematic.
///
/// A body is an entity with a [`MeshCollider`] and a `RigidBody`; its pose is its [`Transform`], taken as a pose in the
/// world (spawn bodies as root entities), scale included.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Component, Default, Debug, PartialEq)]
#[require(Transform, LinearVelocity, AngularVelocity, Sleeping, CenterOfMass)]
pub enum RigidBody {
    /// Moved by forces and collisions.
    #[default]
    Dynamic,
    /// Moved by its velocity alone; pushes dynamic bodies and is never pushed. It turns about its centre of mass, as all bodies
    /// do: give a door that turns about a hinge the [`LinearVelocity`] that its centre has, or set its `Transform` in every step.
    Kinematic,
    /// Does not move by itself.
    Static,
}

/// The shape of a body. Without a [`RigidBody`] beside it the body is static.
#[derive(Component, Reflect, Clone, Debug, PartialEq, Eq)]
#[reflect(Component, Debug, PartialEq)]
#[require(Transform)]
pub struct MeshCollider(pub Handle<CollisionMesh>);

/// A half-space that dynamic bodies bounce off: the points `p` with `normal . p < distance` are solid.
///
/// On an entity of its own, not on a body, if need be with [`Friction`] and [`Restitution`]. Planes are fixed in the world: a `Transform` on the same entity has no effect. They do not look at
/// [`CollisionLayers`]. Touching one is told like touching a body: by [`Collisions`](crate::collisions::Collisions), messages,
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

/// Velocity of the centre of mass in metres per second.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Deref, DerefMut)]
#[reflect(Component, Default, Debug, PartialEq)]
pub struct LinearVelocity(pub Vec3);

/// Angular velocity about the centre of mass in radians per second, as axis times speed, in world axes.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Deref, DerefMut)]
#[reflect(Component, Default, Debug, PartialEq)]
pub struct AngularVelocity(pub Vec3);

/// Which bodies may collide: `a` and `b` do if each is in a layer that the other's filter names.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[reflect(Component, Default, Debug, PartialEq)]
pub struct CollisionLayers {
    /// One bit for each layer the body is in.
    pub memberships: u32,
    /// One bit for each layer it collides with.
    pub filters: u32,
}

impl Default for CollisionLayers {
    fn default() -> Self {
        Self {
            memberships: 1,
            filters: u32::MAX,
        }
    }
}

impl CollisionLayers {
    /// Whether two bodies in these layers collide.
    pub fn interacts_with(self, other: Self) -> bool {
        self.memberships & other.filters != 0 && other.memberships & self.filters != 0
    }
}

/// A body that reports collisions and is not pushed by them. It touches what it overlaps or has inside, asleep or not, at the
/// beginning of a step. What passes it within one step is seen only if that body, or the sensor if it is the one that moves,
/// has [`ContinuousCollision`], and with [`Response::Contacts`](crate::settings::Response).
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Component, Default, Debug, PartialEq)]
pub struct Sensor;

/// Overrules the world's [`Culling`] for this body: which of its triangles take part in tests. The other body of a pair
/// chooses among its own.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Deref, DerefMut)]
#[reflect(Component, Default, Debug, PartialEq)]
pub struct BodyCulling(pub Culling);

/// The entities a body touches, in ascending order; kept up to date where the component is present. They stay for as long as
/// [`EventHysteresis`](crate::settings::EventHysteresis) says after the last touch.
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq, Eq, Deref)]
#[reflect(Component, Default, Debug, PartialEq)]
pub struct CollidingEntities(pub(crate) Vec<Entity>);

/// Makes [`CollisionStart`](crate::events::CollisionStart) and [`CollisionEnd`](crate::events::CollisionEnd) reach
/// observers of this entity; as messages they are always written.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Component, Default, Debug, PartialEq)]
pub struct CollisionEventsEnabled;
