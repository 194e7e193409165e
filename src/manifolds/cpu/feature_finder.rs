//! The features and crossings of a pair, from what it keeps or from a new search. A large pair is shared out over
//! threads: each share has some of the first body's clusters, in order, so that all shares together give the same list
//! however many there are.

use super::candidates::Candidates;
use super::crossing::{Crossings, Segment};
use super::feature::{Feature, TrianglePair};
use super::feature_bits::FeatureBits;
use super::kept::{KeptCandidates, Source};
use super::near::NearTriangles;
use super::near_clusters::NearClusters;
use super::near_features::{BESIDE, NearFeatures};
use super::pair::{Pair, ROUNDING};
use super::search::FeatureQuery;
use super::side::Triangle;
use crate::parallel::loops;
use crate::simd::lanes::Simd;
use crate::simd::level::with_simd;
use rayon::prelude::*;
use std::ops::Range;

/// Least number of pairs of clusters in a share: their search takes much longer than waking a thread.
const MIN_CLUSTER_PAIRS: usize = 256;
/// Shares per thread, to balance the load.
const PER_THREAD: usize = 4;

/// The result, and memory kept between pairs.
#[derive(Default)]
pub struct FeatureFinder {
    clusters: NearClusters,
    shares: Vec<FinderShare>,
    /// Number of shares of the last pair.
    count: usize,
    nearest: NearFeatures,
}

#[derive(Default)]
struct FinderShare {
    /// Which of the first body's near clusters it searches.
    clusters: Range<usize>,
    near: NearTriangles,
    /// The triangles of candidates.
    placed: [Vec<Triangle>; 2],
    crossings: Crossings,
    features: Vec<Feature>,
    segments: Vec<Segment>,
}

impl FeatureFinder {
    /// Finds the wanted features that `admit` admits, and the segments in which triangles cross. Uses `threads` threads
    /// of the current pool; one is the calling thread. Returns where the candidates came from.
    pub fn find(
        &mut self,
        pair: &Pair,
        query: &FeatureQuery,
        kept: &mut KeptCandidates,
        threads: usize,
        admit: impl Fn(&Feature) -> bool + Sync,
    ) -> Source {
        let source = kept.source(pair, query);
        if let Source::Search(search) = &source {
            self.clusters.run(&pair.sides, &pair.pose, search);
            kept.is_large = self.clusters.len() >= 2 * MIN_CLUSTER_PAIRS;
            self.split(threads);
            kept.make_room(self.count);
        } else {
            self.count = kept.shares.len();
            self.grow();
        }
        let Self {
            clusters,
            shares,
            count,
            ..
        } = self;
        let shares = shares[..*count].par_iter_mut().zip(&mut kept.shares);
        let min_shares = if threads > 1 { 1 } else { *count };
        loops::for_each(shares, min_shares, |(share, candidates)| {
            share.run(pair, query, &source, clusters, candidates, &admit);
        });
        self.find_nearest(pair, query, &source, kept);
        source
    }

    /// Finds the features between nearest points.
    fn find_nearest(&mut self, pair: &Pair, query: &FeatureQuery, source: &Source, kept: &mut KeptCandidates) {
        let Self {
            clusters,
            shares,
            count,
            nearest,
        } = self;
        let shares = &mut shares[..*count];
        nearest.clear();
        if !query.nearest {
            return;
        }
        // Surfaces that cross have no distance.
        let crosses = shares.iter().any(|share| !share.segments.is_empty());
        let features = shares.iter().flat_map(|share| &share.features);
        let distance = if crosses { 0.0 } else { least_distance(features) };
        let is_rounded = pair.rounding() > 0.0;
        // Only the nearest features of solids count.
        let one_sided = !is_rounded && pair.sides.iter().all(|side| side.features.one_sided.all());
        let most = if one_sided {
            distance.min(query.margin)
        } else {
            query.margin
        };
        nearest.set_limits(query.margin, distance, is_rounded);
        for (share, candidates) in shares.iter_mut().zip(&mut kept.shares) {
            match source {
                Source::Search(search) => {
                    let slack = search.slack;
                    // After a motion the surfaces may be farther apart, and so may all features that then count.
                    let beside = BESIDE * (query.margin + slack.distance);
                    let kept = most + beside + 2.0 * slack.distance;
                    let reach = if slack.distance > 0.0 { kept } else { most };
                    if reach <= 0.0 {
                        continue;
                    }
                    share.near.for_each_nearest(pair.pose.size, clusters, reach, |found| {
                        let triangles = [0, 1].map(|i| pair.sides[i].triangle(found.triangles[i]));
                        let Some(both) = TrianglePair::new(&pair.sides, triangles.each_ref(), reach) else {
                            return;
                        };
                        if slack.distance > 0.0 {
                            // What has no features after any motion within the slack has none now.
                            if !both.may_have_nearest(reach, slack) {
                                return;
                            }
                            candidates.nearest.push(found);
                        }
                        nearest.add(&both);
                    });
                }
                Source::Kept { motion, .. } if most > 0.0 => {
                    for found in &candidates.nearest {
                        let most = if one_sided { nearest.most() } else { most };
                        if f64::from(found.gap) > most + motion {
                            continue;
                        }
                        let triangles = [0, 1].map(|i| pair.sides[i].triangle(found.triangles[i]));
                        if let Some(both) = TrianglePair::new(&pair.sides, triangles.each_ref(), most) {
                            nearest.add(&both);
                        }
                    }
                }
                Source::Kept { .. } => {}
            }
        }
    }

