//! Polygons that are not convex, cut into triangles.
//!
//! A fan from the first corner suits convex polygons. On others it may fold over: some of its triangles are turned
//! against the polygon and cover what is outside. Then ears are cut off instead: triangles of three corners in a row
//! that have no other corner in them.

use glam::{DVec2, DVec3, Vec3};

/// How many corners the search for the ears of a file may look at in all, and how many more for each of its triangles.
/// The time for a polygon may grow with more than the square of its corners.
const WORK: u64 = 1 << 28;
const WORK_PER_TRIANGLE: u64 = 1 << 12;

/// How many corners the search for the ears of this many triangles may look at.
pub(super) fn work(triangles: usize) -> u64 {
    WORK + WORK_PER_TRIANGLE * triangles as u64
}

/// By how much a corner may be off the line between its neighbours before it counts, relative to the largest
/// coordinate: a little more than the rounding of positions in single precision.
const ROUNDING: f64 = 1.0 / (1 << 21) as f64;

/// Replaces the triangles of a fan by others of the same polygon if it folds over. Returns whether the triangles now
/// cover the polygon: they do not if it crosses itself, or if the work is used up. Corners that do not exist are left
/// to others.
pub(super) fn straighten(fan: &mut [[u32; 3]], vertices: &[Vec3], work: &mut u64) -> bool {
    let [a, b, _] = fan[0];
    let corners = || [a, b].into_iter().chain(fan.iter().map(|triangle| triangle[2]));
    let places: Option<Vec<DVec3>> = corners()
        .map(|corner| vertices.get(corner as usize).map(|p| p.as_dvec3()))
        .collect();
    let Some(places) = places else { return true };
    let Some(plane) = Plane::of_folded(&places) else {
        return true;
    };
    let corners: Vec<u32> = corners().collect();
    let Some(ears) = Ears::cut(places.iter().map(|&p| plane.project(p)).collect(), work) else {
        return false;
    };
    for (triangle, ear) in fan.iter_mut().zip(ears) {
        *triangle = ear.map(|corner| corners[corner as usize]);
    }
    true
}

/// The plane of a polygon.
struct Plane {
    origin: DVec3,
    axes: [DVec3; 2],
}

impl Plane {
    /// The plane across Newell's normal of a polygon, if a triangle of its fan is turned against that normal.
    fn of_folded(places: &[DVec3]) -> Option<Self> {
        let origin = places[0];
        let rays = || {
            places
                .windows(2)
                .skip(1)
                .map(|pair| [pair[0] - origin, pair[1] - origin])
        };
        let normal = rays().map(|[u, v]| u.cross(v)).sum::<DVec3>().try_normalize()?;
        let largest = places.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let folds = rays().any(|[u, v]| {
            let longest = u.length().max(v.length()).max((v - u).length());
            u.cross(v).dot(normal) < -ROUNDING * largest * longest
        });
        folds.then(|| {
            let (x, y) = normal.any_orthonormal_pair();
            // Counter-clockwise about the normal.
            Self { origin, axes: [x, y] }
        })
    }

    fn project(&self, place: DVec3) -> DVec2 {
        DVec2::from_array(self.axes.map(|axis| axis.dot(place - self.origin)))
    }
}

/// A polygon whose ears are being cut off.
struct Ears {
    places: Vec<DVec2>,
    /// The corners after and before each corner that is left.
    next: Vec<u32>,
    last: Vec<u32>,
    /// Whether a corner is left that does not bulge out. Only those can be in an ear.
    is_hollow: Vec<bool>,
}

impl Ears {
    /// The triangles of a polygon that runs counter-clockwise, two fewer than its corners. `None` if it crosses itself,
    /// or if the work is used up.
    fn cut(places: Vec<DVec2>, work: &mut u64) -> Option<Vec<[u32; 3]>> {
        let count = places.len() as u32;
        let mut polygon = Self {
            places,
            next: (0..count).map(|i| (i + 1) % count).collect(),
            last: (0..count).map(|i| (i + count - 1) % count).collect(),
            is_hollow: Vec::new(),
        };
        polygon.is_hollow = (0..count).map(|corner| polygon.turn(corner) <= 0.0).collect();
        let mut ears = Vec::with_capacity(count as usize - 2);
        let (mut at, mut left) = (0, count);
        // Corners in a row that were no ears. After a round without any, corners on a straight line are taken.
        let mut skipped = 0;
        while left > 3 {
            if *work == 0 {
                return None;
            }
            if polygon.is_ear(at, skipped >= left, work) {
                ears.push(polygon.around(at));
                polygon.remove(at);
                left -= 1;
                skipped = 0;
            } else {
                skipped += 1;
                if skipped > 2 * left {
                    return None;
                }
            }
            at = polygon.next[at as usize];
        }
        ears.push(polygon.around(at));
        Some(ears)
    }

