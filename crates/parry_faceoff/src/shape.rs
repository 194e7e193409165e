//! [`ExactMesh`] to parry: its surface, with the mass and a tighter bounding box of the baked mesh.

use crate::convert::narrow;
use crate::mesh::ExactMesh;
use crate::parry::bounding_volume::{Aabb, BoundingSphere};
use crate::parry::mass_properties::MassProperties;
use crate::parry::math::{Matrix, Pose, Real, Vector};
use crate::parry::query::{PointProjection, PointQuery, Ray, RayCast, RayIntersection};
#[cfg(feature = "rapier")]
use crate::parry::shape::SubShapeId;
use crate::parry::shape::{CompositeShape, FeatureId, Shape, ShapeType, TypedShape};

/// parry's composite shapes. The version for rapier wants `Sync`.
#[cfg(feature = "rapier")]
type Composite<'a> = dyn CompositeShape + Sync + 'a;
#[cfg(not(feature = "rapier"))]
type Composite<'a> = dyn CompositeShape + 'a;

impl Shape for ExactMesh {
    fn compute_local_aabb(&self) -> Aabb {
        self.surface().compute_local_aabb()
    }

    fn compute_local_bounding_sphere(&self) -> BoundingSphere {
        self.surface().compute_local_bounding_sphere()
    }

    fn clone_dyn(&self) -> Box<dyn Shape> {
        Box::new(self.clone())
    }

    fn scale_dyn(&self, scale: Vector, _num_subdivisions: u32) -> Option<Box<dyn Shape>> {
        Some(Box::new(self.scaled(scale).ok()?))
    }

    /// The intersection of the turned box and the box of the bounding sphere: the box of a turned mesh is loose.
    fn compute_aabb(&self, position: &Pose) -> Aabb {
        let turned = self.surface().compute_aabb(position);
        let (center, radius) = self.bounding_sphere();
        let center = *position * center;
        let around = Aabb::from_half_extents(center, Vector::splat(radius));
        Aabb::new(turned.mins.max(around.mins), turned.maxs.min(around.maxs))
    }

    fn mass_properties(&self, density: Real) -> MassProperties {
        let Some(placed) = self.placed(&Pose::IDENTITY) else {
            return MassProperties::default();
        };
        let mass = placed.mass(f64::from(density));
        let inertia = placed.inertia(mass).as_mat3().to_cols_array();
        let center = narrow(placed.center_of_mass());
        MassProperties::with_inertia_matrix(center, mass as Real, Matrix::from_cols_array(&inertia))
    }

    fn shape_type(&self) -> ShapeType {
        ShapeType::Custom
    }

    /// The surface, which code that draws, saves or sweeps shapes knows.
    fn as_typed_shape(&self) -> TypedShape<'_> {
        self.surface().as_typed_shape()
    }

    fn ccd_thickness(&self) -> Real {
        self.surface().ccd_thickness()
    }

    fn ccd_angular_thickness(&self) -> Real {
        self.surface().ccd_angular_thickness()
    }

    fn as_composite_shape(&self) -> Option<&Composite<'_>> {
        self.surface().as_composite_shape()
    }

    #[cfg(feature = "rapier")]
    fn feature_normal_at_point(&self, subshape: SubShapeId, feature: FeatureId, point: Vector) -> Option<Vector> {
        self.surface().feature_normal_at_point(subshape, feature, point)
    }

    #[cfg(not(feature = "rapier"))]
    fn feature_normal_at_point(&self, feature: FeatureId, point: Vector) -> Option<Vector> {
        self.surface().feature_normal_at_point(feature, point)
    }
}

impl RayCast for ExactMesh {
    fn cast_local_ray(&self, ray: &Ray, max_time_of_impact: Real, solid: bool) -> Option<Real> {
        self.surface().cast_local_ray(ray, max_time_of_impact, solid)
    }

    fn cast_local_ray_and_get_normal(
        &self,
        ray: &Ray,
        max_time_of_impact: Real,
        solid: bool,
    ) -> Option<RayIntersection> {
        self.surface()
            .cast_local_ray_and_get_normal(ray, max_time_of_impact, solid)
    }

    fn intersects_local_ray(&self, ray: &Ray, max_time_of_impact: Real) -> bool {
        self.surface().intersects_local_ray(ray, max_time_of_impact)
    }
}

impl PointQuery for ExactMesh {
    fn project_local_point_with_max_dist(&self, point: Vector, solid: bool, max_dist: Real) -> Option<PointProjection> {
        self.surface().project_local_point_with_max_dist(point, solid, max_dist)
    }

    fn project_local_point(&self, point: Vector, solid: bool) -> PointProjection {
        self.surface().project_local_point(point, solid)
    }

    fn project_local_point_and_get_feature(&self, point: Vector) -> (PointProjection, FeatureId) {
        self.surface().project_local_point_and_get_feature(point)
    }

    fn contains_local_point(&self, point: Vector) -> bool {
        self.surface().contains_local_point(point)
    }
}
