//! Components of bodies and planes. Those that the core shares are in [`types`](crate::types).
//!
//! All of them can be written in `bsn!`, and saved in scenes: see [`guide::scenes`](crate::guide::scenes).

mod dynamics;

pub use dynamics::*;

use crate::asset::CollisionMesh;
use crate::types::settings::Culling;
use bevy::prelude::*;
use serde::{Deserialize, Serialize};

/// A shape: part of the body of the nearest [`RigidBody`](crate::types::body::RigidBody) on its entity or above it.
/// Without one it is static.
///
/// The handle refers to a file (`assets.load("knot.bake.ron")`), or to a mesh made by the program
/// (`meshes.add(CollisionMesh::new(&mesh))`). The body takes part as soon as the mesh is loaded; until then it stands
/// still. All bodies of a shape share one handle, at any scale.
///
/// It is not drawn. Give the entity a `Mesh3d` too: a mesh of your own, or, with the feature `bevy_mesh`, the triangles
/// that collide: `CollisionMesh::to_bevy_mesh`.
///
/// [`Density`], [`Friction`](crate::types::material::Friction), [`Restitution`](crate::types::material::Restitution),
/// [`CollisionLayers`](crate::types::body::CollisionLayers) and [`BodyCulling`] of a collider are on its entity, or
/// else on its body.
#[derive(Component, Reflect, FromTemplate, Clone, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Default, Debug, PartialEq)]
#[require(Transform)]
pub struct MeshCollider(pub Handle<CollisionMesh>);

/// Marks an entity that gets a [`MeshCollider`] later, on itself or below. Until then a body without colliders is not
/// reported.
#[derive(Component, Clone, Copy, Debug, Default)]
pub(crate) struct ColliderToCome;

/// An infinite plane that is solid on one side, also called a half-space: the points `p` with `normal . p < distance`
/// are solid, in the coordinates of its entity. Dynamic bodies collide with it.
///
/// It follows the `Transform` of its entity and of the entities above. A plane that is moved pushes bodies out of
/// itself, but it has no velocity: it does not carry them along. A lift or a piston is a kinematic body with a mesh.
///
/// Spawn it on an entity of its own. It is never part of a body. It requires a `Transform` so that editors and saved
/// scenes can move it. It may have [`Friction`](crate::types::material::Friction) and
/// [`Restitution`](crate::types::material::Restitution), and obeys
/// [`CollisionLayers`](crate::types::body::CollisionLayers) and [`ColliderDisabled`]. With [`Sensor`] it is not solid,
/// and detects the dynamic and kinematic bodies below it: the surface of a lake, or a depth that no player survives.
/// Collisions with planes are reported like those with bodies: by
/// [`Collisions`](crate::plugin::collisions::Collisions), messages, events and [`CollidingEntities`].
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)]
#[require(Transform)]
#[serde(default, deny_unknown_fields)]
pub struct PlaneCollider {
    /// Points away from the solid side. It need not have unit length.
    pub normal: Vec3,
    /// Signed distance of the surface from the entity's origin along the unit normal, in metres.
    pub distance: f32,
}

impl Default for PlaneCollider {
    /// The ground: y = 0, pointing up.
    fn default() -> Self {
        Self::through(Vec3::ZERO, Vec3::Y)
    }
}

impl PlaneCollider {
    /// The plane through `point`. The solid side is opposite to `normal`.
    pub fn through(point: Vec3, normal: Vec3) -> Self {
        let normal = normal.normalize_or_zero();
        Self {
            normal,
            distance: normal.dot(point),
        }
    }
}

/// A number that stands for the same collider or plane in every run of a program, whatever its entity is.
///
/// Colliders and planes are processed in the order of their keys; those without a key follow in the order of entities.
/// So two worlds whose bodies have the same keys give the same results to the bit, whatever was spawned and despawned
/// in between; and a [`Snapshot`](crate::plugin::snapshot::Snapshot) of one continues in the other. Give one to every
/// collider and plane, or to none.
///
/// Each collider and plane needs a key of its own. The numbers that a network or a saved game uses are suitable. A
/// collider on a child has the key of its body if it has none, which is enough for a body with one collider. A key that
/// appears twice causes a warning in the log, and then counts only for the collider with the smaller entity. The
/// highest bit of a key does not count.
///
/// A collider whose key changes is a new one to the step: it wakes, and its collisions end and start.
#[derive(
    Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
