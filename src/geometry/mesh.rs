//! [`TriMesh`]: a validated triangle mesh with its connectivity.

use super::mesh_error::MeshError;
use super::topology::{Closure, DefectKind, Defects, Faces, Gaps, Orientation, Patches, Topology};
use crate::geometry::Aabb;
use glam::{DVec3, Vec3};
use std::hint::black_box;

/// The largest absolute coordinate a vertex may have, in mesh units.
///
/// The narrow phase multiplies three lengths in `f32`. Below this bound the product stays far from overflow.
pub const MAX_COORDINATE: f32 = 1.0e9;

/// The default weld tolerance, relative to the diagonal of the mesh's bounding box.
///
/// It is a few steps of single precision: the two sides of a seam in an imported file differ by about as much.
pub const WELD_TOLERANCE: f32 = 1.0e-6;

/// A validated triangle mesh.
///
/// Faces of zero area are dropped. [`TriMesh::face_ids`] keeps the input index of each remaining triangle. Reports to
/// users always name faces by that index.
///
/// Connectivity is computed on *welded* vertices: vertices within a tolerance of each other count as one. A seam in an
/// imported file therefore does not open a closed mesh. Welding changes only connectivity. Vertices and triangles keep
/// the coordinates of the input.
#[derive(Clone, Debug, PartialEq)]
pub struct TriMesh {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    face_ids: Vec<u32>,
    dropped: Vec<[u32; 3]>,
    /// For each face of the input, whether its winding is reversed; empty if no face is.
    turned: Vec<bool>,
    topology: Box<Topology>,
}

/// The fields of a stored mesh; see [`TriMesh::from_parts`].
pub(crate) struct MeshParts {
    pub(crate) vertices: Vec<Vec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) face_ids: Vec<u32>,
    pub(crate) dropped: Vec<[u32; 3]>,
    /// For each face of the input, whether its winding is reversed; empty if no face is.
    pub(crate) turned: Vec<bool>,
    pub(crate) weld_tolerance: f32,
}

