//! Contact on the smooth surface that a fine mesh approximates.
//!
//! On its mesh, a rolling ball touches with one vertex after the other. Each lies ahead of the centre until the next
//! collision substep, and lifts the ball over its facets. The ball would lose speed as if its facets were as long as
//! its travel in a collision substep, or gain some: it falls from a vertex, and the solver lifts it out of the overlap
//! onto the next. Balls in an off-centre impact would be deflected along the normals of the facets that lie most across
//! their path, which touch first. So such a surface touches where the smooth surface through its vertices does, which
//! lies up to a hundredth of its radius of curvature outside of the facets.

use super::feature::{Feature, Origin};
use super::side::{Side, rounding};
use crate::geometry::features::{MIN_TURN, Roundness};
use glam::{DMat3, DVec3};

/// Sine of the largest angle between the smooth normal at a vertex and a contact normal at which the vertex stands for
/// the surface around it.
pub(crate) const SMOOTH: f64 = 0.2;
/// Sine of half the largest angle between the smooth normals of two surfaces that touch, each convex in all directions:
/// half the angle between the faces of a cylinder of 32 sides. Coarser ones lie on their facets.
pub(crate) const SMOOTH_PAIR: f64 = 0.1;

/// A square of this sine of the angle between a rotation and a normal, or less, gives no direction in which a body
/// rolls.
pub(crate) const MIN_ROLL: f64 = 1.0e-12;

/// The contact of the smooth surfaces at a feature.
pub struct Smoothed {
    /// Unit vector from the first body to the second.
    pub normal: DVec3,
    /// Offset of each body's point, perpendicular to the normal, to where its smooth surface touches.
    pub slides: [DVec3; 2],
    /// How far each smooth surface lies beyond the body's point there, along its outward normal.
    pub bulges: [f64; 2],
    /// Rotation of the normal per distance that the surfaces slide along each other, rad/m.
    pub normal_rotation: f64,
    /// Radii of curvature, along the direction in which the bodies roll where they are smooth.
    pub radii: [f64; 2],
    /// The vertex from which the feature was derived stands for a smooth surface that touches elsewhere.
    pub elsewhere: bool,
}

/// A vertex of a placed mesh, and the smooth surface or curve around it.
#[derive(Clone, Copy, Debug)]
pub struct RoundVertex {
    shape: Shape,
    /// Length of the longest edge, metres.
    reach: f64,
}

#[derive(Clone, Copy, Debug)]
enum Shape {
    /// See [`Roundness::Surface`].
    Surface(Surface),
    /// A rim along this unit vector with this curvature, see [`Roundness::Rim`].
    Rim { tangent: DVec3, curvature: DVec3 },
}

/// A smooth surface near one of its points.
#[derive(Clone, Copy, Debug)]
struct Surface {
    /// Unit vector.
    normal: DVec3,
    /// Transforms tangents of the mesh. The curvature is a quadratic form on them.
    placement: DMat3,
    /// Radii of curvature of the mesh, times the length of its transformed unit normal.
    radii: DMat3,
}

impl Surface {
    /// The displacement along the surface to where its normal has turned by `turn`.
    fn way(&self, turn: DVec3) -> DVec3 {
        self.placement * (self.radii * (self.placement.transpose() * turn))
    }
}

/// What a vertex is for a contact with a certain normal.
#[derive(Clone, Copy, Debug)]
pub enum AtVertex {
    /// A corner, which touches itself and rotates with the body.
    Corner,
    /// A vertex of a smooth surface that touches nearer to other vertices.
    Elsewhere,
    Round(RoundContact),
}

/// Where the smooth surface around a vertex touches.
#[derive(Clone, Copy, Debug)]
pub struct RoundContact {
    /// Offset from the vertex, perpendicular to the contact normal.
    pub slide: DVec3,
    /// How far it lies beyond the vertex, along the contact normal.
    pub bulge: f64,
    /// Radius of curvature in the direction in which the body rolls.
    pub radius: f64,
}

impl RoundVertex {
    /// The smooth surface at a vertex that `placement`, a rotation and a scale, has placed; `None` at a corner.
    /// `normal` is the normal of the mesh, transformed by the inverse transpose and not normalised.
    pub fn new(round: &Roundness, placement: &DMat3, normal: DVec3, scale: DVec3) -> Option<Self> {
        let (shape, reach) = match *round {
            Roundness::Corner => return None,
            Roundness::Surface { radii, reach } => {
                let length = normal.length();
                let surface = Surface {
                    normal: normal / length,
                    placement: *placement,
                    radii: matrix(radii) * length,
                };
                (Shape::Surface(surface), reach)
            }
            Roundness::Rim {
                tangent,
                curvature,
                reach,
            } => {
                let tangent = *placement * tangent.as_dvec3();
                let square = tangent.length_squared();
                let tangent = tangent / square.sqrt();
                let curvature = (*placement * curvature.as_dvec3() / square).reject_from_normalized(tangent);
                (Shape::Rim { tangent, curvature }, reach)
            }
        };
        let reach = f64::from(reach) * (scale.abs().element_sum() / 3.0);
        Some(Self { shape, reach })
    }

