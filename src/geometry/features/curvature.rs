//! The curvature of the smooth surface that a mesh approximates.

use super::MeshFeatures;
use crate::geometry::edges::is_collapsed;
use glam::{DMat3, DVec3};

impl MeshFeatures {
    /// The radius of curvature along an edge that is not a crease: the radius of the circle that has the vertex normals
    /// of both ends.
    pub(super) fn curvature_radius_along(&self, [u, v]: [u32; 2], normals_at_ends: &[DVec3]) -> f32 {
        let edge = self.vertices[v as usize].as_dvec3() - self.vertices[u as usize].as_dvec3();
        let change = normals_at_ends[v as usize] - normals_at_ends[u as usize];
        let curvature = change.dot(edge) / edge.length_squared();
        // Below this the curvature is rounding of the normals of a flat surface.
        if curvature * edge.length() > 1.0e-4 {
            curvature.recip() as f32
        } else {
            f32::INFINITY
        }
    }

    /// Unit vertex normals: means of the triangle normals, weighted by the triangle's angle at the vertex, so that they
    /// do not depend on how flat faces are split into triangles (Thuermer and Wuethrich, "Computing Vertex Normals from
    /// Polygonal Facets", 1998).
    pub(super) fn angle_weighted_normals(&self) -> Vec<DVec3> {
        let mut sums = vec![DVec3::ZERO; self.vertices.len()];
        let triangles = self.triangles.iter().zip(&self.normals);
        for (corners, normal) in triangles.filter(|(corners, _)| !is_collapsed(**corners)) {
            let at = corners.map(|v| self.vertices[v as usize].as_dvec3());
            for k in 0..3 {
                let (u, v) = (at[(k + 1) % 3] - at[k], at[(k + 2) % 3] - at[k]);
                sums[corners[k] as usize] += normal.as_dvec3() * u.angle_between(v);
            }
        }
        sums.into_iter().map(DVec3::normalize_or_zero).collect()
    }

    /// Adds the normals and the radii of curvature at the vertices.
    pub(super) fn add_vertex_curvature(&mut self) {
        let count = self.vertices.len() as u32;
        self.vertex_normals = (0..count).map(|vertex| self.sphere_normal(vertex).as_vec3()).collect();
        self.vertex_curvature_radii = vec![f32::INFINITY; self.vertices.len()];
        let triangles = self.triangles.iter().zip(&self.curvature_radii);
        for (corners, &radius) in triangles.filter(|(corners, _)| !is_collapsed(**corners)) {
            for &v in corners {
                let least = &mut self.vertex_curvature_radii[v as usize];
                *least = least.min(radius);
            }
        }
    }

    /// The normal of the sphere through the vertex that fits its neighbours best, by least squares.
    fn sphere_normal(&self, vertex: u32) -> DVec3 {
        let at = self.vertices[vertex as usize].as_dvec3();
        let (mut squares, mut sum) = (DMat3::ZERO, DVec3::ZERO);
        for &neighbor in self.neighbors_of(vertex) {
            // Relative to one point of a sphere, its centre `c` and any other point `e` satisfy 2 c . e = e . e.
            let edge = self.vertices[neighbor as usize].as_dvec3() - at;
            let unit = edge.normalize_or_zero();
            squares += DMat3::from_cols(unit * unit.x, unit * unit.y, unit * unit.z);
            sum += edge;
        }
        (squares.inverse() * -sum).normalize_or_zero()
    }
}
