//! The margin of a pair of triangles: how far it is from the opposite answer.
//!
//! Rounding in the product moves corners by about 1e-7 of the bodies' size. It may change an answer only where a shift
//! of that order changes the true answer; the margin is the length of the smallest such shift.

use super::tritri::{Triangle, meet};
use glam::DVec3;

/// The length of the smallest translation of one triangle that changes whether the two meet.
pub fn margin(a: &Triangle, b: &Triangle) -> f64 {
    // Relative to a corner, so that positions far from the origin cost no digits.
    let origin = a[0];
    let [near_a, near_b] = [a, b].map(|t| t.map(|p| p - origin));
    if meet(a, b) {
        depth(&near_a, &near_b)
    } else {
        distance(&near_a, &near_b)
    }
}

/// The distance of two disjoint triangles, which occurs between a corner and a face or between two edges.
pub fn distance(a: &Triangle, b: &Triangle) -> f64 {
    let corners_a = a.iter().map(|&p| point_to_triangle(p, b));
    let corners_b = b.iter().map(|&p| point_to_triangle(p, a));
    let edges = edges(a).into_iter().flat_map(|e| edges(b).map(|f| edge_to_edge(e, f)));
    corners_a.chain(corners_b).chain(edges).fold(f64::INFINITY, f64::min)
}

/// The length of the smallest translation that separates two triangles that meet.
///
/// The translations under which they still meet form the convex set a - b. The origin's distance to its boundary is the
/// least overlap along the normals of its possible faces: those of the triangles and the cross products of their edges.
pub fn depth(a: &Triangle, b: &Triangle) -> f64 {
    let directions = |t: &Triangle| edges(t).map(|[p, q]| q - p);
    let [of_a, of_b] = [directions(a), directions(b)];
    let mut normals = vec![of_a[0].cross(of_a[1]), of_b[0].cross(of_b[1])];
    normals.extend(of_a.iter().flat_map(|e| of_b.iter().map(|f| e.cross(*f))));
    normals
        .into_iter()
        .filter_map(|n| n.try_normalize())
        .map(|n| {
            let [low_a, high_a] = extent(a, n);
            let [low_b, high_b] = extent(b, n);
            (high_a - low_b).min(high_b - low_a).max(0.0)
        })
        .fold(f64::INFINITY, f64::min)
}

fn edges(t: &Triangle) -> [[DVec3; 2]; 3] {
    [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]]
}

fn extent(t: &Triangle, n: DVec3) -> [f64; 2] {
    let along = t.map(|p| p.dot(n));
    [
        along.into_iter().fold(f64::INFINITY, f64::min),
        along.into_iter().fold(f64::NEG_INFINITY, f64::max),
    ]
}

/// The distance of `p` from the closed triangle: from its plane where the projection is inside, else from the nearest
/// edge.
pub fn point_to_triangle(p: DVec3, t: &Triangle) -> f64 {
    let n = (t[1] - t[0]).cross(t[2] - t[0]).normalize();
    let foot_inside = edges(t).iter().all(|[u, v]| n.cross(*v - *u).dot(p - *u) >= 0.0);
    if foot_inside {
        return (p - t[0]).dot(n).abs();
    }
    edges(t)
        .into_iter()
        .map(|e| point_to_edge(p, e))
        .fold(f64::INFINITY, f64::min)
}

fn point_to_edge(p: DVec3, [u, v]: [DVec3; 2]) -> f64 {
    let along = ((p - u).dot(v - u) / (v - u).length_squared()).clamp(0.0, 1.0);
    p.distance(u + (v - u) * along)
}

/// The distance of two segments: between the lines where the closest points are inside both, else from an end.
fn edge_to_edge([p, q]: [DVec3; 2], [u, v]: [DVec3; 2]) -> f64 {
    let ends = [
        point_to_edge(p, [u, v]),
        point_to_edge(q, [u, v]),
        point_to_edge(u, [p, q]),
        point_to_edge(v, [p, q]),
    ];
    let nearest_end = ends.into_iter().fold(f64::INFINITY, f64::min);
    let [e, f, w] = [q - p, v - u, p - u];
    let (ee, ef, ff) = (e.length_squared(), e.dot(f), f.length_squared());
    let determinant = ee * ff - ef * ef;
    if determinant <= 0.0 {
        return nearest_end;
    }
    let s = (ef * f.dot(w) - ff * e.dot(w)) / determinant;
    let t = (ee * f.dot(w) - ef * e.dot(w)) / determinant;
    if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
        nearest_end.min((w + e * s - f * t).length())
    } else {
        nearest_end
    }
}