    /// The mean of both principal radii of curvature; `None` on a rim.
    fn mean_radius(&self) -> Option<f64> {
        match &self.shape {
            Shape::Surface(surface) => {
                Some(0.5 * DVec3::AXES.map(|axis| surface.way(axis).dot(axis)).iter().sum::<f64>())
            }
            Shape::Rim { .. } => None,
        }
    }

    /// The surface for a contact with the outward normal `out`; `None` if the rim is no rounder than a straight edge,
    /// seen from there.
    fn facing(&self, out: DVec3) -> Option<Surface> {
        match self.shape {
            Shape::Surface(surface) => Some(surface),
            Shape::Rim { tangent, curvature } => {
                let normal = out.reject_from_normalized(tangent).try_normalize()?;
                let towards = -curvature.dot(normal);
                let [x, y, z] = tangent.to_array().map(|t| tangent * (t / towards));
                (towards * self.reach > MIN_TURN).then_some(Surface {
                    normal,
                    placement: DMat3::IDENTITY,
                    radii: DMat3::from_cols(x, y, z),
                })
            }
        }
    }

    /// The contact with the outward normal `out` of a body that rotates with `spin` relative to the other.
    pub fn contact(&self, out: DVec3, spin: DVec3) -> AtVertex {
        let Some(surface) = self.facing(out) else {
            return AtVertex::Corner;
        };
        let normal = surface.normal;
        let cosine = normal.dot(out);
        // The surface has the normal `out` this way along it, and falls by its curvature meanwhile.
        let turn = out - normal * cosine;
        let way = surface.way(turn);
        let along = way.dot(turn);
        let size = way.length() * turn.length();
        if cosine <= 0.0 || turn.length_squared() > SMOOTH * SMOOTH || way.length_squared() > self.reach * self.reach {
            // Where it is flat in the direction in which it leans, it does not roll on to other vertices.
            return if cosine > 0.0 && along > 0.5 * size {
                AtVertex::Elsewhere
            } else {
                AtVertex::Corner
            };
        }
        let bulge = along / (1.0 + cosine);
        let slide = way - normal * bulge - out * bulge;
        let across = spin.cross(out);
        let square = across.length_squared();
        let rolling = if square > MIN_ROLL * spin.length_squared() && square > 0.0 {
            across / square.sqrt()
        } else {
            out.any_orthonormal_vector()
        };
        // Along the surface at the vertex, which leans.
        let rolling = rolling - normal * rolling.dot(normal);
        AtVertex::Round(RoundContact {
            slide,
            bulge,
            radius: rolling.dot(surface.way(rolling)) / rolling.length_squared(),
        })
    }
}

/// The contact at a feature, for the radii of curvature of the faces there. The second body rotates with `spin`
/// relative to the first.
pub fn smoothed(sides: &[Side; 2], feature: &Feature, face_radii: [f64; 2], spin: DVec3) -> Smoothed {
    if let Some(round) = between_spheres(sides, feature, face_radii) {
        return round;
    }
    let mut flat = Smoothed {
        normal: feature.normal,
        slides: [DVec3::ZERO; 2],
        bulges: [0.0; 2],
        normal_rotation: 0.0,
        radii: face_radii,
        elsewhere: false,
    };
    if let Origin::Vertices(_) = feature.origin
        && rounding(sides) > 0.0
        && feature.points[0] != feature.points[1]
    {
        // Rounded vertices are balls.
        flat.normal_rotation = feature.points[0].distance(feature.points[1]).recip();
    }
    if let Some((side, vertex)) = feature.vertex() {
        let i = usize::from(side);
        match sides[i]
            .round_vertex(vertex)
            .map(|round| round.contact([feature.normal, -feature.normal][i], spin))
        {
            None | Some(AtVertex::Corner) => flat.radii[i] = 0.0,
            Some(AtVertex::Elsewhere) => (flat.radii[i], flat.elsewhere) = (0.0, true),
            Some(AtVertex::Round(contact)) => {
                // Both points move along the other body's face.
                flat.slides = [contact.slide; 2];
                (flat.bulges[i], flat.radii[i]) = (contact.bulge, contact.radius);
            }
        }
    }
    flat
}

