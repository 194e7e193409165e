//! The space between a mesh and its rounded surface, in pieces: a prism on each face, a sector of a cylinder along each
//! edge, and a sector of a ball at each vertex. Where faces meet in a groove their prisms overlap.

use super::TriMesh;
use glam::DVec3;
use std::collections::{HashMap, HashSet};

/// The largest angle of a slice of a cylinder or of a ball, radians.
const SLICE: f64 = 0.1;
/// Faces are coplanar if the cosine of the angle between their normals differs from 1 by less.
const FLAT: f64 = 1.0e-12;
/// The least cosine of the angle between the mean normal of a corner and the normals of its faces.
const LEAST_COSINE: f64 = 1.0e-3;
/// How often a part of a ball is split at most.
const MAX_SPLITS: u32 = 6;

/// What [`visit`] calls with the pieces.
pub(crate) trait Rounding {
    /// The prism between a face and the face moved by `up`.
    fn face(&mut self, corners: [DVec3; 3], up: DVec3);

    /// A slice of a cylinder along an edge, between two vectors from its axis.
    fn slice(&mut self, ends: [DVec3; 2], radii: [DVec3; 2]);

    /// A half of what the prisms on both sides of a groove have in common, along an edge: a triangle between the edge
    /// and two vectors from there.
    fn groove(&mut self, ends: [DVec3; 2], triangle: [DVec3; 2]);

    /// A part of a ball about a vertex, between three vectors of its radius.
    fn corner(&mut self, at: DVec3, radii: [DVec3; 3]);
}

/// Visits the pieces within `radius` outside of a mesh, on both sides of a sheet. Tells whether the mesh is a solid all
/// of whose edges are convex. Corners of sheets, and those at grooves, have no piece.
pub(crate) fn visit(mesh: &TriMesh, radius: f64, is_solid: bool, pieces: &mut impl Rounding) -> bool {
    let core = Core::new(mesh, is_solid);
    let sides: &[f64] = if is_solid { &[1.0] } else { &[1.0, -1.0] };
    for (t, corners) in core.triangles.iter().enumerate() {
        for side in sides {
            pieces.face(*corners, core.normals[t] * (radius * side));
        }
    }
    let mut is_convex = is_solid;
    let mut at_grooves = HashSet::new();
    for ([u, v], faces) in faces_of_edges(mesh) {
        let ends = [u, v].map(|v| mesh.vertices()[v as usize].as_dvec3());
        match faces[..] {
            [face] => {
                let out = core.outward(face, ends);
                visit_sector(ends, [core.normals[face], out], radius, pieces);
                visit_sector(ends, [out, -core.normals[face]], radius, pieces);
            }
            [one, other] => {
                for side in sides {
                    let normals = [one, other].map(|t| core.normals[t] * *side);
                    let cosine = normals[0].dot(normals[1]);
                    if cosine > 1.0 - FLAT {
                        continue;
                    }
                    if cosine < FLAT - 1.0 {
                        // Both sides of a sheet meet at its border.
                        let out = core.outward(one, ends);
                        visit_sector(ends, [normals[0], out], radius, pieces);
                        visit_sector(ends, [out, normals[1]], radius, pieces);
                    } else if core.height(one, other) * side < 0.0 {
                        visit_sector(ends, normals, radius, pieces);
                    } else {
                        visit_groove(ends, normals, radius, pieces);
                        is_convex = false;
                        at_grooves.extend([u, v]);
                    }
                }
            }
            _ => is_convex = false,
        }
    }
    if is_solid {
        for (vertex, normals) in core.normals_around(mesh) {
            let at = mesh.vertices()[vertex as usize].as_dvec3();
            is_convex &= !at_grooves.contains(&vertex) && visit_corner(at, &normals, radius, pieces);
        }
    }
    is_convex
}

/// The triangles of a mesh with their outward normals.
struct Core {
    triangles: Vec<[DVec3; 3]>,
    normals: Vec<DVec3>,
}

impl Core {
    fn new(mesh: &TriMesh, is_solid: bool) -> Self {
        let triangles: Vec<[DVec3; 3]> = (0..mesh.triangles().len())
            .map(|t| mesh.welded_corners(t).map(|p| p.as_dvec3()))
            .collect();
        let volume: f64 = triangles.iter().map(|[p, q, r]| p.dot(q.cross(*r))).sum();
        let sign = if is_solid && volume < 0.0 { -1.0 } else { 1.0 };
        let normal = |[p, q, r]: &[DVec3; 3]| sign * (*q - *p).cross(*r - *p).normalize_or_zero();
        Self {
            normals: triangles.iter().map(normal).collect(),
            triangles,
        }
    }

    /// How far the middle of a face is above the plane of another: below it beyond a convex edge.
    fn height(&self, over: usize, face: usize) -> f64 {
        let [p, q, r] = self.triangles[face];
        self.normals[over].dot((p + q + r) / 3.0 - self.triangles[over][0])
    }

