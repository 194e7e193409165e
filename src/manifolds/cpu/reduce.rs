//! The few points that say what many say.

use super::feature::Feature;
use crate::manifolds::MOST_POINTS;

/// What a difference of normals counts beside a distance in units of the bodies' size, both squared.
pub(crate) const TURN: f64 = 0.02;
/// Points nearer than this, by that measure, are one.
pub(crate) const SAME: f64 = 1.0e-8;
/// Points that are shallower by this part of the bodies' size count by a factor of e less.
pub(crate) const SHALLOWER: f64 = 0.01;
/// But never less than this.
pub(crate) const LEAST_WEIGHT: f64 = 0.01;

/// Memory kept between pairs.
#[derive(Default)]
pub struct Reduction {
    distances: Vec<f64>,
    chosen: Vec<Feature>,
}

impl Reduction {
    /// The deepest point, then always the one that is farthest from those chosen before. Points that are the same come once.
    pub fn run(&mut self, features: &mut [Feature], size: f64) -> &[Feature] {
        self.chosen.clear();
        features.sort_unstable_by(|p, q| p.separation.total_cmp(&q.separation));
        let Some(deepest) = features.first() else {
            return &self.chosen;
        };
        self.distances.clear();
        self.distances.resize(features.len(), f64::INFINITY);
        let mut next = Some(0);
        while let Some(index) = next.filter(|_| self.chosen.len() < MOST_POINTS) {
            let last = features[index];
            self.chosen.push(last);
            let mut best = 0.0;
            next = None;
            for (i, (feature, distance)) in features.iter().zip(&mut self.distances).enumerate() {
                let apart = feature.points[0].distance_squared(last.points[0]) / (size * size)
                    + TURN * feature.normal.distance_squared(last.normal);
                *distance = distance.min(apart);
                if *distance <= SAME {
                    continue;
                }
                let shallower = (feature.separation - deepest.separation) / (SHALLOWER * size);
                let weighted = *distance * (-shallower).exp().max(LEAST_WEIGHT);
                if weighted > best {
                    best = weighted;
                    next = Some(i);
                }
            }
        }
        &self.chosen
    }
}
