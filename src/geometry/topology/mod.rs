//! Connectivity of a mesh: welded vertices, orientation, connected components, boundary edges.

mod boundary;
mod defects;
mod doubled;
mod loops;
mod shells;

pub(super) use boundary::Closure;
pub use boundary::MAX_OPENING;
pub use defects::{Defect, DefectKind, Defects};

use super::edges::{Edges, NO_EDGE, is_collapsed};
use super::union_find::UnionFind;
use super::weld::{least_distance, size, weld};
use crate::geometry::Aabb;
use crate::geometry::cluster::compact_order;
use glam::{DVec3, Vec3};
use std::collections::HashMap;

/// Whether a mesh is closed, and which way its faces point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub enum Orientation {
    /// Closed and consistently wound, with positive enclosed volume: faces are counter-clockwise seen from outside.
    Outward,
    /// Closed and consistently wound, with negative enclosed volume. This is a room: its walls are solid, its inside is
    /// free.
    Inward,
    /// Closed, but some neighbouring faces have opposite winding. A baked mesh is mixed only if no winding is
    /// consistent.
    Mixed,
    /// Not closed: some edge has an odd number of faces.
    Open,
}

/// The connectivity of a mesh after welding.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Topology {
    /// The weld tolerance, relative to the diagonal of the mesh's bounding box.
    pub tolerance: f32,
    /// For each vertex, the representative of the vertices it is welded with.
    pub welded: Vec<u32>,
    pub orientation: Orientation,
    pub component_vertices: Vec<u32>,
    /// Whether each edge has two faces that agree.
    is_manifold: bool,
    /// Whether an edge has more than two faces that count.
    is_crowded: bool,
    /// What closes a nearly closed mesh, and the reverse of each face that does not count; empty for other meshes.
    pub caps: Vec<[Vec3; 3]>,
    /// The vertices of caps that close its T-junctions.
    pub slivers: Vec<[u32; 3]>,
    /// The orientation of the mesh with its caps.
    capped: Option<Orientation>,
    /// Faces that count once with another one; see [`Faces::twins`].
    pub twins: Vec<[u32; 2]>,
}

/// The boundary of an open mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaps {
    /// The number of edges that have an odd number of faces: the boundary edges.
    pub edges: u32,
    /// The smallest distance between two boundary vertices that no boundary edge joins, in mesh units; `None` if there
    /// is no such pair.
    pub nearest: Option<f64>,
    /// This distance relative to the diagonal of the mesh's bounding box: a larger weld tolerance joins the two.
    pub relative: Option<f64>,
}

/// The input of the topology: vertices and faces of a mesh.
pub(super) struct Faces<'a> {
    pub vertices: &'a [Vec3],
    pub triangles: &'a [[u32; 3]],
    /// The index of each triangle in the input.
    pub face_ids: &'a [u32],
    /// Faces of zero area. They count as long as their corners differ: a sliver that fills a T-junction keeps a mesh
    /// closed.
    pub dropped: &'a [[u32; 3]],
    /// Pairs of a face that does not count and the one with the same corners that does, ascending, by their indices in
    /// the input.
    pub twins: &'a [[u32; 2]],
}

impl Topology {
    pub fn of(faces: &Faces, tolerance: f32) -> Self {
        let welded = weld(faces.vertices, faces.aabb(), tolerance);
        let topology = faces.rewound(Self {
            tolerance,
            orientation: Orientation::Open,
            is_manifold: false,
            component_vertices: faces.component_vertices(&welded),
            welded,
            caps: Vec::new(),
            slivers: Vec::new(),
            capped: None,
            is_crowded: false,
            twins: Vec::new(),
        });
        if !topology.is_crowded {
            return topology;
        }
        let twins = faces.find_twins(&topology);
        if twins.is_empty() {
            return topology;
        }
        let counted = Faces {
            twins: &twins,
            ..*faces
        };
        let topology = counted.rewound(topology);
        Self { twins, ..topology }
    }

    /// Whether faces may count once with others. None do if no edge has more than two faces.
    pub fn may_have_twins(&self) -> bool {
        self.is_crowded || !self.twins.is_empty()
    }

    /// Whether the mesh is one surface without a boundary whose faces agree. Then no face is doubled, and no surface
    /// lies inside another.
    pub fn is_one_surface(&self) -> bool {
        self.is_manifold && self.twins.is_empty() && self.component_vertices.len() == 1
    }

    /// The orientation of a nearly closed mesh with its caps; `None` for other meshes.
    pub fn closed_by_caps(&self) -> Option<Orientation> {
        self.capped
    }
}

