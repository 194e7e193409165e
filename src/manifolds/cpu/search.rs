//! What to search for: the separations of features, the slack, and where.

use super::precision::{AROUND_ERROR, DIRECTION_ERROR};
use crate::geometry::Aabb;
use crate::simd::rounding::PAD;
use arrayvec::ArrayVec;
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
pub struct FeatureQuery {
    /// Largest separation or overlap of features, metres.
    pub margin: f64,
    /// Separations of features, metres.
    pub range: RangeInclusive<f64>,
    /// Largest distance of two triangles with such a feature, metres.
    pub reach: f64,
    /// Limits them to some pairs of triangles. Without it crossings are wanted too.
    pub window: Option<Window>,
    /// Whether features between nearest points are wanted too.
    pub nearest: bool,
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

/// Limits the search to features near some regions, the patches of overlaps.
#[derive(Clone, Copy, Debug)]
pub struct Window {
    regions: [SearchRegion; MAX_REGIONS],
    count: usize,
    /// Bound of the angle by which features differ from the normals of their regions, as a chord.
    pub chord: f32,
    /// The first triangle must extend farther along this direction than the second's lower bound. Zero accepts every
    /// pair.
    pub direction: Vec3,
}

/// A ball that both triangles of a feature meet, and the normal with which the feature agrees.
#[derive(Clone, Copy, Debug, Default)]
pub struct SearchRegion {
    pub center: Vec3,
    pub radius: f32,
    /// A unit vector; zero if features may have any normal.
    pub normal: Vec3,
}

/// Most regions of a window. If there are more, one ball holds them all.
pub const MAX_REGIONS: usize = 4;
/// Regions whose normals differ by more, as a chord, do not find the same features.
const MAX_TURN: f32 = 0.2;
/// Allowance for the rounding of normals, as a chord.
const NORMAL_ERROR: f32 = 2.0 * DIRECTION_ERROR;

impl Window {
    /// A window of these regions. `agreement` is the least cosine between the normals of a region and of a feature.
    pub fn new(all: impl Iterator<Item = SearchRegion> + Clone, agreement: f64) -> Self {
        let mut window = Self {
            regions: [SearchRegion::default(); MAX_REGIONS],
            count: 0,
            chord: (2.0 - 2.0 * agreement).sqrt() as f32 + NORMAL_ERROR,
            direction: Vec3::ZERO,
        };
        window.count = all.clone().count();
        if window.count > MAX_REGIONS {
            (window.regions[0], window.count) = (SearchRegion::around(all), 1);
        } else {
            window.regions.iter_mut().zip(all).for_each(|(to, from)| *to = from);
            // Features that agree with a single region overlap along its normal. Several have no common direction.
            if window.count == 1 {
                window.direction = window.regions[0].normal;
            }
        }
        window
    }

    /// This window for features of any normal.
    pub fn without_normals(mut self) -> Self {
        self.regions.iter_mut().for_each(|region| region.normal = Vec3::ZERO);
        self
    }

    pub fn regions(&self) -> &[SearchRegion] {
        &self.regions[..self.count]
    }

    /// Boxes around the regions, wider by `pad` for rounding, with `unit` units of length per metre.
    pub fn boxes(&self, pad: f32, unit: f32) -> ArrayVec<Aabb, MAX_REGIONS> {
        let around = |region: &SearchRegion| {
            let half = Vec3::splat(region.reach(pad));
            Aabb::around([region.center - half, region.center + half].map(|p| unit * p))
        };
        self.regions().iter().map(around).collect()
    }

    /// Whether what `other` finds includes the features of this window.
    pub fn is_within(&self, other: &Self) -> bool {
        let is_found = |region: &SearchRegion| other.regions().iter().any(|other| region.is_within(other));
        // Features agree with the direction of this window, so they overlap along similar directions, too.
        let overlaps = other.direction == Vec3::ZERO || self.direction.distance(other.direction) < MAX_TURN;
        self.regions().iter().all(is_found) && overlaps
    }

    /// The window for features that may move by `distance` and turn by `rotation`, and whose regions may turn, too.
    pub fn grown(&self, distance: f64, rotation: f64) -> Self {
        let mut grown = *self;
        grown
            .regions
            .iter_mut()
            .for_each(|region| region.radius += distance as f32);
        if distance > 0.0 {
            grown.chord += MAX_TURN + AROUND_ERROR * rotation as f32;
        }
        grown
    }
}

impl SearchRegion {
    /// The radius with allowances for rounding; `pad` is the allowance of positions.
    #[inline(always)]
    pub fn reach(&self, pad: f32) -> f32 {
        AROUND_ERROR * self.radius + pad
    }

    /// A ball around all regions.
    fn around(all: impl Iterator<Item = Self> + Clone) -> Self {
        let bounds = all.clone().fold(Aabb::EMPTY, |bounds, region| {
            bounds.union(Aabb::around([
                region.center - region.radius,
                region.center + region.radius,
            ]))
        });
        let center = bounds.center();
        let radii = all.map(|region| region.center.distance(center) + region.radius);
        Self {
            center,
            radius: radii.fold(0.0, f32::max),
            normal: Vec3::ZERO,
        }
    }

    fn is_within(&self, other: &Self) -> bool {
        let turn = self.normal.distance(other.normal);
        self.center.distance(other.center) + self.radius <= other.radius
            && (other.normal == Vec3::ZERO || self.normal != Vec3::ZERO && turn < MAX_TURN)
    }
}

/// The limits of a [`Search`] in single precision, with the slack and allowances for rounding.
pub struct Limits {
    /// Rounding allowance.
    pub pad: f32,
    /// Whether bodies may move before the next search.
    pub has_slack: bool,
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
            has_slack: search.slack.distance > 0.0,
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
