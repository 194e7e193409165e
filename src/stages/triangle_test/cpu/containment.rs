//! Whether one body lies inside the other when no faces intersect.
//!
//! Without intersecting faces each connected component lies inside a closed mesh as a whole or not at all, so one
//! vertex of each decides, by the winding number along a ray.

use super::lanes::{each, splat, sub};
use super::levels::visit;
use crate::geometry::Orientation;
use crate::geometry::cluster::CLUSTER;
use crate::stages::angles::PAD;
use crate::stages::mesh_arena::{BoxGroup, MeshArena, MeshSlot};
use crate::stages::state::{Bodies, Frame, NearPair};
use glam::DVec3;
use wide::f32x8;

/// Whether either body of the pair is closed and has some component of the other inside.
pub fn either_inside(bodies: &Bodies, meshes: &MeshArena, pair: &NearPair) -> bool {
    let [a, b] = pair.bodies.map(|i| {
        let i = i as usize;
        (&meshes[bodies.mesh[i]], &bodies.frame[i])
    });
    any_inside(a, b) || any_inside(b, a)
}

fn any_inside((inner, inner_frame): (&MeshSlot, &Frame), (outer, outer_frame): (&MeshSlot, &Frame)) -> bool {
    if !outer.mesh.mesh.is_closed() {
        return false;
    }
    // Lanes are about the centre of mass and rounded; the box only saves work, so it may be a little large.
    let center = outer.mesh.mass.center.as_dvec3();
    let (low, high) = (outer.lanes.aabb.min.as_dvec3(), outer.lanes.aabb.max.as_dvec3());
    let pad = DVec3::splat(1.0e-6 * (high - low).length());
    let mesh = &inner.mesh.mesh;
    mesh.component_vertices().iter().any(|&v| {
        let world = inner_frame.rotation * (inner_frame.scale * mesh.vertices()[v as usize].as_dvec3())
            + (inner_frame.position - outer_frame.position);
        let p = (outer_frame.rotation.transpose() * world) / outer_frame.scale;
        let boxed = (p - center).cmpge(low - pad).all() && (p - center).cmple(high + pad).all();
        boxed && contains(outer, p)
    })
}

/// Whether a closed mesh has `p`, in its own space, inside: the signed crossings of the ray from `p` along +z do not
/// cancel, or, if neighbouring faces disagree about the outside, their number is odd.
///
/// Only clusters whose boxes the ray meets are asked: no other triangle can be crossed.
fn contains(slot: &MeshSlot, p: DVec3) -> bool {
    let (mesh, lanes) = (&slot.mesh.mesh, &slot.lanes);
    let from = (p - slot.mesh.mass.center.as_dvec3()).as_vec3();
    let start = splat(from);
    // Boxes and start are rounded, by less than a millionth of the mesh, which is about as far as the start can be.
    let pad = f32x8::splat(PAD * (lanes.aabb.max - lanes.aabb.min).length());
    let met = |group: &BoxGroup| {
        let [x, y, z] = sub(group.center, start);
        let half = each(|i| group.half[i] + pad);
        (x.abs().simd_le(half[0]) & y.abs().simd_le(half[1]) & z.simd_ge(-half[2])).to_bitmask()
    };
    let mut winding = 0i32;
    let mut crossings = 0u32;
    visit(&lanes.levels, &met, &mut |cluster| {
        let first = cluster as usize * CLUSTER;
        for t in first..mesh.triangles().len().min(first + CLUSTER) {
            let corners = mesh.corners(t).map(|v| v.as_dvec3() - p);
            if let Some(sign) = crossing(&corners) {
                winding += sign;
                crossings += 1;
            }
        }
        true
    });
    match mesh.orientation() {
        Orientation::Mixed => crossings % 2 == 1,
        _ => winding != 0,
    }
}

/// Whether the ray from the origin along +z crosses the triangle, and from which side. A ray through an edge or corner
/// is moved aside by an infinitely small step, the same for all triangles, so that neighbours never both count it, nor
/// neither.
fn crossing(t: &[DVec3; 3]) -> Option<i32> {
    let left = |p: DVec3, q: DVec3| {
        // Exactly antisymmetric in p and q, as are the ties: both triangles at an edge agree.
        let side = p.x * q.y - p.y * q.x;
        if side != 0.0 {
            side > 0.0
        } else {
            (q.x, q.y) > (p.x, p.y)
        }
    };
    let sides = [left(t[0], t[1]), left(t[1], t[2]), left(t[2], t[0])];
    if sides != [sides[0]; 3] {
        return None;
    }
    // The plane's height over the origin.
    let normal = (t[1] - t[0]).cross(t[2] - t[0]);
    let above = normal.dot(t[0]) * normal.z > 0.0;
    above.then_some(if sides[0] { 1 } else { -1 })
}
