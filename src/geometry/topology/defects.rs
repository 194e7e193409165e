//! What is wrong with a mesh, with places.

use super::boundary::Boundary;
use super::{Faces, Topology};
use crate::geometry::Aabb;
use crate::geometry::box_tree::BoxTree;
use crate::geometry::weld::size;
use glam::Vec3;
use serde::{Deserialize, Serialize};

/// Two boundary edges are the sides of a crack if their ends are no farther apart than this, relative to the diagonal
/// of the mesh's bounding box.
const CRACK: f64 = 1.0e-3;

/// A kind of defect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum DefectKind {
    /// A face of zero area, which is no triangle of the mesh.
    ZeroArea,
    /// A face with the same corners as an earlier one, in any order.
    Duplicate,
    /// A face whose winding the bake reversed.
    TurnedFace,
    /// An edge whose faces disagree about the winding.
    Disagreement,
    /// An edge of more than two faces.
    CrowdedEdge,
    /// An edge of an odd number of faces: the mesh is open there.
    BoundaryEdge,
    /// A vertex on an edge of a face that is no corner of that face.
    TJunction,
    /// An edge of an opening with another one beside it, a thousandth of the mesh's size away or less: a larger weld
    /// tolerance joins the two.
    Crack,
    /// Boundary edges that hang together around a hole.
    Opening,
    /// A closed shell inside another that is wound alike: a solid inside a solid, counted twice in the mass.
    SolidInSolid,
}

impl DefectKind {
    /// All kinds, in the order of their declaration.
    pub const ALL: [Self; 10] = [
        Self::ZeroArea,
        Self::Duplicate,
        Self::TurnedFace,
        Self::Disagreement,
        Self::CrowdedEdge,
        Self::BoundaryEdge,
        Self::TJunction,
        Self::Crack,
        Self::Opening,
        Self::SolidInSolid,
    ];

    /// What it is called, in the plural.
    pub fn name(self) -> &'static str {
        match self {
            Self::ZeroArea => "faces of zero area",
            Self::Duplicate => "duplicate faces",
            Self::TurnedFace => "turned faces",
            Self::Disagreement => "edges whose faces disagree",
            Self::CrowdedEdge => "edges of more than two faces",
            Self::BoundaryEdge => "boundary edges",
            Self::TJunction => "T-junctions",
            Self::Crack => "edges of cracks",
            Self::Opening => "openings",
            Self::SolidInSolid => "solids inside a solid",
        }
    }
}

/// A defect of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Defect {
    /// What it is.
    pub kind: DefectKind,
    /// Where it is, in mesh space: the middle of the face or edge, the vertex, a vertex of the opening or of the shell.
    pub position: Vec3,
    /// The face, an index of the input; `None` if it is no face.
    pub face: Option<u32>,
}

/// The defects of a mesh. An empty list does not mean that nothing is wrong: whether the surface intersects itself is
/// not looked for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Defects {
    list: Vec<Defect>,
    /// The area of the largest opening, relative to that of the mesh; 0 without openings.
    pub largest_opening: f64,
}

impl Defects {
    /// All defects; those of a kind in the order of the input.
    pub fn list(&self) -> &[Defect] {
        &self.list
    }

    /// The defects of a kind.
    pub fn of(&self, kind: DefectKind) -> impl Iterator<Item = &Defect> {
        self.list.iter().filter(move |defect| defect.kind == kind)
    }

    /// The number of defects of a kind.
    pub fn count(&self, kind: DefectKind) -> usize {
        self.of(kind).count()
    }

    /// Adds a defect at the middle of `points`.
    pub(in crate::geometry) fn add<const N: usize>(&mut self, kind: DefectKind, points: [Vec3; N], face: Option<u32>) {
        self.list.push(Defect {
            kind,
            position: points.iter().map(|p| *p / N as f32).sum(),
            face,
        });
    }
}

impl Faces<'_> {
    /// All defects but those that are known of single faces: zero area, and turned.
    pub fn defects(&self, topology: &Topology) -> Defects {
        let mut defects = Defects::default();
        // Two faces on each other may be one surface.
        if topology.is_one_surface() && self.triangles.len() > 2 {
            return defects;
        }
        let welded = &topology.welded;
        for [t, _] in self.doubled(welded) {
            defects.add(DefectKind::Duplicate, self.placed(t, welded), Some(self.face_ids[t]));
        }
        let place = |v: u32| self.vertices[welded[v as usize] as usize];
        let (edges, counts) = self.edges(welded);
        for (ends, count) in edges.ends.iter().zip(&counts) {
            let ends = ends.map(place);
            if count.is_boundary() {
                defects.add(DefectKind::BoundaryEdge, ends, None);
            } else if count.balance != 0 {
                defects.add(DefectKind::Disagreement, ends, None);
            }
        }
        // All faces crowd an edge, also those that do not count.
        let (all_edges, all_counts) = Faces { twins: &[], ..*self }.edges(welded);
        for (ends, count) in all_edges.ends.iter().zip(&all_counts) {
            if count.faces > 2 {
                defects.add(DefectKind::CrowdedEdge, ends.map(place), None);
            }
        }
        let boundary = self.boundary(&edges, &counts, welded, topology.tolerance);
        for &vertex in &boundary.t_junctions {
            defects.add(DefectKind::TJunction, [place(vertex)], None);
        }
        for edge in self.cracks(&boundary, welded) {
            defects.add(DefectKind::Crack, edge.map(place), None);
        }
        for opening in &boundary.openings {
            defects.add(DefectKind::Opening, [place(opening.vertex)], None);
        }
        defects.largest_opening = boundary.largest() / self.area();
        for vertex in self.solids_inside_solids(welded) {
            defects.add(DefectKind::SolidInSolid, [place(vertex)], None);
        }
        defects
    }

    /// The edges of openings that have another one beside them.
    fn cracks(&self, boundary: &Boundary, welded: &[u32]) -> Vec<[u32; 2]> {
        let edges = &boundary.open_edges;
        if edges.is_empty() {
            return Vec::new();
        }
        let most = CRACK * size(self.aabb());
        let place = |v: u32| self.vertices[welded[v as usize] as usize].as_dvec3();
        let middle = |edge: [u32; 2]| (place(edge[0]) + place(edge[1])) * 0.5;
        let middles: Vec<Vec3> = edges.iter().map(|edge| middle(*edge).as_vec3()).collect();
        let tree = BoxTree::of_scattered(&middles, |i| Aabb::around([middles[i]]));
        let is_crack = |own: usize| {
            let [u, v] = edges[own];
            let at = middle(edges[own]);
            let is_near = |_: &_, b: &Aabb| {
                let outside = (b.min.as_dvec3() - at).max(at - b.max.as_dvec3());
                outside.max_element() <= most
            };
            let mut found = false;
            tree.visit(&mut found, is_near, |found, other| {
                let [x, y] = edges[other];
                let is_beside = place(u).distance(place(y)) <= most && place(v).distance(place(x)) <= most;
                *found |= other != own && is_beside;
            });
            found
        };
        (0..edges.len())
            .filter(|&own| is_crack(own))
            .map(|own| edges[own])
            .collect()
    }
}
