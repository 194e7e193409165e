//! Intersection contours: the segments in which triangles cross, joined, and the patches that closed contours enclose.

use super::crossing::{Key, Segment};
use super::feature::Feature;
use super::rim::{Rim, RimEnd};
use super::search::{SearchRegion, Window};
use super::side::Side;
use crate::geometry::union_find::UnionFind;
use glam::DVec3;

/// Least cosine between the normals of a patch and of a feature that agrees with it.
pub(crate) const MIN_AGREEMENT: f64 = 0.7;
/// Position of the outer probes of a patch, on the way from its centre to the extremes of its contour.
pub(crate) const PROBE_FRACTION: f64 = 0.75;
/// Reach of a patch, in radii of its contour.
pub(crate) const REACH_FACTOR: f64 = 1.3;
/// Contours of a smaller area, in units of the square of the bodies' size, have no direction.
pub(crate) const MIN_ENCLOSED_AREA: f64 = 1.0e-12;

/// Loose ends of contours closer than this, in units of the bodies' size, are the same point.
const TIE: f64 = 1.0e-6;

/// A patch: the part of both surfaces inside a closed contour.
#[derive(Clone, Copy, Debug)]
pub struct Patch {
    pub center: DVec3,
    /// Unit vector from the first body to the second.
    pub normal: DVec3,
    pub area: f64,
    /// Length of the contour.
    pub length: f64,
    /// Distance from the centre up to which features belong to the patch.
    pub reach: f64,
    /// Range of its segments in [`Contours::segments`].
    pub first: usize,
    pub end: usize,
    /// Whether an overlapping feature of it is kept.
    pub kept: bool,
    /// The bodies overlap at its centre by more than features may. It has no overlapping features.
    pub too_deep: bool,
    /// The rim of an open mesh at which the contour ends.
    pub rim: Option<Rim>,
}

/// The result, and memory kept between pairs.
#[derive(Default)]
pub struct Contours {
    /// Segments in the order found; after [`Contours::join`] grouped by contour.
    pub segments: Vec<Segment>,
    pub patches: Vec<Patch>,
    ends: FirstEnds,
    /// Whether each end meets another at its crossing. End `i` is the start of segment `i / 2` if `i` is even.
    has_partner: Vec<bool>,
    /// Ends without a partner, with their segments.
    loose: Vec<(DVec3, u32)>,
    /// Ends at rims of open meshes: of all contours, and of one.
    rims: Vec<RimEnd>,
    own_rims: Vec<RimEnd>,
    joined: UnionFind,
    /// The root of each segment's contour in the upper half, and the segment's number.
    order: Vec<u64>,
    sorted: Vec<Segment>,
}

/// The first segment's end at each crossing, by the crossing's key: a hash table with open addressing. A contour has
/// dozens of segments, and this takes half the time of sorting their ends.
#[derive(Default)]
struct FirstEnds {
    /// Keys and numbers of ends, the latter [`NO_END`] if a slot is empty. The number of slots is a power of two.
    slots: Vec<(Key, u32)>,
}

/// An empty slot of [`FirstEnds`].
const NO_END: u32 = u32::MAX;

impl FirstEnds {
    /// Empties the table and makes room for `ends` ends.
    fn reset(&mut self, ends: usize) {
        self.slots.clear();
        self.slots
            .resize((2 * ends).next_power_of_two(), (Key::default(), NO_END));
    }

    /// The first end at the crossing of this key; `None` if it is `end`, which is noted.
    #[inline]
    fn first(&mut self, key: Key, end: u32) -> Option<u32> {
        // Multiplicative hashing (Knuth 1998, The Art of Computer Programming 3, 6.4): the upper bits are mixed best.
        let hash = key.number().wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32;
        let mask = self.slots.len() - 1;
        let mut at = hash as usize & mask;
        loop {
            match self.slots[at] {
                (_, NO_END) => {
                    self.slots[at] = (key, end);
                    return None;
                }
                (other, first) if other == key => return Some(first),
                _ => at = (at + 1) & mask,
            }
        }
    }
}

impl Contours {
    pub fn clear(&mut self) {
        self.segments.clear();
        self.patches.clear();
    }

    /// Joins the segments of two bodies into contours and patches. `size` is the size of the bodies.
    pub fn join(&mut self, sides: &[Side; 2], margin: f64, size: f64) {
        self.joined.reset(self.segments.len());
        let ends = 2 * self.segments.len() as u32;
        self.ends.reset(ends as usize);
        self.has_partner.clear();
        self.has_partner.resize(ends as usize, false);
        let segments = &self.segments;
        for (end, &key) in (0..).zip(segments.iter().flat_map(|segment| &segment.keys)) {
            if let Some(first) = self.ends.first(key, end) {
                self.joined.join(first / 2, end / 2);
                self.has_partner[first as usize] = true;
                self.has_partner[end as usize] = true;
            }
        }
        self.loose.clear();
        self.rims.clear();
        for end in (0..ends as usize).filter(|&end| !self.has_partner[end]) {
            self.loose.push((segments[end / 2].ends[end % 2], end as u32 / 2));
            self.rims.extend(RimEnd::of(sides, segments, end));
        }
        self.tie_loose_ends(TIE * size);
        self.order.clear();
        for i in 0..self.segments.len() as u32 {
            self.order.push(u64::from(self.joined.root(i)) << 32 | u64::from(i));
        }
        self.order.sort_unstable();
        self.sorted.clear();
        self.sorted
            .extend(self.order.iter().map(|&segment| self.segments[segment as u32 as usize]));
        std::mem::swap(&mut self.sorted, &mut self.segments);

        let mut first = 0;
        for run in self.order.chunk_by(|x, y| x >> 32 == y >> 32) {
            let end = first + run.len();
            self.own_rims.clear();
            for rim in &self.rims {
                if self.joined.root(rim.segment) == (run[0] >> 32) as u32 {
                    self.own_rims.push(*rim);
                }
            }
            let rim = Rim::new(sides, &self.segments[first..end], &self.own_rims, size);
            if let Some(patch) = Patch::new(&self.segments, first, end, margin, size, rim) {
                self.patches.push(patch);
            }
            first = end;
        }
    }

