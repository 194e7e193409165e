//! Pairs with a core without faces: a segment or a point. Their features are found by one descent of the other body's
//! tree, and closed forms.
//!
//! While the core is outside of the other body, its features are all there is. A segment that has pierced the other's
//! surface has no contour; its end is pushed back out. A core inside a closed mesh is pushed out as other bodies are.

use super::feature::{Feature, OUTSIDE, Origin, TrianglePair};
use super::feature_bits::{FACE_BIT, owned_features};
use super::inside;
use super::near_features::NearFeatures;
use super::side::{Side, Triangle, rounding};
use crate::geometry::cluster::CLUSTER;
use crate::geometry::distance::{closest, nearest};
use crate::simd::bounds::{Boxes, Near};
use crate::simd::lanes::{Simd, bits, splat_point};
use crate::simd::level::with_simd;
use crate::simd::levels::visit;
use crate::simd::rounding::PAD;
use crate::state::mesh_arena::BoxGroup;
use crate::state::pairs::DEFAULT_DIRECTION;
use glam::DVec3;
use std::ops::RangeInclusive;

/// The search of a pair, and memory kept between pairs.
#[derive(Default)]
pub struct ThinSearch {
    candidates: Vec<u32>,
    nearest: NearFeatures,
}

/// What was found besides features.
struct Found {
    /// The least distance of the cores.
    least: f64,
    /// The feature that pushes a segment out of the faces that it pierces.
    pierced: Option<Feature>,
}

impl ThinSearch {
    /// Writes the features within `margin` of two bodies, one of which is thin. Overlaps up to `touch` count as
    /// touching.
    pub fn find(&mut self, sides: &[Side; 2], margin: f64, touch: f64, features: &mut Vec<Feature>) {
        features.clear();
        let Some(thin) = sides.iter().position(Side::is_thin) else {
            return;
        };
        if let [Some(a), Some(b)] = sides.each_ref().map(Side::point) {
            features.extend(between_points([a, b], margin));
            return;
        }
        self.collect(sides, thin, margin + touch);
        let found = self.features(sides, thin, &(-touch..=margin), features);
        if found.pierced.is_some() {
            features.extend(found.pierced);
            return;
        }
        // The nearest surface has no feature on its inner side.
        let is_outside = features
            .iter()
            .any(|feature| feature.points[0].distance(feature.points[1]) <= found.least + touch);
        if !is_outside && let Some(contact) = inside::contact(sides) {
            features.clear();
            features.push(contact);
        }
    }

    /// Lists the triangles of the other side whose boxes are within `reach` of the thin core.
    fn collect(&mut self, sides: &[Side; 2], thin: usize, reach: f64) {
        let candidates = &mut self.candidates;
        candidates.clear();
        let other = &sides[1 - thin];
        if other.is_thin() {
            candidates.push(0);
            return;
        }
        with_simd!(simd => collect(simd, &sides[thin], other, reach, candidates));
    }

    /// Adds the features with these candidates whose separation is in `range`.
    fn features(
        &mut self,
        sides: &[Side; 2],
        thin: usize,
        range: &RangeInclusive<f64>,
        features: &mut Vec<Feature>,
    ) -> Found {
        let Self { candidates, nearest } = self;
        nearest.clear();
        nearest.set_limits(*range.end(), 0.0, rounding(sides) > 0.0);
        let own = sides[thin].triangle(0);
        let owned_by_thin = sides[thin].features.owned[0];
        let mut found = Found {
            least: f64::INFINITY,
            pierced: None,
        };
        for &number in &*candidates {
            let face = sides[1 - thin].triangle(number);
            let both = if thin == 0 { [&own, &face] } else { [&face, &own] };
            let Some(pair) = TrianglePair::new(sides, both, *range.end()) else {
                continue;
            };
            let owned = sides[1 - thin].features.owned[number as usize] | FACE_BIT;
            let owned = if thin == 0 {
                [owned_by_thin, owned]
            } else {
                [owned, owned_by_thin]
            };
            pair.features(range, owned_features(owned), |feature| features.push(feature));
            nearest.add(&pair);
            found.least = found.least.min(distance(&own, &face));
            let out = pierced(&sides[thin], &own, &face, thin);
            let depth = |feature: &Option<Feature>| feature.map_or(f64::NEG_INFINITY, |feature| feature.separation);
            if depth(&out) > depth(&found.pierced) {
                found.pierced = out;
            }
        }
        nearest.append_to(features);
        found
    }
}