/// Lower bound of the curvature of side `i` in all directions at a feature, 1/m; infinite at the end of a segment.
pub fn curvature(sides: &[Side; 2], feature: &Feature, i: usize) -> f64 {
    let is_vertex = match feature.origin {
        Origin::Vertex { side, .. } | Origin::VertexEdge { side, .. } => usize::from(side) == i,
        Origin::Vertices(_) => true,
        _ => false,
    };
    if is_vertex && sides[i].is_thin() {
        f64::INFINITY
    } else {
        sides[i].curvature(feature.triangles[i])
    }
}

/// The contact of two surfaces that are convex in all directions: on the line between their centres of curvature.
fn between_spheres(sides: &[Side; 2], feature: &Feature, face_radii: [f64; 2]) -> Option<Smoothed> {
    let curvature = [0, 1].map(|i| curvature(sides, feature, i));
    if curvature.contains(&0.0) {
        return None;
    }
    let [a, b] = [0, 1].map(|i| Sphere::at(&sides[i], feature, i, curvature[i].recip()));
    let (a, b) = (a?, b?);
    // The smooth normals at two points differ by at most the angle of two facets.
    let least = 1.0 - 2.0 * SMOOTH_PAIR * SMOOTH_PAIR;
    if a.normal.dot(feature.normal) < least || -b.normal.dot(feature.normal) < least {
        return None;
    }
    let way = b.center - a.center;
    let normal = way.try_normalize()?;
    let contacts = [(a, normal), (b, -normal)].map(|(sphere, out)| sphere.contact(out));
    let radii = [0, 1].map(|i| contacts[i].2.unwrap_or(face_radii[i]));
    Some(Smoothed {
        normal,
        slides: contacts.map(|(slide, ..)| slide),
        bulges: contacts.map(|(_, bulge, _)| bulge),
        normal_rotation: way.length().recip(),
        radii,
        elsewhere: false,
    })
}

/// The sphere that a surface approximates near a feature.
#[derive(Clone, Copy)]
struct Sphere {
    center: DVec3,
    /// The point of the feature, on a facet.
    point: DVec3,
    /// The outward normal of the smooth surface there.
    normal: DVec3,
    /// `None` if the facets are too coarse to stand for their sphere.
    radius: Option<f64>,
}

impl Sphere {
    /// The sphere at side `i` of a feature. A coarse surface has the sphere of this `radius` through the point.
    fn at(side: &Side, feature: &Feature, i: usize, radius: f64) -> Option<Self> {
        let (triangle, point) = (feature.triangles[i], feature.points[i]);
        if radius == 0.0 {
            return Some(Self {
                center: point,
                point,
                normal: [feature.normal, -feature.normal][i],
                radius: Some(0.0),
            });
        }
        let vertices = side.features.triangles[triangle as usize];
        let weights = weights(vertices.map(|v| side.vertex(v) - point));
        let mut sum = DVec3::ZERO;
        let (mut center, mut fine_radius) = (DVec3::ZERO, Some(0.0));
        for (vertex, weight) in vertices.into_iter().zip(weights) {
            let normal = side.smooth_normal(vertex).normalize_or_zero();
            sum += normal * weight;
            match side.round_vertex(vertex).and_then(|round| round.mean_radius()) {
                Some(own) => {
                    center += weight * (side.vertex(vertex) - normal * own);
                    fine_radius = fine_radius.map(|radius| radius + weight * own);
                }
                None => fine_radius = None,
            }
        }
        let normal = sum.try_normalize()?;
        if fine_radius.is_none() {
            center = point - normal * radius;
        }
        Some(Self {
            center,
            point,
            normal,
            radius: fine_radius,
        })
    }

    /// Slide, bulge and radius of a contact with this outward normal.
    fn contact(self, out: DVec3) -> (DVec3, f64, Option<f64>) {
        let from_center = self.point - self.center;
        let height = from_center.dot(out);
        let slide = out * height - from_center;
        (slide, self.radius.map_or(0.0, |radius| radius - height), self.radius)
    }
}

/// The symmetric matrix with these elements: xx, xy, xz, yy, yz, zz.
fn matrix(elements: [f32; 6]) -> DMat3 {
    let [xx, xy, xz, yy, yz, zz] = elements.map(f64::from);
    DMat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz])
}

/// The barycentric coordinates of the origin, or of what is nearest to it, in a triangle.
fn weights(corners: [DVec3; 3]) -> [f64; 3] {
    let whole = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    let areas = [0, 1, 2].map(|k| {
        let area = corners[(k + 1) % 3].cross(corners[(k + 2) % 3]).dot(whole);
        area.max(0.0)
    });
    let sum = areas.iter().sum::<f64>();
    areas.map(|area| if sum > 0.0 { area / sum } else { 1.0 / 3.0 })
}
