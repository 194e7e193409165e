//! Mass properties of a mesh at density 1.

mod open;
mod rounded;

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
    /// What the mass was computed from.
    pub basis: MassBasis,
    /// How far off the volume may be, relative to itself: what openings and the resolution of sampling leave uncertain.
    /// 0 for a closed mesh; 1 where the mass is not that of an enclosed volume.
    pub error: f32,
    /// Whether the values are a substitute or uncertain: the mesh is not a closed solid, or the values did not fit
    /// `f32`.
    pub approximate: bool,
}

/// What the mass of a mesh is computed from; see [`MassProperties::of`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub enum MassBasis {
    /// The volume that a closed mesh encloses.
    Solid,
    /// A solid that fills a room.
    Room,
    /// The volume that an open mesh encloses with its openings closed.
    Capped,
    /// The places where the winding number exceeds a half, because the mesh is wide open.
    Winding,
    /// A shell of even thickness along the faces, because an open mesh encloses nothing.
    Shell,
    /// The bounding box, because a closed mesh encloses nothing.
    Box,
}

/// An enclosed volume below this fraction of the cube of the bounding box's diagonal counts as zero. It is then
/// rounding of the coordinates: a two-sided sheet is closed but encloses no volume.
const MIN_VOLUME: f64 = 1e-9;
/// The minimum edge of the box that replaces a mesh without volume, relative to its longest edge.
const MIN_EDGE: f64 = 0.01;

/// The default thickness of the shell that gives an open mesh without an inside its mass, relative to the diagonal of
/// its bounding box.
pub const SHELL_THICKNESS: f32 = 0.01;

impl MassProperties {
    /// Calls [`MassProperties::with_shell`] with [`SHELL_THICKNESS`].
    pub fn of(mesh: &TriMesh) -> Self {
        Self::with_shell(mesh, SHELL_THICKNESS)
    }

    /// Integrates over the volume that the welded mesh encloses; exact but for rounding in `f64`.
    ///
    /// The result is a substitute, or uncertain, and [`MassProperties::approximate`] is set, in these cases:
    ///
    /// * A room ([`Orientation::Inward`]) gets the mass of a solid that fills it. Its walls have no outer surface and
    ///   so no mass of their own.
    /// * An open mesh whose openings together take at most 40 % of its area, as does a box without a lid, gets the mass
    ///   of the mesh with its openings closed, each by a cone. This is exact where an opening is flat. The error is
    ///   that of a half ball over each opening.
    /// * Another open mesh, or one whose winding cannot be made consistent, gets the mass of the places where the
    ///   generalised winding number exceeds a half. They are found by sampling the bounding box; the error is half the
    ///   volume of the samples at their border.
    /// * If there are no such places, or if they reach out of the box through more than a tenth of its sides, as those
    ///   below some terrains do, it gets the mass of a shell along its faces. `shell` is its thickness, relative to the
    ///   diagonal of the bounding box.
    /// * If faces are there twice, and the mesh is closed without them, they count once; this is exact. See
    ///   [`TriMesh::caps`].
    /// * A closed mesh that encloses almost no volume gets the mass of its solid bounding box. Each edge of that box
    ///   counts as at least 1 % of the longest.
    /// * If the mesh is so large or small that values do not fit `f32`, they are clamped.
    ///
    /// The thickness of a mesh that is neither closed nor nearly so is the shortest edge of that box.
    ///
    /// All values are finite. Volume, thickness and the diagonal of the second moment are positive.
    pub fn with_shell(mesh: &TriMesh, shell: f32) -> Self {
        let aabb = mesh.aabb();
        let edges = solid_box_edges(aabb);
        let (solid, basis, error) = match mesh.orientation() {
            Orientation::Outward => (integrate(mesh, mesh.caps(), aabb), MassBasis::Solid, 0.0),
            Orientation::Inward => (integrate(mesh, mesh.caps(), aabb), MassBasis::Room, 0.0),
            Orientation::Open | Orientation::Mixed => match capped(mesh, aabb) {
                Some((solid, error)) => (Some(solid), MassBasis::Capped, error),
                None => {
                    let (solid, basis, error) = open::solid(mesh, aabb, f64::from(shell));
                    (Some(solid), basis, error)
                }
            },
        };
        let Some(solid) = solid else {
            return solid_box(aabb).to_single(edges.min_element(), MassBasis::Box, 1.0);
        };
        let is_whole = mesh.is_closed() || !mesh.caps().is_empty();
        match is_whole.then(|| thickness(mesh)) {
            Some(Some(t)) => solid.to_single(t.min(edges.length()), basis, error),
            // No ray leaves the mesh, so its volume is doubtful.
            Some(None) => solid.to_single(edges.min_element(), basis, 1.0),
            None => solid.to_single(edges.min_element(), basis, error),
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

/// Errors up to this are rounding of the coordinates: of cracks and T-junctions, say.
const NO_ERROR: f64 = 1.0e-6;

/// The values before they are rounded to `f32`.
struct Solid {
    volume: f64,
    center: DVec3,
    second_moment: DMat3,
}

impl Solid {
    /// The values in single precision.
    fn to_single(&self, thickness: f64, basis: MassBasis, error: f64) -> MassProperties {
        let is_whole = matches!(basis, MassBasis::Solid | MassBasis::Capped);
        let mut clamped = !is_whole || error > NO_ERROR;
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
            basis,
            error: error.min(1.0) as f32,
            approximate: clamped,
        }
    }
}

/// An open mesh is closed for its mass if its openings together take at most this part of its area. The openings of a
/// sheet take all of it, the opening of a half ball takes a half.
const MAX_SHARE: f64 = 0.4;

/// The mass of an open mesh with its openings closed, and its relative error; `None` if they are too large, or if the
/// winding is not consistent.
///
/// Where an opening is flat, the generalised winding number on its cap is a half. The result then equals the integral
/// over the places where the number is larger. Those would have to be sampled, and samples miss what is thin.
fn capped(mesh: &TriMesh, aabb: Aabb) -> Option<(Solid, f64)> {
    let closure = mesh.closure().filter(|closure| closure.share <= MAX_SHARE)?;
    let solid = integrate(mesh, &closure.caps, aabb)?;
    let error = closure.uncertain_volume / solid.volume;
    Some((solid, error))
}

/// Sums the tetrahedra between an origin and the faces and caps, which may all point inward. `None` if the volume is
/// zero, or if the moments cannot be those of a solid, as when parts of the surface enclose the outside.
fn integrate(mesh: &TriMesh, caps: &[[Vec3; 3]], aabb: Aabb) -> Option<Solid> {
    // Relative to the centre of the box, so that a mesh far from its origin loses no precision.
    let origin = (aabb.min.as_dvec3() + aabb.max.as_dvec3()) * 0.5;
    let (mut volume, mut first, mut second) = (0.0, DVec3::ZERO, DMat3::ZERO);
    let triangles = (0..mesh.triangles().len()).map(|t| mesh.welded_corners(t));
    for triangle in triangles.chain(caps.iter().copied()) {
        let [a, b, c] = triangle.map(|v| v.as_dvec3() - origin);
        let det = a.dot(b.cross(c));
        let sum = a + b + c;
        volume += det;
        first += det * sum;
        second += det * (outer(a) + outer(b) + outer(c) + outer(sum));
    }
    let sign = f64::signum(volume);
    let (mut volume, first, second) = (volume * sign, first * sign, second * sign);
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
