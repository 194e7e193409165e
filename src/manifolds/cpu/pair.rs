//! The points of one pair.

use super::contour::{Contours, Patch, Segment};
use super::feature::{Feature, TrianglePair};
use super::inside;
use super::near::{Near, Setting};
use super::ray::exit;
use super::reduce::Reduction;
use super::side::{Side, sides};
use super::smooth;
use crate::manifolds::{ManifoldPoint, MarginPair};
use crate::state::Bodies;
use crate::state::mesh_arena::MeshArena;
use glam::{DMat3, DVec3};

/// How deep features may overlap, in units of the bodies' size; what is deeper is found by rays.
const DEEP: f64 = 0.04;
/// What overlaps by less, in the same unit, touches: rounding must not part bodies that rest on each other.
const TOUCH: f64 = 1.0e-6;
/// Heights over planes are wrong by less, in units of the bounding radii together.
const ROUNDING: f64 = 1.0e-14;
/// How far rays run, in the same unit: through all of the smaller body.
const RAY: f64 = 1.0;
/// A patch that no ray leaves counts if it is larger than this, in units of the size squared,
const LEAST_AREA: f64 = 1.0e-6;
/// and is taken for this deep at most.
const SHALLOW: f64 = 0.002;

/// Memory kept between pairs.
#[derive(Default)]
pub struct Worker {
    near: Near,
    contours: Contours,
    features: Vec<Feature>,
    deep: Vec<Feature>,
    reduction: Reduction,
}

impl Worker {
    /// Appends the points of a pair.
    pub fn run(&mut self, bodies: &Bodies, meshes: &MeshArena, pair: &MarginPair, points: &mut Vec<ManifoldPoint>) {
        let Some(sides) = sides(bodies, meshes, pair.bodies) else {
            return;
        };
        let [a, b] = pair.bodies.map(|i| i as usize);
        let frame = &bodies.frame[a];
        let setting = Setting {
            rotation: (frame.rotation.transpose() * bodies.frame[b].rotation).as_mat3(),
            translation: sides[1].center.as_vec3(),
            size: bodies.radius[a] + bodies.radius[b],
        };
        let size = sides[0].diameter().min(sides[1].diameter());
        // Not a number is no margin.
        let margin = if pair.margin > 0.0 {
            pair.margin.min(f32::MAX)
        } else {
            0.0
        };
        self.find(&sides, &setting, margin, size);
        let faces = |t: [u32; 2]| [sides[0].face(t[0]), sides[1].face(t[1])];
        let to_world = World {
            rotation: frame.rotation,
            center_b: sides[1].center,
            sides: &sides,
        };
        let chosen = self.reduction.run(&mut self.features, size);
        points.extend(chosen.iter().map(|f| to_world.point(f, faces(f.triangles))));
    }

    /// Fills `features`.
    fn find(&mut self, sides: &[Side; 2], setting: &Setting, margin: f32, size: f64) {
        let Self {
            near,
            contours,
            features,
            deep,
            ..
        } = self;
        features.clear();
        contours.clear();
        let reach = f64::from(margin);
        let touch = TOUCH * size;
        let rounding = ROUNDING * f64::from(setting.size);
        let range = -touch..=reach;
        near.run(sides, setting, margin + touch as f32, None);
        for triangles in near.pairs() {
            if let Some(pair) = TrianglePair::new(sides, triangles, reach + touch) {
                pair.features(&range, |feature| features.push(feature));
                contours.segments.extend(pair.segment(rounding));
            }
        }
        if contours.segments.is_empty() {
            if let Some(contact) = inside::contact(sides) {
                features.clear();
                features.push(contact);
            }
            return;
        }

        contours.join(reach, size);
        features.retain(|feature| contours.admit(feature, false));
        if contours.patches.is_empty() {
            return;
        }
        deep.clear();
        let most = DEEP * size;
        let range = -most..=-touch;
        // With a wide margin all pairs are known.
        if most > reach {
            let window = contours.window(0.5 * most);
            near.run(sides, setting, most as f32, Some(&window));
        }
        for triangles in near.pairs() {
            if let Some(pair) = TrianglePair::new(sides, triangles, most) {
                pair.features(&range, |feature| {
                    if contours.admit(&feature, true) {
                        deep.push(feature);
                    }
                });
            }
        }
        keep_shallowest(deep);
        deep.iter().for_each(|feature| contours.keep(feature));
        features.append(deep);
        for patch in contours.patches.iter().filter(|patch| !patch.kept) {
            let before = features.len();
            let places = patch.places(&contours.segments);
            features.extend(places.into_iter().filter_map(|p| probe(sides, patch, p, size)));
            if features.len() == before {
                features.extend(shallow(&contours.segments, patch, size));
            }
        }
    }
}

