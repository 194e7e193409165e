//! Containment by winding numbers, and the linking of closed curves.

use super::body::{Body, World};
use super::tritri::Triangle;
use glam::DVec3;
use std::f64::consts::PI;

/// Whether a connected component of one body lies inside the other, closed body. The surfaces must not meet: then each
/// component is completely inside or outside, and one of its points decides.
pub fn contained(a: &World, b: &World) -> bool {
    a.components.iter().any(|&p| inside(p, b)) || b.components.iter().any(|&p| inside(p, a))
}

/// Whether `p` lies inside the closed body; nothing lies inside an open one.
pub fn inside(p: DVec3, body: &World) -> bool {
    body.closed && body.bounds.contains(p) && winding_number(p, &body.triangles).abs() > 0.5
}

/// The winding number of the triangles about `p`: the sum of their solid angles, in full spheres (Van Oosterom and
/// Strackee).
pub fn winding_number(p: DVec3, triangles: &[Triangle]) -> f64 {
    let solid_angle = |t: &Triangle| {
        let [a, b, c] = t.map(|v| v - p);
        let [la, lb, lc] = [a.length(), b.length(), c.length()];
        2.0 * a
            .dot(b.cross(c))
            .atan2(la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb)
    };
    triangles.iter().map(solid_angle).sum::<f64>() / (4.0 * PI)
}

/// Gauss' linking number of the core curves of two tubes: half the signed crossings seen along z.
pub fn linking_number(a: &Body, b: &Body) -> i32 {
    let curve = |body: &Body| -> Vec<DVec3> { body.mesh.core.iter().map(|&p| body.place(p)).collect() };
    let [a, b] = [curve(a), curve(b)];
    let mut crossings = 0;
    for (i, &p) in a.iter().enumerate() {
        let e = a[(i + 1) % a.len()] - p;
        for (j, &q) in b.iter().enumerate() {
            let f = b[(j + 1) % b.len()] - q;
            let turn = e.x * f.y - e.y * f.x;
            let w = q - p;
            let s = (w.x * f.y - w.y * f.x) / turn;
            let t = (w.x * e.y - w.y * e.x) / turn;
            // Parallel projections give NaN, which lies in no range.
            if (0.0..1.0).contains(&s) && (0.0..1.0).contains(&t) {
                let a_is_above = p.z + s * e.z > q.z + t * f.z;
                crossings += if (turn > 0.0) == a_is_above { 1 } else { -1 };
            }
        }
    }
    crossings / 2
}
