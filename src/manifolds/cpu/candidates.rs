//! Candidates: pairs of triangles with the features and crossings that may give contact points.
//!
//! A search finds them with some slack. Until the bodies have moved relative to each other by more than the slack, all
//! features and crossings are among them. What is computed from candidates is therefore the same to the bit as after a
//! new search: a search with more slack only adds candidates without a result, and all searches list pairs in the same
//! order.

use super::crossing::Crossings;
use super::eight::GapPair;
use super::feature::{ARC, BELOW, OUTSIDE, PARALLEL, TrianglePair};
#[cfg(test)]
use super::feature_bits;
use super::feature_bits::{CROSSING, FeatureBit, FeatureBits};
use super::near::{NOT_LISTED, NearTriangles};
use super::search::{Search, Slack};
use super::side::{Side, Triangle};
use crate::simd::lanes::bits;
use glam::DVec3;
use std::ops::RangeInclusive;

/// Fractions of the slack. Each candidate stores what it may have after a motion within each fraction. Most have
/// nothing within the first, which covers the motion of bodies at rest.
pub const FRACTIONS: [f64; 3] = [1.0 / 16.0, 1.0 / 4.0, 1.0];

/// A list of candidates.
#[derive(Clone, Debug, Default)]
pub struct Candidates {
    /// Triangles of the first and of the second body.
    triangles: [Vec<CandidateTriangle>; 2],
    pairs: Vec<Candidate>,
    /// Triangles that may have features between nearest points, by their numbers, with lower bounds of their distances
    /// when they were found.
    pub nearest: Vec<GapPair>,
    /// Whether any pair may cross after a motion within each of [`FRACTIONS`] of the slack.
    pub may_cross: [bool; FRACTIONS.len()],
}

/// Shortens a list that uses less than a quarter of its memory. Short lists keep theirs, so that pairs that come and go
/// allocate nothing.
fn shrink<T>(list: &mut Vec<T>, used: usize) {
    const SHORT: usize = 64;
    let used = used.max(SHORT);
    if list.capacity() > 4 * used {
        list.shrink_to(2 * used);
    }
}

/// A triangle of candidates.
#[derive(Clone, Copy, Debug)]
struct CandidateTriangle {
    number: u32,
    /// The smallest of [`FRACTIONS`] within which it may have anything, as an index.
    first: u8,
}

/// A pair of triangles.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    /// Indices into [`Candidates::triangles`].
    triangles: [u32; 2],
    /// What the two may have after a motion within each of the [`FRACTIONS`] of the slack.
    feature_bits: [FeatureBits; FRACTIONS.len()],
}

impl Candidates {
    /// Number of candidates.
    pub fn len(&self) -> usize {
        self.pairs.len() + self.nearest.len()
    }

    /// Selects candidates among pairs of triangles found with the same slack. Without slack it selects none. Calls
    /// `found` for each pair that may have features now, in order, and notes those that may cross, by their indices in
    /// [`NearTriangles::placed`].
    #[inline(always)]
    pub fn select(
        &mut self,
        near: &mut NearTriangles,
        sides: &[Side; 2],
        search: &Search,
        crossings: &mut Crossings,
        mut found: impl FnMut(&TrianglePair, FeatureBits),
    ) {
        self.clear();
        let Self {
            triangles: [firsts, seconds],
            pairs,
            may_cross,
            ..
        } = self;
        let slack = search.slack;
        near.for_each_pair(
            sides,
            #[inline(always)]
            |triangles, near, [first, second]| {
                let features = near.feature_bits & !CROSSING;
                let pair = match features {
                    0 => None,
                    _ => TrianglePair::new(sides, triangles, search.reach + slack.distance),
                };
                if slack.distance == 0.0 {
                    if let Some(pair) = &pair {
                        found(pair, features);
                    }
                    if near.feature_bits & CROSSING != 0 {
                        crossings.push(near.triangles);
                    }
                    return;
                }
                let mut feature_bits = [0; FRACTIONS.len()];
                let (mut features, mut closest) = (features, FRACTIONS.len());
                for (i, fraction) in FRACTIONS.into_iter().enumerate().rev() {
                    let slack = slack * fraction;
                    features = match &pair {
                        Some(pair) => pair.possible_features(&search.range, slack, features),
                        None => 0,
                    };
                    let crosses = f64::from(near.gap) <= slack.distance;
                    let possible = features | if crosses { near.feature_bits & CROSSING } else { 0 };
                    if possible == 0 {
                        break;
                    }
                    (feature_bits[i], closest) = (possible, i);
                }
                if closest == FRACTIONS.len() {
                    return;
                }
                for (may_cross, feature_bits) in may_cross.iter_mut().zip(feature_bits) {
                    *may_cross |= feature_bits & CROSSING != 0;
                }
                if let Some(pair) = pair.filter(|pair| features != 0 && pair.is_within(search.reach)) {
                    found(&pair, features);
                }
                if feature_bits[0] & CROSSING != 0 {
                    crossings.push(near.triangles);
                }
                let listed = |index: &mut u32, list: &mut Vec<CandidateTriangle>, triangle: &Triangle| {
                    if *index == NOT_LISTED {
                        *index = list.len() as u32;
                        list.push(CandidateTriangle {
                            number: triangle.number,
                            first: closest as u8,
                        });
                    }
                    let listed = &mut list[*index as usize].first;
                    *listed = (closest as u8).min(*listed);
                    *index
                };
                pairs.push(Candidate {
                    triangles: [
                        listed(first, firsts, triangles[0]),
                        listed(second, seconds, triangles[1]),
                    ],
                    feature_bits,
                });
            },
        );
    }

