//! Distances in closed form, by other formulas than the product's.

use glam::DVec3;

/// The point of a segment nearest to `p`.
fn on_segment(p: DVec3, [a, b]: [DVec3; 2]) -> DVec3 {
    let way = b - a;
    let square = way.dot(way);
    if square == 0.0 {
        return a;
    }
    a + way * ((p - a).dot(way) / square).clamp(0.0, 1.0)
}

/// The way from a point to a triangle.
fn to_triangle(p: DVec3, corners: [DVec3; 3]) -> DVec3 {
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a).normalize();
    let foot = p - normal * normal.dot(p - a);
    let is_left = |u: DVec3, v: DVec3| (v - u).cross(foot - u).dot(normal) >= 0.0;
    if is_left(a, b) && is_left(b, c) && is_left(c, a) {
        return foot - p;
    }
    shortest([[a, b], [b, c], [c, a]].map(|edge| on_segment(p, edge) - p))
}

fn shortest<const N: usize>(ways: [DVec3; N]) -> DVec3 {
    let least = |p: DVec3, q: DVec3| if q.length() < p.length() { q } else { p };
    ways.into_iter().fold(DVec3::splat(1.0e30), least)
}

/// The way from one segment to another, by solving for both parameters and then trying the ends.
pub fn between_segments(one: [DVec3; 2], other: [DVec3; 2]) -> DVec3 {
    let ends = shortest([
        on_segment(one[0], other) - one[0],
        on_segment(one[1], other) - one[1],
        other[0] - on_segment(other[0], one),
        other[1] - on_segment(other[1], one),
    ]);
    let (u, v, w) = (one[1] - one[0], other[1] - other[0], other[0] - one[0]);
    let normal = u.cross(v);
    let square = normal.length_squared();
    if square < 1.0e-18 {
        return ends;
    }
    let s = w.cross(v).dot(normal) / square;
    let t = w.cross(u).dot(normal) / square;
    let within = (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t);
    if within { (w + v * t) - u * s } else { ends }
}

/// The way from a segment to a triangle; zero where it pierces it.
pub fn segment_to_triangle(segment: [DVec3; 2], corners: [DVec3; 3]) -> DVec3 {
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a);
    let heights = segment.map(|p| normal.dot(p - a));
    if heights[0] * heights[1] < 0.0 {
        let at = segment[0] + (segment[1] - segment[0]) * (heights[0] / (heights[0] - heights[1]));
        if to_triangle(at, corners).length() < 1.0e-12 {
            return DVec3::ZERO;
        }
    }
    let edges = [[a, b], [b, c], [c, a]].map(|edge| between_segments(segment, edge));
    let ends = segment.map(|end| to_triangle(end, corners));
    shortest([edges[0], edges[1], edges[2], ends[0], ends[1]])
}

/// The way from a triangle to another that it does not cross.
pub fn between_triangles(one: [DVec3; 3], other: [DVec3; 3]) -> DVec3 {
    let edges = |[a, b, c]: [DVec3; 3]| [[a, b], [b, c], [c, a]];
    let own = shortest(edges(one).map(|edge| segment_to_triangle(edge, other)));
    let others = shortest(edges(other).map(|edge| -segment_to_triangle(edge, one)));
    shortest([own, others])
}
