//! Conversion between collision meshes and Bevy's own meshes. Needs the feature `bevy_mesh`.
//!
//! Round shapes that Bevy builds, such as spheres and tori, have a seam whose two sides differ by rounding errors.
//! [`BakeSettings::weld_tolerance`](crate::projection::BakeSettings) closes it.

use crate::asset::collision_mesh::CollisionMesh;
use crate::geometry::rounding::{self, Rounding};
use crate::geometry::{MeshError, TriMesh};
use bevy::asset::RenderAssetUsages;
use bevy::math::DVec3;
use bevy::mesh::{Indices, MeshAccessError, PrimitiveTopology, VertexAttributeValues};
use bevy::prelude::*;
use thiserror::Error;

/// Why a Bevy mesh cannot become a collision mesh.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum BevyMeshError {
    /// The mesh is in the render world only.
    #[error(
        "the mesh's data has moved to the render world; create or load it with RenderAssetUsages::MAIN_WORLD (for glTF \
         in GltfLoaderSettings::load_meshes), beside RENDER_WORLD if it is drawn"
    )]
    InRenderWorld,
    /// The mesh has no vertex positions.
    #[error("the mesh has no positions")]
    NoPositions,
    /// The positions are not `Float32x3`.
    #[error("the mesh's positions are {0}; they must be Float32x3")]
    PositionFormat(&'static str),
    /// The mesh consists of points or lines.
    #[error("the mesh is a {0:?}; only triangle lists and strips have surfaces to collide with")]
    Topology(PrimitiveTopology),
    /// The number of corners of a triangle list is not a multiple of three.
    #[error("the mesh has {0} corners, which is not a multiple of three")]
    Corners(usize),
    /// The triangles are not a valid mesh.
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

/// A copy of a Bevy mesh's triangles, so that the rest of the work can run on another thread.
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
            // Every second triangle of a strip has the opposite winding.
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

    /// The triangles of several meshes, joined.
    pub(crate) fn of_all(meshes: &[&Mesh]) -> Result<Self, BevyMeshError> {
        if let [mesh] = meshes {
            return Self::of(mesh);
        }
        let mut all = Self {
            vertices: Vec::new(),
            faces: Vec::new(),
        };
        for mesh in meshes {
            let Self { vertices, faces } = Self::of(mesh)?;
            // An index beyond the vertices of its own mesh stays beyond all vertices, and is reported later.
            let (first, beyond) = (all.vertices.len() as u32, vertices.len() as u32);
            let shifted = |i: u32| if i < beyond { i + first } else { u32::MAX };
            all.faces.extend(faces.into_iter().map(|face| face.map(shifted)));
            all.vertices.extend(vertices);
        }
        Ok(all)
    }

    /// The memory that they take.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&*self.vertices) + size_of_val(&*self.faces)
    }

    pub(crate) fn into_mesh(self) -> Result<TriMesh, MeshError> {
        TriMesh::new(self.vertices, self.faces)
    }
}

/// The triangles of a Bevy mesh, without skins and morph targets. The index of a face is the index of its triangle.
impl TryFrom<&Mesh> for TriMesh {
    type Error = BevyMeshError;
    fn try_from(mesh: &Mesh) -> Result<Self, BevyMeshError> {
        Ok(Triangles::of(mesh)?.into_mesh()?)
    }
}

impl CollisionMesh {
    /// Bakes a Bevy mesh like [`CollisionMesh::new`], without a face table. Takes milliseconds for thousands of
    /// triangles.
    ///
    /// # Errors
    /// If the mesh is not in the main world, has no positions or has no triangles.
    pub fn from_bevy_mesh(mesh: &Mesh) -> Result<Self, BevyMeshError> {
        Ok(Self::new(&TriMesh::try_from(mesh)?))
    }

    /// A flat-shaded Bevy mesh with positions and normals, for debugging: it shows the triangles that collide.
    ///
    /// Triangles share no vertices, so that single faces can be coloured. Vertices `3 t`, `3 t + 1` and `3 t + 2` are
    /// the corners of triangle `t` of [`BakedMesh::mesh`](crate::asset::BakedMesh::mesh). A rounded mesh is
    /// smooth instead, and its triangles are those of its round surface.
    pub fn to_bevy_mesh(&self) -> Mesh {
        let mesh = &self.mesh;
        if mesh.is_thin() {
            return self.round_bevy_mesh();
        }
        if self.settings.rounding > 0.0 {
            let mut surface = RoundSurface::default();
            let is_solid = mesh.is_solid();
            rounding::visit(mesh, f64::from(self.settings.rounding), is_solid, &mut surface);
            return mesh_of(surface.positions, surface.normals);
        }
        let mut positions = Vec::with_capacity(3 * mesh.triangles().len());
        let mut normals = Vec::with_capacity(3 * mesh.triangles().len());
        for t in 0..mesh.triangles().len() {
            let corners = mesh.corners(t);
            let [a, b, c] = corners;
            let normal = (b - a).cross(c - a).normalize_or_zero();
            positions.extend(corners.map(|corner| corner.to_array()));
            normals.extend([normal.to_array(); 3]);
        }
        mesh_of(positions, normals)
    }

    /// A ball or a capsule, smoothly shaded.
    fn round_bevy_mesh(&self) -> Mesh {
        let [start, _, end] = self.mesh.corners(0);
        let (radius, way) = (self.settings.rounding, end - start);
        let round = if way == Vec3::ZERO {
            Sphere::new(radius).mesh().build()
        } else {
            Capsule3d::new(radius, way.length()).mesh().build()
        };
        let turn = Quat::from_rotation_arc(Vec3::Y, way.normalize_or(Vec3::Y));
        round.transformed_by(Transform::from_translation(0.5 * (start + end)).with_rotation(turn))
    }
}

/// A mesh of triangles that share no vertices.
fn mesh_of(positions: Vec<[f32; 3]>, normals: Vec<[f32; 3]>) -> Mesh {
    Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
}

/// The triangles of a rounded surface.
#[derive(Default)]
struct RoundSurface {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
}

impl RoundSurface {
    /// Adds a triangle, given by points of the core and the vectors from there to the surface.
    fn add(&mut self, mut corners: [(DVec3, DVec3); 3]) {
        let [a, b, c] = corners.map(|(at, up)| at + up);
        let out = corners[0].1 + corners[1].1 + corners[2].1;
        if (b - a).cross(c - a).dot(out) < 0.0 {
            corners.swap(1, 2);
        }
        self.positions
            .extend(corners.map(|(at, up)| (at + up).as_vec3().to_array()));
        self.normals
            .extend(corners.map(|(_, up)| up.normalize_or_zero().as_vec3().to_array()));
    }
}

impl Rounding for RoundSurface {
    fn face(&mut self, corners: [DVec3; 3], up: DVec3) {
        self.add(corners.map(|corner| (corner, up)));
    }

    fn slice(&mut self, [start, end]: [DVec3; 2], [p, q]: [DVec3; 2]) {
        self.add([(start, p), (end, p), (end, q)]);
        self.add([(start, p), (end, q), (start, q)]);
    }

    fn groove(&mut self, _: [DVec3; 2], _: [DVec3; 2]) {}

    fn corner(&mut self, at: DVec3, radii: [DVec3; 3]) {
        self.add(radii.map(|up| (at, up)));
    }
}