    /// Removes all candidates.
    pub fn clear(&mut self) {
        self.triangles.iter_mut().for_each(Vec::clear);
        self.pairs.clear();
        self.nearest.clear();
        self.may_cross = Default::default();
    }

    /// Returns memory of lists that have lately had at most `used` elements.
    pub fn shrink(&mut self, used: usize) {
        self.triangles.iter_mut().for_each(|list| shrink(list, used));
        shrink(&mut self.pairs, used);
        shrink(&mut self.nearest, used);
    }

    /// Calls `found` in order for each candidate within `reach` that may have features after a motion within the given
    /// one of [`FRACTIONS`] of the slack. Notes candidates that may cross by their indices in `placed`, which is memory
    /// kept between calls.
    #[inline(always)]
    pub fn for_each(
        &self,
        sides: &[Side; 2],
        placed: &mut [Vec<Triangle>; 2],
        fraction: usize,
        reach: f64,
        crossings: &mut Crossings,
        mut found: impl FnMut(&TrianglePair, FeatureBits),
    ) {
        for ((placed, listed), side) in placed.iter_mut().zip(&self.triangles).zip(sides) {
            // Triangles that are not needed keep what is there.
            placed.resize(listed.len().max(placed.len()), Triangle::default());
            for (triangle, listed) in placed.iter_mut().zip(listed) {
                if usize::from(listed.first) <= fraction {
                    *triangle = side.triangle(listed.number);
                }
            }
        }
        for candidate in &self.pairs {
            let feature_bits = candidate.feature_bits[fraction];
            if feature_bits & CROSSING != 0 {
                crossings.push(candidate.triangles);
            }
            if feature_bits & !CROSSING == 0 {
                continue;
            }
            let [i, j] = candidate.triangles;
            let triangles = [&placed[0][i as usize], &placed[1][j as usize]];
            if let Some(pair) = TrianglePair::new(sides, triangles, reach) {
                found(&pair, feature_bits & !CROSSING);
            }
        }
    }
}

