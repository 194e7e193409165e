//! The curvature of the smooth surface that a mesh approximates.

use super::MeshFeatures;
use crate::geometry::edges::is_collapsed;
use glam::{DMat3, DVec2, DVec3, Vec3};

/// A surface is finely tessellated at a vertex if the normals of the faces around it are within this angle of its own,
/// radians. A sphere of 32 by 16 quadrilaterals is, and so is a sphere of 720 equal triangles.
const FINE: f64 = 0.15;

/// A rim is finely divided if it turns by no more than this at a vertex, radians. The rim of a cylinder of 32 sides is.
const FINE_RIM: f64 = 0.2;

/// A direction in which the surface turns by less than this along the longest edge, radians, is flat.
pub(crate) const MIN_TURN: f64 = 2.0e-3;

/// Below this determinant the neighbours lie in two directions only.
const MIN_DETERMINANT: f64 = 1.0e-3;

/// How the smooth surface around a vertex is curved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Roundness {
    /// A corner of facets, or of a surface that is nowhere convex.
    Corner,
    /// A finely tessellated surface.
    Surface {
        /// The inverse of the curvature along the surface, mesh units. Multiplied by a small change of the normal, it
        /// gives the displacement to where the surface has that normal. A symmetric matrix: xx, xy, xz, yy, yz, zz. It
        /// is 0 along directions in which the surface is flat or concave.
        radii: [f32; 6],
        /// Length of the longest edge, mesh units: the vertex stands for no more of the surface.
        reach: f32,
    },
    /// A finely divided curve at which two surfaces meet, as the rim of a cylinder.
    Rim {
        /// Unit vector along the rim.
        tangent: Vec3,
        /// Vector to the centre of curvature, as long as the curvature, one over mesh units.
        curvature: Vec3,
        /// Length of the longer edge of the rim, mesh units.
        reach: f32,
    },
}

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

    /// Adds the normals and the roundness of the vertices. `creases` are the ends of edges at which surfaces meet.
    pub(super) fn add_roundness(&mut self, creases: &[[u32; 2]]) {
        let count = self.vertices.len();
        let normals: Vec<DVec3> = (0..count as u32).map(|vertex| self.sphere_normal(vertex)).collect();
        // For each vertex: the number of faces around it, and the least cosine between their normals and its own.
        let mut faces = vec![(0, 1.0f64); count];
        let triangles = self.triangles.iter().zip(&self.normals);
        for (corners, own) in triangles.filter(|(corners, _)| !is_collapsed(**corners)) {
            for &v in corners {
                let (number, least) = &mut faces[v as usize];
                *number += 1;
                *least = least.min(own.as_dvec3().dot(normals[v as usize]));
            }
        }
        // The vertices next to each one along its creases, and how many there are.
        let mut along = vec![(0, [0; 2]); count];
        for &[u, v] in creases {
            for (from, to) in [(u, v), (v, u)] {
                let (number, ends) = &mut along[from as usize];
                if let Some(end) = ends.get_mut(*number) {
                    *end = to;
                }
                *number += 1;
            }
        }
        let roundness = (0..count as u32).map(|vertex| {
            let (number, least) = faces[vertex as usize];
            match along[vertex as usize] {
                // At the rim of an open surface there is one face less than neighbours.
                (0, _) if number == self.neighbors_of(vertex).len() && least >= FINE.cos() => {
                    self.fitted(vertex, normals[vertex as usize])
                }
                (2, ends) => self.rim(vertex, ends),
                _ => None,
            }
        });
        self.roundness = roundness.map(|round| round.unwrap_or(Roundness::Corner)).collect();
        self.vertex_normals = normals.iter().map(|normal| normal.as_vec3()).collect();
    }

    /// The quadric with this normal at the vertex that fits its neighbours best, by least squares. On a sphere the
    /// neighbours have its curvature exactly.
    fn fitted(&self, vertex: u32, normal: DVec3) -> Option<Roundness> {
        let at = self.vertices[vertex as usize].as_dvec3();
        let (u, v) = normal.any_orthonormal_pair();
        let (mut squares, mut sum, mut reach) = (DMat3::ZERO, DVec3::ZERO, 0.0f64);
        for &neighbor in self.neighbors_of(vertex) {
            let edge = self.vertices[neighbor as usize].as_dvec3() - at;
            let square = edge.length_squared();
            let along = DVec2::new(edge.dot(u), edge.dot(v)).normalize_or_zero();
            let curvature = -2.0 * edge.dot(normal) / square;
            let row = DVec3::new(along.x * along.x, 2.0 * along.x * along.y, along.y * along.y);
            squares += DMat3::from_cols(row * row.x, row * row.y, row * row.z);
            sum += row * curvature;
            reach = reach.max(square.sqrt());
        }
        if squares.determinant() < MIN_DETERMINANT {
            return None;
        }
        let [x, xy, y] = (squares.inverse() * sum).to_array();
        // The principal curvatures.
        let (mean, half) = (0.5 * (x + y), 0.5 * (x - y));
        let spread = half.hypot(xy);
        let angle = 0.5 * xy.atan2(half);
        let (sin, cos) = angle.sin_cos();
        let axes = [u * cos + v * sin, v * cos - u * sin];
        let mut radii = DMat3::ZERO;
        for (axis, curvature) in axes.into_iter().zip([mean + spread, mean - spread]) {
            if curvature * reach > MIN_TURN {
                radii += DMat3::from_cols(axis * axis.x, axis * axis.y, axis * axis.z) * curvature.recip();
            }
        }
        let [x, y, z] = [radii.x_axis, radii.y_axis, radii.z_axis];
        let radii = [x.x, x.y, x.z, y.y, y.z, z.z].map(|r| r as f32);
        let is_round = radii != [0.0; 6] && radii.iter().all(|r| r.is_finite());
        is_round.then_some(Roundness::Surface {
            radii,
            reach: reach as f32,
        })
    }

    /// The circle through a vertex and its neighbours along a rim.
    fn rim(&self, vertex: u32, ends: [u32; 2]) -> Option<Roundness> {
        let at = self.vertices[vertex as usize].as_dvec3();
        let [back, forth] = ends.map(|end| self.vertices[end as usize].as_dvec3() - at);
        let [a, b] = [-back, forth].map(DVec3::normalize_or_zero);
        if a.dot(b) < FINE_RIM.cos() {
            return None;
        }
        let [p, q] = [back.length_squared(), forth.length_squared()];
        // Perpendicular to the circle, and twice the area of the triangle.
        let across = back.cross(forth);
        let center = (p * forth - q * back).cross(across) / (2.0 * across.length_squared());
        let curvature = center / center.length_squared();
        let tangent = across.cross(center).try_normalize()?;
        let is_round = curvature.is_finite() && curvature.length_squared() > 0.0;
        is_round.then(|| Roundness::Rim {
            tangent: tangent.as_vec3(),
            curvature: curvature.as_vec3(),
            reach: p.max(q).sqrt() as f32,
        })
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
