//! [`SpatialIndex`]: the colliders and planes that queries see.

use crate::queries::Scene;
use crate::types::body::CollisionLayers;
use bevy::ecs::lifecycle::HookContext;
use bevy::ecs::world::DeferredWorld;
use bevy::prelude::*;
use thiserror::Error;

/// Why queries are not possible.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum SpatialQueryError {
    /// Poses stay on the GPU.
    #[error(
        "with Readback::Resident the poses of bodies stay on the GPU: take a Snapshot and call \
         update_spatial_queries_from with its bodies, or use Readback::Latent"
    )]
    Resident,
}

/// The colliders and planes at the poses of their components, as [`SpatialQuery`](super::SpatialQuery) sees them.
#[derive(Resource, Default)]
pub struct SpatialIndex {
    pub(super) scene: Scene,
    /// By number in the scene.
    pub(super) colliders: Vec<IndexedCollider>,
    pub(super) fault: Option<SpatialQueryError>,
    /// Whether the poses were given to [`update_spatial_queries_from`](super::update_spatial_queries_from).
    pub(super) has_given_poses: bool,
    /// Whether any system asks.
    pub(super) is_active: bool,
    /// Whether there were casters.
    pub(super) has_casters: bool,
    /// The step whose poses these are.
    pub(super) step: u64,
}

/// A collider or plane.
#[derive(Clone, Copy)]
pub struct IndexedCollider {
    pub collider: Entity,
    /// Without a body, the collider itself.
    pub body: Entity,
    pub layers: CollisionLayers,
    pub is_sensor: bool,
}

/// Tells the index that there are casters.
pub(super) fn has_casters(mut world: DeferredWorld, _: HookContext) {
    if let Some(mut index) = world.get_resource_mut::<SpatialIndex>() {
        index.has_casters = true;
    }
}

impl SpatialIndex {
    /// The scene, if it can be asked. Otherwise the reason is logged once.
    pub(super) fn scene(&self) -> Option<&Scene> {
        match self.fault {
            None => Some(&self.scene),
            Some(fault) => {
                error_once!("SpatialQuery finds nothing: {fault}");
                None
            }
        }
    }

    pub(super) fn clear(&mut self) {
        self.scene.clear();
        self.colliders.clear();
    }
}
