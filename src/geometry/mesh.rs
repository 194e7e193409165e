//! [`TriMesh`]: a validated triangle mesh and the facts that follow from its connectivity alone.

use super::topology::{Faces, Gaps, Topology};
use crate::geometry::Aabb;
use glam::{DVec3, Vec3};
use thiserror::Error;

/// The largest absolute coordinate a vertex may have, in mesh units.
///
/// The narrow phase multiplies three lengths in `f32`; below this bound the product stays far from overflow.
pub const MAX_COORDINATE: f32 = 1.0e9;

/// Corners no farther apart than this part of the mesh's size count as one, unless the bake says otherwise: some steps of
/// single precision, which is what the two sides of a seam differ by.
pub const WELD_TOLERANCE: f32 = 1.0e-6;

/// Why a list of vertices and faces is not a usable mesh.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum MeshError {
    /// There is no face at all.
    #[error("the mesh has no faces")]
    Empty,
    /// More vertices or faces than 32-bit indices can name.
    #[error("the mesh has {count} {what}, more than 32-bit indices can name")]
    TooLarge {
        /// `"vertices"` or `"faces"`.
        what: &'static str,
        /// How many there are.
        count: usize,
    },
    /// A vertex has a NaN or infinite coordinate.
    #[error("vertex {vertex} is not finite: {position}")]
    NonFinite {
        /// Index of the vertex.
        vertex: u32,
        /// Its coordinates.
        position: Vec3,
    },
    /// A vertex is farther from the origin than [`MAX_COORDINATE`].
    #[error("vertex {vertex} at {position} has a coordinate beyond {MAX_COORDINATE:e}: use a larger unit of length")]
    TooFar {
        /// Index of the vertex.
        vertex: u32,
        /// Its coordinates.
        position: Vec3,
    },
    /// A face names a vertex that does not exist.
    #[error("face {face} names vertex {index}, but the mesh has {vertices} vertices")]
    IndexOutOfRange {
        /// Index of the face.
        face: u32,
        /// The index it names.
        index: u32,
        /// How many vertices there are.
        vertices: u32,
    },
    /// Every face has zero area.
    #[error("all {faces} faces are degenerate (zero area)")]
    AllDegenerate {
        /// How many faces there are.
        faces: u32,
    },
}

/// Which way the faces of a mesh look, found by pairing edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub enum Orientation {
    /// Closed, neighbours agree, and the enclosed volume is positive: counter-clockwise seen from outside.
    Outward,
    /// Closed, neighbours agree, and the enclosed volume is negative: a room, whose walls are solid and whose inside is not.
    Inward,
    /// Closed, but some neighbours disagree about the outside.
    Mixed,
    /// Not closed: some edge has an odd number of faces.
    Open,
}

/// A validated triangle mesh.
///
/// Faces of zero area are dropped; [`TriMesh::face_ids`] keeps the index each remaining triangle had in the input,
/// and that index is the one users see everywhere. Connectivity is found on *places*: vertices at the same place, or within
/// a tolerance of it, count as one, so seams in imported files do not open a closed mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct TriMesh {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    face_ids: Vec<u32>,
    dropped: Vec<[u32; 3]>,
    is_turned: bool,
    topology: Topology,
}

/// What a stored mesh consists of; see [`TriMesh::from_parts`].
pub(crate) struct MeshParts {
    pub(crate) vertices: Vec<Vec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) face_ids: Vec<u32>,
    pub(crate) dropped: Vec<[u32; 3]>,
    pub(crate) is_turned: bool,
    pub(crate) weld_tolerance: f32,
}

