//! Intersection of two triangles as closed sets: triangles that only touch at a point, along an edge or face to face
//! intersect.
//!
//! Each sign is computed with a bound on its error, which covers rounding and the given error of the corner positions.
//! A value within its error bound counts as zero. Touching triangles are therefore never missed.
//!
//! Signs alone would report too many touches. An edge that almost lies in the other triangle's plane meets that plane
//! at no certain place, and so seems to meet the triangle however far beside it passes. A touch by signs must therefore
//! also be one by distance: the triangles are disjoint if they are clearly apart along some direction. Triangles that
//! touch only by rounding are then apart by no more than four times the error of a coordinate, and some 1e-14 of their
//! own extent.

use super::distance::nearest;
use glam::{DVec2, DVec3};

/// The intersection of two closed triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intersection {
    /// One end of the common segment; equal to `end` if the triangles meet at a point.
    pub start: DVec3,
    /// The other end.
    pub end: DVec3,
    /// Whether the triangles are coplanar. Their intersection is then a polygon in general, and `start..end` is its
    /// longest diagonal.
    pub coplanar: bool,
}

/// The intersection of triangles `a` and `b`; `None` if they are disjoint.
///
/// The decision is symmetric in its arguments and in the order of corners. For triangles of zero area the answer is
/// conservative: it may report a touch where there is none.
pub fn intersect(a: &[DVec3; 3], b: &[DVec3; 3]) -> Option<Intersection> {
    intersect_placed(a, b, 0.0)
}

/// [`intersect`] for computed corners with an error of up to `placing` per coordinate: triangles that may touch within
/// that error count as touching.
pub(crate) fn intersect_placed(a: &[DVec3; 3], b: &[DVec3; 3], placing: f64) -> Option<Intersection> {
    let plane_a = Plane::of(a, placing);
    let heights_b = b.map(|p| plane_a.height(p));
    if one_side(&heights_b) {
        return None;
    }
    let plane_b = Plane::of(b, placing);
    let heights_a = a.map(|p| plane_b.height(p));
    if one_side(&heights_a) {
        return None;
    }
    if let (Some(chord_a), Some(chord_b)) = (chord(a, &heights_a), chord(b, &heights_b))
        && let Some(answer) = overlap(plane_a.normal.cross(plane_b.normal), chord_a, chord_b, placing)
    {
        return answer;
    }
    let flat = |h: &[Height; 3]| h.iter().all(|h| h.sign() == 0);
    let found = if flat(&heights_b) {
        coplanar(a, b, plane_a.normal, placing)
    } else if flat(&heights_a) {
        coplanar(a, b, plane_b.normal, placing)
    } else {
        by_edges(a, b, &heights_a, &heights_b, placing)
    };
    found.filter(|_| !clearly_apart(a, b, placing))
}

/// Whether the triangles are apart along some direction by more than the rounding error. Directions need not be exact:
/// triangles that are apart along any direction do not touch.
///
/// Disjoint triangles are apart along one of their normals, along a direction within a plane that is perpendicular to
/// an edge, or along one that is perpendicular to an edge of each (Gottschalk 1996). Between two corners the gap along
/// these may be a small part of the distance; so the direction of the distance itself is tried too.
fn clearly_apart(a: &[DVec3; 3], b: &[DVec3; 3], placing: f64) -> bool {
    let (of_a, of_b) = (a.map(|p| p - a[0]), b.map(|p| p - a[0]));
    let extent = of_a.iter().chain(&of_b).map(|p| norm1(*p)).fold(0.0, f64::max);
    let error = 4.0 * placing + ROUNDING * extent;
    let is_apart_along = |axis: DVec3| {
        let [heights_a, heights_b] = [&of_a, &of_b].map(|t| t.map(|p| p.dot(axis)));
        let lowest = |h: [f64; 3]| h[0].min(h[1]).min(h[2]);
        let highest = |h: [f64; 3]| h[0].max(h[1]).max(h[2]);
        let gap = (lowest(heights_b) - highest(heights_a)).max(lowest(heights_a) - highest(heights_b));
        gap > norm1(axis) * error
    };
    let edges = |t: &[DVec3; 3]| [t[1] - t[0], t[2] - t[1], t[0] - t[2]];
    let (edges_a, edges_b) = (edges(a), edges(b));
    let normals = [edges_a[0].cross(edges_a[1]), edges_b[0].cross(edges_b[1])];
    let within = |normal: DVec3, edges: [DVec3; 3]| edges.iter().any(|edge| is_apart_along(normal.cross(*edge)));
    is_apart_along(nearest(a, b).direction)
        || within(normals[0], edges_a)
        || within(normals[1], edges_b)
        || edges_a
            .iter()
            .any(|edge| edges_b.iter().any(|other| is_apart_along(edge.cross(*other))))
        || normals.iter().any(|normal| is_apart_along(*normal))
}

/// Rounding error of a 3 x 3 determinant relative to the product of the 1-norms of its rows: each difference, product
/// and sum adds half a unit in the last place (Shewchuk 1997 gives `(7 + 56 e) e`).
const ROUNDING: f64 = 16.0 * f64::EPSILON;

