//! Contact on the smooth surface that a fine mesh approximates.
//!
//! On its mesh, a rolling ball touches with one vertex after the other, and each lies ahead of the centre until the
//! next collision substep. The ball would lose speed as if its facets were as long as its travel in a collision substep. Balls
//! in an off-centre impact would be deflected along the normals of the facets that lie most across their path, which
//! touch first.

use super::feature::Feature;
use super::side::Side;
use glam::DVec3;

/// Sine of the largest angle between the smooth normal at a vertex and the contact normal: half the angle between the
/// faces of a cylinder of 32 sides. A coarser surface lies on its facets.
pub(crate) const SMOOTH: f64 = 0.1;

/// The contact of the smooth surfaces at a feature.
pub struct Smoothed {
    /// Unit vector from the first body to the second.
    pub normal: DVec3,
    /// Offset of each body's point, perpendicular to the normal, to where its smooth surface touches.
    pub slides: [DVec3; 2],
    /// Rotation of the normal per distance that the surfaces slide along each other, rad/m.
    pub normal_rotation: f64,
}

/// The contact at a feature, for the radii of curvature there.
pub fn smoothed(sides: &[Side; 2], feature: &Feature, curvature_radii: [f64; 2]) -> Smoothed {
    between_spheres(sides, feature, curvature_radii).unwrap_or_else(|| {
        let slide = feature.vertex().and_then(|(side, vertex)| {
            let i = usize::from(side);
            let anchor = feature.points[i] - sides[i].center;
            let out = [feature.normal, -feature.normal][i];
            slide_of_vertex(sides[i].smooth_normal(vertex), anchor, out, curvature_radii[i])
        });
        Smoothed {
            normal: feature.normal,
            // Both points move along the other body's face.
            slides: [slide.unwrap_or(DVec3::ZERO); 2],
            normal_rotation: 0.0,
        }
    })
}

/// The contact of two surfaces that are convex in all directions: on the line between their centres of curvature.
fn between_spheres(sides: &[Side; 2], feature: &Feature, curvature_radii: [f64; 2]) -> Option<Smoothed> {
    let curvature = [0, 1].map(|i| sides[i].curvature(feature.triangles[i]));
    if curvature.contains(&0.0) {
        return None;
    }
    let [radius_a, radius_b] = curvature.map(f64::recip);
    let [a, b] = [0, 1].map(|i| normal_at(&sides[i], feature.triangles[i], feature.points[i]));
    let (a, b) = (a?, b?);
    // The smooth normals at two points differ by at most the angle of two facets.
    let least = 1.0 - 2.0 * SMOOTH * SMOOTH;
    if a.dot(feature.normal) < least || -b.dot(feature.normal) < least {
        return None;
    }
    let gap = feature.separation.max(0.0);
    let normal = (a * radius_a - b * radius_b + feature.normal * gap).try_normalize()?;
    let anchors = [0, 1].map(|i| feature.points[i] - sides[i].center);
    Some(Smoothed {
        normal,
        slides: [
            slide(a, anchors[0], normal, curvature_radii[0]),
            slide(b, anchors[1], -normal, curvature_radii[1]),
        ],
        normal_rotation: (radius_a + radius_b + gap).recip(),
    })
}

/// Offset from a vertex, at `anchor` from the centre of mass, to where the smooth surface around it has the normal
/// `out`; `None` if there is no smooth surface. `normal` is the smooth normal at the vertex, which may be zero.
pub fn slide_of_vertex(normal: DVec3, anchor: DVec3, out: DVec3, curvature_radius: f64) -> Option<DVec3> {
    let normal = normal.try_normalize()?;
    let is_near = normal.dot(out) > 0.0 && normal.cross(out).length_squared() <= SMOOTH * SMOOTH;
    let is_round = curvature_radius > 0.0 && curvature_radius.is_finite();
    (is_near && is_round).then(|| slide(normal, anchor, out, curvature_radius))
}

/// Offset from a point with this normal, at `anchor` from the centre of mass, to where the normal is `out`.
fn slide(normal: DVec3, anchor: DVec3, out: DVec3, curvature_radius: f64) -> DVec3 {
    // The centre of curvature lies no deeper than the centre of mass, as in the solver.
    let inside = anchor.dot(out).max(0.0);
    (out * normal.dot(out) - normal) * curvature_radius.min(inside)
}

/// The smooth normal at a point of a triangle, interpolated from the corners by barycentric areas.
fn normal_at(side: &Side, triangle: u32, at: DVec3) -> Option<DVec3> {
    let vertices = side.features.triangles[triangle as usize];
    let corners = vertices.map(|v| side.vertex(v) - at);
    let whole = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    let mut sum = DVec3::ZERO;
    for k in 0..3 {
        let area = corners[(k + 1) % 3].cross(corners[(k + 2) % 3]).dot(whole);
        sum += side.smooth_normal(vertices[k]).normalize_or_zero() * area.max(0.0);
    }
    sum.try_normalize()
}