    /// Joins loose ends by position. Rounding may break a contour where corners of one body lie on edges of the other.
    fn tie_loose_ends(&mut self, reach: f64) {
        self.loose
            .sort_unstable_by(|p, q| p.0.x.total_cmp(&q.0.x).then(p.1.cmp(&q.1)));
        for (n, &(p, i)) in self.loose.iter().enumerate() {
            for &(q, j) in self.loose[n + 1..].iter().take_while(|(q, _)| q.x - p.x <= reach) {
                if p.distance_squared(q) <= reach * reach {
                    self.joined.join(i, j);
                }
            }
        }
    }

    /// Whether a feature counts. Overlapping features need a patch nearby that is not deep, and all patches nearby must
    /// agree with the feature.
    pub fn admits(&self, feature: &Feature, overlaps: bool) -> bool {
        let mut any = false;
        for patch in self.patches.iter().filter(|patch| patch.is_near(feature)) {
            any |= !patch.too_deep;
            if feature.normal.dot(patch.normal) < MIN_AGREEMENT {
                return false;
            }
        }
        any || !overlaps
    }

    /// Marks the patches of an overlapping feature that is kept. Deep ones have no such features.
    pub fn keep(&mut self, feature: &Feature) {
        for patch in self.patches.iter_mut().filter(|patch| patch.is_near(feature)) {
            patch.kept = !patch.too_deep;
        }
    }

    /// The window of triangles with overlapping features: near patches that are not deep. Triangles lie up to `half`
    /// from the feature's middle.
    pub fn window(&self, half: f64) -> Window {
        let shallow = self.patches.iter().filter(|patch| !patch.too_deep);
        let regions = shallow.map(|patch| SearchRegion {
            center: patch.center.as_vec3(),
            radius: (patch.reach + half) as f32,
            normal: patch.normal.as_vec3(),
        });
        Window::new(regions, MIN_AGREEMENT)
    }
}

impl Patch {
    /// `None` if the contour encloses no area and has no `rim`.
    fn new(
        segments: &[Segment],
        first: usize,
        end: usize,
        margin: f64,
        size: f64,
        rim: Option<(Rim, DVec3)>,
    ) -> Option<Self> {
        let own = &segments[first..end];
        // Sums are relative to the first point, for precision.
        let origin = own[0].ends[0];
        let (mut length, mut middle) = (0.0, DVec3::ZERO);
        for Segment { ends: [p, q], .. } in own {
            let step = p.distance(*q);
            length += step;
            middle += ((*p - origin) + (*q - origin)) * (0.5 * step);
        }
        let center = origin + middle / length;
        let (mut area, mut radius) = (DVec3::ZERO, 0.0f64);
        for Segment { ends: [p, q], .. } in own {
            area += (*p - center).cross(*q - *p) * 0.5;
            radius = radius.max(p.distance_squared(center)).max(q.distance_squared(center));
        }
        let size = area.length() / (size * size);
        let (rim, of_rim) = rim.unzip();
        (rim.is_some() || size > MIN_ENCLOSED_AREA).then(|| Self {
            center,
            normal: of_rim.unwrap_or_else(|| area.normalize()),
            area: area.length(),
            length,
            reach: REACH_FACTOR * radius.sqrt() + margin,
            first,
            end,
            kept: false,
            too_deep: false,
            rim,
        })
    }

    fn is_near(&self, feature: &Feature) -> bool {
        feature.middle().distance_squared(self.center) < self.reach * self.reach
    }

    /// Four points in the patch: the extremes of the contour in directions perpendicular to the normal, moved to its
    /// centre by a quarter. The first extreme is the farthest from the centre, so the order of the bodies does not
    /// matter.
    pub fn outer_places(&self, segments: &[Segment]) -> [DVec3; 4] {
        let offsets = || {
            segments[self.first..self.end]
                .iter()
                .map(|segment| segment.ends[0] - self.center)
        };
        let mut first = (f64::NEG_INFINITY, DVec3::ZERO);
        for offset in offsets() {
            let reach = offset.reject_from_normalized(self.normal).length_squared();
            if reach > first.0 {
                first = (reach, offset);
            }
        }
        let first = first.1;
        let across = self.normal.cross(first);
        let mut others = [(f64::NEG_INFINITY, DVec3::ZERO); 3];
        for offset in offsets() {
            let aside = offset.dot(across);
            for (other, reach) in others.iter_mut().zip([-offset.dot(first), aside, -aside]) {
                if reach > other.0 {
                    *other = (reach, offset);
                }
            }
        }
        let [second, third, fourth] = others.map(|(_, offset)| offset);
        let offsets = [first, second, third, fourth];
        offsets.map(|p| self.center + p * PROBE_FRACTION)
    }
}
