//! The mass of a rounded mesh: of all that is within a radius of it.
//!
//! Around a convex core this is Steiner's formula, with moments: a prism on each face, a sector of a cylinder along
//! each edge, and a sector of a ball at each vertex. Where faces meet in a groove their prisms overlap, and the overlap
//! counts once. Segments and points have a closed form.

use super::{MassBasis, MassProperties, Solid, outer};
use crate::geometry::TriMesh;
use glam::{DMat3, DVec3};
use std::collections::{HashMap, HashSet};
use std::f64::consts::PI;

/// The largest angle of a slice of a cylinder or of a ball, radians.
const SLICE: f64 = 0.1;
/// Faces with a smaller angle between their normals are coplanar, radians.
const FLAT: f64 = 1.0e-6;

impl MassProperties {
    /// The mass of all that is within `radius` of the mesh; [`MassProperties::with_shell`] for a radius of 0.
    ///
    /// It is exact for segments and points, and to about 1e-5 for convex meshes. It is approximate
    /// ([`MassProperties::approximate`]) if the mesh has grooves narrower than the radius, and for sheets, which get no
    /// more than their two sides and half a cylinder along their borders.
    pub fn rounded(mesh: &TriMesh, shell: f32, radius: f32) -> Self {
        if radius == 0.0 {
            return Self::with_shell(mesh, shell);
        }
        let radius = f64::from(radius);
        if mesh.is_thin() {
            let ends = [mesh.corners(0)[0], mesh.corners(0)[2]].map(|end| end.as_dvec3());
            return capsule(ends, radius).rounded(2.0 * radius, MassBasis::Solid, 0.0);
        }
        let core = Self::with_shell(mesh, shell);
        let is_solid = matches!(core.basis, MassBasis::Solid | MassBasis::Capped);
        let mut sum = Moments::new(core.center.as_dvec3());
        if is_solid {
            (sum.volume, sum.second) = (f64::from(core.volume), core.second_moment.as_dmat3());
        }
        let is_convex = sum.add_rounding(mesh, radius, is_solid);
        let thickness = 2.0 * radius + if is_solid { f64::from(core.thickness) } else { 0.0 };
        let mut all = sum.solid().rounded(thickness, MassBasis::Solid, 0.0);
        all.approximate |= core.approximate || !is_convex;
        all.error = if is_solid { core.error } else { 1.0 };
        if !is_solid {
            all.basis = MassBasis::Shell;
        }
        all
    }
}

/// A segment with a radius: a cylinder between two half balls.
fn capsule([start, end]: [DVec3; 2], radius: f64) -> Solid {
    let (way, square) = (end - start, radius * radius);
    let length = way.length();
    let axis = way.normalize_or(DVec3::Y);
    let (cylinder, ball) = (PI * square * length, 4.0 / 3.0 * PI * square * radius);
    let along =
        cylinder * length * length / 12.0 + ball * (square / 5.0 + length * length / 4.0 + 3.0 / 8.0 * length * radius);
    let across = cylinder * square / 4.0 + ball * square / 5.0;
    Solid {
        volume: cylinder + ball,
        center: 0.5 * (start + end),
        second_moment: DMat3::from_diagonal(DVec3::splat(across)) + outer(axis) * (along - across),
    }
}

/// Volume and moments about an origin.
struct Moments {
    origin: DVec3,
    volume: f64,
    first: DVec3,
    second: DMat3,
}

impl Moments {
    fn new(origin: DVec3) -> Self {
        Self {
            origin,
            volume: 0.0,
            first: DVec3::ZERO,
            second: DMat3::ZERO,
        }
    }

    /// Adds `weight` times a tetrahedron.
    fn add(&mut self, corners: [DVec3; 4], weight: f64) {
        let [a, b, c, d] = corners.map(|p| p - self.origin);
        let det = weight * (b - a).dot((c - a).cross(d - a)).abs();
        let sum = a + b + c + d;
        self.volume += det / 6.0;
        self.first += sum * (det / 24.0);
        self.second += (outer(a) + outer(b) + outer(c) + outer(d) + outer(sum)) * (det / 120.0);
    }

    /// Adds `weight` times the prism between two triangles.
    fn add_prism(&mut self, [a, b, c]: [DVec3; 3], [d, e, f]: [DVec3; 3], weight: f64) {
        self.add([a, b, c, d], weight);
        self.add([b, c, d, e], weight);
        self.add([c, d, e, f], weight);
    }