fn norm1(v: DVec3) -> f64 {
    v.x.abs() + v.y.abs() + v.z.abs()
}

struct Plane {
    origin: DVec3,
    normal: DVec3,
    /// Error bound of the dot product of the normal and a vector, relative to the 1-norm of the vector.
    error: f64,
    /// Error bound of a height that is due to the error of the point itself.
    placing: f64,
}

/// A height over a plane, times the length of the plane's normal, with its error bound.
#[derive(Clone, Copy)]
struct Height {
    value: f64,
    error: f64,
}

impl Height {
    fn sign(self) -> i8 {
        (self.value > self.error) as i8 - (self.value < -self.error) as i8
    }
}

impl Plane {
    fn of(t: &[DVec3; 3], placing: f64) -> Self {
        let (u, v) = (t[1] - t[0], t[2] - t[0]);
        let (normal, nu, nv) = (u.cross(v), norm1(u), norm1(v));
        // The error of a difference of two corners is twice that of a corner.
        Self {
            origin: t[0],
            normal,
            error: ROUNDING * nu * nv + 2.0 * placing * (nu + nv + 2.0 * placing),
            placing: 2.0 * placing * norm1(normal),
        }
    }

    fn height(&self, p: DVec3) -> Height {
        let d = p - self.origin;
        Height {
            value: self.normal.dot(d),
            error: self.error * norm1(d) + self.placing,
        }
    }
}

fn one_side(h: &[Height; 3]) -> bool {
    let s = h.map(Height::sign);
    s == [1; 3] || s == [-1; 3]
}

/// The segment in which a triangle crosses the other's plane, with the error bound of its two ends.
struct Chord {
    points: [DVec3; 2],
    error: f64,
}

/// `None` unless each corner is clearly on one side of the plane.
#[inline]
fn chord(t: &[DVec3; 3], h: &[Height; 3]) -> Option<Chord> {
    if h.iter().any(|h| h.sign() == 0) {
        return None;
    }
    let [p, q, r] = h.map(|h| h.value > 0.0);
    let alone = if p == q {
        2
    } else if p == r {
        1
    } else {
        0
    };
    let cross = |k: usize| {
        let (edge, across) = (t[k] - t[alone], h[alone].value - h[k].value);
        let point = t[alone] + edge * (h[alone].value / across);
        let error = norm1(edge) * ((h[alone].error + h[k].error) / across).abs();
        (point, error)
    };
    let ((x, error_x), (y, error_y)) = (cross((alone + 1) % 3), cross((alone + 2) % 3));
    Some(Chord {
        points: [x, y],
        error: error_x.max(error_y),
    })
}

/// Whether two chords on the common line of both planes overlap (Moeller 1997); `None` if the gap is within its error
/// bound.
#[inline]
fn overlap(line: DVec3, a: Chord, b: Chord, placing: f64) -> Option<Option<Intersection>> {
    let origin = a.points[0];
    let sorted = |[p, q]: [DVec3; 2]| {
        let (s, t) = (line.dot(p - origin), line.dot(q - origin));
        if s <= t { [(s, p), (t, q)] } else { [(t, q), (s, p)] }
    };
    let ([a0, a1], [b0, b1]) = (sorted(a.points), sorted(b.points));
    let gap = (b0.0 - a1.0).max(a0.0 - b1.0);
    // The rounding error of positions along the line is relative to the extent of the points.
    let extent = norm1(a.points[1] - origin) + norm1(b.points[0] - origin) + norm1(b.points[1] - origin);
    let error = norm1(line) * (a.error + b.error + 4.0 * placing + ROUNDING * extent);
    if gap.is_nan() || gap.abs() <= error {
        return None;
    }
    if gap > 0.0 {
        return Some(None);
    }
    let start = if a0.0 >= b0.0 { a0 } else { b0 };
    let end = if a1.0 <= b1.0 { a1 } else { b1 };
    Some(Some(Intersection {
        start: start.1,
        end: end.1,
        coplanar: false,
    }))
}

/// The decision by signs alone, for triangles in different planes: they intersect exactly if an edge of one intersects
/// the other.
fn by_edges(a: &[DVec3; 3], b: &[DVec3; 3], ha: &[Height; 3], hb: &[Height; 3], placing: f64) -> Option<Intersection> {
    let mut found = FarthestPair::default();
    for (edges_of, h, other) in [(a, ha, b), (b, hb, a)] {
        for i in 0..3 {
            let j = (i + 1) % 3;
            let (si, sj) = (h[i].sign(), h[j].sign());
            // An edge within the other's plane can be skipped: the neighbouring edges cover its ends.
            if si == sj || !line_meets(edges_of[i], edges_of[j], other, placing) {
                continue;
            }
            found.add(match (si, sj) {
                (0, _) => edges_of[i],
                (_, 0) => edges_of[j],
                _ => edges_of[i].lerp(edges_of[j], h[i].value / (h[i].value - h[j].value)),
            });
        }
    }
    found.intersection(false)
}

