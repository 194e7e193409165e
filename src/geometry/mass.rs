//! Mass properties of a mesh at density 1.

use super::thickness::thickness;
use crate::geometry::{Aabb, Orientation, TriMesh};
use glam::{DMat3, DVec3, Mat3, Vec3};

/// What a mesh weighs and how it resists turning, at density 1 (kg per cubic mesh unit).
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct MassProperties {
    /// Enclosed volume, equal to the mass at density 1. Always positive and finite.
    pub volume: f32,
    /// Centre of mass in mesh space.
    pub center: Vec3,
    /// Second moments of volume about the centre, `integral of r r^T dV` (symmetric). Scale by `S` gives
    /// `det(S) * S M S`; the inertia tensor is `trace(M) * I - M`.
    pub second_moment: Mat3,
    /// Diameter of the thinnest part, in mesh units: the diameter of the ball that touches the surface from behind and the
    /// surface opposite. At most 2 % of the surface is thinner, so that a sharp edge does not make a body thin.
    pub thickness: f32,
    /// Whether the figures stand in for those of a solid: the mesh is not closed, or is a room.
    pub approximate: bool,
}

/// An enclosed volume below this part of the cube of the box's diagonal is taken for none: what is left is rounding of the
/// coordinates (a sheet with two sides encloses nothing, yet is closed).
const LEAST_VOLUME: f64 = 1e-9;
/// Edges of the box that stands in for a mesh without volume are at least this part of its longest edge.
const LEAST_EDGE: f64 = 0.01;

impl MassProperties {
    /// Integrates over the enclosed volume, exactly but for rounding in `f64`, with corners that count as one joined. A room
    /// ([`Orientation::Inward`]) weighs what a solid of its inside would, and [`MassProperties::approximate`] is set: its walls
    /// have no outside, and so no weight of their own.
    ///
    /// A mesh that is open, whose faces disagree about the outside, or that encloses next to nothing, has no mass of its
    /// own: it gets that of its solid bounding box, no edge of which is taken for shorter than 1 % of the longest, its
    /// thickness is the box's shortest edge, and [`MassProperties::approximate`] is set. The same flag marks meshes so huge
    /// or tiny that the figures do not fit `f32` and were clamped. Everything returned is finite, and volume, thickness and
    /// the diagonal of the second moment are positive.
    pub fn of(mesh: &TriMesh) -> Self {
        let aabb = mesh.aabb();
        let room = mesh.orientation() == Orientation::Inward;
        let solid = match mesh.orientation() {
            Orientation::Outward => integrate(mesh, aabb, 1.0),
            Orientation::Inward => integrate(mesh, aabb, -1.0),
            Orientation::Mixed | Orientation::Open => None,
        };
        let Some(solid) = solid else {
            return solid_box(aabb).rounded(solid_box_edges(aabb).min_element(), true);
        };
        let edges = solid_box_edges(aabb);
        match thickness(mesh) {
            Some(t) => solid.rounded(t.min(edges.length()), room),
            None => solid.rounded(edges.min_element(), true),
        }
    }
}

impl MassProperties {
    /// The inertia tensor about the centre of mass of the mesh scaled by `scale` along its axes, with this mass: scaling by
    /// `S` turns the second moment `M` into `det(S) S M S`.
    pub fn inertia(&self, scale: DVec3, mass: f64) -> DMat3 {
        let scale = DMat3::from_diagonal(scale);
        let moment = scale * self.second_moment.as_dmat3() * scale * (mass / f64::from(self.volume));
        let trace = moment.x_axis.x + moment.y_axis.y + moment.z_axis.z;
        DMat3::from_diagonal(DVec3::splat(trace)) - moment
    }
}

/// The figures before they are rounded.
struct Solid {
    volume: f64,
    center: DVec3,
    second_moment: DMat3,
}

impl Solid {
    fn rounded(self, thickness: f64, approximate: bool) -> MassProperties {
        let mut clamped = approximate;
        let mut positive = |x: f64| {
            let inside = x.clamp(f64::from(f32::MIN_POSITIVE), f64::from(f32::MAX));
            clamped |= inside != x;
            inside as f32
        };
        let volume = positive(self.volume);
        let thickness = positive(thickness);
        let m = self.second_moment;
        let diagonal = [positive(m.x_axis.x), positive(m.y_axis.y), positive(m.z_axis.z)];
        let off = |x: f64| x.clamp(-f64::from(f32::MAX), f64::from(f32::MAX)) as f32;
        let (xy, xz, yz) = (off(m.x_axis.y), off(m.x_axis.z), off(m.y_axis.z));
        MassProperties {
            volume,
            center: self.center.as_vec3(),
            second_moment: Mat3::from_cols(
                Vec3::new(diagonal[0], xy, xz),
                Vec3::new(xy, diagonal[1], yz),
                Vec3::new(xz, yz, diagonal[2]),
            ),
            thickness,
            approximate: clamped,
        }
    }
}

/// Sums tetrahedra between an origin and the faces; `sign` is -1 if the faces look inward. `None` if what they enclose is
/// no volume, or not one that could be a solid's (loops that enclose the outside).
fn integrate(mesh: &TriMesh, aabb: Aabb, sign: f64) -> Option<Solid> {
    // About the middle of the box, so that a mesh far from its origin keeps its digits.
    let origin = (aabb.min.as_dvec3() + aabb.max.as_dvec3()) * 0.5;
    let (mut volume, mut first, mut second) = (0.0, DVec3::ZERO, DMat3::ZERO);
    for t in 0..mesh.triangles().len() {
        let [a, b, c] = mesh.welded_corners(t).map(|v| v.as_dvec3() - origin);
        let det = sign * a.dot(b.cross(c));
        let sum = a + b + c;
        volume += det;
        first += det * sum;
        second += det * (outer(a) + outer(b) + outer(c) + outer(sum));
    }
    volume /= 6.0;
    let diagonal = (aabb.max.as_dvec3() - aabb.min.as_dvec3()).length();
    if volume.is_nan() || volume <= LEAST_VOLUME * diagonal.powi(3) {
        return None;
    }
    let center = first / (24.0 * volume);
    let second_moment = second * (1.0 / 120.0) - outer(center) * volume;
    let least = second_moment
        .x_axis
        .x
        .min(second_moment.y_axis.y)
        .min(second_moment.z_axis.z);
    let inside = center.abs().cmple((aabb.max.as_dvec3() - origin) * (1.0 + 1e-6)).all();
    (least > 0.0 && inside).then_some(Solid {
        volume,
        center: center + origin,
        second_moment,
    })
}

fn outer(v: DVec3) -> DMat3 {
    DMat3::from_cols(v * v.x, v * v.y, v * v.z)
}

fn solid_box_edges(aabb: Aabb) -> DVec3 {
    let edges = aabb.max.as_dvec3() - aabb.min.as_dvec3();
    edges.max(DVec3::splat(edges.max_element() * LEAST_EDGE))
}

fn solid_box(aabb: Aabb) -> Solid {
    let edges = solid_box_edges(aabb);
    let volume = edges.element_product();
    Solid {
        volume,
        center: (aabb.min.as_dvec3() + aabb.max.as_dvec3()) * 0.5,
        second_moment: DMat3::from_diagonal(edges * edges * (volume / 12.0)),
    }
}
