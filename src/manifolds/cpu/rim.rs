//! Overlaps at the rims of open meshes. A contour that ends at a rim encloses nothing, so it has no area whose normal
//! would separate the bodies. A rim within the other body leaves it through the other body's surface along the contour.
//! Two rims that have crossed part along the contour.

use super::crossing::Segment;
use super::feature::{Feature, Origin};
use super::pair::MAX_DEPTH;
use super::side::Side;
use crate::geometry::features::NONE;
use glam::DVec3;

/// The mean of the other surface's normals says nothing if it is shorter than this.
pub(crate) const MIN_MEAN: f64 = 0.1;
/// The depth of a parabola halfway from its middle to its ends.
pub(crate) const HALFWAY_DEPTH: f64 = 0.75;
/// Points on a rim: in the middle of the part within the other body, and halfway to both of its ends, with the depth of
/// a parabola.
const ON_RIM: [(f64, f64); 3] = [(0.0, 1.0), (0.5, HALFWAY_DEPTH), (-0.5, HALFWAY_DEPTH)];

/// An end of a contour at a rim.
#[derive(Clone, Copy, Debug)]
pub struct RimEnd {
    pub at: DVec3,
    /// The body whose rim it is, and the rim's edge.
    pub side: usize,
    pub edge: u32,
    pub segment: u32,
}

/// The part of a rim that is in the other body.
#[derive(Clone, Copy, Debug)]
pub struct Rim {
    pub side: usize,
    /// Middle of the part within the other body.
    middle: DVec3,
    /// From the middle to one end.
    half: DVec3,
    depth: f64,
}

impl RimEnd {
    /// The end of a segment, if it is at a rim.
    pub fn of(sides: &[Side; 2], segments: &[Segment], end: usize) -> Option<Self> {
        let number = end / 2;
        let segment = &segments[number];
        let (side, edge) = segment.keys[end % 2].edge();
        let features = sides[side].features;
        let is_rim = features.across[edge as usize] == NONE;
        let is_sheet = !features.one_sided.is(segment.triangles[side] as usize);
        (is_rim && is_sheet).then_some(Self {
            at: segment.ends[end % 2],
            side,
            edge,
            segment: number as u32,
        })
    }
}

impl Rim {
    /// The rim of a contour with these ends, and the normal, from the first body to the second. `size` is the size of
    /// the bodies.
    pub fn new(sides: &[Side; 2], segments: &[Segment], ends: &[RimEnd], size: f64) -> Option<(Self, DVec3)> {
        let mean = |side: usize| {
            let own = ends.iter().filter(|end| end.side == side);
            let count = own.clone().count();
            (count > 0).then(|| own.map(|end| end.at).sum::<DVec3>() / count as f64)
        };
        let (side, middle) = match [mean(0), mean(1)] {
            [Some(a), Some(b)] => {
                let rim = Self {
                    side: 0,
                    middle: a,
                    half: DVec3::ZERO,
                    depth: a.distance(b),
                };
                return Some((rim, (a - b).try_normalize()?));
            }
            [Some(a), None] => (0, a),
            [None, Some(b)] => (1, b),
            [None, None] => return None,
        };
        let out = way_out(&sides[1 - side], segments, 1 - side, middle)?;
        let points = segments.iter().flat_map(|segment| segment.ends);
        let depth = points.map(|p| out.dot(p - middle)).fold(0.0, f64::max);
        // A rim that has passed a flat face ends there with its corners.
        let corners = ends.iter().filter_map(|end| {
            let own = &sides[side];
            let triangle = segments
                .iter()
                .find(|segment| segment.ends.contains(&end.at))?
                .triangles[side] as usize;
            let k = own.features.triangle_edges[triangle]
                .iter()
                .position(|edge| *edge == end.edge)?;
            let corners = own.features.triangles[triangle];
            let below = [corners[k], corners[(k + 1) % 3]].map(|v| out.dot(end.at - own.vertex(v)));
            Some(below[0].max(below[1]))
        });
        let beyond = corners.fold(0.0, f64::max).min(MAX_DEPTH * size);
        let rim = Self {
            side,
            middle,
            half: ends[0].at - middle,
            depth: depth.max(beyond),
        };
        Some((rim, if side == 0 { -out } else { out }))
    }

    /// Appends its contact points.
    pub fn points(&self, normal: DVec3, triangles: [u32; 2], number: u32, features: &mut Vec<Feature>) {
        for (place, (along, part)) in (0..).zip(ON_RIM) {
            let at = self.middle + self.half * along;
            let way = normal * (part * self.depth);
            let points = if self.side == 0 { [at, at - way] } else { [at + way, at] };
            features.push(Feature {
                points,
                normal,
                separation: -part * self.depth,
                triangles,
                origin: Origin::Patch { place, number },
            });
            if self.half == DVec3::ZERO {
                break;
            }
        }
    }
}

/// The direction in which a rim within a body leaves it: the mean of the body's normals along the contour, or from the
/// rim's `middle` to the contour's.
fn way_out(other: &Side, segments: &[Segment], number: usize, middle: DVec3) -> Option<DVec3> {
    let (mut sum, mut center, mut length) = (DVec3::ZERO, DVec3::ZERO, 0.0);
    for segment in segments {
        let [p, q] = segment.ends;
        let step = p.distance(q);
        sum += other.normal(segment.triangles[number]) * step;
        center += (p + q) * (0.5 * step);
        length += step;
    }
    if sum.length() > MIN_MEAN * length {
        return sum.try_normalize();
    }
    (center / length - middle).try_normalize()
}
