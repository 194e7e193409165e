//! What to search for: the separations of features, the slack, and where.

use super::placed_cluster::{AROUND_ERROR, DIRECTION_ERROR};
use crate::geometry::Aabb;
use crate::simd::rounding::PAD;
use glam::Vec3;
use std::ops::RangeInclusive;

/// How far bodies may move relative to each other until candidates must be searched again.
#[derive(Clone, Copy, Debug, Default)]
pub struct Slack {
    /// Upper bound of the motion of any point of one body near the other, relative to it, metres.
    pub distance: f64,
    /// Upper bound of the relative rotation, radians.
    pub rotation: f64,
}

impl std::ops::Mul<f64> for Slack {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self {
            distance: factor * self.distance,
            rotation: factor * self.rotation,
        }
    }
}

/// Which features of a pair are wanted now.
pub struct Wanted {
    /// Their largest separation or overlap, metres.
    pub margin: f64,
    /// Their separations, metres.
    pub range: RangeInclusive<f64>,
    /// Largest distance of two triangles with such a feature, metres.
    pub reach: f64,
    /// Limits them to some pairs of triangles. Without it crossings are wanted too.
    pub window: Option<Window>,
}

/// What to search for.
pub struct Search {
    /// Separations of features, metres.
    pub range: RangeInclusive<f64>,
    /// Largest distance of two triangles with a feature, metres.
    pub reach: f64,
    /// Slack of all conditions.
    pub slack: Slack,
    /// Whether crossings are wanted too.
    pub crossings: bool,
    /// Limits the search to some pairs of triangles.
    pub window: Option<Window>,
}

/// Limits the search to some pairs of triangles.
#[derive(Clone, Copy, Debug)]
pub struct Window {
    /// Both triangles must meet this box.
    pub around: Aabb,
    /// The first must extend farther along this direction than the second's lower bound. Zero accepts every pair.
    pub direction: Vec3,
}

/// Least cosine between the directions of windows that find the same features. Features differ from the direction by up
/// to 46 degrees, so they overlap along all directions that differ from it by less than 44 degrees.
const MIN_COSINE: f32 = 0.8;

impl Window {
    /// Whether features whose triangles pass this window are found with `other`.
    pub fn is_within(&self, other: &Self) -> bool {
        let boxes = self.around.min.cmpge(other.around.min).all() && self.around.max.cmple(other.around.max).all();
        // Features agree with the direction of this window, so they overlap along similar directions, too.
        boxes && (other.direction == Vec3::ZERO || self.direction.dot(other.direction) > MIN_COSINE)
    }

    /// The window, larger by `distance` on each side.
    pub fn grown(&self, distance: f64) -> Self {
        let Aabb { min, max } = self.around;
        let more = Vec3::splat(distance as f32);
        Self {
            around: Aabb {
                min: min - more,
                max: max + more,
            },
            direction: self.direction,
        }
    }
}

/// The limits of a [`Search`] in single precision, with the slack and allowances for rounding.
pub struct Limits {
    /// Rounding allowance.
    pub pad: f32,
    /// Largest distance of two triangles with a feature.
    pub reach: f32,
    /// Least and largest separation of a feature.
    pub lowest: f32,
    pub highest: f32,
    /// Largest distance of two triangles that may cross.
    pub crossing: f32,
    /// Addition to lateral distances.
    pub lateral: f32,
    /// Addition to angles between normals, radians.
    pub rotation: f32,
}

impl Limits {
    /// `size` is the sum of the bounding radii.
    pub fn new(search: &Search, size: f32) -> Self {
        let pad = PAD * size;
        let [slack, rotation] = [search.slack.distance, search.slack.rotation].map(|s| AROUND_ERROR * s as f32);
        let reach = search.reach as f32 + slack + pad;
        Self {
            pad,
            reach,
            lowest: *search.range.start() as f32 - slack - pad,
            highest: *search.range.end() as f32 + slack + pad,
            crossing: slack + pad,
            // A normal that turns moves the points of a feature sideways.
            lateral: slack + 8.0 * pad + (2.0 * DIRECTION_ERROR + rotation) * reach,
            rotation,
        }
    }
}
