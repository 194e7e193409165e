//! Cluster culling: the clusters of one body that may touch the other body.

use crate::geometry::Aabb;
use crate::simd::lanes::{Rows, bits, dot, each, mul, splat};
use crate::state::mesh_arena::{BoxGroup, MeshLanes, Points};
use glam::{Mat3, Vec3};
use wide::f32x8;

/// The bounds of the other body against which a body's clusters are culled. All are in the culled body's scaled axes
/// about its centre of mass, unless said otherwise.
pub struct Other {
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

struct Test {
    scale: Points,
    scale_abs: Points,
    own_center: Points,
    own_half: Points,
    rotation: Rows,
    rotation_abs: Rows,
    translation: Points,
    other_half: Points,
    sphere_center: Points,
    sphere_square: f32x8,
    axis: Points,
    axis_abs: Points,
    min_height: f32x8,
}

/// Writes into `clusters`, in ascending order, those clusters of `mesh` (scaled by `scale`) that may touch the other
/// body.
pub fn clusters(mesh: &MeshLanes, scale: Vec3, other: &Other, nodes: &mut Vec<u32>, clusters: &mut Vec<u32>) {
    let test = Test::new(scale, other);
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

impl Test {
    fn new(scale: Vec3, other: &Other) -> Self {
        let Other { rotation, pad, .. } = *other;
        let (center, half) = (other.aabb.center(), other.aabb.half_size());
        let to_own = rotation.transpose();
        Self {
            scale: splat(scale),
            scale_abs: splat(scale.abs()),
            own_center: splat(to_own * (center - other.translation)),
            own_half: splat(to_own.abs() * half + pad),
            rotation: Rows::new(rotation),
            rotation_abs: Rows::new(rotation.abs()),
            translation: splat(other.translation - center),
            other_half: splat(half + pad),
            sphere_center: splat(other.center),
            sphere_square: f32x8::splat((other.radius + pad) * (other.radius + pad)),
            axis: splat(other.axis),
            axis_abs: splat(other.axis.abs()),
            min_height: f32x8::splat(other.min_height - pad),
        }
    }

    #[inline]
    fn survivors(&self, group: &BoxGroup) -> u32 {
        let center = mul(group.center, self.scale);
        let half = mul(group.half, self.scale_abs);

        let distance = each(|i| (center[i] - self.own_center[i]).abs());
        let mut alive = within(distance, half, self.own_half);

        let reach = dot(center, self.axis) + dot(half, self.axis_abs);
        alive &= reach.simd_ge(self.min_height);

        let nearest = each(|i| ((center[i] - self.sphere_center[i]).abs() - half[i]).fast_max(f32x8::ZERO));
        alive &= dot(nearest, nearest).simd_le(self.sphere_square);

        let turned = self.rotation.times(center);
        let distance = each(|i| (turned[i] + self.translation[i]).abs());
        alive &= within(distance, self.rotation_abs.times(half), self.other_half);
        alive.to_bitmask()
    }
}

#[inline(always)]
fn within(distance: Points, half_a: Points, half_b: Points) -> f32x8 {
    let ok = |i: usize| distance[i].simd_le(half_a[i] + half_b[i]);
    ok(0) & ok(1) & ok(2)
}
