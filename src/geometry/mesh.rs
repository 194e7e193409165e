//! [`TriMesh`]: a validated triangle mesh and the facts that follow from its connectivity alone.

use crate::geometry::Aabb;
use glam::{DVec3, Vec3};
use std::collections::HashMap;
use thiserror::Error;

/// The largest absolute coordinate a vertex may have, in mesh units.
///
/// The narrow phase multiplies three lengths in `f32`; below this bound the product stays far from overflow.
pub const MAX_COORDINATE: f32 = 1.0e9;

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
    /// Closed, neighbours agree, and the enclosed volume is negative.
    Inward,
    /// Closed, but some neighbours disagree about the outside.
    Mixed,
    /// Not closed: some edge has an odd number of faces.
    Open,
}

/// A validated triangle mesh.
///
/// Faces of zero area are dropped; [`TriMesh::face_ids`] keeps the index each remaining triangle had in the input,
/// and that index is the one users see everywhere. Connectivity is found on *positions*: vertices at the same place
/// count as one, so seams in imported files do not open a closed mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct TriMesh {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    face_ids: Vec<u32>,
    dropped: u32,
    orientation: Orientation,
    component_vertices: Vec<u32>,
}

/// What a stored mesh consists of; see [`TriMesh::from_parts`].
pub(crate) struct MeshParts {
    pub(crate) vertices: Vec<Vec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) face_ids: Vec<u32>,
    pub(crate) dropped: u32,
    pub(crate) orientation: Orientation,
    pub(crate) component_vertices: Vec<u32>,
}

impl TriMesh {
    /// Validates `vertices` and `faces` (three vertex indices each, any winding).
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

        let welded = weld(&vertices);
        let mut orientation = edge_orientation(&faces, &welded);
        let input_faces = faces.len() as u32;
        let (face_ids, triangles): (Vec<u32>, Vec<[u32; 3]>) = (0..input_faces)
            .zip(faces)
            .filter(|(_, t)| !is_degenerate(t.map(|v| vertices[v as usize])))
            .unzip();
        if triangles.is_empty() {
            return Err(MeshError::AllDegenerate { faces: input_faces });
        }
        if orientation == Orientation::Outward && signed_volume(&vertices, &triangles) < 0.0 {
            orientation = Orientation::Inward;
        }
        let component_vertices = component_vertices(&triangles, &welded);
        Ok(Self {
            dropped: input_faces - triangles.len() as u32,
            vertices,
            triangles,
            face_ids,
            orientation,
            component_vertices,
        })
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
        self.dropped
    }

    /// Which way the faces look, and whether the mesh is closed at all.
    pub fn orientation(&self) -> Orientation {
        self.orientation
    }

    /// Whether every edge has a partner, so that the mesh encloses a volume.
    pub fn is_closed(&self) -> bool {
        self.orientation != Orientation::Open
    }

    /// One vertex of every connected component, in order of the components' first faces in the input.
    ///
    /// Containment needs one point per component: if no surfaces cross, a component is inside as a whole or not at all.
    pub fn component_vertices(&self) -> &[u32] {
        &self.component_vertices
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
            dropped: self.dropped,
            orientation: self.orientation,
            component_vertices: self.component_vertices.clone(),
        }
    }

    /// Puts a mesh together that was validated before and stored since. Ranges, coordinates and areas are checked again, as
    /// everything else relies on them; connectivity is believed, which is what makes loading a matter of milliseconds.
    pub(crate) fn from_parts(parts: MeshParts) -> Result<Self, &'static str> {
        let MeshParts {
            vertices,
            triangles,
            face_ids,
            dropped,
            orientation,
            component_vertices,
        } = parts;
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
        if !triangles.iter().flatten().all(in_range) {
            return Err("a triangle names a vertex that does not exist");
        }
        if triangles.iter().any(|t| is_degenerate(t.map(|v| vertices[v as usize]))) {
            return Err("a triangle has no area");
        }
        let faces = triangles.len() as u64 + u64::from(dropped);
        if faces >= u64::from(u32::MAX) || face_ids.len() != triangles.len() {
            return Err("the number of faces is impossible");
        }
        let mut seen = vec![0u64; triangles.len() / 64 + 1];
        let mut beyond = Vec::new();
        for &id in &face_ids {
            if u64::from(id) >= faces {
                return Err("a face id is out of range");
            }
            // Few faces are dropped from real meshes, so few ids lie beyond the triangle count; the bit set is sized by what
            // was really read, never by a number that the file merely claims.
            match seen.get_mut(id as usize / 64) {
                Some(word) if *word & (1 << (id % 64)) != 0 => return Err("a face id comes twice"),
                Some(word) => *word |= 1 << (id % 64),
                None => beyond.push(id),
            }
        }
        beyond.sort_unstable();
        if beyond.windows(2).any(|w| w[0] == w[1]) {
            return Err("a face id comes twice");
        }
        if component_vertices.is_empty()
            || component_vertices.len() > triangles.len()
            || !component_vertices.iter().all(in_range)
        {
            return Err("the list of components is impossible");
        }
        Ok(Self {
            vertices,
            triangles,
            face_ids,
            dropped,
            orientation,
            component_vertices,
        })
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

