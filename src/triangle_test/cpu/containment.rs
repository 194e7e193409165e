//! Containment: whether one body lies inside the other when no faces intersect.
//!
//! Without intersecting faces each connected component lies completely inside or outside a closed mesh. So one vertex
//! of each component decides, by its winding number along a ray.

use crate::asset::CollisionMesh;
use crate::geometry::Orientation;
use crate::geometry::cluster::CLUSTER;
use crate::geometry::crossing::crossing;
use crate::simd::lanes::{Rows, SimdBase, abs, add, all_le, bitmask, load_points, splat, splat_point, sub, widen};
use crate::simd::level::baseline;
use crate::simd::levels::visit;
use crate::simd::rounding::PAD;
use crate::state::mesh_arena::BoxGroup;
use crate::state::{NearPair, PlacedMesh};
use glam::{DVec3, Mat3, Vec3};

/// Whether either body of the pair is solid and contains a component of the other. `near` has their relative pose.
pub fn either_inside([a, b]: [&PlacedMesh; 2], near: &NearPair) -> bool {
    let back = near.rotation.transpose();
    let pad = PAD * (a.radius + b.radius);
    any_inside(a, b, back, -(back * near.translation), pad) || any_inside(b, a, near.rotation, near.translation, pad)
}

/// Whether `outer` contains a component of `inner`. `rotation` and `translation` lead from the axes of `inner`, about
/// its centre of mass, to those of `outer`.
fn any_inside(inner: &PlacedMesh, outer: &PlacedMesh, rotation: Mat3, translation: Vec3, pad: f32) -> bool {
    if !outer.mesh.mesh.is_solid() {
        return false;
    }
    let matrix = rotation * Mat3::from_diagonal(inner.scale);
    let simd = baseline();
    let (turn, spread) = (Rows::new(simd, matrix), Rows::new(simd, matrix.abs()));
    let aabb = outer.mesh.lanes().aabb;
    let middle = splat_point(simd, translation - aabb.center() * outer.scale);
    let outer_half = splat_point(simd, aabb.half_size() * outer.scale.abs() + pad);
    // The box test only saves work, so the boxes may be slightly too large.
    let boxed = |group: &BoxGroup| {
        let center = turn.times(load_points(simd, &group.center));
        let half = spread.times(load_points(simd, &group.half));
        bitmask(all_le(abs(add(center, middle)), add(half, outer_half)))
    };
    let (mesh, lanes) = (&inner.mesh.mesh, inner.mesh.lanes());
    let to_outer = outer.frame.rotation.transpose();
    let none = visit(&lanes.component_levels, boxed, |run| {
        let first = run as usize * CLUSTER;
        !lanes.components[first..lanes.components.len().min(first + CLUSTER)]
            .iter()
            .any(|&v| {
                let world = inner.frame.rotation * (inner.frame.scale * mesh.vertices()[v as usize].as_dvec3())
                    + (inner.frame.position - outer.frame.position);
                contains(outer.mesh, (to_outer * world) / outer.frame.scale)
            })
    });
    !none
}

/// Whether a closed mesh contains `p`, a point in the mesh's space: the signed crossings of the ray from `p` along +z
/// do not cancel, or, if the winding of the faces is inconsistent, their number is odd. Welded corners are used, so no
/// ray slips through a seam, and the caps of a nearly closed mesh count too.
///
/// Only clusters whose boxes the ray meets are tested.
pub fn contains(baked: &CollisionMesh, p: DVec3) -> bool {
    let (mesh, lanes) = (&baked.mesh, baked.lanes());
    let from = (p - baked.mass.center.as_dvec3()).as_vec3();
    let simd = baseline();
    let start = splat_point(simd, from);
    // The rounding errors of boxes and start point are below a millionth of the mesh, which is also about how far
    // outside the start can be.
    let pad = splat(simd, PAD * (lanes.aabb.max - lanes.aabb.min).length());
    let met = |group: &BoxGroup| {
        let [x, y, z] = sub(load_points(simd, &group.center), start);
        let half = widen(load_points(simd, &group.half), pad);
        bitmask(x.abs().simd_le(half[0]) & y.abs().simd_le(half[1]) & z.simd_ge(-half[2]))
    };
    let mut winding = 0i32;
    let mut crossings = 0u32;
    visit(&lanes.levels, met, |cluster| {
        let first = cluster as usize * CLUSTER;
        for t in first..mesh.triangles().len().min(first + CLUSTER) {
            let corners = mesh.welded_corners(t).map(|v| v.as_dvec3() - p);
            if let Some(sign) = crossing(&corners) {
                winding += sign;
                crossings += 1;
            }
        }
        true
    });
    if !mesh.caps().is_empty() {
        visit(&lanes.cap_levels, met, |run| {
            let first = run as usize * CLUSTER;
            let caps = &mesh.caps()[first..mesh.caps().len().min(first + CLUSTER)];
            let crossings = caps.iter().filter_map(|cap| crossing(&cap.map(|v| v.as_dvec3() - p)));
            winding += crossings.sum::<i32>();
            true
        });
    }
    match mesh.orientation() {
        Orientation::Mixed => crossings % 2 == 1,
        _ => winding != 0,
    }
}
