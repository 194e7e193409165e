//! Contact generation of one pair: its features, contours and reduced manifold.

use super::arrival::{Arrival, PairMotion};
use super::contour::{Contours, Patch};
use super::crossing::Segment;
use super::deepest::farthest;
use super::feature::{Feature, Origin};
use super::feature_finder::FeatureFinder;
use super::inside;
use super::kept::{Kept, Source};
use super::near_clusters::PairPose;
use super::ray::exits;
use super::reduce::Reduction;
use super::search::FeatureQuery;
use super::side::{Side, rounding, sides};
use super::smooth;
use super::thin::ThinSearch;
use crate::manifolds::{MAX_POINTS, ManifoldPoint};
use crate::state::PlacedMesh;
use glam::{DMat3, DVec3};
use std::array;

/// Largest overlap of features, in units of the bodies' size. Deeper overlaps are found by rays. The search for
/// features takes time with the depth: with 0.04 in place of 0.025, contact points of knots take a sixth more.
pub(crate) const MAX_DEPTH: f64 = 0.025;
/// A smaller overlap, in the same unit, counts as touching, so that rounding does not drop contacts of resting bodies.
const TOUCH: f64 = 1.0e-6;
/// Bound of the error of heights over planes, in units of the sum of the bounding radii.
pub(super) const ROUNDING: f64 = 1.0e-14;
/// Length of rays, in the same unit: through all of the smaller body.
pub(crate) const RAY_LENGTH: f64 = 1.0;
/// A patch without ray hits counts if its area is larger than this, in units of the size squared.
pub(crate) const MIN_PROBED_AREA: f64 = 1.0e-6;
/// Upper bound of the depth of such a patch, in units of the size.
pub(crate) const SHALLOW: f64 = 0.002;

/// Points of smooth surfaces are one if they are closer than this, in units of the size, and their normals too.
pub(crate) const SAME_CONTACT: f64 = 1.0e-3;

/// The `place` of a point that stands for a patch without ray hits. Rays in the patch have smaller ones.
const MIDDLE: u8 = 5;
/// The `place` of the point where the first body reaches deepest. The second body has the next one.
const DEEPEST: u8 = 6;
/// How far to the side of a patch, in units of its depth there, a vertex may lie that belongs to it.
pub(crate) const ASIDE: f64 = 2.0;
/// A vertex counts if it is deeper than the ray through the patch's middle by this factor: on a ball it is hardly
/// deeper.
pub(crate) const DEEPER: f64 = 1.02;

/// Memory kept between pairs.
#[derive(Default)]
pub struct Worker {
    finder: FeatureFinder,
    thin: ThinSearch,
    contours: Contours,
    features: Vec<Feature>,
    deep: Vec<Feature>,
    /// For each patch, the rays through its centre.
    middles: Vec<Option<Probe>>,
    /// For each patch, the rays through the deepest vertices, and where they start.
    deepest: Vec<[Option<(DVec3, Probe)>; 2]>,
    reduction: Reduction,
    /// The features of a pair at rest.
    pub resting: Vec<Feature>,
    /// Number of calls of [`Worker::all`].
    pub searches: usize,
}

impl Worker {
    /// All contact features of a pair within `margin`, in the axes of its first body. A margin that is negative or NaN
    /// counts as 0. A large pair is shared out over so many threads of the current pool. The result depends neither on
    /// them nor on what is kept.
    pub fn all(&mut self, pair: &Pair, margin: f32, kept: &mut Kept, threads: usize) -> &[Feature] {
        let margin = if margin > 0.0 { margin.min(f32::MAX) } else { 0.0 };
        let rounding = pair.rounding();
        self.searches += 1;
        self.find(pair, f64::from(margin) + rounding, kept, threads);
        if !pair.sides.iter().any(Side::is_thin) {
            kept.near.limit();
            kept.deep.limit();
        }
        if rounding > 0.0 {
            self.features
                .iter_mut()
                .for_each(|feature| feature.separation -= rounding);
        }
        &self.features
    }

    /// The reduced manifold of a pair: the features of [`Worker::all`] that represent all.
    pub fn reduced(&mut self, pair: &Pair, margin: f32, kept: &mut Kept, threads: usize) -> &[Feature] {
        self.all(pair, margin, kept, threads);
        self.reduction.run(&mut self.features, pair.size)
    }

    /// The reduced manifold of a pair in motion, of the features that count, and whether others were dropped; see
    /// [`Arrival`].
    pub fn reduced_in_motion(
        &mut self,
        pair: &Pair,
        margin: f32,
        motion: &PairMotion,
        kept: &mut Kept,
        threads: usize,
    ) -> (&[Feature], bool) {
        let count = self.all(pair, margin, kept, threads).len();
        let mut arrival = Arrival::new(pair, motion);
        self.features.retain(|feature| arrival.counts(feature));
        let dropped = self.features.len() < count;
        (self.reduction.run(&mut self.features, pair.size), dropped)
    }