impl TrianglePair<'_> {
    /// All features that the triangles own.
    #[cfg(test)]
    pub fn owned_features(&self) -> FeatureBits {
        let owned = [0, 1].map(|i| self.sides[i].features.owned[self.triangles[i].number as usize]);
        feature_bits::owned_features(owned.map(|owned| feature_bits::FACE_BIT | owned))
    }

    /// The features among `may_have` that the triangles may have, with a separation in `range`, after a motion within
    /// the slack.
    fn possible_features(&self, range: &RangeInclusive<f64>, slack: Slack, may_have: FeatureBits) -> FeatureBits {
        let most = (range.start().abs().max(range.end().abs()) + slack.distance) * (1.0 + 1.0e-9);
        let possible = bits(u32::from(may_have)).filter(|&bit| match FeatureBit::of(bit) {
            FeatureBit::Vertex { side, k } => self.may_have_vertex(side, k, range, slack),
            FeatureBit::Edges(edges) => self.may_have_edges(edges, most, slack.rotation),
        });
        possible.fold(0, |feature_bits, bit| feature_bits | 1 << bit)
    }

    /// The conditions of a vertex-face feature, each widened by the slack. The vertex moves relative to the face by at
    /// most the slack, because it is near the other body when the feature exists.
    fn may_have_vertex(&self, side: usize, k: usize, range: &RangeInclusive<f64>, slack: Slack) -> bool {
        let (own, over) = (self.triangles[side], self.triangles[1 - side]);
        let (p, height) = (own.corners[k], self.heights[side][k]);
        let is_near = |height: f64| (range.start() - slack.distance..=range.end() + slack.distance).contains(&height);
        // The normal of a two-sided triangle may turn round.
        let sided = self.sides[1 - side].features.one_sided.is(over.number as usize);
        if !(is_near(height) || !sided && is_near(-height)) {
            return false;
        }
        let foot = p - over.normal * height;
        for i in 0..3 {
            let edge = over.corners[(i + 1) % 3] - over.corners[i];
            let across = edge.cross(foot - over.corners[i]).dot(over.normal) * over.winding_sign;
            let square = edge.length_squared();
            if across < 0.0 && across <= -(OUTSIDE * square + slack.distance * square.sqrt()) {
                return false;
            }
        }
        let of = &self.sides[side];
        let vertex = of.features.triangles[own.number as usize][k];
        let below = BELOW + slack.rotation;
        !sided
            || of.features.neighbors_of(vertex).iter().all(|&neighbor| {
                let edge = of.vertex(neighbor) - p;
                let along = edge.dot(over.normal);
                along >= 0.0 || along * along <= below * below * edge.length_squared()
            })
    }

    /// The conditions of an edge-edge feature, each widened. `most` is the largest distance of the edges, `rotation`
    /// bounds the relative rotation.
    fn may_have_edges(&self, edges: [usize; 2], most: f64, rotation: f64) -> bool {
        let [[p, u], [q, v]] = [0, 1].map(|i| {
            let corners = &self.triangles[i].corners;
            [corners[edges[i]], corners[(edges[i] + 1) % 3] - corners[edges[i]]]
        });
        let cross = u.cross(v);
        let square = cross.length_squared();
        let product = (q - p).dot(cross);
        if product * product > most * most * square {
            return false;
        }
        if squared_distance([p, u], [q, v]) > most * most {
            return false;
        }
        let is_one_sided = |i: usize| self.sides[i].features.one_sided.is(self.triangles[i].number as usize);
        if !(is_one_sided(0) && is_one_sided(1)) {
            return true;
        }
        // The sine of the angle between the edges, and upper bounds of how far the normal turns.
        let lengths = [u.length(), v.length()];
        let sine = square.sqrt() / (lengths[0] * lengths[1]);
        if sine + rotation <= PARALLEL {
            return false;
        }
        let turn = 2.0 * rotation / sine + rotation;
        if turn.is_nan() || turn >= 1.0 {
            return true;
        }
        let normal = cross * square.sqrt().recip();
        [normal, -normal].into_iter().any(|normal| {
            (0..2).all(|i| {
                let (side, triangle) = (&self.sides[i], self.triangles[i]);
                let edge = side.features.triangle_edges[triangle.number as usize][edges[i]];
                let out = [normal, -normal][i];
                let least = -(ARC + turn) * lengths[i];
                let turned = |from: DVec3, to: DVec3| triangle.winding_sign * from.cross(to).dot([u, v][i]) >= least;
                turned(triangle.normal, out) && side.across(edge).is_none_or(|other| turned(out, other))
            })
        })
    }
}

/// The squared distance of two segments, each a point and a vector (Ericson 2005, Real-Time Collision Detection,
/// 5.1.9).
pub fn squared_distance([p, u]: [DVec3; 2], [q, v]: [DVec3; 2]) -> f64 {
    let way = p - q;
    let (a, e, b) = (u.length_squared(), v.length_squared(), u.dot(v));
    let (c, f) = (u.dot(way), v.dot(way));
    let unit = |x: f64, of: f64| if of > 0.0 { (x / of).clamp(0.0, 1.0) } else { 0.0 };
    let s = unit(b * f - c * e, a * e - b * b);
    let t = unit(b * s + f, e);
    // The nearest point of the first segment to the one found on the second.
    let s = unit(b * t - c, a);
    (way + u * s - v * t).length_squared()
}
