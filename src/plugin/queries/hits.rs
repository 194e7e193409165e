//! Results of queries.

use super::index::SpatialIndex;
use crate::queries::{SceneCastHit, ScenePointHit, SceneRayHit};
use bevy::ecs::entity::MapEntities;
use bevy::prelude::*;

/// Where a ray hits a collider or plane.
#[derive(Clone, Copy, Debug, MapEntities, PartialEq, Reflect)]
#[reflect(Debug, PartialEq)]
pub struct RayHitData {
    /// The collider or plane.
    #[entities]
    pub collider: Entity,
    /// The body of the collider; without one the collider itself.
    #[entities]
    pub body: Entity,
    /// From the start of the ray, metres.
    pub distance: f32,
    /// The point in the world.
    pub point: Vec3,
    /// Unit normal of the surface, on the side from which the ray comes.
    pub normal: Vec3,
    /// The face, an index of the source mesh. `None` on a plane.
    pub face: Option<u32>,
    /// Weights of the three corners of the face, in their order in the source mesh. They add up to 1. Zero on a plane.
    pub barycentric: Vec3,
    /// Whether the ray comes from behind the face: from inside, if the mesh is closed.
    pub from_behind: bool,
}

impl RayHitData {
    pub(super) fn new(index: &SpatialIndex, hit: &SceneRayHit) -> Self {
        let collider = &index.colliders[hit.number];
        Self {
            collider: collider.collider,
            body: collider.body,
            distance: hit.distance as f32,
            point: hit.point.as_vec3(),
            normal: hit.normal,
            face: hit.face,
            barycentric: hit.barycentric,
            from_behind: hit.from_behind,
        }
    }
}

/// The point of a collider or plane that is nearest to a given one.
#[derive(Clone, Copy, Debug, MapEntities, PartialEq, Reflect)]
#[reflect(Debug, PartialEq)]
pub struct PointHitData {
    /// The collider or plane.
    #[entities]
    pub collider: Entity,
    /// The body of the collider; without one the collider itself.
    #[entities]
    pub body: Entity,
    /// From the given point, metres; 0 if that is inside.
    pub distance: f32,
    /// The nearest point of the surface, in the world.
    pub point: Vec3,
    /// Unit vector out of the collider: from the nearest point to the given one, or back if that is inside.
    pub normal: Vec3,
    /// The face, an index of the source mesh. `None` on a plane.
    pub face: Option<u32>,
    /// Weights of the three corners of the face, in their order in the source mesh. They add up to 1. Zero on a plane.
    pub barycentric: Vec3,
    /// Whether the given point is inside: of a closed mesh, or of the solid side of a plane.
    pub is_inside: bool,
}

impl PointHitData {
    pub(super) fn new(index: &SpatialIndex, hit: &ScenePointHit) -> Self {
        let collider = &index.colliders[hit.number];
        Self {
            collider: collider.collider,
            body: collider.body,
            distance: hit.distance as f32,
            point: hit.point.as_vec3(),
            normal: hit.normal,
            face: hit.face,
            barycentric: hit.barycentric,
            is_inside: hit.is_inside,
        }
    }
}

/// Where a shape that moves along a line first touches a collider or plane.
#[derive(Clone, Copy, Debug, MapEntities, PartialEq, Reflect)]
#[reflect(Debug, PartialEq)]
pub struct ShapeHitData {
    /// The collider or plane.
    #[entities]
    pub collider: Entity,
    /// The body of the collider; without one the collider itself.
    #[entities]
    pub body: Entity,
    /// How far the shape moves until it touches, metres; 0 if it touches or overlaps at the start.
    pub distance: f32,
    /// A point of the surface at which they touch, in the world.
    pub point: Vec3,
    /// Unit vector from the collider to the shape.
    pub normal: Vec3,
    /// The face, an index of the source mesh. `None` on a plane.
    pub face: Option<u32>,
    /// The face of the shape if that is a mesh, unless the shape touches at the start.
    pub shape_face: Option<u32>,
}

impl ShapeHitData {
    pub(super) fn new(index: &SpatialIndex, hit: &SceneCastHit) -> Self {
        let collider = &index.colliders[hit.number];
        Self {
            collider: collider.collider,
            body: collider.body,
            distance: hit.distance as f32,
            point: hit.point.as_vec3(),
            normal: hit.normal,
            face: hit.face,
            shape_face: hit.shape_face,
        }
    }
}
