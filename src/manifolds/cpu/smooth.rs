//! How round surfaces touch of which a mesh has only corners and facets.
//!
//! A finely cut ball that rolls touches with one corner after the other, and each pushes ahead of the centre until the next
//! detection: the ball would be slowed down by as much as if it had facets of the length of its way in an interval. And balls
//! that meet off their centres would be thrown along the normals of the facets that lie most across their way, which come first.

use super::feature::Feature;
use super::side::Side;
use glam::DVec3;

/// How far, as a sine, the normal at a vertex may differ from a contact's: half the angle between faces of a round of 32.
/// What is cut more coarsely lies on its facets.
pub(crate) const SMOOTH: f64 = 0.1;

/// How the smooth surfaces touch at a feature.
pub struct Smoothed {
    /// Unit vector from the first body to the second.
    pub normal: DVec3,
    /// From where each body touches to where its smooth surface does, across the normal.
    pub slides: [DVec3; 2],
    /// How fast the normal turns as the surfaces slide along each other, radians per metre.
    pub turn: f64,
}

/// How they touch at a feature where they are as round as `roundness` says.
pub fn smoothed(sides: &[Side; 2], feature: &Feature, roundness: [f64; 2]) -> Smoothed {
    as_balls(sides, feature, roundness).unwrap_or_else(|| {
        let slide = feature.vertex().and_then(|(side, vertex)| {
            let i = usize::from(side);
            let arm = feature.points[i] - sides[i].center;
            let out = [feature.normal, -feature.normal][i];
            slide_of_vertex(sides[i].round_normal(vertex), arm, out, roundness[i])
        });
        Smoothed {
            normal: feature.normal,
            // Along the other body's face.
            slides: [slide.unwrap_or(DVec3::ZERO); 2],
            turn: 0.0,
        }
    })
}

/// Of surfaces that are round all ways: they touch between the centres of the balls that they are there.
fn as_balls(sides: &[Side; 2], feature: &Feature, roundness: [f64; 2]) -> Option<Smoothed> {
    let curvature = [0, 1].map(|i| sides[i].curvature(feature.triangles[i]));
    if curvature.contains(&0.0) {
        return None;
    }
    let [radius_a, radius_b] = curvature.map(f64::recip);
    let [a, b] = [0, 1].map(|i| normal_at(&sides[i], feature.triangles[i], feature.points[i]));
    let (a, b) = (a?, b?);
    // Two facets lie between the normals at two points.
    let least = 1.0 - 2.0 * SMOOTH * SMOOTH;
    if a.dot(feature.normal) < least || -b.dot(feature.normal) < least {
        return None;
    }
    let gap = feature.separation.max(0.0);
    let normal = (a * radius_a - b * radius_b + feature.normal * gap).try_normalize()?;
    let arms = [0, 1].map(|i| feature.points[i] - sides[i].center);
    Some(Smoothed {
        normal,
        slides: [
            slide(a, arms[0], normal, roundness[0]),
            slide(b, arms[1], -normal, roundness[1]),
        ],
        turn: (radius_a + radius_b + gap).recip(),
    })
}

/// From a vertex at `arm` from the centre of mass to where the smooth surface around it has the normal `out`; nothing if there
/// is no such surface. At the vertex its normal lies along `normal`, which may be zero.
pub fn slide_of_vertex(normal: DVec3, arm: DVec3, out: DVec3, roundness: f64) -> Option<DVec3> {
    let normal = normal.try_normalize()?;
    let is_near = normal.dot(out) > 0.0 && normal.cross(out).length_squared() <= SMOOTH * SMOOTH;
    let is_round = roundness > 0.0 && roundness.is_finite();
    (is_near && is_round).then(|| slide(normal, arm, out, roundness))
}

/// From a point with this normal, at `arm` from the centre of mass, to where it is `out`.
fn slide(normal: DVec3, arm: DVec3, out: DVec3, roundness: f64) -> DVec3 {
    // No farther round than to beside the centre of mass, as the solver takes it.
    let inside = arm.dot(out).max(0.0);
    (out * normal.dot(out) - normal) * roundness.min(inside)
}

/// The smooth surface's normal at a point of a triangle: between those at its corners, by the areas over against them.
fn normal_at(side: &Side, triangle: u32, at: DVec3) -> Option<DVec3> {
    let vertices = side.features.triangles[triangle as usize];
    let corners = vertices.map(|v| side.vertex(v) - at);
    let whole = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    let mut sum = DVec3::ZERO;
    for k in 0..3 {
        let area = corners[(k + 1) % 3].cross(corners[(k + 2) % 3]).dot(whole);
        sum += side.round_normal(vertices[k]).normalize_or_zero() * area.max(0.0);
    }
    sum.try_normalize()
}