impl TriMesh {
    /// Validates `vertices` and `faces` (three vertex indices each, any winding). Corners within [`WELD_TOLERANCE`] count as
    /// one.
    pub fn new(vertices: Vec<Vec3>, faces: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        // u32::MAX stays free, so that "none" can be stored in an index.
        for (what, count) in [("vertices", vertices.len()), ("faces", faces.len())] {
            if count >= u32::MAX as usize {
                return Err(MeshError::TooLarge { what, count });
            }
        }
        if faces.is_empty() {
            return Err(MeshError::Empty);
        }
        for (i, &position) in vertices.iter().enumerate() {
            let vertex = i as u32;
            if !position.is_finite() {
                return Err(MeshError::NonFinite { vertex, position });
            }
            if position.abs().max_element() > MAX_COORDINATE {
                return Err(MeshError::TooFar { vertex, position });
            }
        }
        for (face, corners) in faces.iter().enumerate() {
            if let Some(&index) = corners.iter().find(|&&v| v as usize >= vertices.len()) {
                return Err(MeshError::IndexOutOfRange {
                    face: face as u32,
                    index,
                    vertices: vertices.len() as u32,
                });
            }
        }

        let (mut triangles, mut face_ids, mut dropped) = (Vec::with_capacity(faces.len()), Vec::new(), Vec::new());
        for (id, face) in (0..).zip(faces) {
            if is_degenerate(face.map(|v| vertices[v as usize])) {
                dropped.push(face);
            } else {
                triangles.push(face);
                face_ids.push(id);
            }
        }
        if triangles.is_empty() {
            return Err(MeshError::AllDegenerate {
                faces: dropped.len() as u32,
            });
        }
        Ok(Self::assembled(MeshParts {
            vertices,
            triangles,
            face_ids,
            dropped,
            is_turned: false,
            weld_tolerance: WELD_TOLERANCE,
        }))
    }

    /// Finds out how the parts hang together.
    fn assembled(parts: MeshParts) -> Self {
        let faces = Faces {
            vertices: &parts.vertices,
            triangles: &parts.triangles,
            face_ids: &parts.face_ids,
            dropped: &parts.dropped,
        };
        Self {
            topology: Topology::of(&faces, parts.weld_tolerance),
            vertices: parts.vertices,
            triangles: parts.triangles,
            face_ids: parts.face_ids,
            dropped: parts.dropped,
            is_turned: parts.is_turned,
        }
    }