    /// Writes all features of the pair.
    fn find(&mut self, pair: &Pair, margin: f64, kept: &mut Kept, threads: usize) {
        let Self {
            finder,
            thin,
            contours,
            features,
            ..
        } = self;
        let Pair { sides, size, .. } = pair;
        let touch = TOUCH * size;
        if sides.iter().any(Side::is_thin) {
            thin.find(sides, margin, touch, features);
            return;
        }
        let query = FeatureQuery {
            margin,
            range: -touch..=margin,
            reach: margin + touch,
            window: None,
            nearest: true,
        };
        let source = finder.find(pair, &query, &mut kept.near, threads, |_| true);
        let fraction = match source {
            Source::Kept { fraction, .. } => fraction,
            Source::Search(_) => {
                kept.was_apart = false;
                0
            }
        };
        finder.features(features);
        contours.clear();
        finder.segments(&mut contours.segments);
        if contours.segments.is_empty() {
            // Without a crossing on the way, nothing has got inside since the search.
            let has_not_crossed = !kept.near.may_cross(fraction);
            if kept.was_apart && has_not_crossed {
                return;
            }
            if let Some(contact) = inside::contact(sides) {
                features.clear();
                features.push(contact);
            } else {
                kept.was_apart |= has_not_crossed;
            }
            return;
        }
        contours.join(sides, margin, *size);
        features.retain(|feature| contours.admits(feature, false));
        if !contours.patches.is_empty() {
            self.find_overlaps(pair, kept, threads);
        }
    }

    /// Adds the overlapping features at the patches, or points in their place.
    fn find_overlaps(&mut self, pair: &Pair, kept: &mut Kept, threads: usize) {
        let Self {
            finder,
            contours,
            features,
            deep,
            middles,
            deepest,
            ..
        } = self;
        let Pair { sides, size, .. } = pair;
        let most = MAX_DEPTH * size;
        middles.clear();
        deepest.clear();
        for patch in &mut contours.patches {
            let [middle] = match patch.rim {
                None => probes(sides, patch, [patch.center], *size),
                Some(_) => [None],
            };
            let vertices = deepest_probes(sides, patch, middle.as_ref(), most, *size);
            let probes = middle.iter().chain(vertices.iter().flatten().map(|(_, probe)| probe));
            patch.too_deep = probes.into_iter().any(|probe| -probe.separation > most);
            middles.push(middle);
            deepest.push(vertices);
        }
        if contours.patches.iter().any(|patch| !patch.too_deep) {
            let window = contours.window(0.5 * most);
            // The normals of two-sided triangles may turn round.
            let one_sided = sides.iter().all(|side| side.features.one_sided.all());
            let query = FeatureQuery {
                margin: most,
                range: -most..=-TOUCH * size,
                reach: most,
                window: Some(if one_sided { window } else { window.without_normals() }),
                nearest: false,
            };
            finder.find(pair, &query, &mut kept.deep, threads, |feature| {
                contours.admits(feature, true)
            });
            finder.features(deep);
            keep_shallowest(deep);
            deep.iter().for_each(|feature| contours.keep(feature));
            features.append(deep);
        }
        let rays = middles.iter().zip(deepest);
        for (number, (patch, (middle, vertices))) in (0..).zip(contours.patches.iter().zip(rays)) {
            if patch.kept {
                continue;
            }
            if let Some(rim) = patch.rim {
                let triangles = contours.segments[patch.first].triangles;
                rim.points(patch.normal, triangles, number, features);
                continue;
            }
            let before = features.len();
            let mut add = |place: u8, p: DVec3, probe: Option<&Probe>| {
                features.extend(probe.map(|probe| probe.feature(patch, p, Origin::Patch { place, number })));
            };
            add(0, patch.center, middle.as_ref());
            let places = patch.outer_places(&contours.segments);
            let outer = probes(sides, patch, places, *size);
            for (place, (p, probe)) in (1..).zip(places.into_iter().zip(&outer)) {
                add(place, p, probe.as_ref());
            }
            for (place, vertex) in (DEEPEST..).zip(vertices) {
                if let Some((p, probe)) = vertex {
                    add(place, *p, Some(probe));
                }
            }
            if features.len() == before {
                features.extend(shallow(&contours.segments, patch, *size, number));
            }
        }
    }
}

/// Keeps the shallowest feature of each vertex: the face through which it entered.
fn keep_shallowest(deep: &mut Vec<Feature>) {
    // Vertices first, each in order of increasing depth.
    let key = |f: &Feature| f.vertex().unwrap_or((u8::MAX, 0));
    deep.sort_unstable_by(|p, q| key(p).cmp(&key(q)).then(q.separation.total_cmp(&p.separation)));
    deep.dedup_by(|later, first| later.vertex().is_some() && later.vertex() == first.vertex());
}

