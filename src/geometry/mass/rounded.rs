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
    /// ([`MassProperties::approximate`]) if the mesh has grooves, of which narrow ones take too much off, and for
    /// sheets, which get no more than their two sides and half a cylinder along their borders.
    pub fn rounded(mesh: &TriMesh, shell: f32, radius: f32) -> Self {
        if radius == 0.0 {
            return Self::with_shell(mesh, shell);
        }
        let radius = f64::from(radius);
        if mesh.is_thin() {
            let [start, _, end] = mesh.corners(0).map(|p| p.as_dvec3());
            return Self::of_segment([start, end], radius);
        }
        let core = Self::with_shell(mesh, shell);
        let has_volume = matches!(core.basis, MassBasis::Solid | MassBasis::Capped);
        let is_solid = has_volume || mesh.is_solid();
        let mut sum = Moments::new(core.center.as_dvec3());
        if has_volume {
            (sum.volume, sum.second) = (f64::from(core.volume), core.second_moment.as_dmat3());
        }
        let is_convex = rounding::visit(mesh, radius, is_solid, &mut sum);
        let thickness = 2.0 * radius + if has_volume { f64::from(core.thickness) } else { 0.0 };
        if !sum.is_valid() || has_volume && sum.volume < f64::from(core.volume) {
            // Narrow grooves have taken more than there is.
            return Self {
                thickness: thickness as f32,
                approximate: true,
                error: 1.0,
                ..core
            };
        }
        let basis = if is_solid { MassBasis::Solid } else { MassBasis::Shell };
        let error = (sum.taken / sum.volume).max(if has_volume { f64::from(core.error) } else { 0.0 });
        let mut all = sum.solid().to_single(thickness, basis, error);
        all.approximate |= !is_convex || has_volume && core.approximate;
        all
    }

    /// The mass of all that is within `radius` of a segment.
    pub(crate) fn of_segment(ends: [DVec3; 2], radius: f64) -> Self {
        capsule(ends, radius).to_single(2.0 * radius, MassBasis::Solid, 0.0)
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
    /// What grooves took off, as a volume.
    taken: f64,
}

impl Moments {
    fn new(origin: DVec3) -> Self {
        Self {
            origin,
            volume: 0.0,
            first: DVec3::ZERO,
            second: DMat3::ZERO,
            taken: 0.0,
        }
    }

    /// Adds `weight` times a tetrahedron.
    fn add(&mut self, corners: [DVec3; 4], weight: f64) {
        let [a, b, c, d] = corners.map(|p| p - self.origin);
        let det = weight * (b - a).dot((c - a).cross(d - a)).abs();
        let sum = a + b + c + d;
        self.volume += det / 6.0;
        self.taken -= (det / 6.0).min(0.0);
        self.first += sum * (det / 24.0);
        self.second += (outer(a) + outer(b) + outer(c) + outer(d) + outer(sum)) * (det / 120.0);
    }

    /// Adds `weight` times the prism between two triangles.
    fn add_prism(&mut self, [a, b, c]: [DVec3; 3], [d, e, f]: [DVec3; 3], weight: f64) {
        self.add([a, b, c, d], weight);
        self.add([b, c, d, e], weight);
        self.add([c, d, e, f], weight);
    }

    /// Whether these may be the moments of a solid.
    fn is_valid(&self) -> bool {
        let solid = self.solid();
        let m = solid.second_moment;
        let least = m.x_axis.x.min(m.y_axis.y).min(m.z_axis.z);
        self.volume > 0.0 && least > 0.0 && m.is_finite() && solid.center.is_finite()
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
        let wider = if angle > 0.0 { (angle / angle.sin()).sqrt() } else { 1.0 };
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

    #[test]
    fn both_sides_of_a_doubled_sheet_count_once() {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 0.6, 0.8), Vec3::new(0.0, 0.6, 0.8)];
        let single = vec![[0, 1, 2], [0, 2, 3]];
        let doubled = vec![[0, 1, 2], [0, 2, 3], [0, 2, 1], [0, 3, 2]];
        let [single, doubled] = [single, doubled].map(|faces| {
            let mesh = TriMesh::new(corners.to_vec(), faces).unwrap();
            MassProperties::rounded(&mesh, 0.01, 0.1).volume
        });
        assert!((doubled / single - 1.0).abs() < 1.0e-4, "{doubled} for {single}");
    }

    #[test]
    fn odd_corners_and_narrow_grooves_give_a_mass() {
        // Two cubes that share a corner.
        let cube = shapes::cube(1.0);
        let [low, high] = [-0.5f32, 0.5].map(|by| cube.vertices().iter().map(move |p| *p + by));
        let faces = cube.triangles().iter();
        let faces = faces.clone().copied().chain(faces.map(|t| t.map(|v| v + 8)));
        let cubes = TriMesh::new(low.chain(high).collect(), faces.collect()).unwrap();
        let mass = MassProperties::rounded(&cubes, 0.01, 0.1);
        assert!(mass.volume > 2.0 && mass.volume < 4.5 && mass.approximate, "{mass:?}");

        // A star with so many narrow teeth that their grooves take more than there is.
        let (teeth, height) = (64, 1.5);
        let at = |i: i32, y: f32| {
            let (sin, cos) = (std::f32::consts::PI * i as f32 / teeth as f32).sin_cos();
            let radius = if i % 2 == 0 { 1.0 } else { 0.8 };
            Vec3::new(radius * cos, y, radius * sin)
        };
        let mut vertices = vec![Vec3::Y * height, Vec3::NEG_Y * height];
        vertices.extend((0..2 * teeth).flat_map(|i| [at(i, height), at(i, -height)]));
        let ring = |i: i32, k: i32| (2 + 2 * (i % (2 * teeth)) + k) as u32;
        let faces = (0..2 * teeth).flat_map(|i| {
            let [a, b, c, d] = [ring(i, 0), ring(i, 1), ring(i + 1, 0), ring(i + 1, 1)];
            [[0, c, a], [1, b, d], [a, c, b], [c, d, b]]
        });
        let star = TriMesh::new(vertices, faces.collect()).unwrap();
        let [core, mass] = [0.0, 0.3].map(|radius| MassProperties::rounded(&star, 0.01, radius));
        assert!(mass.volume >= core.volume && mass.center.length() < 0.1, "{mass:?}");
        assert!(mass.approximate && mass.error > 0.0);
    }
}
