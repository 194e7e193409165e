//! Welding: vertices within a tolerance of each other count as one.

use crate::geometry::Aabb;
use glam::{DVec3, Vec3};
use std::collections::HashMap;

/// The end of a list.
const NONE: u32 = u32::MAX;
/// Cell width as a multiple of the search distance. With wide cells few points are near a side of their cell, so few
/// searches visit neighbouring cells.
const CELL: f64 = 4.0;
/// Minimum cell width relative to the diagonal of the bounding box.
const MIN_CELL: f64 = 1.0e-12;

/// The diagonal of a mesh's bounding box. Tolerances are relative to it.
pub fn size(aabb: Aabb) -> f64 {
    (aabb.max.as_dvec3() - aabb.min.as_dvec3()).length()
}

/// For each vertex, the index of its representative. The weld distance is `tolerance` times the diagonal of `aabb`.
///
/// Positions are visited in lexicographic order. Each is welded to the nearest representative within the weld distance,
/// or becomes a representative itself. So no vertex is farther than the weld distance from its representative, even in
/// a long chain of vertices, and the result does not depend on the order of the vertices. With a tolerance of 0 only
/// equal positions are welded (`-0.0` equals `0.0`).
pub fn weld(vertices: &[Vec3], aabb: Aabb, tolerance: f32) -> Vec<u32> {
    let distance = f64::from(tolerance) * size(aabb);
    let mut sorted: Vec<([i32; 3], u32)> = vertices.iter().map(|v| v.to_array().map(rank)).zip(0..).collect();
    sorted.sort_unstable();
    let mut welded = vec![0; vertices.len()];
    let mut keepers = Grid::new(aabb, CELL * distance);
    for run in sorted.chunk_by(|a, b| a.0 == b.0) {
        let own = run[0].1;
        let mut keeper = own;
        if distance > 0.0 {
            let at = vertices[own as usize].as_dvec3();
            let mut nearest = f64::INFINITY;
            keepers.visit(at, distance, |other, apart| {
                if apart < nearest {
                    (nearest, keeper) = (apart, other);
                }
            });
            if keeper == own {
                keepers.add(at, own);
            }
        }
        for &(_, vertex) in run {
            welded[vertex as usize] = keeper;
        }
    }
    welded
}

/// An integer with the same order as the coordinate. Adding zero turns -0 into 0.
fn rank(x: f32) -> i32 {
    let bits = (x + 0.0).to_bits() as i32;
    bits ^ ((bits >> 31) & i32::MAX)
}

/// The smallest distance between two points that are not `linked`; `None` if there is no such pair. `aabb` must contain
/// all points.
pub fn least_distance(points: &[DVec3], aabb: Aabb, linked: impl Fn(usize, usize) -> bool) -> Option<f64> {
    let mut least = f64::INFINITY;
    let mut grid = Grid::new(aabb, size(aabb));
    // In scattered order the running minimum soon approaches the final one, so the grid is rebuilt only a few times.
    let order: Vec<usize> = scattered(points.len()).collect();
    for (done, &i) in order.iter().enumerate() {
        let before = least;
        grid.visit(points[i], least.min(grid.cell), |j, apart| {
            if apart < least && !linked(i, j as usize) {
                least = apart;
            }
        });
        if least < before && 2.0 * CELL * least < grid.cell {
            grid = Grid::new(aabb, CELL * least);
            for &i in &order[..done] {
                grid.add(points[i], i as u32);
            }
        }
        grid.add(points[i], i as u32);
    }
    least.is_finite().then_some(least)
}

