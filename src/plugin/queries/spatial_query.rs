//! [`SpatialQuery`]: the system parameter for spatial queries.

use super::filter::SpatialQueryFilter;
use super::hits::{PointHitData, RayHitData, ShapeHitData};
use super::index::{SpatialIndex, SpatialQueryError};
use super::update::update_spatial_queries;
use crate::queries::{QueryShape, Ray, Scene, SceneCastHit, SceneRayHit, SceneSegmentHit};
use bevy::ecs::system::SystemParam;
use bevy::math::{DQuat, DVec3};
use bevy::platform::collections::HashSet;
use bevy::prelude::*;

/// Queries colliders and planes: by rays, points, overlaps and casts, exact on the triangles.
///
/// Queries use the poses after the last step, which are those of the components. To see what systems have moved since
/// then, run [`update_spatial_queries`] before. Queries run on the CPU, wherever the stages run. They need no exclusive
/// access to anything, so systems that query run in parallel, and may write `Transform`s.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_faceoff::prelude::*;
///
/// fn what_is_below(player: Single<(Entity, &Transform), With<Name>>, world: SpatialQuery) {
///     let (player, transform) = *player;
///     let filter = SpatialQueryFilter::excluding([player]);
///     if let Some(hit) = world.cast_ray(transform.translation, Dir3::NEG_Y, 100.0, &filter) {
///         println!("{} metres above face {:?} of {}", hit.distance, hit.face, hit.collider);
///     }
/// }
/// # bevy::ecs::system::assert_is_system(what_is_below);
/// ```
#[derive(SystemParam)]
pub struct SpatialQuery<'w, 's> {
    index: Res<'w, SpatialIndex>,
    _activation: Local<'s, IndexActivation>,
}

/// Activates the index for a system that queries.
struct IndexActivation;

impl FromWorld for IndexActivation {
    fn from_world(world: &mut World) -> Self {
        let index = world.get_resource_or_init::<SpatialIndex>();
        if !index.is_active {
            index.into_inner().is_active = true;
            // The first query may come before the next step.
            if let Err(error) = world.run_system_cached(update_spatial_queries) {
                error!("{error}");
            }
        }
        Self
    }
}

impl SpatialQuery<'_, '_> {
    /// Whether queries are possible. If not, they find nothing, and the error is logged once.
    ///
    /// # Errors
    /// With [`Readback::Resident`](crate::plugin::settings::Readback::Resident), unless
    /// [`update_spatial_queries_from`](super::update_spatial_queries_from) was called.
    pub fn check(&self) -> Result<(), SpatialQueryError> {
        self.index.fault.map_or(Ok(()), Err)
    }

    /// The first hit of a ray.
    ///
    /// A ray that starts on a face hits it at distance 0. A ray that starts inside a closed mesh hits it from behind. A
    /// NaN, or a negative `max_distance`, hits nothing; `f32::INFINITY` is without end.
    pub fn cast_ray(
        &self,
        origin: Vec3,
        direction: Dir3,
        max_distance: f32,
        filter: &SpatialQueryFilter,
    ) -> Option<RayHitData> {
        let ray = ray(origin, direction, max_distance);
        let hit = self
            .index
            .scene()?
            .cast_ray(&ray, |number| self.admits(filter, number))?;
        Some(self.hit(&hit))
    }

    /// The first hit of a ray for which `predicate` holds. It may be called for hits behind the first one. Of a rounded
    /// collider only the first hit is tried.
    pub fn cast_ray_predicate(
        &self,
        origin: Vec3,
        direction: Dir3,
        max_distance: f32,
        filter: &SpatialQueryFilter,
        predicate: impl Fn(&RayHitData) -> bool,
    ) -> Option<RayHitData> {
        let ray = ray(origin, direction, max_distance);
        let hit = self.index.scene()?.cast_ray_predicate(
            &ray,
            |number| self.admits(filter, number),
            |hit| predicate(&self.hit(hit)),
        )?;
        Some(self.hit(&hit))
    }

    /// All hits of a ray, in the order of distance: each face that it passes through. A ray through the common edge of
    /// two faces hits both. A rounded collider has only its first hit.
    pub fn ray_hits(
        &self,
        origin: Vec3,
        direction: Dir3,
        max_distance: f32,
        filter: &SpatialQueryFilter,
    ) -> Vec<RayHitData> {
        let Some(scene) = self.index.scene() else {
            return Vec::new();
        };
        let ray = ray(origin, direction, max_distance);
        let hits = scene.ray_hits(&ray, |number| self.admits(filter, number));
        hits.iter().map(|hit| self.hit(hit)).collect()
    }

    /// Whether a ray hits anything: faster than the first hit.
    pub fn hits_ray(&self, origin: Vec3, direction: Dir3, max_distance: f32, filter: &SpatialQueryFilter) -> bool {
        let ray = ray(origin, direction, max_distance);
        let scene = self.index.scene();
        scene.is_some_and(|scene| scene.hits_ray(&ray, |number| self.admits(filter, number)))
    }

