//! One body of a pair, placed in the axes of the pair's first body.

use super::feature::ARC;
use super::smooth::RoundVertex;
use crate::asset::CollisionMesh;
use crate::geometry::features::{ANY_NORMAL, MeshFeatures, NONE};
use crate::simd::lanes::{Simd, SimdBase, SimdFrom, each, each_lane, f32x8, splat};
use crate::state::PlacedMesh;
use crate::state::pairs::DEFAULT_DIRECTION;
use glam::{DMat3, DVec3, Vec3};

/// A body in the axes of the pair's first body, relative to that body's centre of mass, in metres. Double precision
/// keeps all digits far from the origin and between bodies of very different size.
pub struct Side<'a> {
    pub mesh: &'a CollisionMesh,
    pub features: &'a MeshFeatures,
    pub scale: Vec3,
    /// Radius of the rounding. All else is that of the core.
    pub rounding: f64,
    /// The centre of mass.
    pub center: DVec3,
    /// The other body's centre of mass.
    other_center: DVec3,
    /// Places a point of the mesh: `matrix * p + origin`.
    matrix: DMat3,
    origin: DVec3,
    inverse: DMat3,
    /// Transforms normals of the mesh: the inverse transpose, which keeps outward normals outward even if the scale
    /// mirrors.
    normal_matrix: DMat3,
    /// -1 if the scale mirrors, so that outward faces are clockwise; else 1.
    mirror: f64,
}

/// A triangle of a [`Side`].
#[derive(Clone, Copy, Default)]
pub struct Triangle {
    pub number: u32,
    pub corners: [DVec3; 3],
    /// Unit vector, outward. Normals of two-sided triangles point to the other body.
    pub normal: DVec3,
    /// 1 if the corners are counter-clockwise about the normal, else -1.
    pub winding_sign: f64,
    /// One bit per edge, set if it leads to the vertex of the smaller number. Both triangles of an edge follow it from
    /// there.
    pub backward: u32,
}

/// Rounding allowance, as a factor on [`ARC`], of the angle between a triangle's normal and a contact normal at its
/// edges.
pub(crate) const ARC_SLACK: f64 = 1.1;

/// Two bodies coincide if their centres differ by less than this part of their size and their rotations by less than
/// this many radians.
pub(crate) const SAME_PLACE: f64 = 1.0e-4;
/// Offset that separates coinciding bodies, in units of their size.
pub(crate) const NUDGE: f64 = 1.0e-3;

/// The two bodies of a pair.
pub fn sides<'a>([a, b]: [&PlacedMesh<'a>; 2]) -> [Side<'a>; 2] {
    let to_a = a.frame.rotation.transpose();
    let nudge = nudge(a, b);
    let center_b = to_a * (b.frame.center - a.frame.center + nudge);
    let side = |own: &PlacedMesh<'a>, rotation: DMat3, nudge: DVec3, center: DVec3, other_center: DVec3| {
        let frame = own.frame;
        let inverse = DMat3::from_diagonal(frame.scale.recip()) * rotation.transpose();
        Side {
            mesh: own.mesh,
            features: own.mesh.features(),
            scale: own.scale,
            rounding: f64::from(own.rounding),
            center,
            other_center,
            matrix: rotation * DMat3::from_diagonal(frame.scale),
            origin: to_a * (frame.position - a.frame.center + nudge),
            inverse,
            normal_matrix: inverse.transpose(),
            mirror: frame.scale.element_product().signum(),
        }
    };
    [
        side(a, DMat3::IDENTITY, DVec3::ZERO, DVec3::ZERO, center_b),
        side(b, to_a * b.frame.rotation, nudge, center_b, DVec3::ZERO),
    ]
}

/// How far apart cores are whose rounded surfaces touch; 0 without rounding.
pub fn rounding([a, b]: &[Side; 2]) -> f64 {
    a.rounding + b.rounding
}