    /// Unit vector in the plane of a face, away from it, perpendicular to one of its edges.
    fn outward(&self, face: usize, [start, end]: [DVec3; 2]) -> DVec3 {
        let along = (end - start).normalize_or_zero();
        let ways = self.triangles[face].iter().map(|p| (*p - start).reject_from(along));
        let inward = ways.max_by(|p, q| p.length().total_cmp(&q.length()));
        -inward.unwrap_or_default().normalize_or_zero()
    }

    /// The different normals of the faces at each vertex, in the order of vertices.
    fn normals_around(&self, mesh: &TriMesh) -> Vec<(u32, Vec<DVec3>)> {
        let mut around: Vec<Vec<DVec3>> = vec![Vec::new(); mesh.vertices().len()];
        for (triangle, own) in mesh.triangles().iter().zip(&self.normals) {
            for v in triangle {
                let normals = &mut around[mesh.welded()[*v as usize] as usize];
                if normals.iter().all(|other| other.dot(*own) <= 1.0 - FLAT) {
                    normals.push(*own);
                }
            }
        }
        let corners = (0..).zip(around).filter(|(_, normals)| normals.len() > 2);
        corners.collect()
    }
}

/// The triangles at each edge, in the order of triangles.
fn faces_of_edges(mesh: &TriMesh) -> Vec<([u32; 2], Vec<usize>)> {
    let mut numbers = HashMap::new();
    let mut all: Vec<([u32; 2], Vec<usize>)> = Vec::new();
    for (t, triangle) in mesh.triangles().iter().enumerate() {
        let corners = triangle.map(|v| mesh.welded()[v as usize]);
        for k in 0..3 {
            let (u, v) = (corners[k], corners[(k + 1) % 3]);
            if u != v {
                let edge = [u.min(v), u.max(v)];
                let number = *numbers.entry(edge).or_insert_with(|| {
                    all.push((edge, Vec::new()));
                    all.len() - 1
                });
                all[number].1.push(t);
            }
        }
    }
    all
}

/// Visits the sector of a cylinder along an edge, between two normals.
fn visit_sector(ends: [DVec3; 2], [from, to]: [DVec3; 2], radius: f64, pieces: &mut impl Rounding) {
    let angle = from.angle_between(to);
    let axis = from.cross(to).normalize_or_zero();
    let slices = (angle / SLICE).ceil().max(1.0);
    let at = |i: f64| {
        let (sin, cos) = (angle * i / slices).sin_cos();
        (from * cos + axis.cross(from) * sin) * radius
    };
    for i in 0..slices as u32 {
        pieces.slice(ends, [at(f64::from(i)), at(f64::from(i) + 1.0)]);
    }
}

/// Visits what the prisms on both sides of a groove have in common.
fn visit_groove(ends: [DVec3; 2], normals: [DVec3; 2], radius: f64, pieces: &mut impl Rounding) {
    let middle = (normals[0] + normals[1]).normalize_or_zero();
    let tip = middle * (radius / middle.dot(normals[0]).max(0.1));
    for normal in normals {
        pieces.groove(ends, [normal * radius, tip]);
    }
}

/// Visits the sector of a ball at a vertex, between the normals of its faces. Tells whether these are on one side, as
/// at a convex corner; otherwise there is no sector.
fn visit_corner(at: DVec3, normals: &[DVec3], radius: f64, pieces: &mut impl Rounding) -> bool {
    let middle = normals.iter().sum::<DVec3>().normalize_or_zero();
    if normals.iter().any(|normal| normal.dot(middle) < LEAST_COSINE) {
        return false;
    }
    // By their angle about the middle.
    let (u, v) = middle.any_orthonormal_pair();
    let angle = |n: &DVec3| n.dot(v).atan2(n.dot(u));
    let mut around = normals.to_vec();
    around.sort_by(|p, q| angle(p).total_cmp(&angle(q)));
    for (i, from) in around.iter().enumerate() {
        let to = around[(i + 1) % around.len()];
        visit_triangle(at, [middle, *from, to], radius, MAX_SPLITS, pieces);
    }
    true
}

/// Visits a triangle on the unit sphere, split at most `splits` times.
fn visit_triangle(at: DVec3, corners: [DVec3; 3], radius: f64, splits: u32, pieces: &mut impl Rounding) {
    let [a, b, c] = corners;
    let longest = a.angle_between(b).max(b.angle_between(c)).max(c.angle_between(a));
    if longest <= SLICE || splits == 0 {
        pieces.corner(at, corners.map(|p| p * radius));
        return;
    }
    let [p, q, r] = [a + b, b + c, c + a].map(DVec3::normalize_or_zero);
    for part in [[a, p, r], [p, b, q], [r, q, c], [p, q, r]] {
        visit_triangle(at, part, radius, splits - 1, pieces);
    }
}
