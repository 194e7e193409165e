//! The points of one pair.

use super::contour::{Contours, Patch, Segment};
use super::feature::{Feature, Key, Origin, TrianglePair};
use super::inside;
use super::near::{Near, Setting};
use super::ray::exit;
use super::reduce::Reduction;
use super::side::{PlacedMesh, Side, sides};
use super::smooth;
use crate::manifolds::ManifoldPoint;
use glam::{DMat3, DVec3};

/// How deep features may overlap, in units of the bodies' size; what is deeper is found by rays.
pub(crate) const DEEP: f64 = 0.04;
/// What overlaps by less, in the same unit, touches: rounding must not part bodies that rest on each other.
const TOUCH: f64 = 1.0e-6;
/// Heights over planes are wrong by less, in units of the bounding radii together.
const ROUNDING: f64 = 1.0e-14;
/// How far rays run, in the same unit: through all of the smaller body.
pub(crate) const RAY: f64 = 1.0;
/// A patch that no ray leaves counts if it is larger than this, in units of the size squared,
pub(crate) const LEAST_PROBED_AREA: f64 = 1.0e-6;
/// and is taken for this deep at most.
pub(crate) const SHALLOW: f64 = 0.002;

/// The place in a patch of a point that no ray found; those of rays are smaller.
const MIDDLE: u8 = 5;

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
    /// The points at which the bodies of a pair push each other where their surfaces come as near as `margin`, in the axes of
    /// its first body. A margin that is negative or not a number is none.
    pub fn all(&mut self, pair: &Pair, margin: f32) -> &[Feature] {
        let margin = if margin > 0.0 { margin.min(f32::MAX) } else { 0.0 };
        self.find(&pair.sides, &pair.setting, margin, pair.size);
        &self.features
    }

    /// The few of [`Worker::all`] that say what all say.
    pub fn reduced(&mut self, pair: &Pair, margin: f32) -> &[Feature] {
        self.all(pair, margin);
        self.reduction.run(&mut self.features, pair.size)
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
            let key = patch.key(&contours.segments);
            let places = (0..).zip(patch.places(&contours.segments));
            features.extend(places.filter_map(|(place, p)| {
                let origin = Origin::Patch { place, key };
                probe(sides, patch, p, size, origin)
            }));
            if features.len() == before {
                features.extend(shallow(&contours.segments, patch, size, key));
            }
        }
    }
}

/// Of the faces under which a vertex is, the one through which it came.
fn keep_shallowest(deep: &mut Vec<Feature>) {
    // Vertices first, each from its shallowest face on.
    let key = |f: &Feature| f.vertex().unwrap_or((u8::MAX, 0));
    deep.sort_unstable_by(|p, q| key(p).cmp(&key(q)).then(q.separation.total_cmp(&p.separation)));
    deep.dedup_by(|later, first| later.vertex().is_some() && later.vertex() == first.vertex());
}

/// The point of a patch by rays from `p`, if both leave a body. They start a little before it: a contour around what reaches
/// through a flat face lies in the face, and rounding may have `p` outside.
fn probe(sides: &[Side; 2], patch: &Patch, p: DVec3, size: f64, origin: Origin) -> Option<Feature> {
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
        origin,
    })
}

/// What stands for a patch that no ray leaves, if it is not tiny.
fn shallow(segments: &[Segment], patch: &Patch, size: f64, key: Key) -> Option<Feature> {
    // Twice the area over the length is the radius of a circle.
    let depth = (2.0 * patch.area / patch.length).min(SHALLOW * size);
    let half = patch.normal * (0.5 * depth);
    (patch.area > LEAST_PROBED_AREA * size * size).then(|| Feature {
        points: [patch.center + half, patch.center - half],
        normal: patch.normal,
        separation: -depth,
        triangles: segments[patch.first].triangles,
        origin: Origin::Patch { place: MIDDLE, key },
    })
}

/// Two bodies in the axes of the first.
pub struct Pair<'a> {
    pub sides: [Side<'a>; 2],
    pub setting: Setting,
    /// The smaller one's diameter.
    size: f64,
    /// Out of the first body's axes.
    rotation: DMat3,
}

impl<'a> Pair<'a> {
    /// `one_mesh` is whether both bodies have the same.
    pub fn new([a, b]: [&PlacedMesh<'a>; 2], one_mesh: bool) -> Self {
        let sides = sides([a, b], one_mesh);
        let setting = Setting {
            rotation: (a.frame.rotation.transpose() * b.frame.rotation).as_mat3(),
            translation: sides[1].center.as_vec3(),
            size: a.radius + b.radius,
        };
        Self {
            size: sides[0].diameter().min(sides[1].diameter()),
            setting,
            sides,
            rotation: a.frame.rotation,
        }
    }

    /// What the solver needs to know of a feature, and its arms in double precision.
    pub fn point(&self, feature: &Feature) -> (ManifoldPoint, [DVec3; 2]) {
        let roundness = [0, 1].map(|side| self.roundness(feature, side));
        let smoothed = smooth::smoothed(&self.sides, feature, roundness.map(f64::from));
        let [a, b] = [0, 1].map(|i| feature.points[i] + smoothed.slides[i]);
        let arms = [a, b - self.sides[1].center].map(|arm| self.rotation * arm);
        let point = ManifoldPoint {
            arms: arms.map(|arm| arm.as_vec3()),
            normal: (self.rotation * smoothed.normal).normalize().as_vec3(),
            separation: feature.separation as f32,
            roundness,
            turn: smoothed.turn as f32,
            faces: [0, 1].map(|i| self.sides[i].face(feature.triangles[i])),
        };
        (point, arms)
    }

    /// Of one body's surface at the feature.
    fn roundness(&self, feature: &Feature, side: usize) -> f32 {
        let own = &self.sides[side];
        let roundness = own.features.curvature_radii[feature.triangles[side] as usize];
        let is_face = feature.vertex().is_some_and(|(of, _)| usize::from(of) != side);
        if is_face && roundness == 0.0 {
            // Between creases a face is flat.
            f32::INFINITY
        } else {
            roundness * own.scale.abs().element_sum() / 3.0
        }
    }
}