    fn faces(&self) -> Faces<'_> {
        Faces {
            vertices: &self.vertices,
            triangles: &self.triangles,
            face_ids: &self.face_ids,
            dropped: &self.dropped,
        }
    }

    /// The same mesh in which corners count as one that are no farther apart than `tolerance` times the diagonal of its box;
    /// with 0 only those at the same place. What follows from connectivity is found anew; triangles stay what they are, to
    /// the bit.
    pub fn with_weld_tolerance(self, tolerance: f32) -> Self {
        if self.topology.tolerance == tolerance {
            return self;
        }
        let topology = Topology::of(&self.faces(), tolerance);
        Self { topology, ..self }
    }

    /// The tolerance within which corners count as one, as a part of the diagonal of the mesh's box.
    pub fn weld_tolerance(&self) -> f32 {
        self.topology.tolerance
    }

    /// The same mesh with all its faces looking the other way.
    pub fn turned(mut self) -> Self {
        for face in self.triangles.iter_mut().chain(&mut self.dropped) {
            face.swap(1, 2);
        }
        self.is_turned = !self.is_turned;
        if matches!(self.topology.orientation, Orientation::Outward | Orientation::Inward) {
            self.topology.orientation = self.faces().outward_or_inward(&self.topology.welded);
        }
        self
    }

    /// Whether its faces look the other way than in the input.
    pub fn is_turned(&self) -> bool {
        self.is_turned
    }

    /// All vertices of the input, the unused ones too.
    pub fn vertices(&self) -> &[Vec3] {
        &self.vertices
    }

    /// The triangles of non-zero area: three vertex indices each.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The corner positions of triangle `t`.
    pub fn corners(&self, t: usize) -> [Vec3; 3] {
        self.triangles[t].map(|v| self.vertices[v as usize])
    }

    /// For each triangle the index of its face in the input.
    pub fn face_ids(&self) -> &[u32] {
        &self.face_ids
    }

    /// How many faces of the input were dropped because their area is zero.
    pub fn dropped(&self) -> u32 {
        self.dropped.len() as u32
    }

    /// The faces that were dropped: three vertex indices each, in the order of the input.
    pub fn dropped_faces(&self) -> &[[u32; 3]] {
        &self.dropped
    }

    /// For each vertex the one that stands for all that count as one with it; it stands for itself.
    pub fn welded(&self) -> &[u32] {
        &self.topology.welded
    }

    /// The corner positions of triangle `t` after corners that count as one have been joined: there is no gap at a seam.
    /// They may be in one place or on one line.
    pub fn welded_corners(&self, t: usize) -> [Vec3; 3] {
        self.triangles[t].map(|v| self.vertices[self.topology.welded[v as usize] as usize])
    }

    /// Which way the faces look, and whether the mesh is closed at all.
    pub fn orientation(&self) -> Orientation {
        self.topology.orientation
    }

    /// Whether every edge has a partner, so that the mesh encloses a volume.
    pub fn is_closed(&self) -> bool {
        self.topology.orientation != Orientation::Open
    }

    /// Whether what the mesh encloses is solid, so that another body can be wholly inside: it is closed, and no room.
    pub fn is_solid(&self) -> bool {
        matches!(self.topology.orientation, Orientation::Outward | Orientation::Mixed)
    }

    /// Where the mesh is open; `None` if it is closed. Found at every call.
    pub fn gaps(&self) -> Option<Gaps> {
        if self.is_closed() {
            return None;
        }
        self.faces().gaps(&self.topology.welded)
    }

    /// One vertex of every connected component, in order of the components' first faces in the input.
    ///
    /// Containment needs one point per component: if no surfaces cross, a component is inside as a whole or not at all.
    pub fn component_vertices(&self) -> &[u32] {
        &self.topology.component_vertices
    }

    /// The same mesh with its triangles in another order: triangle `i` of the result is triangle `order[i]` of `self`.
    /// Vertices, face ids and everything that follows from connectivity stay what they were.
    ///
    /// # Panics
    /// If `order` is not a permutation of the triangles' indices.
    pub fn reordered(&self, order: &[u32]) -> Self {
        assert_eq!(order.len(), self.triangles.len(), "an order names every triangle once");
        let mut seen = vec![false; order.len()];
        for &t in order {
            assert!(
                !std::mem::replace(&mut seen[t as usize], true),
                "an order names every triangle once, but triangle {t} comes twice"
            );
        }
        Self {
            vertices: self.vertices.clone(),
            triangles: order.iter().map(|&t| self.triangles[t as usize]).collect(),
            face_ids: order.iter().map(|&t| self.face_ids[t as usize]).collect(),
            dropped: self.dropped.clone(),
            is_turned: self.is_turned,
            topology: self.topology.clone(),
        }
    }

    /// Puts a mesh together that was validated before and stored since. Ranges, coordinates and areas are checked again, as
    /// everything else relies on them, and connectivity is found again.
    pub(crate) fn from_parts(parts: MeshParts) -> Result<Self, &'static str> {
        let MeshParts {
            vertices,
            triangles,
            face_ids,
            dropped,
            ..
        } = &parts;
        let in_range = |v: &u32| (*v as usize) < vertices.len();
        if triangles.is_empty() || vertices.len() >= u32::MAX as usize {
            return Err("it has no triangles, or more vertices than indices can name");
        }
        if !vertices
            .iter()
            .all(|v| v.abs().max_element() <= MAX_COORDINATE && v.is_finite())
        {
            return Err("a vertex is not finite or too far out");
        }
        if !triangles.iter().chain(dropped).flatten().all(in_range) {
            return Err("a triangle names a vertex that does not exist");
        }
        let has_no_area = |t: &[u32; 3]| is_degenerate(t.map(|v| vertices[v as usize]));
        if triangles.iter().any(has_no_area) {
            return Err("a triangle has no area");
        }
        if !dropped.iter().all(has_no_area) {
            return Err("a face was dropped that has an area");
        }
        let faces = triangles.len() as u64 + dropped.len() as u64;
        if faces >= u64::from(u32::MAX) || face_ids.len() != triangles.len() {
            return Err("the number of faces is impossible");
        }
        let mut seen = vec![false; faces as usize];
        for &id in face_ids {
            match seen.get_mut(id as usize) {
                None => return Err("a face id is out of range"),
                Some(true) => return Err("a face id comes twice"),
                Some(seen) => *seen = true,
            }
        }
        Ok(Self::assembled(parts))
    }

    /// The box around all triangles.
    pub fn aabb(&self) -> Aabb {
        Aabb::around(self.used_positions())
    }

    /// The positions that triangles use, once per use.
    pub fn used_positions(&self) -> impl Iterator<Item = Vec3> + '_ {
        self.triangles.iter().flatten().map(|&v| self.vertices[v as usize])
    }
}

/// Whether the corners lie on one line. Differences of `f32`s are exact in `f64` unless one is some `2^29` times the
/// other, and then so are their products: the comparison with zero is exact for all but absurd triangles.
fn is_degenerate([a, b, c]: [Vec3; 3]) -> bool {
    let a = a.as_dvec3();
    (b.as_dvec3() - a).cross(c.as_dvec3() - a) == DVec3::ZERO
}
