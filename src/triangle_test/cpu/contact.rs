//! Where, and in which direction, two bodies push each other.
//!
//! One contact per pair: the centroid of the intersection contour, and the contour's area vector, which is the
//! direction in which the overlap shrinks fastest. It follows from the winding of the faces alone, so an open mesh pushes
//! towards the side from which its faces run counter-clockwise.

use crate::geometry::Orientation;
use crate::geometry::triangle::intersect_placed;
use crate::state::mesh_arena::MeshArena;
use crate::state::{Bodies, Contact, Frame, NearPair};
use glam::{DMat3, DVec3, Vec3};

/// The pair in double precision, in the first body's axes about its centre of mass.
pub struct PairView {
    a: Frame,
    b_matrix: DMat3,
    a_origin: DVec3,
    b_origin: DVec3,
    /// How wrong a placed coordinate can be.
    pub placing: f64,
}

/// A segment in which two faces intersect, in the axes of [`PairView`].
pub struct Segment {
    pub start: DVec3,
    pub end: DVec3,
    /// Whether it runs along the cross product of the faces' normals, and not across a common plane.
    directed: bool,
}

impl Segment {
    /// Two faces in different planes; from `start` to `end` along the cross product of their normals.
    pub fn across(start: DVec3, end: DVec3) -> Self {
        Self {
            start,
            end,
            directed: true,
        }
    }
}

impl PairView {
    /// `size` is the sum of the bounding radii.
    pub fn new(a: &Frame, b: &Frame, size: f32) -> Self {
        // Corners are sums of products no larger than the bodies and the way from each mesh's origin to its centre.
        let arms = a.position.distance(a.center) + b.position.distance(b.center);
        let to_a = a.rotation.transpose();
        Self {
            a: *a,
            b_matrix: to_a * b.rotation * DMat3::from_diagonal(b.scale),
            a_origin: to_a * (a.position - a.center),
            b_origin: to_a * (b.position - a.center),
            placing: 16.0 * f64::EPSILON * (size as f64 + arms),
        }
    }

    /// A point of the first mesh.
    #[inline]
    pub fn place_a(&self, p: Vec3) -> DVec3 {
        self.a.scale * p.as_dvec3() + self.a_origin
    }

    /// A point of the second mesh.
    #[inline]
    pub fn place_b(&self, p: Vec3) -> DVec3 {
        self.b_matrix * p.as_dvec3() + self.b_origin
    }

    /// Decides a pair of faces, given by the corners in their meshes.
    pub fn intersect(&self, a: [Vec3; 3], b: [Vec3; 3]) -> Option<Segment> {
        let (a, b) = (a.map(|p| self.place_a(p)), b.map(|p| self.place_b(p)));
        let hit = intersect_placed(&a, &b, self.placing)?;
        let normal = |t: &[DVec3; 3]| (t[1] - t[0]).cross(t[2] - t[0]);
        let forward = (hit.end - hit.start).dot(normal(&a).cross(normal(&b))) >= 0.0;
        let (start, end) = if forward {
            (hit.start, hit.end)
        } else {
            (hit.end, hit.start)
        };
        Some(Segment {
            start,
            end,
            directed: !hit.coplanar,
        })
    }

    pub fn to_world(&self, p: DVec3) -> Vec3 {
        (self.a.rotation * p + self.a.center).as_vec3()
    }

    fn turn_to_world(&self, v: DVec3) -> Vec3 {
        (self.a.rotation * v).as_vec3()
    }
}

/// Sums over the segments in which the surfaces intersect.
#[derive(Default)]
pub struct Contour {
    /// Sums are taken about the first point, for digits.
    origin: Option<DVec3>,
    count: f64,
    length: f64,
    middle: DVec3,
    weighted_middle: DVec3,
    area: DVec3,
    closing: DVec3,
}

impl Contour {
    pub fn add(&mut self, segment: &Segment) {
        let origin = *self.origin.get_or_insert(segment.start);
        let (start, end) = (segment.start - origin, segment.end - origin);
        let step = end - start;
        let (length, middle) = (step.length(), (start + end) * 0.5);
        self.count += 1.0;
        self.middle += middle;
        self.length += length;
        self.weighted_middle += middle * length;
        if segment.directed {
            self.area += start.cross(step) * 0.5;
            self.closing += step;
        }
    }

    /// Centroid and area vector about it.
    fn finish(&self) -> Option<(DVec3, DVec3)> {
        let origin = self.origin?;
        let middle = if self.length > 0.0 {
            self.weighted_middle / self.length
        } else {
            self.middle / self.count
        };
        Some((middle + origin, self.area - middle.cross(self.closing) * 0.5))
    }
}

/// The share of a circle's area that a contour must enclose for its area vector to say anything: patches on opposite
/// sides cancel, and so do crossings of open sheets.
pub(crate) const SIGNIFICANT: f64 = 0.02;

/// The pair's contact, from its contour or, without a usable one, along the line of centres.
pub fn contact(bodies: &Bodies, meshes: &MeshArena, pair: &NearPair, contour: &Contour, view: &PairView) -> Contact {
    let [a, b] = pair.bodies.map(|i| i as usize);
    let (center_a, center_b) = (bodies.frame[a].center, bodies.frame[b].center);
    let centers = (center_b - center_a).as_vec3().try_normalize().unwrap_or(Vec3::Y);
    let Some((middle, area)) = contour.finish() else {
        // One inside the other: push apart at the centre of the smaller one.
        let inner = if bodies.radius[a] < bodies.radius[b] {
            center_a
        } else {
            center_b
        };
        return Contact {
            point: inner.as_vec3(),
            normal: centers,
        };
    };
    let mut sign = 1.0;
    for body in [a, b] {
        let mirrored = bodies.frame[body].scale.element_product() < 0.0;
        match meshes[bodies.mesh[body]].mesh.mesh.orientation() {
            Orientation::Mixed => sign = 0.0,
            Orientation::Outward | Orientation::Inward | Orientation::Open if mirrored => sign = -sign,
            _ => {}
        }
    }
    let circle = contour.length * contour.length / (4.0 * std::f64::consts::PI);
    let normal = if area.length() > SIGNIFICANT * circle && sign != 0.0 {
        view.turn_to_world(area.normalize() * sign)
    } else {
        centers
    };
    Contact {
        point: view.to_world(middle),
        normal,
    }
}