/// Offset of the second of two bodies with equal meshes; not zero if they coincide. Coinciding surfaces have no
/// contours, so nothing would separate them. The meshes may have been loaded twice.
fn nudge(a: &PlacedMesh, b: &PlacedMesh) -> DVec3 {
    let size = f64::from(a.radius.min(b.radius));
    let same = a.mesh.fingerprint() == b.mesh.fingerprint()
        && a.scale == b.scale
        && a.frame.center.distance(b.frame.center) < SAME_PLACE * size
        && a.frame.rotation.abs_diff_eq(b.frame.rotation, SAME_PLACE);
    if same {
        DEFAULT_DIRECTION * (NUDGE * size)
    } else {
        DVec3::ZERO
    }
}

/// Eight elements of a list from `first` on, and `beyond` after its end.
#[inline(always)]
fn eight_from<T: Copy>(list: &[T], first: u32, beyond: T) -> [T; 8] {
    let list = &list[first as usize..];
    match list.first_chunk() {
        Some(eight) => *eight,
        None => each_lane(|lane| list.get(lane).copied().unwrap_or(beyond)),
    }
}

impl Side<'_> {
    /// Places a vertex of [`MeshFeatures`].
    #[inline(always)]
    pub fn vertex(&self, v: u32) -> DVec3 {
        self.place(self.features.vertices[v as usize])
    }

    /// Places a point of the mesh.
    #[inline(always)]
    pub fn place(&self, p: Vec3) -> DVec3 {
        self.matrix * p.as_dvec3() + self.origin
    }

    /// Rotation and scale of the mesh.
    pub fn matrix(&self) -> DMat3 {
        self.matrix
    }

    /// Transforms a placed point back to the mesh.
    pub fn to_mesh(&self, p: DVec3) -> DVec3 {
        self.inverse * (p - self.origin)
    }

    /// The direction in which heights of the mesh's points are heights of placed points along `d`.
    pub fn direction_from(&self, d: DVec3) -> DVec3 {
        self.matrix.transpose() * d
    }

    /// Transforms a direction back to the mesh, with its length.
    pub fn direction_to_mesh(&self, d: DVec3) -> DVec3 {
        self.inverse * d
    }

    /// A placed triangle. Its normal is computed from the placed corners, so corners in its plane have a height of
    /// nearly zero.
    #[inline(always)]
    pub fn triangle(&self, number: u32) -> Triangle {
        let vertices = self.features.triangles[number as usize];
        let corners = each(|k| self.vertex(vertices[k]));
        let [p, q, r] = corners;
        let cross = (q - p).cross(r - p) * self.mirror;
        let length = cross.length();
        // If the scale flattens the triangle, it keeps the transformed normal of its mesh.
        let normal = if length > f64::MIN_POSITIVE {
            cross / length
        } else {
            self.baked_normal(number)
        };
        let (normal, winding_sign) = self.towards_other(number, normal, p);
        let [u, v, w] = vertices;
        Triangle {
            number,
            corners,
            normal,
            winding_sign,
            backward: u32::from(u > v) | u32::from(v > w) << 1 | u32::from(w > u) << 2,
        }
    }

    /// 1 if the placed corners are counter-clockwise seen from outside, else -1.
    pub fn winding(&self) -> f32 {
        self.mirror as f32
    }

    /// For eight triangles from `first` on, the largest angle between a triangle's normal and a contact normal at an
    /// edge that it owns, radians.
    #[inline(always)]
    pub fn edge_normal_rotations<S: Simd>(&self, simd: S, first: u32) -> f32x8<S> {
        self.rotations(simd, &self.features.edge_normal_rotations, first)
    }

    /// For eight triangles from `first` on, the largest angle between a triangle's normal and the way to a point to
    /// which it is nearest at a vertex or edge that it owns, radians.
    #[inline(always)]
    pub fn nearest_rotations<S: Simd>(&self, simd: S, first: u32) -> f32x8<S> {
        self.rotations(simd, &self.features.nearest_rotations, first)
    }

    #[inline(always)]
    fn rotations<S: Simd>(&self, simd: S, of_triangles: &[f32], first: u32) -> f32x8<S> {
        let any = splat(simd, ANY_NORMAL);
        // Non-uniform scales change angles.
        let scale = self.scale.abs();
        if scale.max_element() > scale.min_element() * (1.0 + 1.0e-6) {
            return any;
        }
        let rotations = eight_from(of_triangles, first, ANY_NORMAL);
        let wider = f32x8::simd_from(simd, rotations) + splat(simd, ARC_SLACK as f32 * ARC as f32);
        wider.min(any)
    }

    /// What eight triangles from `first` on own, see [`MeshFeatures::owned`].
    #[inline(always)]
    pub fn owned(&self, first: u32) -> [u32; 8] {
        eight_from(&self.features.owned, first, 0)
    }

    /// Normal of a triangle, in the precision of the baked normals.
    #[inline]
    pub fn normal(&self, number: u32) -> DVec3 {
        // The position matters only for two-sided triangles.
        let corner = if self.features.one_sided.is(number as usize) {
            DVec3::ZERO
        } else {
            self.vertex(self.features.triangles[number as usize][0])
        };
        self.towards_other(number, self.baked_normal(number), corner).0
    }

    #[inline]
    fn baked_normal(&self, number: u32) -> DVec3 {
        // A segment has no normal.
        (self.normal_matrix * self.features.normals[number as usize].as_dvec3()).normalize_or_zero()
    }

    #[inline(always)]
    fn towards_other(&self, number: u32, normal: DVec3, corner: DVec3) -> (DVec3, f64) {
        if !self.features.one_sided.is(number as usize) && normal.dot(self.other_center - corner) < 0.0 {
            (-normal, -self.mirror)
        } else {
            (normal, self.mirror)
        }
    }

    /// Normal of the triangle across an edge from its owner; `None` at a boundary edge.
    #[inline]
    pub fn across(&self, edge: u32) -> Option<DVec3> {
        let number = self.features.across[edge as usize];
        (number != NONE).then(|| self.normal(number))
    }

    /// Normal of the smooth surface at a vertex, of any length; zero if it has none.
    pub fn smooth_normal(&self, vertex: u32) -> DVec3 {
        self.normal_matrix * self.features.vertex_normals[vertex as usize].as_dvec3()
    }

    /// The smooth surface around a vertex; `None` at a corner.
    pub fn round_vertex(&self, vertex: u32) -> Option<RoundVertex> {
        let round = &self.features.roundness[vertex as usize];
        RoundVertex::new(round, &self.matrix, self.smooth_normal(vertex), self.scale.as_dvec3())
    }

    /// Lower bound of the surface's curvature in all directions at a triangle, 1/m; 0 if it is not convex in all
    /// directions or not finely tessellated.
    pub fn curvature(&self, triangle: u32) -> f64 {
        let scale = self.scale.as_dvec3().abs();
        // The flattest point of a sphere scaled to an ellipsoid has the radius of curvature `longest^2 / shortest`.
        let flattest = scale.max_element() * scale.max_element() / scale.min_element();
        f64::from(self.features.curvature[triangle as usize]) / flattest
    }

    /// Whether its core is a segment or a point.
    pub fn is_thin(&self) -> bool {
        self.mesh.mesh.is_thin()
    }

    /// Its core, if that is a point.
    pub fn point(&self) -> Option<DVec3> {
        (self.is_thin() && self.features.vertices.len() == 1).then(|| self.vertex(0))
    }

    /// Longest side of its box along its own axes, with the rounding.
    pub fn diameter(&self) -> f64 {
        let aabb = self.mesh.lanes().aabb;
        f64::from(((aabb.max - aabb.min) * self.scale.abs()).max_element()) + 2.0 * self.rounding
    }

    /// Index of a triangle in the source mesh.
    pub fn face(&self, triangle: u32) -> u32 {
        self.mesh.mesh.face_ids()[triangle as usize]
    }
}
