//! The baseline: all triangles of one body against all triangles of the other, in single precision on one thread. A box
//! test comes before Moeller's interval test (1997). There is no hierarchy, no culling and no contact generation.

use glam::{Mat3, Vec3};

#[derive(Clone, Copy)]
pub struct Triangle {
    corners: [Vec3; 3],
    normal: Vec3,
    offset: f32,
    min: Vec3,
    max: Vec3,
}

impl Triangle {
    #[inline(always)]
    pub fn new(corners: [Vec3; 3]) -> Self {
        let [p, q, r] = corners;
        let normal = (q - p).cross(r - p);
        Self {
            corners,
            normal,
            offset: normal.dot(p),
            min: p.min(q).min(r),
            max: p.max(q).max(r),
        }
    }
}

/// Transforms the triangles of `b` to the axes of `a`, tests all pairs, and returns the number that intersect.
pub fn count(a: &[Triangle], b: &[[Vec3; 3]], matrix: Mat3, translation: Vec3, placed: &mut Vec<Triangle>) -> u32 {
    placed.clear();
    placed.extend(b.iter().map(|t| Triangle::new(t.map(|p| matrix * p + translation))));
    let mut hits = 0;
    for s in a {
        for t in placed.iter() {
            let apart = s.min.x > t.max.x
                || s.max.x < t.min.x
                || s.min.y > t.max.y
                || s.max.y < t.min.y
                || s.min.z > t.max.z
                || s.max.z < t.min.z;
            if !apart && moeller(s, t) {
                hits += 1;
            }
        }
    }
    hits
}

fn moeller(s: &Triangle, t: &Triangle) -> bool {
    let ht = t.corners.map(|p| s.normal.dot(p) - s.offset);
    if ht[0] * ht[1] > 0.0 && ht[0] * ht[2] > 0.0 {
        return false;
    }
    let hs = s.corners.map(|p| t.normal.dot(p) - t.offset);
    if hs[0] * hs[1] > 0.0 && hs[0] * hs[2] > 0.0 {
        return false;
    }
    let axis = s.normal.cross(t.normal).abs().max_position();
    match (
        interval(s.corners.map(|p| p[axis]), hs),
        interval(t.corners.map(|p| p[axis]), ht),
    ) {
        (Some(a), Some(b)) => a.0 <= b.1 && b.0 <= a.1,
        _ => false,
    }
}

/// The interval in which a triangle crosses the other's plane, from its coordinates `x` along the common line and its
/// heights `h` over the plane.
fn interval(x: [f32; 3], h: [f32; 3]) -> Option<(f32, f32)> {
    let alone = if h[0] * h[1] > 0.0 {
        2
    } else if h[0] * h[2] > 0.0 {
        1
    } else if h[1] * h[2] > 0.0 || h[0] != 0.0 {
        0
    } else if h[1] != 0.0 {
        1
    } else if h[2] != 0.0 {
        2
    } else {
        return None;
    };
    let cross = |k: usize| x[alone] + (x[k] - x[alone]) * h[alone] / (h[alone] - h[k]);
    let (p, q) = (cross((alone + 1) % 3), cross((alone + 2) % 3));
    Some((p.min(q), p.max(q)))
}