/// An edge with its faces.
#[derive(Clone, Copy, Default)]
struct Count {
    faces: u32,
    /// The number of faces that traverse it forward, minus the number that traverse it backward.
    balance: i32,
}

/// Triangles that hang together across edges of two faces that agree.
pub(in crate::geometry) struct Patches {
    /// For each triangle, the number of its patch.
    pub of_triangles: Vec<u32>,
    /// For each such number, whether all edges of the patch have two faces that agree.
    pub is_closed: Vec<bool>,
}

impl Count {
    fn add(&mut self, forward: bool) {
        self.faces += 1;
        self.balance += if forward { 1 } else { -1 };
    }

    fn is_boundary(self) -> bool {
        self.faces % 2 == 1
    }
}

impl Faces<'_> {
    /// The topology of the same faces after some were turned: all that depends on the winding is computed again.
    pub fn rewound(&self, topology: Topology) -> Topology {
        let welded = &topology.welded;
        let (edges, counts) = self.edges(welded);
        let (orientation, (mut caps, slivers)) = if counts.is_empty() {
            // A segment or a point has no faces.
            (Orientation::Open, Default::default())
        } else if counts.iter().any(|count| count.is_boundary()) {
            let boundary = self.boundary(&edges, &counts, welded, topology.tolerance);
            (Orientation::Open, boundary.caps_if_nearly_closed(self.area()))
        } else if counts.iter().any(|count| count.balance != 0) {
            (Orientation::Mixed, Default::default())
        } else {
            (self.outward_or_inward(welded, &[]), Default::default())
        };
        let capped = (!caps.is_empty()).then(|| self.outward_or_inward(welded, &caps));
        let is_closed = matches!(orientation, Orientation::Outward | Orientation::Inward);
        if !self.twins.is_empty() && (is_closed || capped.is_some()) {
            caps.extend(self.reversed_twins(welded));
            let centroids: Vec<Vec3> = caps.iter().map(|cap| cap.iter().map(|p| *p / 3.0).sum()).collect();
            caps = compact_order(&centroids)
                .into_iter()
                .map(|i| caps[i as usize])
                .collect();
        }
        Topology {
            orientation,
            is_manifold: counts.iter().all(|count| count.faces == 2 && count.balance == 0),
            is_crowded: counts.iter().any(|count| count.faces > 2),
            capped,
            caps,
            slivers,
            ..topology
        }
    }

    /// The area of all triangles.
    fn area(&self) -> f64 {
        let at = |v: u32| self.vertices[v as usize].as_dvec3();
        let area = |&[a, b, c]: &[u32; 3]| (at(b) - at(a)).cross(at(c) - at(a)).length() * 0.5;
        self.counted().map(|t| area(&self.triangles[t])).sum()
    }

    fn aabb(&self) -> Aabb {
        let corners = self.triangles.iter().chain(self.dropped).flatten();
        Aabb::around(corners.map(|&v| self.vertices[v as usize]))
    }

    /// All faces after welding: the triangles, then the dropped ones. Those that do not count are collapsed.
    fn welded_faces<'a>(&'a self, welded: &'a [u32]) -> impl Iterator<Item = [u32; 3]> + 'a {
        let counts = (0..self.triangles.len())
            .map(|t| self.counts(t))
            .chain(std::iter::repeat(true));
        let all = self.triangles.iter().chain(self.dropped).zip(counts);
        all.map(|(face, counts)| {
            let face = face.map(|v| welded[v as usize]);
            if counts { face } else { [face[0]; 3] }
        })
    }

    /// The edges of all faces that do not collapse.
    ///
    /// Welding two vertices removes the faces of an edge in pairs, one from each side. It never opens a closed mesh.
    fn edges(&self, welded: &[u32]) -> (Edges, Vec<Count>) {
        let faces: Vec<[u32; 3]> = self.welded_faces(welded).filter(|face| !is_collapsed(*face)).collect();
        let edges = Edges::of(&faces, welded.len());
        let mut counts = vec![Count::default(); edges.ends.len()];
        for (face, numbers) in faces.iter().zip(&edges.of_triangles) {
            for (&edge, from) in numbers.iter().zip(face) {
                counts[edge as usize].add(edges.ends[edge as usize][0] == *from);
            }
        }
        (edges, counts)
    }

    /// The patches of the surface: triangles that hang together across edges of two faces that agree.
    pub fn patches(&self, welded: &[u32]) -> Patches {
        let faces: Vec<[u32; 3]> = self.welded_faces(welded).collect();
        let edges = Edges::of(&faces, welded.len());
        let whole = || (0u32..).zip(&faces).filter(|(_, face)| !is_collapsed(**face));
        let mut counts = vec![Count::default(); edges.ends.len()];
        for (own, face) in whole() {
            for (&edge, from) in edges.of_triangles[own as usize].iter().zip(face) {
                counts[edge as usize].add(edges.ends[edge as usize][0] == *from);
            }
        }
        let agree = |edge: u32| counts[edge as usize].faces == 2 && counts[edge as usize].balance == 0;
        let mut first = vec![NO_EDGE; edges.ends.len()];
        let mut joined = UnionFind::new(faces.len());
        for (own, _) in whole() {
            for edge in edges.of_triangles[own as usize].into_iter().filter(|&edge| agree(edge)) {
                match first[edge as usize] {
                    NO_EDGE => first[edge as usize] = own,
                    other => joined.join(own, other),
                }
            }
        }
        let mut is_closed = vec![true; faces.len()];
        for own in 0..faces.len() as u32 {
            let edges = edges.of_triangles[own as usize];
            let has_border = is_collapsed(faces[own as usize]) || edges.into_iter().any(|edge| !agree(edge));
            is_closed[joined.root(own) as usize] &= !has_border;
        }
        let of_triangles = (0..self.triangles.len() as u32).map(|t| joined.root(t)).collect();
        Patches {
            of_triangles,
            is_closed,
        }
    }

    /// The orientation of a closed, consistently wound mesh, which some triangles of `caps` may close.
    fn outward_or_inward(&self, welded: &[u32], caps: &[[Vec3; 3]]) -> Orientation {
        let place = |v: u32| self.vertices[welded[v as usize] as usize];
        let triangles = self.counted().map(|t| self.triangles[t].map(place));
        // Relative to the first corner, so that a mesh far from the origin loses no precision.
        let origin = place(self.triangles[0][0]).as_dvec3();
        if volume(triangles.chain(caps.iter().copied()), origin) < 0.0 {
            Orientation::Inward
        } else {
            Orientation::Outward
        }
    }

    /// One vertex of each component, ordered by the components' first faces in the input.
    fn component_vertices(&self, welded: &[u32]) -> Vec<u32> {
        let mut joined = UnionFind::new(welded.len());
        for t in self.triangles {
            let [a, b, c] = t.map(|v| welded[v as usize]);
            joined.join(a, b);
            joined.join(a, c);
        }
        // For each root, the component's first face and a corner of that face.
        let mut firsts: HashMap<u32, (u32, u32)> = HashMap::new();
        for (t, &face) in self.triangles.iter().zip(self.face_ids) {
            let first = firsts.entry(joined.root(welded[t[0] as usize])).or_insert((face, t[0]));
            *first = (*first).min((face, t[0]));
        }
        let mut firsts: Vec<(u32, u32)> = firsts.into_values().collect();
        firsts.sort_unstable();
        firsts.into_iter().map(|(_, vertex)| vertex).collect()
    }

    /// The boundary edges; `None` if there are none.
    pub fn gaps(&self, welded: &[u32]) -> Option<Gaps> {
        let (edges, counts) = self.edges(welded);
        let odd = edges.ends.iter().zip(&counts).filter(|(_, count)| count.is_boundary());
        let mut links: Vec<[u32; 2]> = odd.map(|(&[u, v], _)| [u.min(v), u.max(v)]).collect();
        links.sort_unstable();
        if links.is_empty() {
            return None;
        }
        let mut corners = links.as_flattened().to_vec();
        corners.sort_unstable();
        corners.dedup();
        let places: Vec<DVec3> = corners.iter().map(|&v| self.vertices[v as usize].as_dvec3()).collect();
        let is_linked = |i: usize, j: usize| {
            let (u, v) = (corners[i], corners[j]);
            links.binary_search(&[u.min(v), u.max(v)]).is_ok()
        };
        let aabb = self.aabb();
        let nearest = least_distance(&places, aabb, is_linked);
        Some(Gaps {
            edges: links.len() as u32,
            nearest,
            relative: nearest.map(|d| d / size(aabb)),
        })
    }
}

/// The signed volume that triangles enclose: positive if they point outward.
fn volume(triangles: impl Iterator<Item = [Vec3; 3]>, origin: DVec3) -> f64 {
    let volumes = triangles.map(|t| {
        let [a, b, c] = t.map(|v| v.as_dvec3() - origin);
        a.dot(b.cross(c)) / 6.0
    });
    volumes.sum()
}