/// Whether the line through `p` and `q` passes through the closed triangle `t`.
fn line_meets(p: DVec3, q: DVec3, t: &[DVec3; 3], placing: f64) -> bool {
    let d = q - p;
    let c = t.map(|v| v - p);
    let (mut left, mut right) = (false, false);
    for i in 0..3 {
        let (u, v) = (c[i], c[(i + 1) % 3]);
        let det = d.dot(u.cross(v));
        let (nd, nu, nv) = (norm1(d), norm1(u), norm1(v));
        let error = ROUNDING * nd * nu * nv + 2.0 * placing * (nd * nu + nu * nv + nv * nd);
        left |= det > error;
        right |= det < -error;
    }
    !(left && right)
}

/// Coplanar triangles intersect if two edges cross or a corner is inside the other triangle.
fn coplanar(a: &[DVec3; 3], b: &[DVec3; 3], normal: DVec3, placing: f64) -> Option<Intersection> {
    let n = normal.abs();
    let flat = |p: DVec3| {
        if n.x >= n.y && n.x >= n.z {
            DVec2::new(p.y, p.z)
        } else if n.y >= n.z {
            DVec2::new(p.z, p.x)
        } else {
            DVec2::new(p.x, p.y)
        }
    };
    let (fa, fb) = (a.map(flat), b.map(flat));
    let mut found = FarthestPair::default();
    for (points, flat_points, triangle) in [(a, &fa, &fb), (b, &fb, &fa)] {
        for i in 0..3 {
            if contains(triangle, flat_points[i], placing) {
                found.add(points[i]);
            }
        }
    }
    for i in 0..3 {
        for j in 0..3 {
            let (i2, j2) = ((i + 1) % 3, (j + 1) % 3);
            if let Some(t) = segments_cross([fa[i], fa[i2]], [fb[j], fb[j2]], placing) {
                found.add(a[i].lerp(a[i2], t));
            }
        }
    }
    found.intersection(true)
}

/// Which side of the line `p q` the point `r` lies on; 0 within rounding.
fn side(p: DVec2, q: DVec2, r: DVec2, placing: f64) -> (i8, f64) {
    let (u, v) = (q - p, r - p);
    let (left, right) = (u.x * v.y, u.y * v.x);
    let det = left - right;
    let spread = u.abs().element_sum() + v.abs().element_sum();
    let error = ROUNDING * (left.abs() + right.abs()) + 2.0 * placing * (spread + 2.0 * placing);
    ((det > error) as i8 - (det < -error) as i8, det)
}

/// Whether the closed triangle contains the point. A triangle of zero area contains nothing here; the edge tests find
/// its points.
fn contains(t: &[DVec2; 3], p: DVec2, placing: f64) -> bool {
    let s = [0, 1, 2].map(|i| side(t[i], t[(i + 1) % 3], p, placing).0);
    s != [0; 3] && !(s.contains(&1) && s.contains(&-1))
}

/// The parameter along `p q` at which it meets `r s`; both segments are closed. Collinear segments meet at the first
/// common point along `p q`.
fn segments_cross([p, q]: [DVec2; 2], [r, s]: [DVec2; 2], placing: f64) -> Option<f64> {
    let ((sr, _), (ss, _)) = (side(p, q, r, placing), side(p, q, s, placing));
    let ((sp, hp), (sq, hq)) = (side(r, s, p, placing), side(r, s, q, placing));
    if sr * ss > 0 || sp * sq > 0 {
        return None;
    }
    if sp != sq {
        return Some(match (sp, sq) {
            (0, _) => 0.0,
            (_, 0) => 1.0,
            _ => hp / (hp - hq),
        });
    }
    // Both ends of p q lie on the line of r s: compare along it.
    let d = q - p;
    let length = d.length_squared();
    if length == 0.0 {
        let (lo, hi) = (r.min(s) - 2.0 * placing, r.max(s) + 2.0 * placing);
        return (p.cmpge(lo).all() && p.cmple(hi).all()).then_some(0.0);
    }
    let (t0, t1) = (d.dot(r - p) / length, d.dot(s - p) / length);
    let (lo, hi) = (t0.min(t1).max(0.0), t0.max(t1).min(1.0));
    let error = 4.0 * placing / length.sqrt();
    (lo <= hi + error).then_some(lo.min(1.0))
}

/// Keeps the two of the added points that are farthest apart.
#[derive(Default)]
struct FarthestPair {
    points: [DVec3; 2],
    count: usize,
}

impl FarthestPair {
    fn add(&mut self, p: DVec3) {
        match self.count {
            0 => self.points = [p, p],
            _ => {
                let [s, e] = self.points;
                let (se, sp, ep) = (s.distance_squared(e), s.distance_squared(p), e.distance_squared(p));
                if sp > se && sp >= ep {
                    self.points[1] = p;
                } else if ep > se {
                    self.points[0] = p;
                }
            }
        }
        self.count += 1;
    }

    fn intersection(self, coplanar: bool) -> Option<Intersection> {
        (self.count > 0).then_some(Intersection {
            start: self.points[0],
            end: self.points[1],
            coplanar,
        })
    }
}
