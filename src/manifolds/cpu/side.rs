//! One body of a pair, in the axes of the pair's first body.

use super::feature::ARC;
use crate::asset::CollisionMesh;
use crate::geometry::features::{ANY_NORMAL, MeshFeatures, NONE};
use crate::simd::lanes::each;
use crate::state::Frame;
use glam::{DMat3, DVec3, Vec3};
use wide::f32x8;

/// A mesh in the world.
pub struct PlacedMesh<'a> {
    pub mesh: &'a CollisionMesh,
    pub frame: &'a Frame,
    pub scale: Vec3,
    /// Of the bounding sphere about the centre of mass, rounded up.
    pub radius: f32,
}

/// A body, placed in the axes of the pair's first body about that body's centre of mass, in metres. Double precision: digits
/// are lost neither far from the origin nor between a small body and a large one.
pub struct Side<'a> {
    pub mesh: &'a CollisionMesh,
    pub features: &'a MeshFeatures,
    pub scale: Vec3,
    /// The centre of mass.
    pub center: DVec3,
    /// The other body's.
    other_center: DVec3,
    /// Corner of the mesh to point: `matrix * p + origin`.
    matrix: DMat3,
    origin: DVec3,
    inverse: DMat3,
    /// Turns normals of the mesh: the transposed inverse, which keeps outward what is outward even if the scale mirrors.
    normal_matrix: DMat3,
    /// Minus one if the scale mirrors, so that corners run clockwise seen from outside.
    mirror: f64,
}

/// A triangle of a [`Side`].
#[derive(Clone, Copy, Default)]
pub struct Triangle {
    pub number: u32,
    pub corners: [DVec3; 3],
    /// Unit vector, outward; of triangles with two sides towards the other body.
    pub normal: DVec3,
    /// 1 if the corners run counter-clockwise about the normal, else -1.
    pub handed: f64,
}

/// A contact's normal may turn from a triangle's by this many times [`ARC`] more than to the edges: for rounding.
pub(crate) const ARC_SLACK: f64 = 1.1;

/// Bodies are in the same place if their centres differ by less than this part of their size, and their rotations by as many
/// radians.
pub(crate) const SAME_PLACE: f64 = 1.0e-4;
/// How far from there the second one is taken to be, in the same unit...
pub(crate) const ASIDE: f64 = 1.0e-3;
/// ...in a direction that is along no side of a mesh.
pub(crate) const DEFAULT_DIRECTION: DVec3 = DVec3::new(0.36, 0.48, 0.8);

/// The two bodies of a pair. `one_mesh` is whether both have the same.
pub fn sides<'a>([a, b]: [&PlacedMesh<'a>; 2], one_mesh: bool) -> [Side<'a>; 2] {
    let to_a = a.frame.rotation.transpose();
    let aside = if one_mesh { aside(a, b) } else { DVec3::ZERO };
    let center_b = to_a * (b.frame.center - a.frame.center + aside);
    let side = |own: &PlacedMesh<'a>, rotation: DMat3, aside: DVec3, center: DVec3, other_center: DVec3| {
        let frame = own.frame;
        let inverse = DMat3::from_diagonal(frame.scale.recip()) * rotation.transpose();
        Side {
            mesh: own.mesh,
            features: own.mesh.features(),
            scale: own.scale,
            center,
            other_center,
            matrix: rotation * DMat3::from_diagonal(frame.scale),
            origin: to_a * (frame.position - a.frame.center + aside),
            inverse,
            normal_matrix: inverse.transpose(),
            mirror: frame.scale.element_product().signum(),
        }
    };
    [
        side(a, DMat3::IDENTITY, DVec3::ZERO, DVec3::ZERO, center_b),
        side(b, to_a * b.frame.rotation, aside, center_b, DVec3::ZERO),
    ]
}

/// By how much the second of two bodies of one mesh is taken to be elsewhere: a little if both are in the same place. Their
/// surfaces do not cross then but are one, which would leave no way out.
fn aside(a: &PlacedMesh, b: &PlacedMesh) -> DVec3 {
    let size = f64::from(a.radius.min(b.radius));
    let same = a.scale == b.scale
        && a.frame.center.distance(b.frame.center) < SAME_PLACE * size
        && a.frame.rotation.abs_diff_eq(b.frame.rotation, SAME_PLACE);
    if same { DEFAULT_DIRECTION * (ASIDE * size) } else { DVec3::ZERO }
}