/// Of the faces under which a vertex is, the one through which it came.
fn keep_shallowest(deep: &mut Vec<Feature>) {
    // Vertices first, each from its shallowest face on.
    let key = |f: &Feature| f.vertex.map_or((u8::MAX, 0), |v| v);
    deep.sort_unstable_by(|p, q| key(p).cmp(&key(q)).then(q.separation.total_cmp(&p.separation)));
    deep.dedup_by(|later, first| later.vertex.is_some() && later.vertex == first.vertex);
}

/// The point of a patch by rays from `p`, if both leave a body. They start a little before it: a contour around what reaches
/// through a flat face lies in the face, and rounding may have `p` outside.
fn probe(sides: &[Side; 2], patch: &Patch, p: DVec3, size: f64) -> Option<Feature> {
    let (n, back) = (patch.normal, TOUCH * size);
    let most = RAY * size + back;
    let (up, a) = exit(&sides[0], p - n * back, n, most)?;
    let (down, b) = exit(&sides[1], p + n * back, -n, most)?;
    let (up, down) = (up - back, down - back);
    Some(Feature {
        points: [p + n * up, p - n * down],
        normal: n,
        separation: -(up + down),
        triangles: [a, b],
        vertex: None,
    })
}

/// What stands for a patch that no ray leaves, if it is not tiny.
fn shallow(segments: &[Segment], patch: &Patch, size: f64) -> Option<Feature> {
    // Twice the area over the length is the radius of a circle.
    let depth = (2.0 * patch.area / patch.length).min(SHALLOW * size);
    let half = patch.normal * (0.5 * depth);
    (patch.area > LEAST_AREA * size * size).then(|| Feature {
        points: [patch.center + half, patch.center - half],
        normal: patch.normal,
        separation: -depth,
        triangles: segments[patch.first].triangles,
        vertex: None,
    })
}

/// Out of the first body's axes.
struct World<'a> {
    rotation: DMat3,
    center_b: DVec3,
    sides: &'a [Side<'a>; 2],
}

impl World<'_> {
    fn point(&self, feature: &Feature, faces: [u32; 2]) -> ManifoldPoint {
        let roundness = [0, 1].map(|side| self.roundness(feature, side));
        let smoothed = smooth::smoothed(self.sides, feature, roundness.map(f64::from));
        let [a, b] = [0, 1].map(|i| feature.points[i] + smoothed.slides[i]);
        ManifoldPoint {
            arms: [a, b - self.center_b].map(|arm| (self.rotation * arm).as_vec3()),
            normal: (self.rotation * smoothed.normal).normalize().as_vec3(),
            separation: feature.separation as f32,
            roundness,
            turn: smoothed.turn as f32,
            faces,
        }
    }

    /// Of one body's surface at the feature.
    fn roundness(&self, feature: &Feature, side: usize) -> f32 {
        let own = &self.sides[side];
        let roundness = own.features.curvature_radii[feature.triangles[side] as usize];
        let is_face = feature.vertex.is_some_and(|(of, _)| usize::from(of) != side);
        if is_face && roundness == 0.0 {
            // Between creases a face is flat.
            f32::INFINITY
        } else {
            roundness * own.scale.abs().element_sum() / 3.0
        }
    }
}
