//! Triangles that close a hole: the triangulation of its boundary with the smallest area, after Barequet & Sharir 1995.
//!
//! It needs no plane, so it closes holes of curved surfaces, and it uses every vertex of the boundary, so that nothing
//! is left open. For a boundary in a plane it is the polygon inside. Time grows with the third power of the number of
//! edges.

use crate::geometry::mesh::is_degenerate;
use glam::Vec3;

/// If triangulations have the same area, as those of a polygon in a plane do, the one with shorter edges is better:
/// this fraction of the squares of the edges' lengths counts as area.
const EDGE_COST: f64 = 1.0e-6;

/// Triangulates a hole with the given boundary, and returns triangles as numbers of its vertices. `None` if there is no
/// triangulation in which each triangle has an area and is allowed. `chord(i, j)` tells whether the vertices of numbers
/// `i < j`, which are no neighbours, may be joined; `triangle` whether a triangle may be used.
pub(super) fn fill(
    boundary: &[Vec3],
    chord: impl Fn(usize, usize) -> bool,
    triangle: impl Fn([usize; 3]) -> bool,
) -> Option<Vec<[usize; 3]>> {
    let count = boundary.len();
    if count < 3 {
        return None;
    }
    // For each `i < j`, the cost of the part from `i` to `j`, and the corner of the triangle at its chord.
    let mut costs = vec![0.0f64; count * count];
    let mut tips = vec![0u32; count * count];
    for length in 2..count {
        for i in 0..count - length {
            let j = i + length;
            let mut best = (f64::INFINITY, 0);
            if length == count - 1 || chord(i, j) {
                for k in i + 1..j {
                    let parts = costs[i * count + k] + costs[k * count + j];
                    // Costs are positive, so most corners are ruled out before their triangle is looked at.
                    if parts < best.0 {
                        let cost = parts + cost([i, k, j].map(|v| boundary[v]));
                        if cost < best.0 && triangle([i, k, j]) {
                            best = (cost, k as u32);
                        }
                    }
                }
            }
            (costs[i * count + j], tips[i * count + j]) = best;
        }
    }
    if costs[count - 1].is_infinite() {
        return None;
    }
    let mut triangles = Vec::with_capacity(count - 2);
    let mut parts = vec![(0, count - 1)];
    while let Some((i, j)) = parts.pop() {
        if j - i >= 2 {
            let k = tips[i * count + j] as usize;
            triangles.push([i, k, j]);
            parts.extend([(i, k), (k, j)]);
        }
    }
    Some(triangles)
}

/// What a triangle costs; infinite if it has no area.
pub(super) fn cost(corners: [Vec3; 3]) -> f64 {
    if is_degenerate(corners) {
        return f64::INFINITY;
    }
    let [a, b, c] = corners.map(|p| p.as_dvec3());
    let [u, v, w] = [b - a, c - b, a - c];
    let edges = u.length_squared() + v.length_squared() + w.length_squared();
    u.cross(v).length() * 0.5 + EDGE_COST * edges
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn area(boundary: &[Vec3], triangles: &[[usize; 3]]) -> (f64, DVec3) {
        let crosses = triangles.iter().map(|t| {
            let [a, b, c] = t.map(|v| boundary[v].as_dvec3());
            (b - a).cross(c - a) * 0.5
        });
        crosses.fold((0.0, DVec3::ZERO), |(sum, whole), cross| {
            (sum + cross.length(), whole + cross)
        })
    }

    #[test]
    fn a_polygon_in_a_plane_is_covered_once() {
        // A star with many points on straight lines between its tips.
        let mut star = Vec::new();
        for k in 0..10 {
            let corner = |k: usize| {
                let angle = std::f32::consts::TAU * k as f32 / 10.0;
                Vec3::new(angle.cos(), angle.sin(), 0.0) * if k.is_multiple_of(2) { 1.0 } else { 0.3 }
            };
            star.extend((0..4).map(|step| corner(k).lerp(corner(k + 1), step as f32 / 4.0)));
        }
        let triangles = fill(&star, |_, _| true, |_| true).unwrap();
        assert_eq!(triangles.len(), star.len() - 2);
        let (sum, whole) = area(&star, &triangles);
        let true_area = 10.0 * 0.5 * 0.3 * (std::f64::consts::TAU / 10.0).sin();
        assert!((sum - true_area).abs() < 1e-5, "{sum} is not {true_area}");
        assert!(
            (whole.z - true_area).abs() < 1e-5,
            "the triangles are wound as the boundary"
        );
    }

    #[test]
    fn a_forbidden_chord_is_avoided_and_collinear_points_have_no_triangulation() {
        let square = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];
        let [a, b] = [(0, 2), (1, 3)].map(|chord| {
            let triangles = fill(&square, |i, j| (i, j) != chord, |_| true).unwrap();
            triangles.into_iter().flatten().filter(|&v| v == chord.0).count()
        });
        assert_eq!((a, b), (1, 1), "the other diagonal");
        assert_eq!(fill(&square, |_, _| false, |_| true), None);
        assert_eq!(fill(&square, |_, _| true, |t| t != [0, 1, 3] && t != [0, 2, 3]), None);
        assert_eq!(fill(&[Vec3::ZERO, Vec3::X, Vec3::X * 2.0], |_, _| true, |_| true), None);
    }
}