impl Side<'_> {
    /// A vertex of [`MeshFeatures`].
    #[inline]
    pub fn vertex(&self, v: u32) -> DVec3 {
        self.place(self.features.vertices[v as usize])
    }

    /// A point of the mesh.
    #[inline]
    pub fn place(&self, p: Vec3) -> DVec3 {
        self.matrix * p.as_dvec3() + self.origin
    }

    /// What turns and scales the mesh.
    pub fn matrix(&self) -> DMat3 {
        self.matrix
    }

    /// Back to a point of the mesh.
    pub fn to_mesh(&self, p: DVec3) -> DVec3 {
        self.inverse * (p - self.origin)
    }

    /// A direction, its length scaled with the mesh.
    pub fn direction_to_mesh(&self, d: DVec3) -> DVec3 {
        self.inverse * d
    }

    /// A triangle. Its normal is that of the placed corners, so that corners in its plane have a height of nearly zero.
    #[inline]
    pub fn triangle(&self, number: u32) -> Triangle {
        let vertices = self.features.triangles[number as usize];
        let corners = each(|k| self.vertex(vertices[k]));
        let [p, q, r] = corners;
        let cross = (q - p).cross(r - p) * self.mirror;
        let length = cross.length();
        // A scale that flattens the triangle leaves it the normal of its mesh.
        let normal = if length > f64::MIN_POSITIVE {
            cross / length
        } else {
            self.baked_normal(number)
        };
        let (normal, handed) = self.towards_other(normal, p);
        Triangle {
            number,
            corners,
            normal,
            handed,
        }
    }

    /// 1 if the placed corners of the mesh's triangles run counter-clockwise seen from outside, else -1.
    pub fn winding(&self) -> f32 {
        self.mirror as f32
    }

    /// For eight triangles from `first` on how far a contact's normal at an edge of theirs may turn from their own, radians.
    pub fn edge_turns(&self, first: u32) -> f32x8 {
        // Unequal scales change angles.
        let scale = self.scale.abs();
        let is_even = scale.max_element() <= scale.min_element() * (1.0 + 1.0e-6);
        let turns = &self.features.edge_normal_rotations[first as usize..];
        let slack = ARC_SLACK as f32 * ARC as f32;
        f32x8::new(std::array::from_fn(|lane| match turns.get(lane) {
            Some(turn) if is_even && turn + slack < ANY_NORMAL => turn + slack,
            _ => ANY_NORMAL,
        }))
    }

    /// Its normal alone, as exact as single precision keeps it.
    #[inline]
    pub fn normal(&self, number: u32) -> DVec3 {
        // Only two-sided triangles need to know where they are.
        let corner = if self.features.sided {
            DVec3::ZERO
        } else {
            self.vertex(self.features.triangles[number as usize][0])
        };
        self.towards_other(self.baked_normal(number), corner).0
    }

    #[inline]
    fn baked_normal(&self, number: u32) -> DVec3 {
        let n = self.normal_matrix * self.features.normals[number as usize].as_dvec3();
        n * n.length_recip()
    }

    #[inline]
    fn towards_other(&self, normal: DVec3, corner: DVec3) -> (DVec3, f64) {
        if !self.features.sided && normal.dot(self.other_center - corner) < 0.0 {
            (-normal, -self.mirror)
        } else {
            (normal, self.mirror)
        }
    }

    /// The normal of the triangle across edge `edge` from its owner.
    #[inline]
    pub fn across(&self, edge: u32) -> Option<DVec3> {
        let number = self.features.across[edge as usize];
        (number != NONE).then(|| self.normal(number))
    }

    /// Along the normal of the smooth surface at a vertex, of any length; zero if it has none.
    pub fn round_normal(&self, vertex: u32) -> DVec3 {
        self.normal_matrix * self.features.vertex_normals[vertex as usize].as_dvec3()
    }

    /// A curvature that the surface has at least in every direction at a triangle, 1/m; 0 if it is none or not finely cut.
    pub fn curvature(&self, triangle: u32) -> f64 {
        let scale = self.scale.as_dvec3().abs();
        // Of a ball squeezed to an ellipsoid the flattest place has the radius `longest^2 / shortest`.
        let flattest = scale.max_element() * scale.max_element() / scale.min_element();
        f64::from(self.features.curvature[triangle as usize]) / flattest
    }

    /// The longest side of its box along its own axes.
    pub fn diameter(&self) -> f64 {
        let aabb = self.mesh.lanes().aabb;
        f64::from(((aabb.max - aabb.min) * self.scale.abs()).max_element())
    }

    /// The number that a triangle has in the input mesh.
    pub fn face(&self, triangle: u32) -> u32 {
        self.mesh.mesh.face_ids()[triangle as usize]
    }
}
