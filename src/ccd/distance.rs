//! Where two triangles are nearest to each other, in double precision.

use glam::DVec3;

/// The shortest way between two triangles.
#[derive(Clone, Copy, Debug)]
pub struct Nearest {
    /// The point of the first triangle; if they have a common point, one that is near both.
    pub from: DVec3,
    /// Zero if they have a common point, to rounding.
    pub distance: f64,
    /// From the first to the second, of length one; anything if they have a common point.
    pub direction: DVec3,
}

/// Of triangles `a` and `b`. The nearest points of two triangles that do not meet are on an edge of each, or a corner of one and
/// a point within the other.
pub fn nearest(a: &[DVec3; 3], b: &[DVec3; 3]) -> Nearest {
    let (mut from, mut way) = (a[0], DVec3::INFINITY);
    let mut squared = f64::INFINITY;
    let mut offer = |start: DVec3, offered: DVec3| {
        if offered.length_squared() < squared {
            (from, way, squared) = (start, offered, offered.length_squared());
        }
    };
    for i in 0..3 {
        for j in 0..3 {
            let [start, offered] = between_segments([a[i], a[(i + 1) % 3]], [b[j], b[(j + 1) % 3]]);
            offer(start, offered);
        }
    }
    let from_a = corners_over(a, b, &mut |corner, way| offer(corner - way, way));
    let from_b = corners_over(b, a, &mut |corner, way| offer(corner, -way));
    if from_a || from_b {
        (way, squared) = (DVec3::ZERO, 0.0);
    }
    let distance = squared.sqrt();
    Nearest {
        from,
        distance,
        direction: way / distance.max(f64::MIN_POSITIVE),
    }
}

/// Calls `found` for those corners of `other` that are above the inner of `triangle`, or below, with the ways to them, and tells
/// whether an edge of `other` passes through it.
fn corners_over(triangle: &[DVec3; 3], other: &[DVec3; 3], found: &mut impl FnMut(DVec3, DVec3)) -> bool {
    let [p, q, r] = *triangle;
    let normal = (q - p).cross(r - p);
    let squared = normal.length_squared();
    let sides = [(p, q), (q, r), (r, p)].map(|(from, to)| (from, normal.cross(to - from)));
    // Of a triangle without an area the sides are all there is.
    let is_over = |x: DVec3| squared > 0.0 && sides.iter().all(|(from, inward)| inward.dot(x - *from) >= 0.0);
    let heights = other.map(|x| normal.dot(x - p));
    for k in 0..3 {
        if is_over(other[k]) {
            found(other[k], normal * (heights[k] / squared));
        }
    }
    (0..3).any(|k| {
        let (from, to) = (k, (k + 1) % 3);
        let crosses = (heights[from] < 0.0) != (heights[to] < 0.0);
        let part = heights[from] / (heights[from] - heights[to]);
        crosses && is_over(other[from] + (other[to] - other[from]) * part)
    })
}

/// Where the shortest way from a segment to another begins, and that way (Ericson, "Real-Time Collision Detection", 5.1.9).
fn between_segments([p, p_end]: [DVec3; 2], [q, q_end]: [DVec3; 2]) -> [DVec3; 2] {
    let (u, v, w) = (p_end - p, q_end - q, p - q);
    let (uu, vv, uv) = (u.length_squared(), v.length_squared(), u.dot(v));
    let (uw, vw) = (u.dot(w), v.dot(w));
    let part = |numerator: f64, denominator: f64| {
        if denominator > 0.0 {
            (numerator / denominator).clamp(0.0, 1.0)
        } else {
            0.0
        }
    };
    // Where the lines are nearest, if that is on the first segment; then the nearest on the second to that; then back.
    let s = part(uv * vw - uw * vv, uu * vv - uv * uv);
    let t = part(uv * s + vw, vv);
    let s = part(uv * t - uw, uu);
    let from = p + u * s;
    [from, (q + v * t) - from]
}
