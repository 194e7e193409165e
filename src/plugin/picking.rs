//! Bevy's pointer events on colliders: [`ColliderPickingPlugin`]. Needs the feature `bevy_picking`.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_faceoff::plugin::picking::ColliderPickingPlugin;
//! use bevy_faceoff::prelude::*;
//!
//! fn spawn(mut commands: Commands, mesh: Handle<CollisionMesh>) {
//!     commands
//!         .spawn((RigidBody::Dynamic, MeshCollider(mesh)))
//!         .observe(|press: On<Pointer<Press>>, mut forces: Query<&mut ExternalForces>| {
//!             let hit = press.hit.extra_as::<RayHitData>().expect("colliders have it");
//!             println!("face {:?} of {}", hit.face, hit.collider);
//!             if let Ok(mut forces) = forces.get_mut(hit.body) {
//!                 forces.impulse -= hit.normal;
//!             }
//!         });
//! }
//!
//! App::new()
//!     .add_plugins((DefaultPlugins, FaceoffPlugins::default(), ColliderPickingPlugin))
//!     .run();
//! ```

use super::queries::{SpatialQuery, SpatialQueryFilter, update_while_time_stands};
use bevy::camera::Camera;
use bevy::ecs::entity::Entities;
use bevy::picking::PickingSystems;
use bevy::picking::backend::prelude::*;
use bevy::prelude::*;
use serde::{Deserialize, Serialize};

/// Sends pointer events to the colliders and planes under the pointers. Add it after Bevy's picking plugins, which
/// `DefaultPlugins` contains, and after [`FaceoffPlugins`](crate::plugin::FaceoffPlugins).
///
/// The target of an event is the collider. Events bubble up to its body if the body is above it. `HitData` has the
/// point and the normal in the world, the distance from the near plane of the camera, and a
/// [`RayHitData`](crate::plugin::queries::RayHitData), which
/// `HitData::extra_as` gives: the face, for example. Bevy's `Pickable` decides whether a collider gets events, and
/// whether colliders behind it do.
///
/// Colliders are where they were after the last step, or, while the clock of physics or of the game is paused, where
/// their components are.
pub struct ColliderPickingPlugin;

/// Which colliders get pointer events.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[reflect(Resource, Default, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ColliderPickingSettings {
    /// Whether only colliders with Bevy's `Pickable` do, and only through cameras with [`ColliderPickingCamera`].
    /// Default: all do.
    pub require_markers: bool,
}

/// A camera through which colliders are picked, and which colliders. Cameras without it pick all colliders that are not
/// sensors.
#[derive(Component, Reflect, Clone, Debug, PartialEq, Deref, DerefMut)]
#[reflect(Component, Default, Debug, PartialEq)]
pub struct ColliderPickingCamera(#[entities] pub SpatialQueryFilter);

impl Default for ColliderPickingCamera {
    fn default() -> Self {
        Self(SpatialQueryFilter::default().without_sensors())
    }
}

impl Plugin for ColliderPickingPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<ColliderPickingSettings>()
            .register_type::<ColliderPickingSettings>()
            .register_type::<ColliderPickingCamera>()
            // Bevy's picking plugins, if present, add this message too.
            .add_message::<PointerHits>()
            .add_systems(
                PreUpdate,
                (update_while_time_stands, pick).chain().in_set(PickingSystems::Backend),
            );
    }
}

fn pick(
    settings: Res<ColliderPickingSettings>,
    rays: Option<Res<RayMap>>,
    cameras: Query<(&Camera, Option<&ColliderPickingCamera>)>,
    pickables: Query<&Pickable>,
    entities: &Entities,
    world: SpatialQuery,
    mut pointer_hits: MessageWriter<PointerHits>,
) {
    let Some(rays) = rays else {
        warn_once!("ColliderPickingPlugin has no effect: add Bevy's DefaultPickingPlugins");
        return;
    };
    let by_default = ColliderPickingCamera::default();
    for (&id, ray) in rays.iter() {
        let Ok((camera, picking)) = cameras.get(id.camera) else {
            continue;
        };
        if settings.require_markers && picking.is_none() {
            continue;
        }
        let filter = &picking.unwrap_or(&by_default).0;
        // A collider may be gone since the last step.
        let is_wanted = |collider| match pickables.get(collider) {
            Ok(pickable) => pickable.is_hoverable || pickable.should_block_lower,
            Err(_) => !settings.require_markers && entities.contains_spawned(collider),
        };
        let mut picks: Vec<(Entity, HitData)> = Vec::new();
        // The nearest one, and those behind it as far as they get events.
        while let Some(hit) = world.cast_ray_predicate(ray.origin, ray.direction, f32::INFINITY, filter, |hit| {
            is_wanted(hit.collider) && picks.iter().all(|(collider, _)| *collider != hit.collider)
        }) {
            let data = HitData::new_with_extra(id.camera, hit.distance, Some(hit.point), Some(hit.normal), hit);
            picks.push((hit.collider, data));
            let pickable = pickables.get(hit.collider).ok();
            if pickable.is_none_or(|pickable| pickable.should_block_lower) {
                break;
            }
        }
        if !picks.is_empty() {
            pointer_hits.write(PointerHits::new(id.pointer, picks, camera.order as f32));
        }
    }
}
