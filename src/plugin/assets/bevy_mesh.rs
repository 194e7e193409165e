//! Collision meshes from Bevy's own meshes, and back. Needs the feature `bevy_mesh`.
//!
//! The round shapes that Bevy builds, spheres and tori say, have a seam whose two sides differ by a rounding error:
//! [`BakeSettings::weld_tolerance`](crate::projection::BakeSettings) closes it.

use crate::asset::collision_mesh::CollisionMesh;
use crate::geometry::{MeshError, TriMesh};
use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, MeshAccessError, PrimitiveTopology, VertexAttributeValues};
use bevy::prelude::*;
use thiserror::Error;

/// Why a Bevy mesh gives no collision mesh.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum BevyMeshError {
    /// The renderer took the data.
    #[error(
        "the mesh's data has moved to the render world; create or load it with RenderAssetUsages::MAIN_WORLD (for glTF in \
         GltfLoaderSettings::load_meshes), beside RENDER_WORLD if it is drawn"
    )]
    InRenderWorld,
    /// There are no vertices.
    #[error("the mesh has no positions")]
    NoPositions,
    /// Positions of another format than Bevy draws.
    #[error("the mesh's positions are {0}; they must be Float32x3")]
    PositionFormat(&'static str),
    /// Points or lines.
    #[error("the mesh is a {0:?}; only triangle lists and strips have surfaces to collide with")]
    Topology(PrimitiveTopology),
    /// A triangle list with a triangle that is not whole.
    #[error("the mesh has {0} corners, which do not make whole triangles")]
    Corners(usize),
    /// The triangles are no usable mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

impl From<MeshAccessError> for BevyMeshError {
    fn from(error: MeshAccessError) -> Self {
        match error {
            MeshAccessError::ExtractedToRenderWorld => Self::InRenderWorld,
            MeshAccessError::NotFound => Self::NoPositions,
        }
    }
}

/// What is needed of a Bevy mesh, copied, so that all else can happen on another thread.
pub(crate) struct Triangles {
    vertices: Vec<Vec3>,
    faces: Vec<[u32; 3]>,
}

impl Triangles {
    pub(crate) fn of(mesh: &Mesh) -> Result<Self, BevyMeshError> {
        let topology = mesh.primitive_topology();
        if !matches!(
            topology,
            PrimitiveTopology::TriangleList | PrimitiveTopology::TriangleStrip
        ) {
            return Err(BevyMeshError::Topology(topology));
        }
        let vertices: Vec<Vec3> = match mesh.try_attribute(Mesh::ATTRIBUTE_POSITION)? {
            VertexAttributeValues::Float32x3(positions) => positions.iter().copied().map(Vec3::from).collect(),
            other => return Err(BevyMeshError::PositionFormat(other.enum_variant_name())),
        };
        let corners: Vec<u32> = match mesh.try_indices_option()? {
            None => (0..vertices.len() as u32).collect(),
            Some(Indices::U16(indices)) => indices.iter().copied().map(u32::from).collect(),
            Some(Indices::U32(indices)) => indices.clone(),
        };
        let faces = match topology {
            PrimitiveTopology::TriangleList => {
                let (faces, rest) = corners.as_chunks();
                if !rest.is_empty() {
                    return Err(BevyMeshError::Corners(corners.len()));
                }
                faces.to_vec()
            }
            // Every second triangle of a strip is turned.
            _ => corners
                .windows(3)
                .enumerate()
                .map(|(i, w)| {
                    if i % 2 == 0 {
                        [w[0], w[1], w[2]]
                    } else {
                        [w[0], w[2], w[1]]
                    }
                })
                .collect(),
        };
        Ok(Self { vertices, faces })
    }

    pub(crate) fn into_mesh(self) -> Result<TriMesh, MeshError> {
        TriMesh::new(self.vertices, self.faces)
    }
}

/// The triangles of a Bevy mesh as modelled: skins and morph targets are not applied. A face's index is the number of its
/// triangle.
impl TryFrom<&Mesh> for TriMesh {
    type Error = BevyMeshError;
    fn try_from(mesh: &Mesh) -> Result<Self, BevyMeshError> {
        Ok(Triangles::of(mesh)?.into_mesh()?)
    }
}

impl CollisionMesh {
    /// Heights and clusters of a Bevy mesh, as [`CollisionMesh::new`] makes them; milliseconds for thousands of triangles.
    ///
    /// # Errors
    /// If the mesh is not in the main world, has no positions or no triangles.
    pub fn from_bevy_mesh(mesh: &Mesh) -> Result<Self, BevyMeshError> {
        Ok(Self::new(&TriMesh::try_from(mesh)?))
    }

    /// The mesh as Bevy draws it, every triangle flat and with corners of its own: corners `3 t`, `3 t + 1` and `3 t + 2` are
    /// those of triangle `t` of [`BakedMesh::mesh`](super::BakedMesh::mesh). It has positions and normals. To look at what
    /// collides, and to colour single faces; a game draws a model of its own.
    pub fn to_bevy_mesh(&self) -> Mesh {
        let mesh = &self.mesh;
        let mut positions = Vec::with_capacity(3 * mesh.triangles().len());
        let mut normals = Vec::with_capacity(3 * mesh.triangles().len());
        for t in 0..mesh.triangles().len() {
            let corners = mesh.corners(t);
            let [a, b, c] = corners;
            let normal = (b - a).cross(c - a).normalize_or_zero();
            positions.extend(corners.map(|corner| corner.to_array()));
            normals.extend([normal.to_array(); 3]);
        }
        Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
            .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
    }
}
