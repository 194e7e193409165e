//! Cluster culling: the clusters of one body that may touch the other body.

use crate::geometry::Aabb;
use crate::simd::lanes::{
    Points, Rows, Simd, SimdBase, abs, add, all_le, bitmask, bits, dot, f32x8, load_points, max, mul, splat,
    splat_point, sub,
};
use crate::state::mesh_arena::{BoxGroup, MeshLanes};
use glam::{Mat3, Vec3};

/// The bounds of the other body against which a body's clusters are culled. All are in the culled body's scaled axes
/// about its centre of mass, unless said otherwise.
pub struct OtherBounds {
    /// Rotation from the body's axes to the other's.
    pub rotation: Mat3,
    /// From the other's centre of mass to the body's, in the other's axes.
    pub translation: Vec3,
    /// The other's bounding box in its own axes.
    pub aabb: Aabb,
    /// The other's centre of mass.
    pub center: Vec3,
    /// The other's bounding radius.
    pub radius: f32,
    /// Best support axis, towards the other.
    pub axis: Vec3,
    /// Lower bound of the other along the axis. Clusters below it cannot touch.
    pub min_height: f32,
    /// Rounding allowance.
    pub pad: f32,
}

struct CullTest<S: Simd> {
    simd: S,
    scale: Points<S>,
    scale_abs: Points<S>,
    own_center: Points<S>,
    own_half: Points<S>,
    rotation: Rows<S>,
    rotation_abs: Rows<S>,
    translation: Points<S>,
    other_half: Points<S>,
    sphere_center: Points<S>,
    sphere_square: f32x8<S>,
    axis: Points<S>,
    axis_abs: Points<S>,
    min_height: f32x8<S>,
}

/// Writes into `clusters`, in ascending order, those clusters of `mesh` (scaled by `scale`) that may touch the other
/// body.
#[inline(always)]
pub fn clusters<S: Simd>(
    simd: S,
    mesh: &MeshLanes,
    scale: Vec3,
    other: &OtherBounds,
    nodes: &mut Vec<u32>,
    clusters: &mut Vec<u32>,
) {
    let test = CullTest::new(simd, scale, other);
    // Traverses the implicit tree level by level: child `8 g + lane` of group `g` is the group of that number one level
    // below, or a cluster at the bottom.
    clusters.clear();
    clusters.push(0);
    for level in mesh.levels.iter().rev() {
        std::mem::swap(nodes, clusters);
        clusters.clear();
        for &g in nodes.iter() {
            clusters.extend(bits(test.survivors(&level[g as usize])).map(|lane| 8 * g + lane as u32));
        }
    }
}

impl<S: Simd> CullTest<S> {
    #[inline(always)]
    fn new(simd: S, scale: Vec3, other: &OtherBounds) -> Self {
        let OtherBounds { rotation, pad, .. } = *other;
        let (center, half) = (other.aabb.center(), other.aabb.half_size());
        let to_own = rotation.transpose();
        Self {
            simd,
            scale: splat_point(simd, scale),
            scale_abs: splat_point(simd, scale.abs()),
            own_center: splat_point(simd, to_own * (center - other.translation)),
            own_half: splat_point(simd, to_own.abs() * half + pad),
            rotation: Rows::new(simd, rotation),
            rotation_abs: Rows::new(simd, rotation.abs()),
            translation: splat_point(simd, other.translation - center),
            other_half: splat_point(simd, half + pad),
            sphere_center: splat_point(simd, other.center),
            sphere_square: splat(simd, (other.radius + pad) * (other.radius + pad)),
            axis: splat_point(simd, other.axis),
            axis_abs: splat_point(simd, other.axis.abs()),
            min_height: splat(simd, other.min_height - pad),
        }
    }

    #[inline(always)]
    fn survivors(&self, group: &BoxGroup) -> u32 {
        let center = mul(load_points(self.simd, &group.center), self.scale);
        let half = mul(load_points(self.simd, &group.half), self.scale_abs);

        let distance = abs(sub(center, self.own_center));
        let mut alive = all_le(distance, add(half, self.own_half));

        let reach = dot(center, self.axis) + dot(half, self.axis_abs);
        alive &= reach.simd_ge(self.min_height);

        let nearest = sub(abs(sub(center, self.sphere_center)), half);
        let nearest = max(nearest, splat_point(self.simd, Vec3::ZERO));
        alive &= dot(nearest, nearest).simd_le(self.sphere_square);

        let distance = abs(add(self.rotation.times(center), self.translation));
        alive &= all_le(distance, add(self.rotation_abs.times(half), self.other_half));
        bitmask(alive)
    }
}
