//! Polygons of a mesh file, split into triangles.

use super::ears::{straighten, work};
use super::import_error::ImportError;
use crate::geometry::{MeshError, TriMesh};
use glam::Vec3;

/// The triangles of the polygons read so far. Their order is that of the file.
#[derive(Default)]
pub(super) struct Fans {
    pub triangles: Vec<[u32; 3]>,
    /// The polygons of more than three corners: the first triangle of each, and how many it has.
    several: Vec<[u32; 2]>,
}

impl Fans {
    /// Adds a polygon as a fan from its first corner. One with fewer than three corners has no triangle.
    ///
    /// # Errors
    /// If there are more triangles than 32 bits count.
    pub fn push(&mut self, corners: &[u32]) -> Result<(), TooMany> {
        let first = self.triangles.len();
        let count = corners.len().saturating_sub(2);
        if first + count >= u32::MAX as usize {
            return Err(TooMany);
        }
        let pairs = corners.windows(2).skip(1);
        self.triangles.extend(pairs.map(|pair| [corners[0], pair[0], pair[1]]));
        if count > 1 {
            self.several.push([first as u32, count as u32]);
        }
        Ok(())
    }

    /// The triangles, once all vertices are known: a fan that folds over is replaced by as many other triangles of its
    /// polygon.
    pub fn finish(mut self, vertices: &[Vec3], warnings: &mut Vec<String>) -> Vec<[u32; 3]> {
        let mut work = work(self.triangles.len());
        let mut folded = 0;
        for [first, count] in self.several {
            let fan = &mut self.triangles[first as usize..(first + count) as usize];
            folded += usize::from(!straighten(fan, vertices, &mut work));
        }
        if folded > 0 {
            warnings.push(format!(
                "polygons that are not convex and cross themselves or have very many corners, {folded} in all, are read as \
                 fans from their first corners, which fold over; export the mesh as triangles"
            ));
        }
        self.triangles
    }
}

/// There are more triangles than 32 bits count.
pub(super) struct TooMany;

/// Polygons and strips of indices that a file may have wrong.
#[derive(Default)]
pub(super) struct Polygons {
    fans: Fans,
    /// Number of polygons read.
    count: usize,
    /// Scratch: the corners of a polygon.
    corners: Vec<u32>,
}

impl Polygons {
    /// Adds a polygon.
    pub fn push(&mut self, corners: &[i64]) -> Result<(), ImportError> {
        self.corners.clear();
        // Without a triangle its corners do not matter.
        if corners.len() >= 3 {
            for &corner in corners {
                self.corners.push(index(corner, self.count)?);
            }
        }
        self.fans.push(&self.corners).map_err(|TooMany| self.too_many())?;
        self.count += 1;
        Ok(())
    }

    /// Adds a strip: each corner after the second makes a triangle with the two before it, in turn with one winding and
    /// the other. A negative index ends a strip, and another one begins.
    pub fn push_strips(&mut self, corners: &[i64]) -> Result<(), ImportError> {
        for strip in corners.split(|&corner| corner < 0) {
            for (i, three) in strip.windows(3).enumerate() {
                let mut triangle = [0; 3];
                for (to, &corner) in triangle.iter_mut().zip(three) {
                    *to = index(corner, self.count)?;
                }
                let [a, b, c] = triangle;
                let wound = if i % 2 == 0 { [a, b, c] } else { [b, a, c] };
                self.fans.push(&wound).map_err(|TooMany| self.too_many())?;
            }
            self.count += 1;
        }
        Ok(())
    }

    fn too_many(&self) -> ImportError {
        let count = self.fans.triangles.len();
        MeshError::TooLarge {
            what: "triangles",
            count,
        }
        .into()
    }

    /// The mesh with these vertices.
    pub fn finish(self, vertices: Vec<Vec3>, warnings: &mut Vec<String>) -> Result<TriMesh, ImportError> {
        if self.fans.triangles.is_empty() {
            return Err(ImportError::NoFaces {
                vertices: vertices.len(),
            });
        }
        let triangles = self.fans.finish(&vertices, warnings);
        Ok(TriMesh::new(vertices, triangles)?)
    }
}

fn index(corner: i64, polygon: usize) -> Result<u32, ImportError> {
    u32::try_from(corner).map_err(|_| ImportError::BadIndex { polygon, index: corner })
}