/// The feature of two points no farther apart than `most`.
fn between_points([a, b]: [DVec3; 2], most: f64) -> Option<Feature> {
    let way = b - a;
    let distance = way.length();
    (distance <= most).then(|| Feature {
        points: [a, b],
        normal: if distance > 0.0 {
            way / distance
        } else {
            DEFAULT_DIRECTION
        },
        separation: distance,
        triangles: [0; 2],
        origin: Origin::Vertices([0; 2]),
    })
}

fn distance(thin: &Triangle, face: &Triangle) -> f64 {
    let [start, _, end] = thin.corners;
    if start == end {
        closest(start, &face.corners).distance(start)
    } else {
        nearest(&face.corners, &thin.corners).distance
    }
}

/// The feature that pushes a segment out of a face that it pierces: of its end behind the face.
fn pierced(side: &Side, own: &Triangle, face: &Triangle, thin: usize) -> Option<Feature> {
    let ends = [own.corners[0], own.corners[2]];
    let heights = ends.map(|end| face.normal.dot(end - face.corners[0]));
    if (heights[0] < 0.0) == (heights[1] < 0.0) {
        return None;
    }
    let at = ends[0] + (ends[1] - ends[0]) * (heights[0] / (heights[0] - heights[1]));
    let inside = (0..3).all(|k| {
        let (p, q) = (face.corners[k], face.corners[(k + 1) % 3]);
        // A point on the edge of two faces is in one of them at least.
        (q - p).cross(at - p).dot(face.normal) * face.winding_sign >= -OUTSIDE * (q - p).length_squared()
    });
    let behind = usize::from(heights[1] < 0.0);
    let (end, separation) = (ends[behind], heights[behind]);
    let foot = end - face.normal * separation;
    let (points, normal, triangles) = if thin == 0 {
        ([end, foot], -face.normal, [own.number, face.number])
    } else {
        ([foot, end], face.normal, [face.number, own.number])
    };
    inside.then(|| Feature {
        points,
        normal,
        separation,
        triangles,
        origin: Origin::Vertex {
            side: thin as u8,
            vertex: side.features.triangles[0][2 * behind],
        },
    })
}

/// Lists the triangles of a side whose boxes are within `reach` of a thin core's.
#[inline(always)]
fn collect<S: Simd>(simd: S, thin: &Side, other: &Side, reach: f64, candidates: &mut Vec<u32>) {
    let (mesh, lanes) = (&other.mesh, other.mesh.lanes());
    let center = mesh.mass.center.as_dvec3();
    // In the axes of the other's mesh, scaled, about its centre of mass.
    let [start, end] = [0, 2].map(|k| {
        let vertex = thin.vertex(thin.features.triangles[0][k]);
        (other.to_mesh(vertex) - center) * other.scale.as_dvec3()
    });
    let pad = PAD * (other.diameter() + thin.diameter()) as f32;
    let near = Near::new(simd, 0.5 * (start + end), (0.5 * (end - start)).abs(), pad);
    let (scales, reach) = (splat_point(simd, other.scale), (reach * (1.0 + 1.0e-6)) as f32);
    let met = |group: &BoxGroup| near.bounds(&Boxes::of(simd, group).scaled(scales), reach).1;
    visit(&lanes.levels, met, |number| {
        let cluster = &lanes.clusters[number as usize];
        let boxes = Boxes::of_triangles(simd, cluster, mesh.mass.center).scaled(scales);
        let (_, met) = near.bounds(&boxes, reach);
        let first = number * CLUSTER as u32;
        candidates.extend(bits(met).map(|lane| first + lane as u32));
        true
    });
}