    /// Adds the space within `radius` outside of a mesh, on both sides of a sheet. Tells whether all edges are convex.
    fn add_rounding(&mut self, mesh: &TriMesh, radius: f64, is_solid: bool) -> bool {
        let triangles: Vec<[DVec3; 3]> = (0..mesh.triangles().len())
            .map(|t| mesh.welded_corners(t).map(|p| p.as_dvec3()))
            .collect();
        let sign = if is_solid && signed_volume(&triangles) < 0.0 {
            -1.0
        } else {
            1.0
        };
        let normal = |t: usize| {
            let [p, q, r] = triangles[t];
            sign * (q - p).cross(r - p).normalize_or_zero()
        };
        let sides: &[f64] = if is_solid { &[1.0] } else { &[1.0, -1.0] };
        for (t, corners) in triangles.iter().enumerate() {
            for side in sides {
                let up = normal(t) * (radius * side);
                self.add_prism(*corners, corners.map(|p| p + up), 1.0);
            }
        }
        let mut is_convex = is_solid;
        let mut is_concave_at = HashSet::new();
        for ([u, v], faces) in faces_of_edges(mesh) {
            let ends = [u, v].map(|v| mesh.vertices()[v as usize].as_dvec3());
            match faces[..] {
                [face] => {
                    let along = (ends[1] - ends[0]).normalize_or_zero();
                    let third = triangles[face].iter().map(|p| *p - ends[0]);
                    let inward = third
                        .map(|p| p.reject_from(along))
                        .max_by(|p, q| p.length().total_cmp(&q.length()));
                    let out = -inward.unwrap_or_default().normalize_or_zero();
                    self.add_sector(ends, [normal(face), out], radius);
                    self.add_sector(ends, [out, -normal(face)], radius);
                }
                [one, other] => {
                    let middle = |t: usize| (triangles[t][0] + triangles[t][1] + triangles[t][2]) / 3.0;
                    // The other face lies below the plane of a face at a convex edge.
                    let height = normal(one).dot(middle(other) - ends[0]);
                    for side in sides {
                        let normals = [one, other].map(|t| normal(t) * *side);
                        if normals[0].angle_between(normals[1]) < FLAT {
                            continue;
                        }
                        if height * side < 0.0 {
                            self.add_sector(ends, normals, radius);
                        } else {
                            self.take_groove(ends, normals, radius);
                            is_convex = false;
                            is_concave_at.extend([u, v]);
                        }
                    }
                }
                _ => is_convex = false,
            }
        }
        if is_solid {
            for (vertex, normals) in normals_around(mesh, normal) {
                if !is_concave_at.contains(&vertex) {
                    self.add_corner(mesh.vertices()[vertex as usize].as_dvec3(), &normals, radius);
                }
            }
        }
        is_convex
    }

    /// Adds the sector of a cylinder along an edge, between two normals.
    fn add_sector(&mut self, ends: [DVec3; 2], [from, to]: [DVec3; 2], radius: f64) {
        let angle = from.angle_between(to);
        let axis = from.cross(to).normalize_or_zero();
        let slices = (angle / SLICE).ceil().max(1.0);
        let slice = angle / slices;
        // The triangles of the slices have the area of the sector.
        let radius = radius * (slice / slice.sin()).sqrt();
        let at = |i: f64| (from * (slice * i).cos() + axis.cross(from) * (slice * i).sin()) * radius;
        for i in 0..slices as u32 {
            let (p, q) = (at(f64::from(i)), at(f64::from(i) + 1.0));
            let [near, far] = ends.map(|end| [end, end + p, end + q]);
            self.add_prism(near, far, 1.0);
        }
    }

    /// Takes away what the prisms on both sides of a groove have in common.
    fn take_groove(&mut self, ends: [DVec3; 2], [one, other]: [DVec3; 2], radius: f64) {
        let middle = (one + other).normalize_or_zero();
        let tip = middle * (radius / middle.dot(one).max(0.1));
        for normal in [one, other] {
            let [near, far] = ends.map(|end| [end, end + normal * radius, end + tip]);
            self.add_prism(near, far, -1.0);
        }
    }

    /// Adds the sector of a ball at a vertex, between the normals of its faces.
    fn add_corner(&mut self, at: DVec3, normals: &[DVec3], radius: f64) {
        let middle = normals.iter().sum::<DVec3>().normalize_or_zero();
        // By their angle about the middle.
        let (u, v) = middle.any_orthonormal_pair();
        let angle = |n: &DVec3| n.dot(v).atan2(n.dot(u));
        let mut around = normals.to_vec();
        around.sort_by(|p, q| angle(p).total_cmp(&angle(q)));
        for (i, from) in around.iter().enumerate() {
            let to = around[(i + 1) % around.len()];
            self.add_spherical_triangle(at, [middle, *from, to], radius);
        }
    }

    /// Adds the cone from a point to a triangle on the unit sphere, times the radius.
    fn add_spherical_triangle(&mut self, at: DVec3, corners: [DVec3; 3], radius: f64) {
        let [a, b, c] = corners;
        let longest = a.angle_between(b).max(b.angle_between(c)).max(c.angle_between(a));
        if longest > SLICE {
            let [p, q, r] = [a + b, b + c, c + a].map(DVec3::normalize_or_zero);
            for part in [[a, p, r], [p, b, q], [r, q, c], [p, q, r]] {
                self.add_spherical_triangle(at, part, radius);
            }
            return;
        }
        let det = a.dot(b.cross(c)).abs();
        if det == 0.0 {
            return;
        }
        // Van Oosterom and Strackee, "The solid angle of a plane triangle", 1983. The cone has the volume of the
        // sector.
        let solid_angle = 2.0 * det.atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a));
        let radius = radius * (2.0 * solid_angle / det).cbrt();
        self.add([at, at + a * radius, at + b * radius, at + c * radius], 1.0);
    }

    fn solid(&self) -> Solid {
        let center = self.first / self.volume;
        Solid {
            volume: self.volume,
            center: self.origin + center,
            second_moment: self.second - outer(center) * self.volume,
        }
    }
}

