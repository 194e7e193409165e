//! [`Surface`]: the mesh while it is repaired.

use super::Work;
use crate::geometry::edges::{Edges, is_collapsed};
use crate::geometry::weld::{size, weld};
use crate::geometry::{Aabb, MeshError, TriMesh};
use glam::Vec3;

/// Vertices and faces, three vertex indices each. Faces may have no area.
pub(super) struct Surface {
    pub vertices: Vec<Vec3>,
    pub faces: Vec<[u32; 3]>,
    /// The weld tolerance, relative to the diagonal of the bounding box.
    pub tolerance: f32,
}

/// How many faces use an edge.
#[derive(Clone, Copy, Default, PartialEq)]
pub(super) struct Uses {
    pub faces: i32,
    /// The number of faces that run along it as the edge is directed, minus the number that run the other way.
    pub balance: i32,
}

impl Uses {
    pub fn is_odd(self) -> bool {
        self.faces % 2 != 0
    }
}

/// The edges of faces, with their uses.
pub(super) struct CountedEdges {
    pub edges: Edges,
    pub uses: Vec<Uses>,
}

impl CountedEdges {
    /// Faces that collapsed use no edge. `vertices` is the number of vertices.
    pub fn of(faces: &[[u32; 3]], vertices: usize) -> Self {
        let edges = Edges::of(faces, vertices);
        let mut uses = vec![Uses::default(); edges.ends.len()];
        for (face, numbers) in faces.iter().zip(&edges.of_triangles) {
            if !is_collapsed(*face) {
                for (&edge, &from) in numbers.iter().zip(face) {
                    uses[edge as usize].faces += 1;
                    uses[edge as usize].balance += direction(&edges, edge, from);
                }
            }
        }
        Self { edges, uses }
    }

    /// The edges of a face, each with 1 if the face runs along it as it is directed, else -1. None if the face
    /// collapsed.
    pub fn of_face(&self, number: usize, face: [u32; 3]) -> impl Iterator<Item = (u32, i32)> + '_ {
        let edges = self.edges.of_triangles[number];
        let sides = edges.into_iter().zip(face).filter(move |_| !is_collapsed(face));
        sides.map(|(edge, from)| (edge, direction(&self.edges, edge, from)))
    }
}

fn direction(edges: &Edges, edge: u32, from: u32) -> i32 {
    if edges.ends[edge as usize][0] == from { 1 } else { -1 }
}

impl Surface {
    /// The box around all faces.
    fn aabb(&self) -> Aabb {
        Aabb::around(self.faces.iter().flatten().map(|&v| self.vertices[v as usize]))
    }

    /// The weld distance in mesh units.
    pub fn distance(&self) -> f64 {
        f64::from(self.tolerance) * self.size()
    }

    /// The diagonal of the bounding box, in mesh units.
    pub fn size(&self) -> f64 {
        size(self.aabb())
    }

    /// For each vertex, the one that stands for all that are welded with it.
    pub fn welded(&self) -> Vec<u32> {
        weld(&self.vertices, self.aabb(), self.tolerance)
    }

    /// The faces after welding.
    pub fn welded_faces(&self, welded: &[u32]) -> Vec<[u32; 3]> {
        self.faces.iter().map(|face| face.map(|v| welded[v as usize])).collect()
    }

    /// Merges vertices. The others keep their order.
    pub fn weld(&mut self, work: &mut Work) {
        let welded = self.welded();
        self.faces = self.welded_faces(&welded);
        let before = self.vertices.len();
        self.keep_vertices(|v| welded[v as usize] == v);
        work.merged_vertices = before - self.vertices.len();
    }

    /// Drops the vertices that no face uses.
    pub fn drop_vertices(&mut self, work: &mut Work) {
        let mut is_used = vec![false; self.vertices.len()];
        self.faces.iter().flatten().for_each(|&v| is_used[v as usize] = true);
        let before = self.vertices.len();
        self.keep_vertices(|v| is_used[v as usize]);
        work.dropped_vertices = before - self.vertices.len();
    }

    /// Keeps some vertices, among them all that faces use.
    fn keep_vertices(&mut self, keep: impl Fn(u32) -> bool) {
        let mut numbers = vec![0; self.vertices.len()];
        let mut kept = Vec::with_capacity(self.vertices.len());
        for (v, &position) in (0..).zip(&self.vertices) {
            if keep(v) {
                numbers[v as usize] = kept.len() as u32;
                kept.push(position);
            }
        }
        self.vertices = kept;
        self.faces
            .as_flattened_mut()
            .iter_mut()
            .for_each(|v| *v = numbers[*v as usize]);
    }

    /// Makes the winding consistent.
    pub fn orient(&mut self, work: &mut Work) -> Result<(), MeshError> {
        let mesh = self.mesh()?.oriented();
        work.turned_faces += mesh.turned().iter().filter(|turned| **turned).count();
        self.faces = mesh.all_faces();
        Ok(())
    }

    fn mesh(&self) -> Result<TriMesh, MeshError> {
        let mesh = TriMesh::new(self.vertices.clone(), self.faces.clone())?;
        Ok(mesh.with_weld_tolerance(self.tolerance))
    }

    pub fn into_mesh(self) -> Result<TriMesh, MeshError> {
        let tolerance = self.tolerance;
        let mesh = TriMesh::new(self.vertices, self.faces)?;
        Ok(mesh.with_weld_tolerance(tolerance))
    }
}