#[reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)]
pub struct StableKey(pub u64);

/// Makes a collider report collisions without pushing or being pushed. It has no mass, unless its body has no other
/// colliders than sensors.
///
/// A sensor touches the bodies that it overlaps or contains at the beginning of a step, asleep or not. It detects a
/// body that passes within one step only with [`Response::Contacts`](crate::types::settings::Response::Contacts), and
/// only if the faster one of the two has [`ContinuousCollision`].
///
/// At least one of the two must be dynamic or kinematic. So a static sensor detects dynamic and kinematic bodies, also
/// the door that it opens, but no static colliders. A dynamic or kinematic sensor detects static colliders too. Ask who
/// came:
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_faceoff::prelude::*;
/// #[derive(Component)]
/// struct Player;
///
/// fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
///     let area = (
///         Sensor,
///         CollisionEventsEnabled,
///         MeshCollider(assets.load("cube.bake.ron")),
///         Transform::from_scale(Vec3::new(4.0, 2.0, 2.0)),
///     );
///     // In its events, `collider1` and `body1` are the sensor, and `body2` is the body that entered.
///     commands.spawn(area).observe(|start: On<CollisionStart>, players: Query<&Player>| {
///         if players.contains(start.body2) {
///             info!("the door opens");
///         }
///     });
/// }
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sensor;

/// Takes a collider or plane out of the world until it is removed: it touches nothing, has no mass, and no query finds
/// it. So does Bevy's `Disabled`.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)]
pub struct ColliderDisabled;

/// Takes a body and its colliders out of the world until it is removed: the body does not move and touches nothing. So
/// does Bevy's `Disabled`.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)]
pub struct RigidBodyDisabled;

/// Places a kinematic body at its `Transform` in the next step, without the velocity of the move
/// ([`RigidBody::Kinematic`](crate::types::body::RigidBody::Kinematic)). The step removes it.
///
/// A dynamic body whose `Transform` is written is always placed. With interpolation this component shows it at its new
/// place at once, instead of on its way there.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)]
pub struct Teleport;

/// The velocity of a kinematic body that its `Transform` moved in the last step
/// ([`RigidBody::Kinematic`](crate::types::body::RigidBody::Kinematic)). The step writes it, here and to
/// [`LinearVelocity`](crate::types::body::LinearVelocity) and [`AngularVelocity`](crate::types::body::AngularVelocity).
/// Where these still hold it, they do not move the body: only other values come from the game. It is saved in scenes
/// with them.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)]
pub struct DrivenVelocity {
    /// In m/s, of the centre of mass.
    pub linear: Vec3,
    /// In rad/s, in world axes.
    pub angular: Vec3,
}

/// Overrides the resource [`Culling`] for this body. It chooses which triangles of this body are tested. The mode of
/// the other body of a pair chooses among the triangles of that other body.
#[derive(
    Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Deref, DerefMut, Serialize, Deserialize,
)]
#[reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)]
pub struct BodyCulling(pub Culling);

/// The colliders and planes that a collider touches, in the order of [`StableKey`], then of spawning; on a body, all
/// that any of its colliders touches. Add it to a collider, body or plane, and the step keeps it up to date. An entity
/// stays in the list for the time of [`EventHysteresis`](crate::plugin::settings::EventHysteresis) after the last
/// touch.
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq, Eq, Deref)]
#[reflect(Component, Default, Debug, PartialEq)]
pub struct CollidingEntities(
    #[entities]
    #[reflect(skip_serializing)]
    pub(crate) Vec<Entity>,
);

/// Triggers [`CollisionStart`](crate::plugin::events::CollisionStart) and
/// [`CollisionEnd`](crate::plugin::events::CollisionEnd) as events on this collider, body or plane, for observers. As
/// messages they are always written.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)]
pub struct CollisionEventsEnabled;