/// Two rays through a point of a patch, to where they leave the bodies.
struct Probe {
    /// How far each body extends from the point along the patch's normal: the first body forwards, the second back.
    ways: [f64; 2],
    /// The triangles that the rays hit.
    triangles: [u32; 2],
    separation: f64,
}

/// Casts rays along a patch's normal through each of `places`; `None` unless both leave a body. They start slightly
/// before it: a contour around a part that protrudes through a flat face lies in that face, and rounding may put the
/// place outside.
fn probes<const N: usize>(sides: &[Side; 2], patch: &Patch, places: [DVec3; N], size: f64) -> [Option<Probe>; N] {
    let (n, back) = (patch.normal, TOUCH * size);
    let most = RAY_LENGTH * size + back;
    let ups = exits(&sides[0], places.map(|p| Some(p - n * back)), n, most);
    // Where the first ray hits nothing, the second is of no use.
    let starts: [_; N] = array::from_fn(|i| ups[i].map(|_| places[i] + n * back));
    let downs = exits(&sides[1], starts, -n, most);
    array::from_fn(|i| {
        let ((up, a), (down, b)) = (ups[i]?, downs[i]?);
        let (up, down) = (up - back, down - back);
        Some(Probe {
            ways: [up, down],
            triangles: [a, b],
            separation: -(up + down),
        })
    })
}

/// Casts rays along a patch's normal from the vertices of both bodies that reach deepest, if they reach deeper than
/// features and than the ray through its middle: the end of a slender body lies far from there.
fn deepest_probes(
    sides: &[Side; 2],
    patch: &Patch,
    middle: Option<&Probe>,
    most: f64,
    size: f64,
) -> [Option<(DVec3, Probe)>; 2] {
    array::from_fn(|i| {
        if patch.rim.is_some() {
            return None;
        }
        let way = [patch.normal, -patch.normal][i];
        let known = middle.map_or(0.0, |probe| probe.ways[i]);
        let least = most.max(known * DEEPER);
        let number = farthest(&sides[i], way, least + way.dot(patch.center))?;
        let vertex = sides[i].vertex(number) - patch.center;
        let depth = vertex.dot(way);
        let aside = vertex - way * depth;
        let most_aside = patch.reach + ASIDE * depth;
        if depth <= least || depth > RAY_LENGTH * size || aside.length() > most_aside {
            return None;
        }
        // Nothing of its own body lies beyond the vertex.
        let [hit] = exits(&sides[1 - i], [Some(patch.center + vertex)], -way, RAY_LENGTH * size);
        let (back, other) = hit?;
        // Another part of the other body is another patch.
        let beyond = back - depth;
        if beyond.abs() > 0.5 * depth {
            return None;
        }
        let mut own = sides[i].features.triangles.iter();
        let own = own.position(|triangle| triangle.contains(&number)).unwrap_or(0) as u32;
        let swap = |pair: [f64; 2]| if i == 1 { [pair[1], pair[0]] } else { pair };
        let probe = Probe {
            ways: swap([depth, beyond]),
            triangles: if i == 1 { [other, own] } else { [own, other] },
            separation: -back,
        };
        Some((patch.center + aside, probe))
    })
}

impl Probe {
    /// The contact point at `p`.
    fn feature(&self, patch: &Patch, p: DVec3, origin: Origin) -> Feature {
        let [up, down] = self.ways;
        Feature {
            points: [p + patch.normal * up, p - patch.normal * down],
            normal: patch.normal,
            separation: self.separation,
            triangles: self.triangles,
            origin,
        }
    }
}

/// A contact for a patch without ray hits, if the patch is not tiny.
fn shallow(segments: &[Segment], patch: &Patch, size: f64, number: u32) -> Option<Feature> {
    // Twice the area over the length of a circle is its radius.
    let depth = (2.0 * patch.area / patch.length).min(SHALLOW * size);
    let half = patch.normal * (0.5 * depth);
    (patch.area > MIN_PROBED_AREA * size * size).then(|| Feature {
        points: [patch.center + half, patch.center - half],
        normal: patch.normal,
        separation: -depth,
        triangles: segments[patch.first].triangles,
        origin: Origin::Patch { place: MIDDLE, number },
    })
}

/// A contact point of a pair, in world axes.
pub struct PairPoint {
    pub point: ManifoldPoint,
    /// From the centres of mass to the points on the meshes, inside of the smooth surfaces.
    pub on_meshes: [DVec3; 2],
    /// Whether the point stands for a smooth surface that touches elsewhere.
    pub elsewhere: bool,
}

