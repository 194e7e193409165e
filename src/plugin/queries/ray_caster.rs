//! [`RayCaster`]: a component that casts a ray after each step.

use super::filter::SpatialQueryFilter;
use super::hits::RayHitData;
use super::index::has_casters;
use super::spatial_query::SpatialQuery;
use super::update::Colliders;
use bevy::math::DAffine3;
use bevy::prelude::*;

/// Casts a ray from its entity after each step, and keeps what it hits in [`RayHits`].
///
/// ```
/// use bevy::prelude::*;
/// use bevy_faceoff::prelude::*;
///
/// fn spawn(mut commands: Commands) {
///     commands.spawn((Transform::from_xyz(0.0, 2.0, 0.0), RayCaster::new(Vec3::ZERO, Dir3::NEG_Y)));
/// }
///
/// fn read(casters: Query<&RayHits, Changed<RayHits>>) {
///     for hit in casters.iter().filter_map(|hits| hits.first()) {
///         println!("{} is {} metres below", hit.collider, hit.distance);
///     }
/// }
/// # bevy::ecs::system::assert_is_system(spawn);
/// # bevy::ecs::system::assert_is_system(read);
/// ```
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Debug, PartialEq)]
#[component(on_add = has_casters)]
#[require(Transform, RayHits)]
pub struct RayCaster {
    /// If false, it hits nothing.
    pub enabled: bool,
    /// Where the ray starts, in the coordinates of the entity.
    pub origin: Vec3,
    /// Where it goes, in the coordinates of the entity.
    pub direction: Dir3,
    /// How far it goes in the world, metres. May be infinite.
    pub max_distance: f32,
    /// How many colliders it reports: the nearest ones.
    pub max_hits: usize,
    /// Whether the colliders of its own entity, and of the body to which that belongs, are ignored.
    pub ignore_self: bool,
    /// Which colliders count.
    #[entities]
    pub filter: SpatialQueryFilter,
}

/// The first hit of the ray on each collider, nearest first.
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq, Deref)]
#[reflect(Component, Default, Debug, PartialEq)]
pub struct RayHits(
    #[entities]
    #[reflect(skip_serializing)]
    pub(super) Vec<RayHitData>,
);

impl Default for RayCaster {
    /// Forward, along -z, from the origin of the entity.
    fn default() -> Self {
        Self::new(Vec3::ZERO, Dir3::NEG_Z)
    }
}

impl RayCaster {
    /// Without an end. It reports all colliders but its own.
    pub fn new(origin: Vec3, direction: Dir3) -> Self {
        Self {
            enabled: true,
            origin,
            direction,
            max_distance: f32::INFINITY,
            max_hits: usize::MAX,
            ignore_self: true,
            filter: SpatialQueryFilter::default(),
        }
    }

    /// This caster with a range of `max_distance` metres.
    pub fn with_max_distance(self, max_distance: f32) -> Self {
        Self { max_distance, ..self }
    }

    /// This caster with at most `max_hits` hits.
    pub fn with_max_hits(self, max_hits: usize) -> Self {
        Self { max_hits, ..self }
    }

    /// This caster for the colliders that `filter` admits.
    pub fn with_filter(self, filter: SpatialQueryFilter) -> Self {
        Self { filter, ..self }
    }

    /// This caster, which ignores its own colliders if `ignore_self`.
    pub fn with_ignore_self(self, ignore_self: bool) -> Self {
        Self { ignore_self, ..self }
    }
}

/// Casts the rays of all casters.
pub(super) fn cast_rays(
    world: SpatialQuery,
    colliders: Colliders,
    mut casters: Query<(Entity, &RayCaster, &mut RayHits)>,
) {
    for (entity, caster, mut hits) in &mut casters {
        let found = match caster.in_world(&colliders.to_world(entity)) {
            Some((origin, direction)) if caster.enabled => caster.cast(&world, &colliders, entity, origin, direction),
            _ => Vec::new(),
        };
        hits.set_if_neq(RayHits(found));
    }
}

impl RayCaster {
    /// Start and direction of the ray in the world. `None` if it has no direction there.
    pub(crate) fn in_world(&self, to_world: &DAffine3) -> Option<(Vec3, Dir3)> {
        let origin = to_world.transform_point3(self.origin.as_dvec3()).as_vec3();
        let direction = to_world.transform_vector3(self.direction.as_dvec3()).as_vec3();
        Some((origin, Dir3::new(direction).ok()?))
    }

    fn cast(
        &self,
        world: &SpatialQuery,
        colliders: &Colliders,
        entity: Entity,
        origin: Vec3,
        direction: Dir3,
    ) -> Vec<RayHitData> {
        let own;
        let filter = if self.ignore_self {
            own = self.filter.clone().without(colliders.own(entity));
            &own
        } else {
            &self.filter
        };
        let (most, distance) = (self.max_hits, self.max_distance);
        if most == 1 {
            return world
                .cast_ray(origin, direction, distance, filter)
                .into_iter()
                .collect();
        }
        let mut hits = Vec::new();
        for hit in world.ray_hits(origin, direction, distance, filter) {
            if hits.len() < most && hits.iter().all(|other: &RayHitData| other.collider != hit.collider) {
                hits.push(hit);
            }
        }
        hits
    }
}