fn signed_volume(triangles: &[[DVec3; 3]]) -> f64 {
    triangles.iter().map(|[p, q, r]| p.dot(q.cross(*r))).sum()
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

/// The different normals of the faces at each vertex, in the order of vertices.
fn normals_around(mesh: &TriMesh, normal: impl Fn(usize) -> DVec3) -> Vec<(u32, Vec<DVec3>)> {
    let mut around: Vec<Vec<DVec3>> = vec![Vec::new(); mesh.vertices().len()];
    for (t, triangle) in mesh.triangles().iter().enumerate() {
        for v in triangle {
            let normals = &mut around[mesh.welded()[*v as usize] as usize];
            let own = normal(t);
            if normals.iter().all(|other| other.angle_between(own) > FLAT) {
                normals.push(own);
            }
        }
    }
    let corners = (0..).zip(around).filter(|(_, normals)| normals.len() > 2);
    corners.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::shapes;
    use glam::Vec3;

    fn near(a: f32, b: f64) -> bool {
        (f64::from(a) - b).abs() <= 2.0e-5 * b.abs()
    }

    #[test]
    fn a_ball_and_a_capsule_have_their_closed_forms() {
        let ball = TriMesh::segment([Vec3::X; 2]).unwrap();
        let ball = MassProperties::rounded(&ball, 0.01, 0.5);
        let volume = 4.0 / 3.0 * PI * 0.125;
        assert!(near(ball.volume, volume) && ball.center == Vec3::X && !ball.approximate);
        let inertia = ball.inertia(DVec3::ONE, 1.0);
        assert!(near(inertia.x_axis.x as f32, 0.4 * 0.25) && near(inertia.z_axis.z as f32, 0.4 * 0.25));

        let capsule = TriMesh::segment([Vec3::ZERO, 2.0 * Vec3::Y]).unwrap();
        let capsule = MassProperties::rounded(&capsule, 0.01, 0.5);
        assert!(near(capsule.volume, volume + PI * 0.25 * 2.0) && capsule.center == Vec3::Y);
        let shares = [PI * 0.5, volume].map(|v| v / (volume + PI * 0.5));
        let along = shares[0] * 0.125 + shares[1] * 0.1;
        let inertia = capsule.inertia(DVec3::ONE, 1.0);
        assert!(near(inertia.y_axis.y as f32, along), "{}", inertia.y_axis.y);
        let across = shares[0] * (4.0 / 12.0 + 0.25 / 4.0) + shares[1] * (0.1 + 1.0 + 3.0 / 8.0);
        assert!(near(inertia.x_axis.x as f32, across), "{}", inertia.x_axis.x);
    }

    #[test]
    fn a_rounded_cube_follows_steiner() {
        let (edge, radius) = (1.0, 0.25);
        let all = MassProperties::rounded(&shapes::cube(edge), 0.01, radius as f32);
        let volume = edge.powi(3)
            + 6.0 * edge * edge * radius
            + 3.0 * PI * radius * radius * edge
            + 4.0 / 3.0 * PI * radius.powi(3);
        assert!(near(all.volume, volume), "{} for {volume}", all.volume);
        assert!(all.center.length() < 1.0e-6 && !all.approximate);
        let inertia = all.inertia(DVec3::ONE, 1.0);
        assert!((inertia.x_axis.x - inertia.z_axis.z).abs() < 1.0e-6);
    }

    #[test]
    fn a_rounded_ball_is_a_larger_ball() {
        let rounded = MassProperties::rounded(&shapes::ball(0.5, 4), 0.01, 0.25);
        let ball = MassProperties::with_shell(&shapes::ball(0.75, 4), 0.01);
        assert!((rounded.volume / ball.volume - 1.0).abs() < 2.0e-3);
        let [a, b] = [&rounded, &ball].map(|mass| mass.inertia(DVec3::ONE, 1.0).x_axis.x);
        assert!((a / b - 1.0).abs() < 4.0e-3, "{a} for {b}");
    }

    #[test]
    fn a_thick_sheet_weighs_its_two_sides_and_its_border() {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y];
        let sheet = TriMesh::new(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).unwrap();
        let all = MassProperties::rounded(&sheet, 0.01, 0.1);
        let volume = 0.2 + 4.0 * 0.5 * PI * 0.01;
        assert!(near(all.volume, volume) && all.approximate, "{}", all.volume);
    }
}
