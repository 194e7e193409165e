//! [`Placed`]: a baked mesh with a pose in double precision.

use crate::asset::CollisionMesh;
use crate::geometry::cluster::CLUSTER;
use crate::geometry::mesh::MAX_COORDINATE;
use crate::simd::lanes::{Rows, SimdBase, add, bitmask, load_points, splat, splat_point, sub, widen};
use crate::simd::level::baseline;
use crate::simd::levels::visit;
use crate::simd::rounding::PAD;
use crate::state::bodies::{bounding_radius, rounding};
use crate::state::checks::check_pose;
use crate::state::fault::BodyFault;
use crate::state::mesh_arena::BoxGroup;
use crate::state::{Frame, PlacedMesh};
use glam::{DMat3, DQuat, DVec3, Vec3};
use std::cell::Cell;

/// A baked mesh that is scaled, then rotated, then translated.
///
/// Queries about two placed meshes use the difference of their translations in double precision, so no digit is lost
/// far from the origin. If only the relative pose is known, place the first mesh at [`DVec3::ZERO`].
#[derive(Clone, Copy, Debug)]
pub struct Placed<'a> {
    mesh: &'a CollisionMesh,
    pose: PlacedPose,
}

/// Everything of a [`Placed`] but its mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlacedPose {
    translation: DVec3,
    scale: Vec3,
    /// The pose without the translation.
    frame: Frame,
    /// Radius of the bounding sphere about the centre of mass, metres.
    radius: f32,
}

impl<'a> Placed<'a> {
    /// Places a mesh. `rotation` may have any length but zero; `scale` is along the mesh's own axes and may mirror.
    ///
    /// # Errors
    /// If a number is not finite, the rotation is zero, the scale makes a mesh flat that is not, or the placed mesh
    /// extends beyond [`MAX_COORDINATE`] metres.
    pub fn new(mesh: &'a CollisionMesh, translation: DVec3, rotation: DQuat, scale: Vec3) -> Result<Self, BodyFault> {
        if !(translation.is_finite() && rotation.is_finite() && scale.is_finite()) {
            return Err(BodyFault::NonFinitePose);
        }
        let (rotation, scale, radius) = check_pose(mesh, rotation, scale)?;
        let frame = Frame::new(DVec3::ZERO, rotation, scale.as_dvec3(), mesh.mass.center);
        let extent = frame.center.abs().max_element() + f64::from(radius);
        if extent.is_nan() || extent > f64::from(MAX_COORDINATE) {
            return Err(BodyFault::TooFar);
        }
        let pose = PlacedPose {
            translation,
            scale,
            frame,
            radius,
        };
        Ok(Self { mesh, pose })
    }

