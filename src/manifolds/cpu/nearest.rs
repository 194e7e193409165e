//! Features between nearest points: a corner and an edge, two corners, edges of any angle, and, of two-sided triangles,
//! a corner over the back of a face.
//!
//! The way from one point to the other is the normal. It must be the shortest of all ways nearby: no face and no edge
//! of either feature leads nearer to the other point. So no feature is found where a corner over a face, or two edges
//! that cross, are nearer. Parallel edges touch with the ends of the part along which they overlap.

use super::candidates::squared_distance;
use super::feature::{Feature, OUTSIDE, Origin, TrianglePair};
use super::search::Slack;
use super::side::{Side, Triangle, rounding};
use crate::geometry::features::NONE;
use crate::simd::lanes::bits;
use crate::state::pairs::DEFAULT_DIRECTION;
use arrayvec::ArrayVec;
use glam::DVec3;

/// Sine of the angle between the way and a face's normal, or an edge's perpendicular, below which both count as equal.
/// Without it, points that almost touch would only have to meet [`OUTSIDE`], which all ways do.
pub(crate) const ALONG: f64 = 1.0e-3;
/// Sine of the angle below which only rounding gives two edges nearest points within both.
const EXACTLY_PARALLEL: f64 = 1.0e-7;
/// Rounding error of a position, relative to the largest coordinate.
const ROUNDING: f64 = 1.0e-14;

/// A corner that a triangle owns.
struct Corner<'a> {
    side: &'a Side<'a>,
    k: usize,
    at: DVec3,
    vertex: u32,
}

/// An edge that a triangle owns.
struct Edge<'a> {
    side: &'a Side<'a>,
    triangle: &'a Triangle,
    k: usize,
    start: DVec3,
    along: DVec3,
    square: f64,
}

/// By how much the conditions are wider, see [`Slack`].
#[derive(Clone, Copy)]
struct Allowance {
    slack: Slack,
    rounding: f64,
}

impl Allowance {
    /// Bound of the change of a unit vector's product with the way between two points.
    fn of_way(&self, way: f64) -> f64 {
        self.slack.distance + self.slack.rotation * (way + self.slack.distance) + self.rounding
    }

    /// How far beside an edge, or beyond the end of an edge of this `length`, points still count as over the face, or
    /// beside the edge.
    fn outside(way: f64, length: f64) -> f64 {
        (OUTSIDE * length).min(ALONG * way)
    }
}

impl<'a> Corner<'a> {
    fn new(side: &'a Side<'a>, triangle: &Triangle, k: usize) -> Self {
        Self {
            side,
            k,
            at: triangle.corners[k],
            vertex: side.features.triangles[triangle.number as usize][k],
        }
    }

    /// Whether none of its edges leads nearer to the end of this way from it.
    fn faces(&self, way: DVec3, allowance: &Allowance) -> bool {
        let length = way.length();
        let own = allowance.of_way(length);
        let features = self.side.features;
        features.neighbors_of(self.vertex).iter().all(|&neighbor| {
            let edge = self.side.vertex(neighbor) - self.at;
            let of_edge = edge.length();
            edge.dot(way) <= of_edge * (own + Allowance::outside(length, of_edge))
        })
    }

    /// Unit vector away from its edges.
    fn outward(&self) -> DVec3 {
        let neighbors = self.side.features.neighbors_of(self.vertex).iter();
        let away = |&neighbor: &u32| (self.at - self.side.vertex(neighbor)).normalize_or_zero();
        neighbors.map(away).sum::<DVec3>().normalize_or_zero()
    }
}

impl<'a> Edge<'a> {
    fn new(side: &'a Side<'a>, triangle: &'a Triangle, k: usize) -> Self {
        let start = triangle.corners[k];
        let along = triangle.corners[(k + 1) % 3] - start;
        Self {
            side,
            triangle,
            k,
            start,
            along,
            square: along.length_squared(),
        }
    }

    /// For each of its faces, the unit vector in the face, perpendicular to the edge, away from it.
    fn inward(&self) -> ArrayVec<DVec3, 2> {
        let mut inward = ArrayVec::new();
        let mut add = |corner: DVec3| {
            let way = corner - self.start;
            inward.extend((way - self.along * (way.dot(self.along) / self.square)).try_normalize());
        };
        add(self.triangle.corners[(self.k + 2) % 3]);
        let (features, number) = (self.side.features, self.triangle.number as usize);
        let other = features.across[features.triangle_edges[number][self.k] as usize];
        if other != NONE {
            let own = features.triangles[number];
            let ends = [own[self.k], own[(self.k + 1) % 3]];
            let third = features.triangles[other as usize].iter().find(|v| !ends.contains(v));
            if let Some(&third) = third {
                add(self.side.vertex(third));
            }
        }
        inward
    }

    /// Whether none of its faces leads nearer to the end of this way, to another edge.
    fn faces(&self, way: DVec3, allowance: &Allowance) -> bool {
        let most = allowance.of_way(way.length());
        self.inward().iter().all(|inward| inward.dot(way) <= most)
    }

