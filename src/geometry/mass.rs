//! Mass properties of a mesh at density 1.

use super::thickness::thickness;
use crate::geometry::{Aabb, Orientation, TriMesh};
use glam::{DMat3, DVec3, Mat3, Vec3};

/// Mass, centre of mass and inertia of a mesh at density 1 (kg per cubic mesh unit), and its thickness.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct MassProperties {
    /// The enclosed volume in cubic mesh units; equal to the mass at density 1. Always positive and finite.
    pub volume: f32,
    /// Centre of mass in mesh space.
    pub center: Vec3,
    /// Second moments of volume about the centre of mass, `M = integral of r r^T dV` (symmetric). A scale `S` turns `M`
    /// into `det(S) * S M S`. The inertia tensor at density 1 is `trace(M) * I - M`.
    pub second_moment: Mat3,
    /// The thickness of the thinnest part, in mesh units: the diameter of the ball inside that touches the surface and
    /// the opposite surface. Up to 2 % of the surface may be thinner, so that sharp edges do not count.
    pub thickness: f32,
    /// Whether the values are a substitute: the mesh is not a closed solid, or the values did not fit `f32`. See
    /// [`MassProperties::of`].
    pub approximate: bool,
}

/// An enclosed volume below this fraction of the cube of the bounding box's diagonal counts as zero. It is then
/// rounding of the coordinates: a two-sided sheet is closed but encloses no volume.
const MIN_VOLUME: f64 = 1e-9;
/// The minimum edge of the box that replaces a mesh without volume, relative to its longest edge.
const MIN_EDGE: f64 = 0.01;

impl MassProperties {
    /// Integrates over the volume that the welded mesh encloses; exact but for rounding in `f64`.
    ///
    /// The result is a substitute, and [`MassProperties::approximate`] is set, in these cases:
    ///
    /// * A room ([`Orientation::Inward`]) gets the mass of a solid that fills it. Its walls have no outer surface and
    ///   so no mass of their own.
    /// * An open mesh, a mesh with mixed winding, or one that encloses almost no volume gets the mass of its solid
    ///   bounding box. Each edge of that box counts as at least 1 % of the longest, and its shortest edge is the
    ///   thickness.
    /// * If the mesh is so large or small that values do not fit `f32`, they are clamped.
    ///
    /// All values are finite. Volume, thickness and the diagonal of the second moment are positive.
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
    /// The inertia tensor about the centre of mass, for the mesh scaled by `scale` along its axes and with mass `mass`.
    /// The unit is that of `mass` times squared mesh units.
    pub fn inertia(&self, scale: DVec3, mass: f64) -> DMat3 {
        let [x, y, z] = [0, 1, 2].map(|axis| scale * self.second_moment.col(axis).as_dvec3() * scale[axis]);
        let moment = DMat3::from_cols(x, y, z) * (mass / f64::from(self.volume));
        let trace = moment.x_axis.x + moment.y_axis.y + moment.z_axis.z;
        DMat3::from_diagonal(DVec3::splat(trace)) - moment
    }
}

/// The values before they are rounded to `f32`.
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

/// Sums the tetrahedra between an origin and the faces; `sign` is -1 if the faces point inward. `None` if the volume is
/// zero, or if the moments cannot be those of a solid, as when parts of the surface enclose the outside.
fn integrate(mesh: &TriMesh, aabb: Aabb, sign: f64) -> Option<Solid> {
    // Relative to the centre of the box, so that a mesh far from its origin loses no precision.
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
    if volume.is_nan() || volume <= MIN_VOLUME * diagonal.powi(3) {
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
    edges.max(DVec3::splat(edges.max_element() * MIN_EDGE))
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