    /// The point of a collider or plane that is nearest to a given one, if it is no farther than `max_distance` metres.
    ///
    /// If a collider with a closed mesh contains the point, the distance is 0, and the point of the answer is on its
    /// surface. A NaN or a negative `max_distance` finds nothing; `f32::INFINITY` is without limit.
    pub fn closest_point(&self, point: Vec3, max_distance: f32, filter: &SpatialQueryFilter) -> Option<PointHitData> {
        let scene = self.index.scene()?;
        let admits = |number: usize| self.admits(filter, number);
        let hit = scene.closest_point(point.as_dvec3(), max_distance.into(), admits)?;
        Some(PointHitData::new(&self.index, &hit))
    }

    /// The colliders and planes that a shape touches or contains, or that contain it, ascending. An invalid shape or
    /// pose overlaps nothing.
    pub fn overlapping(
        &self,
        shape: &QueryShape,
        translation: Vec3,
        rotation: Quat,
        filter: &SpatialQueryFilter,
    ) -> Vec<Entity> {
        let Some(scene) = self.index.scene() else {
            return Vec::new();
        };
        let (translation, rotation) = (translation.as_dvec3(), rotation.as_dquat());
        let found = scene.overlapping(shape, translation, rotation, |number| self.admits(filter, number));
        let mut colliders: Vec<_> = found
            .iter()
            .map(|&number| self.index.colliders[number].collider)
            .collect();
        colliders.sort_unstable();
        colliders
    }

    /// Where a shape that moves up to `max_distance` metres along `direction`, without turning, first touches
    /// something. See [`Placed::cast`](crate::queries::Placed::cast): the distance is exact on the triangles, and 0 if
    /// the shape touches or overlaps something at the start, also if it moves away from it.
    pub fn cast_shape(
        &self,
        shape: &QueryShape,
        translation: Vec3,
        rotation: Quat,
        direction: Dir3,
        max_distance: f32,
        filter: &SpatialQueryFilter,
    ) -> Option<ShapeHitData> {
        let path = ShapePath::new(shape, translation, rotation, direction, max_distance);
        let hit = path.first(self.index.scene()?, |number| self.admits(filter, number))?;
        Some(ShapeHitData::new(&self.index, &hit))
    }

    /// Like [`SpatialQuery::cast_shape`], for each of the `max_hits` colliders and planes that the shape touches first,
    /// in the order of distance, as if it went through them.
    pub fn shape_hits(
        &self,
        shape: &QueryShape,
        translation: Vec3,
        rotation: Quat,
        direction: Dir3,
        max_distance: f32,
        max_hits: usize,
        filter: &SpatialQueryFilter,
    ) -> Vec<ShapeHitData> {
        let Some(scene) = self.index.scene() else {
            return Vec::new();
        };
        let path = ShapePath::new(shape, translation, rotation, direction, max_distance);
        let (mut hits, mut passed) = (Vec::new(), HashSet::<usize>::default());
        while hits.len() < max_hits
            && let Some(hit) = path.first(scene, |number| self.admits(filter, number) && !passed.contains(&number))
        {
            passed.insert(hit.number);
            hits.push(ShapeHitData::new(&self.index, &hit));
        }
        hits
    }

    /// The nearest surface to a segment: see [`Scene::closest_to_segment`](crate::queries::Scene::closest_to_segment).
    pub(crate) fn closest_to_segment(
        &self,
        ends: [Vec3; 2],
        max_distance: f32,
        filter: &SpatialQueryFilter,
    ) -> Option<SceneSegmentHit> {
        let ends = ends.map(|end| end.as_dvec3());
        let admits = |number: usize| self.admits(filter, number);
        (self.index.scene()?).closest_to_segment(ends, max_distance.into(), admits)
    }

    fn admits(&self, filter: &SpatialQueryFilter, number: usize) -> bool {
        filter.admits(&self.index.colliders[number])
    }

    fn hit(&self, hit: &SceneRayHit) -> RayHitData {
        RayHitData::new(&self.index, hit)
    }
}

/// A shape and where it moves.
struct ShapePath<'a> {
    shape: &'a QueryShape<'a>,
    translation: DVec3,
    rotation: DQuat,
    direction: DVec3,
    max_distance: f64,
}

impl<'a> ShapePath<'a> {
    fn new(shape: &'a QueryShape<'a>, translation: Vec3, rotation: Quat, direction: Dir3, max_distance: f32) -> Self {
        Self {
            shape,
            translation: translation.as_dvec3(),
            rotation: rotation.as_dquat(),
            direction: direction.as_dvec3(),
            max_distance: max_distance.into(),
        }
    }

    /// What it touches first of what passes the filter.
    fn first(&self, scene: &Scene, filter: impl Fn(usize) -> bool) -> Option<SceneCastHit> {
        scene.cast(
            self.shape,
            self.translation,
            self.rotation,
            self.direction,
            self.max_distance,
            filter,
        )
    }
}

fn ray(origin: Vec3, direction: Dir3, max_distance: f32) -> Ray {
    Ray {
        origin: origin.as_dvec3(),
        direction: direction.as_dvec3(),
        max_distance: max_distance.into(),
    }
}