    /// Whether the end of this way, a corner, lies beside all of its faces.
    fn is_outside(&self, way: DVec3, allowance: &Allowance) -> bool {
        let length = way.length();
        let most = if allowance.slack.distance > 0.0 {
            allowance.of_way(length)
        } else {
            -Allowance::outside(length, self.square.sqrt())
        };
        self.inward().iter().all(|inward| inward.dot(way) <= most)
    }

    fn outward(&self) -> DVec3 {
        -self.inward().iter().sum::<DVec3>().normalize_or_zero()
    }
}

/// Two points, and a direction that separates them if they touch.
struct SeparatedPoints {
    points: [DVec3; 2],
    outward: DVec3,
    origin: Origin,
}

/// The direction that separates two features with the outward vectors `of`; zero if their points do not touch.
fn outward(distance: f64, allowance: &Allowance, of: impl Fn() -> [DVec3; 2]) -> DVec3 {
    if distance > allowance.rounding {
        return DVec3::ZERO;
    }
    let [a, b] = of();
    (a - b).normalize_or_zero()
}

impl TrianglePair<'_> {
    /// Calls `found` for each feature between nearest points no farther apart than `most`.
    pub fn nearest_features(&self, most: f64, mut found: impl FnMut(Feature)) {
        let allowance = Allowance {
            slack: Slack::default(),
            rounding: self.rounding(),
        };
        self.each_nearest(
            most,
            &allowance,
            |SeparatedPoints {
                 points,
                 outward,
                 origin,
             }| {
                let way = points[1] - points[0];
                let distance = way.length();
                let normal = if distance > allowance.rounding {
                    way / distance
                } else if outward != DVec3::ZERO || rounding(self.sides) == 0.0 {
                    // The way between points that touch is rounding only.
                    outward
                } else {
                    // The centres of two balls coincide.
                    DEFAULT_DIRECTION
                };
                if normal != DVec3::ZERO {
                    found(Feature {
                        points,
                        normal,
                        separation: distance,
                        triangles: self.triangles.map(|triangle| triangle.number),
                        origin,
                    });
                }
            },
        );
    }

    /// Whether the triangles may have features between nearest points no farther apart than `most` after a motion
    /// within the slack.
    pub fn may_have_nearest(&self, most: f64, slack: Slack) -> bool {
        let allowance = Allowance {
            slack,
            rounding: self.rounding(),
        };
        let mut any = false;
        self.each_nearest(most + slack.distance, &allowance, |_| any = true);
        any
    }

    fn rounding(&self) -> f64 {
        let [a, b] = self.triangles.map(|triangle| triangle.corners);
        let largest = a.iter().chain(&b).map(|p| p.abs().max_element()).fold(0.0, f64::max);
        ROUNDING * largest
    }

    fn each_nearest(&self, most: f64, allowance: &Allowance, mut found: impl FnMut(SeparatedPoints)) {
        if !self.is_within(most) {
            return;
        }
        for a in self.corners(0) {
            for b in self.corners(1) {
                self.of_corners([&a, &b], most, allowance).map(&mut found);
            }
        }
        for i in 0..2 {
            let over = self.triangles[1 - i];
            let one_sided = self.sides[1 - i].features.one_sided.is(over.number as usize);
            for corner in self.corners(i) {
                for edge in self.edges_of(1 - i) {
                    self.of_corner_and_edge(i, &corner, &edge, most, allowance)
                        .map(&mut found);
                }
                if !one_sided {
                    self.over_back(i, &corner, most, allowance).map(&mut found);
                }
            }
        }
        for a in self.edges_of(0) {
            for b in self.edges_of(1) {
                self.of_edges([&a, &b], most, allowance).map(&mut found);
            }
        }
    }

    /// The corners that a side's triangle owns.
    #[inline(always)]
    fn corners(&self, i: usize) -> impl Iterator<Item = Corner<'_>> {
        let corner = move |k| Corner::new(&self.sides[i], self.triangles[i], k);
        bits(self.owned(i) & 0b111).map(corner)
    }

    /// The edges that a side's triangle owns.
    #[inline(always)]
    fn edges_of(&self, i: usize) -> impl Iterator<Item = Edge<'_>> {
        let edge = move |k| Edge::new(&self.sides[i], self.triangles[i], k);
        bits(self.owned(i) >> 3 & 0b111).map(edge)
    }

    fn owned(&self, i: usize) -> u32 {
        self.sides[i].features.owned[self.triangles[i].number as usize]
    }

    fn of_corners(&self, [a, b]: [&Corner; 2], most: f64, allowance: &Allowance) -> Option<SeparatedPoints> {
        let way = b.at - a.at;
        (way.length_squared() <= most * most && a.faces(way, allowance) && b.faces(-way, allowance)).then(|| {
            SeparatedPoints {
                points: [a.at, b.at],
                outward: outward(way.length(), allowance, || [a.outward(), b.outward()]),
                origin: Origin::Vertices([a.k as u8, b.k as u8]),
            }
        })
    }

    /// A corner of this side and an edge of the other.
    fn of_corner_and_edge(
        &self,
        side: usize,
        corner: &Corner,
        edge: &Edge,
        most: f64,
        allowance: &Allowance,
    ) -> Option<SeparatedPoints> {
        let at = (corner.at - edge.start).dot(edge.along) / edge.square;
        let foot = edge.start + edge.along * at;
        let way = corner.at - foot;
        let square = way.length_squared();
        // Also for edges without length.
        if square.is_nan() || square > most * most {
            return None;
        }
        let length = edge.square.sqrt();
        let within = if allowance.slack.distance > 0.0 {
            -allowance.of_way(square.sqrt()) / length
        } else {
            Allowance::outside(square.sqrt(), length) / length
        };
        if at < within || at > 1.0 - within || !edge.is_outside(way, allowance) || !corner.faces(-way, allowance) {
            return None;
        }
        let swap = |pair: [DVec3; 2]| if side == 1 { [pair[1], pair[0]] } else { pair };
        Some(SeparatedPoints {
            points: swap([corner.at, foot]),
            outward: outward(square.sqrt(), allowance, || swap([corner.outward(), edge.outward()])),
            origin: Origin::VertexEdge {
                side: side as u8,
                edge: edge.k as u8,
                vertex: corner.vertex,
            },
        })
    }

    fn of_edges(&self, [a, b]: [&Edge; 2], most: f64, allowance: &Allowance) -> Option<SeparatedPoints> {
        let cross = a.along.cross(b.along);
        let square = cross.length_squared();
        let between = b.start - a.start;
        let product = between.dot(cross);
        // The distance of the lines rejects most pairs.
        if product * product > most * most * square || square == 0.0 {
            return None;
        }
        if squared_distance([a.start, a.along], [b.start, b.along]) > most * most {
            return None;
        }
        let origin = Origin::Edges([a.k as u8, b.k as u8]);
        let sine = (square / (a.square * b.square)).sqrt();
        let turn = 2.0 * allowance.slack.rotation / sine + allowance.slack.rotation;
        if allowance.slack.distance > 0.0 {
            let points = [a.start, b.start];
            let faces = |normal: DVec3| {
                let most = turn + allowance.rounding;
                let all = |edge: &Edge, normal: DVec3| edge.inward().iter().all(|inward| inward.dot(normal) <= most);
                all(a, normal) && all(b, -normal)
            };
            let normal = cross * square.sqrt().recip();
            return (sine + allowance.slack.rotation > EXACTLY_PARALLEL
                && (turn.is_nan() || turn >= 1.0 || faces(normal) || faces(-normal)))
            .then_some(SeparatedPoints {
                points,
                outward: DVec3::ZERO,
                origin,
            });
        }
        if sine <= EXACTLY_PARALLEL {
            return None;
        }
        let at_a = between.cross(b.along).dot(cross) / square;
        let at_b = between.cross(a.along).dot(cross) / square;
        if !(0.0..=1.0).contains(&at_a) || !(0.0..=1.0).contains(&at_b) {
            return None;
        }
        let points = [a.start + a.along * at_a, b.start + b.along * at_b];
        let way = points[1] - points[0];
        // Edges that cross and touch have a feature without this.
        (way.length() > allowance.rounding && a.faces(way, allowance) && b.faces(-way, allowance)).then_some(
            SeparatedPoints {
                points,
                outward: DVec3::ZERO,
                origin,
            },
        )
    }

    /// A corner of this side over the back of the other side's face.
    fn over_back(&self, side: usize, corner: &Corner, most: f64, allowance: &Allowance) -> Option<SeparatedPoints> {
        let over = self.triangles[1 - side];
        let height = self.heights[side][corner.k];
        // The normal may turn round after a motion.
        let may_turn = allowance.slack.distance > 0.0;
        if height.abs() > most || height >= 0.0 && !may_turn {
            return None;
        }
        let foot = corner.at - over.normal * height;
        let aside = allowance.slack.distance + allowance.slack.rotation * most;
        for i in 0..3 {
            let edge = over.corners[(i + 1) % 3] - over.corners[i];
            let across = edge.cross(foot - over.corners[i]).dot(over.normal) * over.winding_sign;
            let square = edge.length_squared();
            if across <= -(OUTSIDE * square + aside * square.sqrt()) {
                return None;
            }
        }
        let way = foot - corner.at;
        if !may_turn && !corner.faces(way, allowance) {
            return None;
        }
        let swap = |pair: [DVec3; 2]| if side == 1 { [pair[1], pair[0]] } else { pair };
        Some(SeparatedPoints {
            points: swap([corner.at, foot]),
            outward: DVec3::ZERO,
            origin: Origin::Vertex {
                side: side as u8,
                vertex: corner.vertex,
            },
        })
    }
}
