//! [`ShapeCaster`]: a component that casts a shape after each step.

use super::filter::SpatialQueryFilter;
use super::hits::ShapeHitData;
use super::index::has_casters;
use super::spatial_query::SpatialQuery;
use super::update::Colliders;
use crate::asset::CollisionMesh;
use crate::plugin::sync::hierarchy::decompose;
use crate::queries::QueryShape;
use bevy::math::DAffine3;
use bevy::prelude::*;

/// Casts a shape from its entity after each step, and keeps what it runs into in [`ShapeHits`].
///
/// ```
/// use bevy::prelude::*;
/// use bevy_faceoff::prelude::*;
///
/// fn spawn(mut commands: Commands) {
///     let foot = CasterShape::Ball { radius: 0.2 };
///     commands.spawn((Transform::default(), ShapeCaster::new(foot, Vec3::Y, Dir3::NEG_Y).with_max_distance(1.5)));
/// }
///
/// fn read(casters: Query<&ShapeHits, Changed<ShapeHits>>) {
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
#[require(Transform, ShapeHits)]
pub struct ShapeCaster {
    /// If false, it hits nothing.
    pub enabled: bool,
    /// The shape. The scale of the entity does not apply to it.
    pub shape: CasterShape,
    /// Where the shape starts, in the coordinates of the entity.
    pub origin: Vec3,
    /// How it is turned there.
    pub rotation: Quat,
    /// Where it goes, in the coordinates of the entity.
    pub direction: Dir3,
    /// How far it goes in the world, metres. May be infinite.
    pub max_distance: f32,
    /// How many colliders it reports: the nearest ones. Each costs a cast. Default 1.
    pub max_hits: usize,
    /// Whether the colliders of its own entity, and of the body to which that belongs, are ignored.
    pub ignore_self: bool,
    /// Which colliders count.
    #[entities]
    pub filter: SpatialQueryFilter,
}

/// The shape of a [`ShapeCaster`]. See [`QueryShape`].
#[derive(Reflect, Clone, Debug, PartialEq)]
#[reflect(Default, Debug, PartialEq)]
pub enum CasterShape {
    /// A ball about the origin.
    Ball {
        /// Metres.
        radius: f32,
    },
    /// A box about the origin.
    Box {
        /// Half the lengths of its edges, metres.
        half_size: Vec3,
    },
    /// All points that are no farther than `radius` from a segment of the y axis about the origin.
    Capsule {
        /// Metres.
        radius: f32,
        /// Half the length of the segment, metres.
        half_length: f32,
    },
    /// A mesh. Until it is loaded the caster hits nothing.
    Mesh {
        /// The baked mesh.
        mesh: Handle<CollisionMesh>,
        /// Along the mesh's own axes.
        scale: Vec3,
    },
}

/// What the shape runs into, nearest first.
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq, Deref)]
#[reflect(Component, Default, Debug, PartialEq)]
pub struct ShapeHits(
    #[entities]
    #[reflect(skip_serializing)]
    pub(super) Vec<ShapeHitData>,
);

impl Default for CasterShape {
    /// A ball with a radius of half a metre.
    fn default() -> Self {
        Self::Ball { radius: 0.5 }
    }
}

impl Default for ShapeCaster {
    /// The default shape, forward, along -z, from the origin of the entity.
    fn default() -> Self {
        Self::new(CasterShape::default(), Vec3::ZERO, Dir3::NEG_Z)
    }
}

impl ShapeCaster {
    /// Without an end. It reports the first collider but its own.
    pub fn new(shape: CasterShape, origin: Vec3, direction: Dir3) -> Self {
        Self {
            enabled: true,
            shape,
            origin,
            rotation: Quat::IDENTITY,
            direction,
            max_distance: f32::INFINITY,
            max_hits: 1,
            ignore_self: true,
            filter: SpatialQueryFilter::default(),
        }
    }

    /// This caster with the shape turned by `rotation`.
    pub fn with_rotation(self, rotation: Quat) -> Self {
        Self { rotation, ..self }
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

impl ShapeCaster {
    /// Pose at the start and direction of the shape in the world. `None` if it has no direction there.
    pub(crate) fn in_world(&self, to_world: &DAffine3) -> Option<(Isometry3d, Dir3)> {
        let translation = to_world.transform_point3(self.origin.as_dvec3()).as_vec3();
        let rotation = decompose(&to_world.matrix3).0.as_quat() * self.rotation;
        let direction = to_world.transform_vector3(self.direction.as_dvec3()).as_vec3();
        Some((Isometry3d::new(translation, rotation), Dir3::new(direction).ok()?))
    }
}

impl CasterShape {
    fn as_query<'a>(&self, meshes: &'a Assets<CollisionMesh>) -> Option<QueryShape<'a>> {
        Some(match self {
            &Self::Ball { radius } => QueryShape::Ball { radius: radius.into() },
            Self::Box { half_size } => QueryShape::Box {
                half_size: half_size.as_dvec3(),
            },
            &Self::Capsule { radius, half_length } => QueryShape::Capsule {
                radius: radius.into(),
                half_length: half_length.into(),
            },
            Self::Mesh { mesh, scale } => QueryShape::Mesh(meshes.get(mesh)?, *scale),
        })
    }
}

/// Casts the shapes of all casters.
pub(super) fn cast_shapes(
    world: SpatialQuery,
    meshes: Res<Assets<CollisionMesh>>,
    colliders: Colliders,
    mut casters: Query<(Entity, &ShapeCaster, &mut ShapeHits)>,
) {
    for (entity, caster, mut hits) in &mut casters {
        let start = caster.in_world(&colliders.to_world(entity));
        let mut filter = caster.filter.clone();
        if caster.ignore_self {
            filter = filter.without(colliders.own(entity));
        }
        let mut found = Vec::new();
        if caster.enabled
            && let Some((Isometry3d { translation, rotation }, direction)) = start
            && let Some(shape) = caster.shape.as_query(&meshes)
        {
            found = world.shape_hits(
                &shape,
                translation.into(),
                rotation,
                direction,
                caster.max_distance,
                caster.max_hits,
                &filter,
            );
        }
        hits.set_if_neq(ShapeHits(found));
    }
}