/// A pair of bodies in the axes of the first.
pub struct Pair<'a> {
    pub sides: [Side<'a>; 2],
    pub pose: PairPose,
    /// Diameter of the smaller body.
    pub size: f64,
    /// Radii of the bounding spheres.
    pub radii: [f32; 2],
    /// From the second body's axes to the first's.
    pub relative_rotation: DMat3,
    /// From the first body's axes to the world.
    rotation: DMat3,
}

impl<'a> Pair<'a> {
    /// The pair of two placed bodies.
    pub fn new([a, b]: [&PlacedMesh<'a>; 2]) -> Self {
        let sides = sides([a, b]);
        let relative_rotation = a.frame.rotation.transpose() * b.frame.rotation;
        let pose = PairPose {
            rotation: relative_rotation.as_mat3(),
            translation: sides[1].center.as_vec3(),
            size: a.radius + b.radius,
        };
        Self {
            size: sides[0].diameter().min(sides[1].diameter()),
            pose,
            sides,
            radii: [a.radius, b.radius],
            relative_rotation,
            rotation: a.frame.rotation,
        }
    }

    /// How far apart cores are whose rounded surfaces touch; 0 without rounding.
    pub fn rounding(&self) -> f64 {
        rounding(&self.sides)
    }

    /// A vector in the axes of the first body, from one in world axes.
    pub fn to_first_axes(&self, v: DVec3) -> DVec3 {
        self.rotation.transpose() * v
    }

    /// The manifold point of a feature. The second body rotates with `spin` relative to the first, in world axes.
    pub fn point(&self, feature: &Feature, spin: DVec3) -> PairPoint {
        let face_radii = [0, 1].map(|side| f64::from(self.curvature_radius(feature, side)));
        let spin = self.rotation.transpose() * spin;
        let smoothed = smooth::smoothed(&self.sides, feature, face_radii, spin);
        let roundings = self.sides.each_ref().map(|side| side.rounding);
        let [a, b] = [0, 1].map(|i| feature.points[i] + smoothed.slides[i]);
        let normal = (self.rotation * smoothed.normal).normalize();
        let on_cores = [a, b - self.sides[1].center].map(|anchor| self.rotation * anchor);
        let on_meshes = [on_cores[0] + normal * roundings[0], on_cores[1] - normal * roundings[1]];
        let [bulge_a, bulge_b] = smoothed.bulges;
        let anchors = [on_meshes[0] + normal * bulge_a, on_meshes[1] - normal * bulge_b];
        PairPoint {
            point: ManifoldPoint {
                anchors: anchors.map(|anchor| anchor.as_vec3()),
                normal: normal.as_vec3(),
                separation: feature.separation as f32,
                bulge: (bulge_a + bulge_b) as f32,
                curvature_radii: [0, 1].map(|i| (smoothed.radii[i] + roundings[i]) as f32),
                normal_rotation: smoothed.normal_rotation as f32,
                faces: [0, 1].map(|i| self.sides[i].face(feature.triangles[i])),
            },
            on_meshes,
            elsewhere: smoothed.elsewhere,
        }
    }

    /// Adds the manifold points of reduced features. The first feature is the deepest. A smooth surface has one point
    /// where it touches, not one per nearby vertex.
    pub fn add_points(&self, chosen: &[Feature], spin: DVec3, mut add: impl FnMut(ManifoldPoint)) {
        let mut added = arrayvec::ArrayVec::<ManifoldPoint, MAX_POINTS>::new();
        let close = (SAME_CONTACT * self.size) as f32;
        for PairPoint { point, elsewhere, .. } in chosen.iter().map(|feature| self.point(feature, spin)) {
            let is_same = |other: &ManifoldPoint| {
                other.normal.distance(point.normal) < SAME_CONTACT as f32
                    && other.anchors[0].distance(point.anchors[0]) < close
            };
            let is_round = point
                .curvature_radii
                .iter()
                .any(|radius| *radius > 0.0 && radius.is_finite());
            if !(elsewhere || is_round && added.iter().any(is_same)) {
                added.push(point);
                add(point);
            }
        }
        if let Some(deepest) = chosen.first().filter(|_| added.is_empty()) {
            add(self.point(deepest, spin).point);
        }
    }

    /// Radius of curvature of one body's surface at the feature.
    fn curvature_radius(&self, feature: &Feature, side: usize) -> f32 {
        let own = &self.sides[side];
        let radius = own.features.curvature_radii[feature.triangles[side] as usize];
        let is_face = feature.vertex().is_some_and(|(of, _)| usize::from(of) != side);
        if is_face && radius == 0.0 {
            // The interior of a face between creases is flat.
            f32::INFINITY
        } else {
            radius * own.scale.abs().element_sum() / 3.0
        }
    }
}
