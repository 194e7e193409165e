//! [`SpatialQueryFilter`]: what a query considers.

use super::index::IndexedCollider;
use bevy::ecs::entity::{EntityHashSet, EntityMapper, MapEntities};
use bevy::prelude::*;

/// Which colliders and planes a query considers. Default: all, sensors included.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_faceoff::prelude::*;
/// # fn of(player: Entity) {
/// let ground = SpatialQueryFilter::in_layers(0b10).without([player]).without_sensors();
/// # let _ = ground;
/// # }
/// ```
#[derive(Clone, Debug, PartialEq, Reflect)]
#[reflect(Default, Debug, PartialEq)]
pub struct SpatialQueryFilter {
    /// One bit for each layer: colliders in none of them are ignored
    /// ([`CollisionLayers::memberships`](crate::types::body::CollisionLayers::memberships)).
    pub layers: u32,
    /// Whether sensors count.
    pub sensors: bool,
    /// Colliders, planes and bodies that are ignored. A body stands for all its colliders.
    pub excluded: EntityHashSet,
}

impl Default for SpatialQueryFilter {
    fn default() -> Self {
        Self {
            layers: u32::MAX,
            sensors: true,
            excluded: EntityHashSet::default(),
        }
    }
}

impl MapEntities for SpatialQueryFilter {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        self.excluded = self.excluded.iter().map(|entity| mapper.get_mapped(*entity)).collect();
    }
}

impl SpatialQueryFilter {
    /// A filter for colliders and planes in one of these layers.
    pub fn in_layers(layers: u32) -> Self {
        Self {
            layers,
            ..Self::default()
        }
    }

    /// A filter without these colliders, planes and bodies.
    pub fn excluding(entities: impl IntoIterator<Item = Entity>) -> Self {
        Self::default().without(entities)
    }

    /// This filter without these colliders, planes and bodies.
    pub fn without(mut self, entities: impl IntoIterator<Item = Entity>) -> Self {
        self.excluded.extend(entities);
        self
    }

    /// This filter without sensors.
    pub fn without_sensors(self) -> Self {
        Self { sensors: false, ..self }
    }

    pub(super) fn admits(&self, collider: &IndexedCollider) -> bool {
        collider.layers.memberships & self.layers != 0
            && (self.sensors || !collider.is_sensor)
            && !self.excluded.contains(&collider.collider)
            && !self.excluded.contains(&collider.body)
    }
}