    /// Writes the features that were found, in order.
    pub fn features(&mut self, to: &mut Vec<Feature>) {
        to.clear();
        for share in &self.shares[..self.count] {
            to.extend_from_slice(&share.features);
        }
        self.nearest.append_to(to);
    }

    /// Writes the segments that were found, in order.
    pub fn segments(&self, to: &mut Vec<Segment>) {
        to.clear();
        for share in &self.shares[..self.count] {
            to.extend_from_slice(&share.segments);
        }
    }

    /// Splits the near clusters into shares.
    fn split(&mut self, threads: usize) {
        let most = if threads > 1 { PER_THREAD * threads } else { 1 };
        self.count = (self.clusters.len() / MIN_CLUSTER_PAIRS).clamp(1, most);
        self.grow();
        let shares = &mut self.shares[..self.count];
        shares.iter_mut().for_each(|share| share.clusters = 0..0);
        let mut next = shares.iter_mut();
        self.clusters.split(self.count, |range| {
            if let Some(share) = next.next() {
                share.clusters = range;
            }
        });
    }

    fn grow(&mut self) {
        if self.shares.len() < self.count {
            self.shares.resize_with(self.count, FinderShare::default);
        }
    }
}

/// The least distance of the points of these features; 0 if any overlaps.
fn least_distance<'a>(features: impl Iterator<Item = &'a Feature>) -> f64 {
    let distance = |feature: &Feature| {
        let overlaps = feature.separation <= 0.0;
        if overlaps {
            0.0
        } else {
            feature.points[0].distance(feature.points[1])
        }
    };
    features.map(distance).fold(f64::INFINITY, f64::min)
}

impl FinderShare {
    /// Finds its features and segments.
    fn run(
        &mut self,
        pair: &Pair,
        query: &FeatureQuery,
        source: &Source,
        clusters: &NearClusters,
        candidates: &mut Candidates,
        admit: impl Fn(&Feature) -> bool,
    ) {
        if let Source::Search(search) = source {
            let range = self.clusters.clone();
            self.near.run(&pair.sides, pair.pose.size, search, clusters, range);
        }
        // Double precision takes less time with the wider instructions, too.
        with_simd!(simd => self.run_with(simd, pair, query, source, candidates, admit));
    }

    #[inline(always)]
    fn run_with<S: Simd>(
        &mut self,
        simd: S,
        pair: &Pair,
        query: &FeatureQuery,
        source: &Source,
        candidates: &mut Candidates,
        admit: impl Fn(&Feature) -> bool,
    ) {
        let Self {
            near,
            placed,
            crossings,
            features,
            segments,
            ..
        } = self;
        features.clear();
        segments.clear();
        crossings.clear();
        let sides = &pair.sides;
        let found = |pair: &TrianglePair, feature_bits: FeatureBits| {
            pair.features(&query.range, feature_bits, |feature| {
                if admit(&feature) {
                    features.push(feature);
                }
            });
        };
        let triangles = match source {
            Source::Search(search) => {
                candidates.select(near, sides, search, crossings, found);
                near.placed()
            }
            Source::Kept { fraction, .. } => {
                candidates.for_each(sides, placed, *fraction, query.reach, crossings, found);
                placed.each_ref().map(Vec::as_slice)
            }
        };
        let rounding = ROUNDING * f64::from(pair.pose.size);
        crossings.segments(simd, sides, triangles, rounding, segments);
    }
}