    /// The mesh.
    pub fn mesh(&self) -> &'a CollisionMesh {
        self.mesh
    }

    /// World position of the mesh's origin, metres.
    pub fn translation(&self) -> DVec3 {
        self.pose.translation
    }

    /// World position of the centre of mass, metres.
    pub fn center_of_mass(&self) -> DVec3 {
        self.pose.translation + self.pose.frame.center
    }

    /// Radius of a sphere about the centre of mass that holds the placed mesh, metres.
    pub fn bounding_radius(&self) -> f32 {
        self.pose.radius
    }

    /// The mass in kilograms at a density in kg/m^3. [`MassProperties`](crate::geometry::MassProperties) tells how
    /// meshes that are not closed are treated.
    pub fn mass(&self, density: f64) -> f64 {
        density * self.mesh.volume(self.pose.frame.scale)
    }

    /// The inertia tensor about the centre of mass for a mass in kilograms, in the mesh's own axes, kg m^2.
    pub fn inertia(&self, mass: f64) -> DMat3 {
        self.mesh.inertia(self.pose.frame.scale, mass)
    }

    /// The axis-aligned bounding box of the placed mesh in the world: least and largest coordinates, metres. Exact up
    /// to rounding in double precision.
    pub fn bounding_box(&self) -> [DVec3; 2] {
        let Frame { rotation, scale, .. } = self.pose.frame;
        let (matrix, lanes) = (rotation * DMat3::from_diagonal(scale), self.mesh.lanes());
        // Boxes of triangles that cannot enlarge the bounding box are skipped, in single precision relative to the
        // centre of mass.
        let simd = baseline();
        let rotate = Rows::new(simd, matrix.as_mat3());
        let spread = Rows::new(simd, matrix.as_mat3().abs());
        let pad = splat(simd, 2.0 * PAD * self.pose.radius);
        let found = Cell::new([DVec3::INFINITY, DVec3::NEG_INFINITY]);
        let grows = |group: &BoxGroup| {
            let [low, high] = found
                .get()
                .map(|p| splat_point(simd, (p - self.pose.frame.center).as_vec3()));
            let stored = load_points(simd, &group.half);
            let center = rotate.times(load_points(simd, &group.center));
            let half = widen(spread.times(stored), pad);
            let (top, bottom) = (add(center, half), sub(center, half));
            let beyond = |i: usize| top[i].simd_gt(high[i]) | bottom[i].simd_lt(low[i]);
            // Unused lanes have a half size of minus infinity.
            let held = splat(simd, 0.0).simd_le(stored[0]);
            bitmask((beyond(0) | beyond(1) | beyond(2)) & held)
        };
        visit(&lanes.levels, grows, |cluster| {
            let first = cluster as usize * CLUSTER;
            let [mut low, mut high] = found.get();
            for t in first..self.mesh.mesh.triangles().len().min(first + CLUSTER) {
                for p in self.mesh.mesh.corners(t) {
                    let p = matrix * p.as_dvec3();
                    (low, high) = (low.min(p), high.max(p));
                }
            }
            found.set([low, high]);
            true
        });
        let rounding = DVec3::splat(self.rounding());
        let [low, high] = found.get().map(|p| self.pose.translation + p);
        [low - rounding, high + rounding]
    }

    /// Whether the bounding spheres show that the meshes are farther apart than `distance`.
    pub(super) fn is_beyond(&self, other: &Self, distance: f64) -> bool {
        let way = other.pose.translation - self.pose.translation + other.pose.frame.center - self.pose.frame.center;
        let radii = (f64::from(self.pose.radius) + f64::from(other.pose.radius)) * (1.0 + 1.0e-6);
        way.length() > radii + distance
    }

    /// The pose without the translation.
    pub(super) fn frame(&self) -> &Frame {
        &self.pose.frame
    }

    pub(super) fn scale(&self) -> Vec3 {
        self.pose.scale
    }

    /// Radius of the bounding sphere about the centre of mass, metres.
    pub(super) fn radius(&self) -> f32 {
        self.pose.radius
    }

    /// -1 if the scale mirrors, so that faces that are counter-clockwise in the mesh are clockwise; else 1.
    pub(super) fn mirror(&self) -> f64 {
        self.pose.frame.scale.element_product().signum()
    }

    /// A point of the world in the mesh's own axes, about its origin, in metres: scaled, but not rotated.
    pub(super) fn in_axes(&self, point: DVec3) -> DVec3 {
        self.pose.frame.rotation.transpose() * (point - self.pose.translation)
    }

    /// The point of the world that [`Placed::in_axes`] maps to this one.
    pub(super) fn in_world(&self, point: DVec3) -> DVec3 {
        self.pose.translation + self.pose.frame.rotation * point
    }

    /// A direction along the mesh's own axes in those of the world.
    pub(super) fn turn_to_world(&self, direction: DVec3) -> DVec3 {
        self.pose.frame.rotation * direction
    }

    /// The centre of mass in [`Placed::in_axes`].
    pub(super) fn axes_center(&self) -> DVec3 {
        self.pose.frame.scale * self.mesh.mass.center.as_dvec3()
    }

    /// The corners of a triangle in [`Placed::in_axes`].
    pub(super) fn corners(&self, triangle: usize) -> [DVec3; 3] {
        let corners = self.mesh.mesh.corners(triangle);
        corners.map(|p| self.pose.frame.scale * p.as_dvec3())
    }

    /// Everything but the mesh.
    pub(super) fn pose(&self) -> PlacedPose {
        self.pose
    }

    /// Restores a placed mesh from its earlier pose.
    pub(super) fn again(mesh: &'a CollisionMesh, pose: PlacedPose) -> Self {
        Self { mesh, pose }
    }

    /// Centre and half size of a box in the world that contains the mesh. It is quick to compute, and larger than
    /// [`Placed::bounding_box`] if the mesh is turned.
    pub(crate) fn outer_box(&self) -> [DVec3; 2] {
        let Frame {
            rotation,
            scale,
            center,
            ..
        } = self.pose.frame;
        let (matrix, aabb) = (rotation * DMat3::from_diagonal(scale), self.mesh.lanes().aabb);
        let half = matrix.abs() * aabb.half_size().as_dvec3();
        [
            self.pose.translation + center + matrix * aabb.center().as_dvec3(),
            half * (1.0 + 1.0e-6) + DVec3::splat(f64::from(PAD) * f64::from(self.pose.radius) + self.rounding()),
        ]
    }

    /// The point of the mesh that is farthest along a direction of the world.
    pub(super) fn farthest(&self, direction: DVec3) -> DVec3 {
        let along = self.pose.frame.scale * (self.pose.frame.rotation.transpose() * direction);
        let vertices = self.mesh.features().vertices.iter().map(|p| p.as_dvec3());
        let farthest = vertices.max_by(|a, b| along.dot(*a).total_cmp(&along.dot(*b)));
        self.in_world(self.pose.frame.scale * farthest.unwrap_or_default())
            + direction.normalize_or_zero() * self.rounding()
    }

    /// Its pose relative to `origin`.
    pub(super) fn frame_about(&self, origin: DVec3) -> Frame {
        let position = self.pose.translation - origin;
        Frame {
            position,
            center: position + self.pose.frame.center,
            body_center: position + self.pose.frame.center,
            ..self.pose.frame
        }
    }

    /// The mesh with this pose.
    pub(super) fn in_frame<'f>(&self, frame: &'f Frame) -> PlacedMesh<'f>
    where
        'a: 'f,
    {
        PlacedMesh {
            mesh: self.mesh,
            frame,
            scale: self.pose.scale,
            radius: bounding_radius(self.pose.radius, frame.center.as_vec3()),
            rounding: rounding(self.mesh, self.pose.scale),
        }
    }

    /// Vector from the translation to the centre of mass.
    pub(super) fn center_offset(&self) -> DVec3 {
        self.pose.frame.center
    }
}
