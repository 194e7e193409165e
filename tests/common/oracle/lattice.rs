//! Triangles with integer coordinates, where degenerate cases are common and a second, unrelated test is exact:
//! separating axes in 128-bit integers.

use super::tritri::Triangle;
use glam::DVec3;

/// A point of the lattice.
pub type Point = [i128; 3];

/// All triangles of non-zero area with corners in `0..n` cubed, each once.
pub fn all_triangles(n: i128) -> Vec<[Point; 3]> {
    let points: Vec<Point> = (0..n * n * n).map(|i| [i % n, i / n % n, i / n / n]).collect();
    let mut triangles = vec![];
    for (i, &a) in points.iter().enumerate() {
        for (j, &b) in points.iter().enumerate().skip(i + 1) {
            for &c in &points[j + 1..] {
                if !on_a_line(&[a, b, c]) {
                    triangles.push([a, b, c]);
                }
            }
        }
    }
    triangles
}

/// The corners as `f64`; exact up to 2^53.
pub fn real(t: &[Point; 3]) -> Triangle {
    t.map(|p| DVec3::from_array(p.map(|c| c as f64)))
}

/// Whether the triangle has no area.
pub fn on_a_line(&[a, b, c]: &[Point; 3]) -> bool {
    cross(sub(b, a), sub(c, a)) == [0; 3]
}

/// Whether the closed triangles share a point.
///
/// Convex sets are disjoint if and only if their projections on some axis are. For polygons the normals of the faces of
/// the Minkowski difference suffice as axes: both normals and the cross products of edges. If the triangles are
/// parallel, that body is flat, and the normals of its boundary are needed instead: edges rotated in the plane.
pub fn meet(a: &[Point; 3], b: &[Point; 3]) -> bool {
    let edges = |&[a, b, c]: &[Point; 3]| [sub(b, a), sub(c, b), sub(a, c)];
    let normal = |&[a, b, c]: &[Point; 3]| cross(sub(b, a), sub(c, a));
    let in_plane = |t: &[Point; 3]| edges(t).map(|e| cross(normal(t), e));
    let mut axes = vec![normal(a), normal(b)];
    axes.extend(edges(a).iter().flat_map(|&e| edges(b).map(|f| cross(e, f))));
    axes.extend(in_plane(a));
    axes.extend(in_plane(b));
    axes.iter().all(|&axis| {
        let shadow = |t: &[Point; 3]| t.map(|p| p.iter().zip(axis).map(|(x, y)| x * y).sum::<i128>());
        let [of_a, of_b] = [shadow(a), shadow(b)];
        of_a.iter().min() <= of_b.iter().max() && of_b.iter().min() <= of_a.iter().max()
    })
}

fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: Point, b: Point) -> Point {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}
