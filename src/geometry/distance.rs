//! The nearest points of two triangles, and of a triangle and a point, in double precision.

use glam::DVec3;

/// The shortest segment between two triangles.
#[derive(Clone, Copy, Debug)]
pub struct Nearest {
    /// The nearest point of the first triangle. If the triangles intersect, a point near both.
    pub from: DVec3,
    /// Zero if they intersect, up to rounding.
    pub distance: f64,
    /// Unit vector from the first to the second; arbitrary if they intersect.
    pub direction: DVec3,
}

/// The nearest points of triangles `a` and `b`. If the triangles do not intersect, they lie on an edge of each, or are
/// a corner of one and an interior point of the other.
pub fn nearest(a: &[DVec3; 3], b: &[DVec3; 3]) -> Nearest {
    let (mut from, mut offset) = (a[0], DVec3::INFINITY);
    let mut squared = f64::INFINITY;
    let mut consider = |start: DVec3, candidate: DVec3| {
        if candidate.length_squared() < squared {
            (from, offset, squared) = (start, candidate, candidate.length_squared());
        }
    };
    for i in 0..3 {
        for j in 0..3 {
            let [start, candidate] = between_segments([a[i], a[(i + 1) % 3]], [b[j], b[(j + 1) % 3]]);
            consider(start, candidate);
        }
    }
    let b_crosses = corners_above(a, b, &mut |corner, height| consider(corner - height, height));
    let a_crosses = corners_above(b, a, &mut |corner, height| consider(corner, -height));
    if b_crosses || a_crosses {
        (offset, squared) = (DVec3::ZERO, 0.0);
    }
    let distance = squared.sqrt();
    Nearest {
        from,
        distance,
        direction: offset / distance.max(f64::MIN_POSITIVE),
    }
}

/// Calls `found` with each corner of `other` that is above or below the interior of `triangle`, and with its height as
/// a vector. Returns whether an edge of `other` crosses `triangle`.
fn corners_above(triangle: &[DVec3; 3], other: &[DVec3; 3], found: &mut impl FnMut(DVec3, DVec3)) -> bool {
    let [p, q, r] = *triangle;
    let normal = (q - p).cross(r - p);
    let squared = normal.length_squared();
    let sides = [(p, q), (q, r), (r, p)].map(|(from, to)| (from, normal.cross(to - from)));
    // A triangle without area has no interior.
    let is_above = |x: DVec3| squared > 0.0 && sides.iter().all(|(from, inward)| inward.dot(x - *from) >= 0.0);
    let heights = other.map(|x| normal.dot(x - p));
    for k in 0..3 {
        if is_above(other[k]) {
            found(other[k], normal * (heights[k] / squared));
        }
    }
    (0..3).any(|k| {
        let (from, to) = (k, (k + 1) % 3);
        let crosses = (heights[from] < 0.0) != (heights[to] < 0.0);
        let fraction = heights[from] / (heights[from] - heights[to]);
        crosses && is_above(other[from] + (other[to] - other[from]) * fraction)
    })
}

/// The start of the shortest segment between two segments, and the vector from there to its end (Ericson, "Real-Time
/// Collision Detection", 5.1.9).
fn between_segments([p, p_end]: [DVec3; 2], [q, q_end]: [DVec3; 2]) -> [DVec3; 2] {
    let (u, v, w) = (p_end - p, q_end - q, p - q);
    let (uu, vv, uv) = (u.length_squared(), v.length_squared(), u.dot(v));
    let (uw, vw) = (u.dot(w), v.dot(w));
    let clamped_ratio = |numerator: f64, denominator: f64| {
        if denominator > 0.0 {
            (numerator / denominator).clamp(0.0, 1.0)
        } else {
            0.0
        }
    };
    // The nearest point of the lines, clamped to the first segment; the point of the second segment nearest to it; and
    // the point of the first segment nearest to that.
    let s = clamped_ratio(uv * vw - uw * vv, uu * vv - uv * uv);
    let t = clamped_ratio(uv * s + vw, vv);
    let s = clamped_ratio(uv * t - uw, uu);
    let from = p + u * s;
    [from, (q + v * t) - from]
}

/// Nearest point of a triangle to `p`, by Voronoi regions (Ericson, 5.1.5).
pub fn closest(p: DVec3, &[a, b, c]: &[DVec3; 3]) -> DVec3 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let (d3, d4) = (ab.dot(p - b), ac.dot(p - b));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let (d5, d6) = (ab.dot(p - c), ac.dot(p - c));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let (va, vb, vc) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        // Welded corners leave an edge of zero length.
        return a + ab * (d1 / (d1 - d3).max(f64::MIN_POSITIVE));
    }
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    a + (ab * vb + ac * vc) / (va + vb + vc)
}
