//! Where a round surface touches of which a mesh has only corners.
//!
//! A finely cut ball that rolls touches with one corner after the other, and each pushes ahead of the centre until the next
//! detection: the ball would be slowed down by as much as if it had facets of the length of its way in an interval.

use super::feature::Feature;
use super::side::Side;
use glam::{DMat3, DVec3};

/// How far, as a sine, the normal at a vertex may differ from a contact's: half the angle between faces of a round of 32.
/// What is cut more coarsely lies on its facets.
const SMOOTH: f64 = 0.1;

/// From where a feature with a vertex touches to where the smooth surface around the vertex does, along the other body's
/// face. `roundness` is the surface's.
pub fn slide(sides: &[Side; 2], feature: &Feature, roundness: f64) -> DVec3 {
    let Some((side, vertex)) = feature.vertex.filter(|_| roundness > 0.0 && roundness.is_finite()) else {
        return DVec3::ZERO;
    };
    let own = &sides[usize::from(side)];
    let out = if side == 0 { feature.normal } else { -feature.normal };
    let across = |normal: DVec3| normal - out * normal.dot(out);
    let Some(across) = normal(own, vertex).filter(|n| n.dot(out) > 0.0).map(across) else {
        return DVec3::ZERO;
    };
    if across.length_squared() > SMOOTH * SMOOTH {
        return DVec3::ZERO;
    }
    // No farther round than to beside the centre of mass, as the solver takes it.
    let inside = (feature.points[usize::from(side)] - own.center).dot(out).max(0.0);
    -across * roundness.min(inside)
}

/// The normal at a vertex: that of the sphere that fits it and its neighbours best, which does not depend on how the surface
/// is cut.
fn normal(side: &Side, vertex: u32) -> Option<DVec3> {
    let at = side.vertex(vertex);
    let (mut squares, mut sum) = (DMat3::ZERO, DVec3::ZERO);
    for &neighbor in side.features.neighbors_of(vertex) {
        // From a point of a sphere to its centre `c` and another point `e`: 2 c . e = e . e.
        let edge = side.vertex(neighbor) - at;
        let way = edge.normalize_or_zero();
        squares += DMat3::from_cols(way * way.x, way * way.y, way * way.z);
        sum += edge;
    }
    (squares.inverse() * -sum).try_normalize()
}
