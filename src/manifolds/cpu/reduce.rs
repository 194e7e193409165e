//! Contact reduction: selects the few points that represent a manifold.

use super::feature::Feature;
use crate::manifolds::MAX_POINTS;

/// Weight of the squared difference of normals against the squared distance in units of the bodies' size.
pub(crate) const NORMAL_WEIGHT: f64 = 0.02;
/// Points closer than this, by that measure, are duplicates.
pub(crate) const DUPLICATE: f64 = 1.0e-8;
/// Depth over which the weight of a point falls by a factor of e, measured from the deepest, in units of the bodies'
/// size.
pub(crate) const DEPTH_SCALE: f64 = 0.01;
/// Lower bound of that weight.
pub(crate) const MIN_WEIGHT: f64 = 0.01;

/// Memory kept between pairs.
#[derive(Default)]
pub struct Reduction {
    /// For each feature, its distance from the selected ones, and its weight, which falls with the difference to the
    /// deepest.
    ranks: Vec<(f64, f64)>,
    chosen: Vec<Feature>,
}

impl Reduction {
    /// Selects the deepest point, then repeatedly the one farthest from those selected. Duplicates are dropped.
    pub fn run(&mut self, features: &mut [Feature], size: f64) -> &[Feature] {
        self.chosen.clear();
        features.sort_unstable_by(|p, q| p.separation.total_cmp(&q.separation));
        let Some(deepest) = features.first() else {
            return &self.chosen;
        };
        self.ranks.clear();
        self.ranks.extend(features.iter().map(|feature| {
            let shallower = (feature.separation - deepest.separation) / (DEPTH_SCALE * size);
            (f64::INFINITY, (-shallower).exp().max(MIN_WEIGHT))
        }));
        let mut next = Some(0);
        while let Some(index) = next.filter(|_| self.chosen.len() < MAX_POINTS) {
            let last = features[index];
            self.chosen.push(last);
            let mut best = 0.0;
            next = None;
            for (i, (feature, (distance, weight))) in features.iter().zip(&mut self.ranks).enumerate() {
                let apart = feature.points[0].distance_squared(last.points[0]) / (size * size)
                    + NORMAL_WEIGHT * feature.normal.distance_squared(last.normal);
                *distance = distance.min(apart);
                if *distance <= DUPLICATE {
                    continue;
                }
                let weighted = *distance * *weight;
                if weighted > best {
                    best = weighted;
                    next = Some(i);
                }
            }
        }
        &self.chosen
    }
}