    fn around(&self, corner: u32) -> [u32; 3] {
        [self.last[corner as usize], corner, self.next[corner as usize]]
    }

    /// Twice the area of the triangle at a corner; negative where the polygon is hollow.
    fn turn(&self, corner: u32) -> f64 {
        let [a, b, c] = self.around(corner).map(|i| self.places[i as usize]);
        (b - a).perp_dot(c - b)
    }

    fn is_ear(&self, corner: u32, even_flat: bool, work: &mut u64) -> bool {
        *work = work.saturating_sub(1);
        let turn = self.turn(corner);
        if turn < 0.0 || (turn == 0.0 && !even_flat) {
            return false;
        }
        let [a, b, c] = self.around(corner).map(|i| self.places[i as usize]);
        let mut other = self.next[self.next[corner as usize] as usize];
        let end = self.last[corner as usize];
        while other != end {
            *work = work.saturating_sub(1);
            let p = self.places[other as usize];
            // Where a polygon touches itself, as around a hole, corners are at the same place.
            if self.is_hollow[other as usize] && p != a && p != b && p != c {
                let sides = [(a, b), (b, c), (c, a)].map(|(from, to)| (to - from).perp_dot(p - from));
                if sides.iter().all(|&side| side >= 0.0) {
                    return false;
                }
            }
            other = self.next[other as usize];
        }
        true
    }

    fn remove(&mut self, corner: u32) {
        let [last, _, next] = self.around(corner);
        self.next[last as usize] = next;
        self.last[next as usize] = last;
        for neighbour in [last, next] {
            self.is_hollow[neighbour as usize] = self.turn(neighbour) <= 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Area of a polygon, and those of its triangles.
    fn areas(places: &[[f64; 2]]) -> (f64, Vec<f64>) {
        let places: Vec<DVec2> = places.iter().map(|&p| p.into()).collect();
        let area = |a: DVec2, b: DVec2, c: DVec2| (b - a).perp_dot(c - a) / 2.0;
        let whole = places.windows(2).map(|pair| area(places[0], pair[0], pair[1])).sum();
        let ears = Ears::cut(places.clone(), &mut work(places.len())).unwrap();
        assert_eq!(ears.len(), places.len() - 2);
        let areas = ears.iter().map(|ear| {
            let [a, b, c] = ear.map(|i| places[i as usize]);
            area(a, b, c)
        });
        (whole, areas.collect())
    }

    #[test]
    fn ears_cover_a_polygon_once_and_none_is_turned() {
        let comb: Vec<[f64; 2]> = (0..200)
            .map(|i| [f64::from(i), if i % 2 == 0 { 1.0 } else { 9.0 }])
            .rev()
            .chain([[0.0, 0.0], [199.0, 0.0]])
            .collect();
        let flat = vec![
            [0.0, 0.0],
            [1.0, 0.0],
            [2.0, 0.0],
            [2.0, 1.0],
            [1.0, 1.0],
            [1.0, 1.5],
            [1.0, 2.0],
            [0.0, 2.0],
            [0.0, 1.0],
        ];
        // A square with a square hole, joined by a bridge.
        let ring = vec![
            [0.0, 0.0],
            [3.0, 0.0],
            [3.0, 3.0],
            [0.0, 3.0],
            [0.0, 0.0],
            [1.0, 1.0],
            [1.0, 2.0],
            [2.0, 2.0],
            [2.0, 1.0],
            [1.0, 1.0],
        ];
        for polygon in [comb, flat, ring] {
            for first in 0..polygon.len() {
                let mut turned = polygon.clone();
                turned.rotate_left(first);
                let (whole, areas) = areas(&turned);
                assert!(areas.iter().all(|&area| area >= 0.0), "{areas:?}");
                assert!((areas.iter().sum::<f64>() - whole).abs() < 1e-9, "{areas:?}");
            }
        }
    }

    #[test]
    fn the_work_for_ears_is_bounded() {
        let spiral = (0..1000).map(|i| DVec2::from_angle(f64::from(i) * 2.4) * f64::from(i));
        let mut left = 10_000;
        assert!(Ears::cut(spiral.collect(), &mut left).is_none());
        assert_eq!(left, 0);
    }

    #[test]
    fn fans_of_convex_polygons_stay() {
        let ring: Vec<Vec3> = (0..40)
            .map(|i| (i as f32 * 0.157_079_63).sin_cos())
            .map(|(y, x)| Vec3::new(1e3 + x, -0.3 * x + 0.7 * y, 2.0 * y))
            .collect();
        let fan: Vec<[u32; 3]> = (1..39).map(|i| [0, i, i + 1]).collect();
        let mut same = fan.clone();
        assert!(straighten(&mut same, &ring, &mut work(38)));
        assert_eq!(same, fan);
    }
}