/// For each vertex the first vertex at the same position (`-0.0` equals `0.0`).
fn weld(vertices: &[Vec3]) -> Vec<u32> {
    let mut first: HashMap<[u32; 3], u32> = HashMap::with_capacity(vertices.len());
    vertices
        .iter()
        .enumerate()
        .map(|(i, v)| {
            let key = (*v + Vec3::ZERO).to_array().map(f32::to_bits);
            *first.entry(key).or_insert(i as u32)
        })
        .collect()
}

/// Pairs edges. Faces of zero area take part as long as their corners differ: a sliver that fills a T-junction keeps a
/// mesh closed although it is dropped later.
fn edge_orientation(faces: &[[u32; 3]], welded: &[u32]) -> Orientation {
    // Per undirected edge: how many faces have it, and how many more run from low to high than back.
    let mut edges: HashMap<(u32, u32), (u32, i32)> = HashMap::with_capacity(faces.len() * 3 / 2);
    for face in faces {
        let [a, b, c] = face.map(|v| welded[v as usize]);
        if a == b || b == c || c == a {
            continue;
        }
        for (u, v) in [(a, b), (b, c), (c, a)] {
            let (count, balance) = edges.entry((u.min(v), u.max(v))).or_default();
            *count += 1;
            *balance += if u < v { 1 } else { -1 };
        }
    }
    if edges.values().any(|(count, _)| count % 2 == 1) {
        Orientation::Open
    } else if edges.values().any(|&(_, balance)| balance != 0) {
        Orientation::Mixed
    } else {
        Orientation::Outward
    }
}

/// Whether the corners lie on one line. Differences of `f32`s are exact in `f64` unless one is some `2^29` times the
/// other, and then so are their products: the comparison with zero is exact for all but absurd triangles.
fn is_degenerate([a, b, c]: [Vec3; 3]) -> bool {
    let a = a.as_dvec3();
    (b.as_dvec3() - a).cross(c.as_dvec3() - a) == DVec3::ZERO
}

/// Six times the volume enclosed, about the first corner so that a distant mesh keeps its digits.
fn signed_volume(vertices: &[Vec3], triangles: &[[u32; 3]]) -> f64 {
    let origin = vertices[triangles[0][0] as usize].as_dvec3();
    let at = |v: u32| vertices[v as usize].as_dvec3() - origin;
    triangles.iter().map(|&[a, b, c]| at(a).dot(at(b).cross(at(c)))).sum()
}

fn component_vertices(triangles: &[[u32; 3]], welded: &[u32]) -> Vec<u32> {
    let mut parent: Vec<u32> = (0..welded.len() as u32).collect();
    fn root(parent: &mut [u32], mut v: u32) -> u32 {
        while parent[v as usize] != v {
            parent[v as usize] = parent[parent[v as usize] as usize];
            v = parent[v as usize];
        }
        v
    }
    for t in triangles {
        let [a, b, c] = t.map(|v| root(&mut parent, welded[v as usize]));
        let low = a.min(b).min(c);
        for v in [a, b, c] {
            parent[v as usize] = low;
        }
    }
    let mut seen = vec![false; welded.len()];
    triangles
        .iter()
        .filter_map(|t| {
            let r = root(&mut parent, welded[t[0] as usize]) as usize;
            (!std::mem::replace(&mut seen[r], true)).then_some(t[0])
        })
        .collect()
}