/// A permutation of the numbers below `count` in which consecutive numbers are far apart: multiples, modulo `count`, of
/// a number that is coprime to `count` and near `count` over the golden ratio.
pub fn scattered(count: usize) -> impl Iterator<Item = usize> {
    let common = |mut a: usize, mut b: usize| {
        while b > 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    let golden = (count as f64 * 0.618_033_988_749_894_9) as usize;
    let step = (golden.max(1)..).find(|&step| common(step, count) == 1).unwrap_or(1);
    (0..count).map(move |i| (i as u128 * step as u128 % count as u128) as usize)
}

/// A hash grid of points, for neighbour searches.
struct Grid {
    origin: DVec3,
    cell: f64,
    /// For each cell, its first point as an index into `points`.
    first: HashMap<[i64; 3], u32>,
    /// Linked lists: position, number, and the next point of the same cell.
    points: Vec<(DVec3, u32, u32)>,
}

impl Grid {
    fn new(aabb: Aabb, cell: f64) -> Self {
        Self {
            origin: aabb.min.as_dvec3(),
            cell: cell.max(MIN_CELL * size(aabb)).max(f64::MIN_POSITIVE),
            first: HashMap::new(),
            points: Vec::new(),
        }
    }

    fn cell_of(&self, at: DVec3) -> [i64; 3] {
        ((at - self.origin) / self.cell).floor().to_array().map(|x| x as i64)
    }

    fn add(&mut self, at: DVec3, number: u32) {
        let index = self.points.len() as u32;
        let next = self.first.insert(self.cell_of(at), index).unwrap_or(NONE);
        self.points.push((at, number, next));
    }

    /// Calls `found` with the number and distance of each point within the distance `within` of `at`.
    fn visit(&self, at: DVec3, within: f64, mut found: impl FnMut(u32, f64)) {
        let (low, high) = (self.cell_of(at - within), self.cell_of(at + within));
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let mut index = self.first.get(&[x, y, z]).copied().unwrap_or(NONE);
                    while index != NONE {
                        let (place, number, next) = self.points[index as usize];
                        let apart = place.distance(at);
                        if apart <= within {
                            found(number, apart);
                        }
                        index = next;
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn aabb(points: &[Vec3]) -> Aabb {
        Aabb::around(points.iter().copied())
    }

    #[test]
    fn a_chain_of_vertices_is_not_welded_into_one() {
        // The spacing is 0.8 of the weld distance.
        let chain: Vec<Vec3> = (0..1000).map(|i| Vec3::X * i as f32).collect();
        let tolerance = 1.25 / 999.0;
        let welded = weld(&chain, aabb(&chain), tolerance);
        for (at, &keeper) in chain.iter().zip(&welded) {
            assert!(at.distance(chain[keeper as usize]) <= 1.25);
            assert_eq!(
                welded[keeper as usize], keeper,
                "a representative is its own representative"
            );
        }
        // The representatives do not depend on the order of the vertices.
        let order: Vec<usize> = scattered(1000).collect();
        let mixed: Vec<Vec3> = order.iter().map(|&i| chain[i]).collect();
        let again = weld(&mixed, aabb(&mixed), tolerance);
        for (i, &keeper) in order.iter().zip(&again) {
            assert_eq!(order[keeper as usize], welded[*i] as usize);
        }
    }

    #[test]
    fn without_a_tolerance_only_equal_positions_are_welded() {
        let near = Vec3::splat(1.0f32.next_up());
        let points = [
            Vec3::ONE,
            near,
            Vec3::ONE,
            Vec3::ZERO,
            -Vec3::ZERO,
            Vec3::NEG_ONE,
            Vec3::splat(-1e-38),
        ];
        assert_eq!(weld(&points, aabb(&points), 0.0), [0, 1, 0, 3, 3, 5, 6]);
        assert_eq!(weld(&points, aabb(&points), 1e-6)[..5], [0, 0, 0, 6, 6]);
    }

    #[test]
    fn the_least_distance_is_that_of_brute_force() {
        let mut seed = 7u32;
        let mut number = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) as f32 / (1 << 24) as f32
        };
        for count in [0, 1, 2, 3, 50, 300] {
            let points: Vec<Vec3> = (0..count).map(|_| Vec3::new(number(), number(), 0.0)).collect();
            let places: Vec<DVec3> = points.iter().map(|p| p.as_dvec3()).collect();
            // Consecutive points are linked.
            let linked = |i: usize, j: usize| i.abs_diff(j) <= 1;
            let pairs = (0..count).flat_map(|i| (0..i).map(move |j| (i, j)));
            let brute = pairs
                .filter(|&(i, j)| !linked(i, j))
                .map(|(i, j)| places[i].distance(places[j]))
                .min_by(f64::total_cmp);
            assert_eq!(least_distance(&places, aabb(&points), linked), brute, "{count}");
        }
    }
}
