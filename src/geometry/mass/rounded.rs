//! The mass of a rounded mesh: of all that is within a radius of it.
//!
//! Around a convex core this is Steiner's formula, with moments: see [`rounding`]. Segments and points have a closed
//! form.

use super::{MassBasis, MassProperties, Solid, outer};
use crate::geometry::TriMesh;
use crate::geometry::rounding::{self, Rounding};
use glam::{DMat3, DVec3};
use std::f64::consts::PI;

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
        let is_convex = rounding::visit(mesh, radius, is_solid, &mut sum);
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

    fn solid(&self) -> Solid {
        let center = self.first / self.volume;
        Solid {
            volume: self.volume,
            center: self.origin + center,
            second_moment: self.second - outer(center) * self.volume,
        }
    }
}

impl Rounding for Moments {
    fn face(&mut self, corners: [DVec3; 3], up: DVec3) {
        self.add_prism(corners, corners.map(|p| p + up), 1.0);
    }

    fn slice(&mut self, ends: [DVec3; 2], [p, q]: [DVec3; 2]) {
        // The triangles of the slices have the area of the sector.
        let angle = p.angle_between(q);
        let wider = (angle / angle.sin()).sqrt();
        let [near, far] = ends.map(|end| [end, end + p * wider, end + q * wider]);
        self.add_prism(near, far, 1.0);
    }

    fn groove(&mut self, ends: [DVec3; 2], [up, tip]: [DVec3; 2]) {
        let [near, far] = ends.map(|end| [end, end + up, end + tip]);
        self.add_prism(near, far, -1.0);
    }

    fn corner(&mut self, at: DVec3, corners: [DVec3; 3]) {
        let radius = corners[0].length();
        let [a, b, c] = corners.map(|p| p / radius);
        let det = a.dot(b.cross(c)).abs();
        if det == 0.0 {
            return;
        }
        // Van Oosterom and Strackee, "The solid angle of a plane triangle", 1983. The cone has the volume of the
        // sector.
        let solid_angle = 2.0 * det.atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a));
        let wider = (2.0 * solid_angle / det).cbrt();
        let [a, b, c] = corners.map(|p| at + p * wider);
        self.add([at, a, b, c], 1.0);
    }
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
