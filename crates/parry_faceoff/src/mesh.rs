//! [`ExactMesh`]: a baked mesh as a shape of parry.

use crate::convert::{from_parry, rotation, to_parry, translation};
use crate::parry::math::{Pose, Vector};
use crate::parry::shape::{TriMesh, TriMeshBuilderError, TriMeshFlags};
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::{self, MeshError, Orientation};
use bevy_faceoff::queries::{BodyFault, Placed, QueryShape};
use glam::{DQuat, DVec3, Vec3};

/// A triangle mesh for a collider. Where [`ExactDispatcher`](crate::ExactDispatcher) is installed, two of them touch with
/// the exact contacts of bevy_faceoff.
///
/// To everything else it is the mesh of parry that [`ExactMesh::surface`] returns. This holds for rays, points, shape
/// casts, continuous collision detection, contacts with other shapes, and debug rendering. It also holds for two exact meshes
/// where the dispatcher is not installed.
///
/// A clone shares the baked data, but not the mesh of parry. Colliders of the same mesh should share one
/// [`SharedShape`](crate::parry::shape::SharedShape).
#[derive(Clone)]
pub struct ExactMesh {
    mesh: CollisionMesh,
    scale: Vec3,
    surface: TriMesh,
}

/// Why there is no [`ExactMesh`].
#[derive(Clone, Debug, thiserror::Error)]
pub enum ExactMeshError {
    /// The vertices or triangles are invalid.
    #[error("the triangles make no mesh: {0}")]
    Mesh(#[from] MeshError),
    /// The scale is zero along an axis, not finite, or makes the mesh too large.
    #[error("the mesh cannot be scaled: {0}")]
    Scale(BodyFault),
    /// parry's mesh cannot be made.
    #[error("parry makes no mesh of it: {0}")]
    Surface(#[from] TriMeshBuilderError),
}

impl ExactMesh {
    /// Bakes a mesh, in about a millisecond for a thousand triangles. Counter-clockwise faces look outward. Vertices are in metres.
    ///
    /// # Errors
    /// If there is no face of non-zero area, an invalid coordinate or an invalid index.
    pub fn new(vertices: Vec<Vector>, indices: Vec<[u32; 3]>) -> Result<Self, ExactMeshError> {
        let vertices = vertices.into_iter().map(from_parry).collect();
        Self::from_baked(CollisionMesh::new(&geometry::TriMesh::new(vertices, indices)?))
    }

    /// Takes a baked mesh, for instance from a file.
    ///
    /// # Errors
    /// If parry takes no such mesh.
    pub fn from_baked(mesh: CollisionMesh) -> Result<Self, ExactMeshError> {
        Self::with_scale(mesh, Vec3::ONE, None)
    }

    /// A copy of the mesh with its scale multiplied by this one, along its own axes. The scale may mirror. Nothing is
    /// baked.
    ///
    /// # Errors
    /// If the scale is not finite, or makes the mesh flat or larger than
    /// [`MAX_COORDINATE`](bevy_faceoff::geometry::mesh::MAX_COORDINATE).
    pub fn scaled(&self, scale: Vector) -> Result<Self, ExactMeshError> {
        Self::with_scale(
            self.mesh.clone(),
            self.scale * from_parry(scale),
            Some(self.surface.flags()),
        )
    }

    /// A copy of the mesh with other flags for parry's mesh. They change contacts with other shapes, and whether rays
    /// and points take it for solid; see [`ExactMesh::surface`]. Flags that delete triangles make the triangles'
    /// indices wrong.
    ///
    /// # Errors
    /// If parry cannot compute what the flags ask for.
    pub fn with_flags(&self, flags: TriMeshFlags) -> Result<Self, ExactMeshError> {
        Self::with_scale(self.mesh.clone(), self.scale, Some(flags))
    }

    fn with_scale(mesh: CollisionMesh, scale: Vec3, flags: Option<TriMeshFlags>) -> Result<Self, ExactMeshError> {
        let placed = Placed::new(&mesh, DVec3::ZERO, DQuat::IDENTITY, scale).map_err(ExactMeshError::Scale)?;
        let surface = &placed.mesh().mesh;
        let vertices = surface.vertices().iter().map(|&v| to_parry(v * scale)).collect();
        let mut faces = surface.all_faces();
        if scale.element_product() < 0.0 {
            faces.iter_mut().for_each(|face| face.swap(1, 2));
        }
        let is_one_sided = surface.is_solid() && surface.orientation() != Orientation::Mixed;
        let flags = flags.unwrap_or(match is_one_sided {
            true => TriMeshFlags::FIX_INTERNAL_EDGES | TriMeshFlags::ORIENTED,
            false => TriMeshFlags::empty(),
        });
        let surface = TriMesh::with_flags(vertices, faces, flags)?;
        Ok(Self { mesh, scale, surface })
    }

    /// The baked mesh, not scaled.
    pub fn mesh(&self) -> &CollisionMesh {
        &self.mesh
    }

    /// The scale along the mesh's own axes.
    pub fn scale(&self) -> Vector {
        to_parry(self.scale)
    }

    /// The scaled mesh of parry. Its triangles have the indices of the input.
    ///
    /// If the mesh is solid and its winding consistent, the flags are `FIX_INTERNAL_EDGES` and `ORIENTED`. Else there are none, so
    /// that faces have two sides.
    pub fn surface(&self) -> &TriMesh {
        &self.surface
    }

    /// The mesh in this pose; `None` if it is not finite or too far away.
    pub(crate) fn placed(&self, pose: &Pose) -> Option<Placed<'_>> {
        Placed::new(&self.mesh, translation(pose), rotation(pose), self.scale).ok()
    }

    /// The mesh as a shape to ask with.
    pub(crate) fn asked(&self) -> QueryShape<'_> {
        QueryShape::Mesh(&self.mesh, self.scale)
    }

    /// Its centre of mass, and the radius of a sphere about it that contains the mesh.
    pub(crate) fn bounding_sphere(&self) -> (Vector, f32) {
        let radius = self.mesh.radius * self.scale.abs().max_element();
        (to_parry(self.mesh.mass.center * self.scale), radius * (1.0 + 1.0e-5))
    }
}