impl TriMesh {
    /// Validates `vertices` and `faces` (three vertex indices each, any winding). Connectivity uses [`WELD_TOLERANCE`].
    ///
    /// # Errors
    /// If the input has no faces of non-zero area, an invalid coordinate or an invalid index; see [`MeshError`].
    pub fn new(vertices: Vec<Vec3>, faces: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        // The index u32::MAX is reserved for "none".
        for (what, count) in [("vertices", vertices.len()), ("faces", faces.len())] {
            if count >= u32::MAX as usize {
                return Err(MeshError::TooLarge { what, count });
            }
        }
        if faces.is_empty() {
            return Err(MeshError::Empty);
        }
        check_vertices(&vertices)?;
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
            turned: Vec::new(),
            weld_tolerance: WELD_TOLERANCE,
        }))
    }

    /// A mesh without faces: a segment between two points, or a single point if both are equal. Only the core of a
    /// rounded mesh can be one: its surface is all that is within a distance of it.
    ///
    /// # Errors
    /// If a coordinate is invalid; see [`MeshError`].
    pub fn segment(ends: [Vec3; 2]) -> Result<Self, MeshError> {
        check_vertices(&ends)?;
        let [start, end] = ends;
        let (vertices, triangle) = if start == end {
            (vec![start], [0, 0, 0])
        } else {
            (vec![start, end], [0, 1, 1])
        };
        Ok(Self::assembled(MeshParts {
            vertices,
            triangles: vec![triangle],
            face_ids: vec![0],
            dropped: Vec::new(),
            turned: Vec::new(),
            weld_tolerance: 0.0,
        }))
    }

    /// Whether this is a single segment or a single point; see [`TriMesh::segment`].
    pub fn is_thin(&self) -> bool {
        is_thin(&self.triangles)
    }

    /// Computes the connectivity of validated parts.
    fn assembled(parts: MeshParts) -> Self {
        let faces = Faces {
            vertices: &parts.vertices,
            triangles: &parts.triangles,
            face_ids: &parts.face_ids,
            dropped: &parts.dropped,
            twins: &[],
        };
        Self {
            topology: Box::new(Topology::of(&faces, parts.weld_tolerance)),
            vertices: parts.vertices,
            triangles: parts.triangles,
            face_ids: parts.face_ids,
            dropped: parts.dropped,
            turned: parts.turned,
        }
    }

    fn faces(&self) -> Faces<'_> {
        Faces {
            vertices: &self.vertices,
            triangles: &self.triangles,
            face_ids: &self.face_ids,
            dropped: &self.dropped,
            twins: &self.topology.twins,
        }
    }

    /// A copy of the mesh with another weld tolerance, relative to the diagonal of its bounding box. With 0 only
    /// vertices at exactly the same position are welded.
    ///
    /// Recomputes the connectivity. Vertices and triangles stay bit-identical.
    pub fn with_weld_tolerance(self, tolerance: f32) -> Self {
        if self.topology.tolerance == tolerance || self.is_thin() {
            return self;
        }
        self.with_topology_at(tolerance)
    }

    /// Computes the whole topology again.
    fn with_topology_at(mut self, tolerance: f32) -> Self {
        let all = Faces {
            twins: &[],
            ..self.faces()
        };
        *self.topology = Topology::of(&all, tolerance);
        self
    }

    /// The weld tolerance, relative to the diagonal of the mesh's bounding box.
    pub fn weld_tolerance(&self) -> f32 {
        self.topology.tolerance
    }

    /// A copy of the mesh with the winding of all faces reversed.
    pub fn flipped(self) -> Self {
        self.turned_where(|_| true)
    }

    /// A copy of the mesh in which the winding of each shell is consistent and the faces of solids point outward.
    ///
    /// A *shell* is a set of faces that hang together across edges of two faces each. Edges are those of the welded
    /// mesh.
    ///
    /// * If neighbouring faces of a shell disagree, some are turned. The faces of a closed shell then point outward, as
    ///   do those of an open one that encloses something. A closed shell inside another closed one becomes a cavity of
    ///   that. In a sheet the part with the smaller area is turned.
    /// * A closed shell outside all others that points inward is turned, and what lies inside it with it. But if all
    ///   such shells point inward in the input, the mesh is a room, and none is turned.
    /// * A shell inside another stays as it is: wound oppositely it is a cavity, wound alike a solid inside a solid;
    ///   see [`DefectKind::SolidInSolid`].
    /// * A shell that has no consistent winding, like a Möbius strip, stays as it is.
    pub fn oriented(self) -> Self {
        // One closed surface is a solid or a room as it is.
        if self.topology.is_one_surface() {
            return self;
        }
        let turn = self.faces().faces_to_turn(&self.topology.welded);
        if !turn.contains(&true) {
            return self;
        }
        // `turn` lists the triangles, then the dropped faces.
        let mut by_id = vec![false; turn.len()];
        for (id, turn) in self.face_ids.iter().copied().chain(self.dropped_ids()).zip(turn) {
            by_id[id as usize] = turn;
        }
        self.turned_where(|id| by_id[id as usize])
    }

    /// A copy of the mesh with the winding of the input.
    pub fn as_input(self) -> Self {
        if self.turned.is_empty() {
            return self;
        }
        let turned = self.turned.clone();
        self.turned_where(|id| turned.get(id as usize).is_some_and(|turned| *turned))
    }

    /// Reverses the winding of the faces for which `turn` holds, by their index in the input.
    fn turned_where(mut self, turn: impl Fn(u32) -> bool) -> Self {
        let dropped_ids = self.dropped_ids();
        let ids = self.face_ids.iter().copied().chain(dropped_ids);
        let mut turned = std::mem::take(&mut self.turned);
        turned.resize(self.triangles.len() + self.dropped.len(), false);
        for (face, id) in self.triangles.iter_mut().chain(&mut self.dropped).zip(ids) {
            if turn(id) {
                face.swap(1, 2);
                turned[id as usize] ^= true;
            }
        }
        if turned.contains(&true) {
            self.turned = turned;
        }
        if self.topology.may_have_twins() {
            // Which faces count may depend on the winding of the others. A stored mesh is read with its current
            // winding.
            let tolerance = self.topology.tolerance;
            return self.with_topology_at(tolerance);
        }
        *self.topology = self.faces().rewound((*self.topology).clone());
        self
    }

    /// The indices of the dropped faces in the input.
    fn dropped_ids(&self) -> Vec<u32> {
        let mut is_triangle = vec![false; self.triangles.len() + self.dropped.len()];
        for &id in &self.face_ids {
            is_triangle[id as usize] = true;
        }
        (0..)
            .zip(is_triangle)
            .filter_map(|(id, is_triangle)| (!is_triangle).then_some(id))
            .collect()
    }

    /// Whether the winding of triangle `t` is reversed relative to the input.
    #[inline]
    pub fn is_turned(&self, t: usize) -> bool {
        !self.turned.is_empty() && self.turned[self.face_ids[t] as usize]
    }

    /// For each face of the input, whether its winding is reversed; empty if no face is.
    pub fn turned(&self) -> &[bool] {
        &self.turned
    }

    /// All vertices of the input, including unused ones.
    pub fn vertices(&self) -> &[Vec3] {
        &self.vertices
    }

    /// The triangles of non-zero area: three vertex indices each. A segment has one triangle, without area.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The corner positions of triangle `t`.
    #[inline(always)]
    pub fn corners(&self, t: usize) -> [Vec3; 3] {
        let [u, v, w] = self.triangles[t];
        [
            self.vertices[u as usize],
            self.vertices[v as usize],
            self.vertices[w as usize],
        ]
    }

    /// Reads triangle `t`, so that it and its neighbours are soon in the cache. The processor goes on meanwhile.
    #[inline(always)]
    pub(crate) fn read_early(&self, t: usize) {
        black_box(self.triangles[t].map(|v| self.vertices[v as usize].x));
        black_box(self.face_ids[t]);
    }

    /// The corner positions of a face by its index in the input, in the input's order of corners. `None` if there is no
    /// such face, or it has no area. Looks at all triangles.
    pub fn input_face(&self, face: u32) -> Option<[Vec3; 3]> {
        let t = self.face_ids.iter().position(|&id| id == face)?;
        let [a, b, c] = self.corners(t);
        Some(if self.is_turned(t) { [a, c, b] } else { [a, b, c] })
    }

    /// For each triangle, the index of its face in the input.
    pub fn face_ids(&self) -> &[u32] {
        &self.face_ids
    }

    /// The number of input faces that were dropped because their area is zero.
    pub fn dropped(&self) -> u32 {
        self.dropped.len() as u32
    }

    /// The dropped faces: three vertex indices each, in input order.
    pub fn dropped_faces(&self) -> &[[u32; 3]] {
        &self.dropped
    }

    /// All faces, three vertex indices each: the triangles and the dropped ones, in the order of the input.
    pub fn all_faces(&self) -> Vec<[u32; 3]> {
        let mut faces = vec![None; self.triangles.len() + self.dropped.len()];
        for (&id, &triangle) in self.face_ids.iter().zip(&self.triangles) {
            faces[id as usize] = Some(triangle);
        }
        let mut dropped = self.dropped.iter().copied();
        let faces = faces.into_iter().filter_map(|face| face.or_else(|| dropped.next()));
        faces.collect()
    }

    /// For each vertex, the representative of the vertices it is welded with. A representative maps to itself.
    pub fn welded(&self) -> &[u32] {
        &self.topology.welded
    }

    /// The corner positions of triangle `t` after welding, so that seams have no gap. Welding may make the triangle
    /// degenerate.
    pub fn welded_corners(&self, t: usize) -> [Vec3; 3] {
        self.triangles[t].map(|v| self.vertices[self.topology.welded[v as usize] as usize])
    }

    /// Whether the mesh is closed, and which way its faces point.
    pub fn orientation(&self) -> Orientation {
        self.topology.orientation
    }

    /// Whether every edge has an even number of faces, so that the mesh encloses a volume.
    pub fn is_closed(&self) -> bool {
        self.topology.orientation != Orientation::Open
    }

    /// Whether the enclosed volume is solid, so that another body can lie wholly inside. This holds for a mesh that is
    /// closed or nearly so, unless it is a room ([`Orientation::Inward`]).
    pub fn is_solid(&self) -> bool {
        match self.topology.orientation {
            Orientation::Outward | Orientation::Mixed => true,
            Orientation::Inward => false,
            Orientation::Open => self.topology.closed_by_caps() == Some(Orientation::Outward),
        }
    }

    /// Whether the mesh is closed or nearly so, and its faces point inward.
    pub fn is_room(&self) -> bool {
        self.topology.orientation == Orientation::Inward || self.topology.closed_by_caps() == Some(Orientation::Inward)
    }

    /// Triangles that close a *nearly closed* mesh; none for other meshes. They have no number: nothing collides with
    /// them.
    ///
    /// A mesh is nearly closed if its winding is consistent, its largest opening takes at most [`MAX_OPENING`] of its
    /// area, and all together take at most a fifth. Mass and containment are those of the mesh with its caps, so that a
    /// crack or a missing face changes neither. Openings through which something could fall, as that of a box without a
    /// lid, get no caps.
    ///
    /// If faces are there twice, and the mesh is closed or nearly so without them, they count once: each has its
    /// reverse among the caps.
    ///
    /// [`MAX_OPENING`]: crate::geometry::MAX_OPENING
    pub fn caps(&self) -> &[[Vec3; 3]] {
        &self.topology.caps
    }

    /// The vertices of triangles without area that close the mesh: dropped faces, and caps that close T-junctions.
    pub(crate) fn slivers(&self) -> impl Iterator<Item = &[u32; 3]> {
        self.dropped.iter().chain(&self.topology.slivers)
    }

    /// Pairs of a triangle that does not count for what the mesh encloses and the earlier one with the same corners
    /// that does. Both collide. Empty if the mesh is open without the former.
    pub(crate) fn twins(&self) -> Vec<[usize; 2]> {
        self.faces().twin_triangles()
    }

    /// What closes an open mesh of consistent winding, however large its openings are; `None` for other meshes.
    /// Computed at every call.
    pub(super) fn closure(&self) -> Option<Closure> {
        self.faces().closure(&self.topology)
    }

    /// The patches of the surface. Computed at every call.
    pub(super) fn patches(&self) -> Patches {
        self.faces().patches(&self.topology.welded)
    }

    /// What is wrong with the mesh, counted. Computed at every call.
    pub fn defects(&self) -> Defects {
        let mut defects = self.faces().defects(&self.topology);
        let turned = (0..self.triangles.len()).filter(|&t| self.is_turned(t));
        for t in turned {
            defects.add(DefectKind::TurnedFace, self.corners(t), Some(self.face_ids[t]));
        }
        for (face, id) in self.dropped.iter().zip(self.dropped_ids()) {
            let corners = face.map(|v| self.vertices[v as usize]);
            defects.add(DefectKind::ZeroArea, corners, Some(id));
        }
        defects
    }

    /// The boundary edges of an open mesh; `None` if it is closed. Computed at every call.
    pub fn gaps(&self) -> Option<Gaps> {
        if self.is_closed() {
            return None;
        }
        self.faces().gaps(&self.topology.welded)
    }

    /// One vertex of each connected component, ordered by the components' first faces in the input.
    ///
    /// The containment test needs one point per component: if no surfaces cross, a component is wholly inside or wholly
    /// outside.
    pub fn component_vertices(&self) -> &[u32] {
        &self.topology.component_vertices
    }

    /// A copy of the mesh with its triangles in another order: triangle `i` of the result is triangle `order[i]` of
    /// `self`. Face ids move with their triangles. Vertices and connectivity do not change.
    ///
    /// # Panics
    /// If `order` is not a permutation of the triangles' indices.
    pub fn reordered(&self, order: &[u32]) -> Self {
        assert_eq!(order.len(), self.triangles.len(), "an order lists every triangle once");
        let mut seen = vec![false; order.len()];
        for &t in order {
            assert!(
                !std::mem::replace(&mut seen[t as usize], true),
                "an order lists every triangle once, but triangle {t} is listed twice"
            );
        }
        Self {
            vertices: self.vertices.clone(),
            triangles: order.iter().map(|&t| self.triangles[t as usize]).collect(),
            face_ids: order.iter().map(|&t| self.face_ids[t as usize]).collect(),
            dropped: self.dropped.clone(),
            turned: self.turned.clone(),
            topology: self.topology.clone(),
        }
    }

    /// A copy of the mesh with each vertex moved. Faces keep their ids.
    ///
    /// # Errors
    /// If a vertex has an invalid coordinate, or no face has an area; see [`MeshError`].
    #[cfg(feature = "bevy")]
    pub(crate) fn mapped(&self, map: impl Fn(Vec3) -> Vec3) -> Result<Self, MeshError> {
        if self.is_thin() {
            let [start, _, end] = self.corners(0);
            return Self::segment([map(start), map(end)]);
        }
        let vertices = self.vertices.iter().map(|&v| map(v)).collect();
        let mesh = Self::new(vertices, self.all_faces())?;
        Ok(Self {
            turned: self.turned.clone(),
            ..mesh
        })
    }

    /// Rebuilds a mesh from stored parts. Validates ranges, coordinates and areas again, because all other code relies
    /// on them, and recomputes the connectivity.
    ///
    /// # Errors
    /// A sentence that says what is wrong with the parts.
    pub(crate) fn from_parts(parts: MeshParts) -> Result<Self, &'static str> {
        let MeshParts {
            vertices,
            triangles,
            face_ids,
            dropped,
            turned,
            ..
        } = &parts;
        let in_range = |v: &u32| (*v as usize) < vertices.len();
        if triangles.is_empty() || vertices.len() >= u32::MAX as usize {
            return Err("it has no triangles, or more vertices than indices can address");
        }
        if !vertices
            .iter()
            .all(|v| v.abs().max_element() <= MAX_COORDINATE && v.is_finite())
        {
            return Err("a vertex is not finite or too far out");
        }
        if !triangles.iter().chain(dropped).flatten().all(in_range) {
            return Err("a triangle refers to a vertex that does not exist");
        }
        let has_no_area = |t: &[u32; 3]| is_degenerate(t.map(|v| vertices[v as usize]));
        if !is_thin(triangles) && triangles.iter().any(has_no_area) {
            return Err("a triangle has no area");
        }
        if !dropped.iter().all(has_no_area) {
            return Err("a dropped face has a non-zero area");
        }
        let faces = triangles.len() as u64 + dropped.len() as u64;
        if faces >= u64::from(u32::MAX) || face_ids.len() != triangles.len() {
            return Err("the number of faces is impossible");
        }
        if !turned.is_empty() && (turned.len() as u64 != faces || !turned.contains(&true)) {
            return Err("its list of turned faces is invalid");
        }
        let mut seen = vec![false; faces as usize];
        for &id in face_ids {
            match seen.get_mut(id as usize) {
                None => return Err("a face id is out of range"),
                Some(true) => return Err("a face id occurs twice"),
                Some(seen) => *seen = true,
            }
        }
        let weld_tolerance = if is_thin(triangles) { 0.0 } else { parts.weld_tolerance };
        Ok(Self::assembled(MeshParts {
            weld_tolerance,
            ..parts
        }))
    }

    /// The bounding box of all triangles.
    pub fn aabb(&self) -> Aabb {
        Aabb::around(self.used_positions())
    }

    /// The corner positions of all triangles. A shared vertex occurs once per triangle.
    pub fn used_positions(&self) -> impl Iterator<Item = Vec3> + '_ {
        self.triangles.iter().flatten().map(|&v| self.vertices[v as usize])
    }
}

/// Checks that all coordinates are finite and not too large.
fn check_vertices(vertices: &[Vec3]) -> Result<(), MeshError> {
    for (vertex, &position) in (0..).zip(vertices) {
        if !position.is_finite() {
            return Err(MeshError::NonFinite { vertex, position });
        }
        if position.abs().max_element() > MAX_COORDINATE {
            return Err(MeshError::TooFar { vertex, position });
        }
    }
    Ok(())
}

/// Whether these are the triangles of [`TriMesh::segment`].
fn is_thin(triangles: &[[u32; 3]]) -> bool {
    matches!(triangles, [[0, end, other]] if end == other && *end <= 1)
}

/// Whether the corners are collinear.
///
/// The comparison with zero is exact for all but absurd triangles: the difference of two `f32`s is exact in `f64`
/// unless one is about `2^29` times the other, and the products of such differences are exact too.
pub(super) fn is_degenerate([a, b, c]: [Vec3; 3]) -> bool {
    let a = a.as_dvec3();
    (b.as_dvec3() - a).cross(c.as_dvec3() - a) == DVec3::ZERO
}
