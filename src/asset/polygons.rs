//! Polygons of a mesh file, split into triangles.

use super::import_error::ImportError;
use crate::geometry::TriMesh;
use glam::Vec3;

/// The triangles of a polygon, as a fan from its first corner. One with fewer than three corners has none.
pub(super) fn fan<T: Copy>(corners: &[T]) -> impl Iterator<Item = [T; 3]> {
    corners.windows(2).skip(1).map(|pair| [corners[0], pair[0], pair[1]])
}

/// The triangles read so far. Their order is that of the file.
#[derive(Default)]
pub(super) struct Polygons {
    triangles: Vec<[u32; 3]>,
    /// Number of polygons read.
    count: usize,
}

impl Polygons {
    /// Adds a polygon as its [`fan`].
    pub fn push(&mut self, corners: &[i64]) -> Result<(), ImportError> {
        for triangle in fan(corners) {
            self.triangle(triangle)?;
        }
        self.count += 1;
        Ok(())
    }

    /// Adds a strip: each corner after the second makes a triangle with the two before it, in turn with one winding and the
    /// other. A negative index ends a strip, and another one begins.
    pub fn push_strips(&mut self, corners: &[i64]) -> Result<(), ImportError> {
        for strip in corners.split(|&corner| corner < 0) {
            for (i, three) in strip.windows(3).enumerate() {
                let [a, b, c] = [three[0], three[1], three[2]];
                self.triangle(if i % 2 == 0 { [a, b, c] } else { [b, a, c] })?;
            }
            self.count += 1;
        }
        Ok(())
    }

    fn triangle(&mut self, corners: [i64; 3]) -> Result<(), ImportError> {
        let mut triangle = [0; 3];
        for (index, corner) in triangle.iter_mut().zip(corners) {
            let polygon = self.count;
            *index = u32::try_from(corner).map_err(|_| ImportError::BadIndex { polygon, index: corner })?;
        }
        self.triangles.push(triangle);
        Ok(())
    }

    /// The mesh with these vertices.
    pub fn finish(self, vertices: Vec<Vec3>) -> Result<TriMesh, ImportError> {
        if self.triangles.is_empty() {
            return Err(ImportError::NoFaces {
                vertices: vertices.len(),
            });
        }
        Ok(TriMesh::new(vertices, self.triangles)?)
    }
}
