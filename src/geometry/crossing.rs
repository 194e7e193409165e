//! The crossing of a triangle by a ray along +z, so exact that the crossings of a closed surface add up.

use glam::DVec3;

/// Sign of the crossing of a triangle by the ray from the origin along +z, if it crosses: 1 if the corners are
/// counter-clockwise seen from above. A ray through an edge or corner is shifted by an infinitesimal step, the same for
/// all triangles, so exactly one of two neighbours counts it.
pub(crate) fn crossing(t: &[DVec3; 3]) -> Option<i32> {
    let left = |p: DVec3, q: DVec3| {
        // Exactly antisymmetric in p and q, ties included, so both triangles of an edge agree.
        let side = p.x * q.y - p.y * q.x;
        if side != 0.0 {
            side > 0.0
        } else {
            (q.x, q.y) > (p.x, p.y)
        }
    };
    let sides = [left(t[0], t[1]), left(t[1], t[2]), left(t[2], t[0])];
    if sides != [sides[0]; 3] {
        return None;
    }
    // Whether the plane lies above the origin.
    let normal = (t[1] - t[0]).cross(t[2] - t[0]);
    let above = normal.dot(t[0]) * normal.z > 0.0;
    above.then_some(if sides[0] { 1 } else { -1 })
}
