//! The support-axis cull of one pair: Gilbert's iteration over the support heights of both meshes.

use super::view;
use crate::angles::AXES;
use crate::simd::rounding::PAD;
use crate::state::mesh_arena::MeshArena;
use crate::state::{Bodies, NearPair, PlacedMesh, View};
use glam::{DMat3, Mat3, Vec3};

/// The pair with its best support axis and visible triangles; `None` if an axis separates the two by more than
/// `margin`.
pub fn near_pair(bodies: &Bodies, meshes: &MeshArena, pair: [u32; 2], margin: f32) -> Option<NearPair> {
    let [a, b] = pair.map(|i| PlacedMesh::of(bodies, meshes, i));
    let best = NearPair {
        bodies: pair,
        ..best_axis([&a, &b], margin)?
    };
    Some(NearPair {
        views: view::of_pair(bodies, meshes, &best, PAD * (a.radius + b.radius)),
        ..best
    })
}

/// The best support axis of two placed meshes with all triangles visible, as bodies 0 and 1; `None` if an axis
/// separates the two by more than `margin`.
pub fn best_axis([a, b]: [&PlacedMesh; 2], margin: f32) -> Option<NearPair> {
    let to_a: DMat3 = a.frame.rotation.transpose();
    let rotation = (to_a * b.frame.rotation).as_mat3();
    let translation = (to_a * (b.frame.center - a.frame.center)).as_vec3();
    let size = a.radius + b.radius;
    let pad = PAD * size;
    let to_b = rotation.transpose();

    let most = margin + 2.0 * pad;
    if is_beyond_box(b, a, rotation, translation, most) || is_beyond_box(a, b, to_b, to_b * -translation, most) {
        return None;
    }
    let mut best = NearPair {
        bodies: [0, 1],
        rotation,
        translation,
        axis: Vec3::ZERO,
        b_above: f32::NEG_INFINITY,
        a_below: f32::INFINITY,
        views: [View::All; 2],
        margin,
    };
    let mut best_overlap = f32::INFINITY;
    // The point of the Minkowski difference of `a` and `b` that is nearest to the origin so far; at first the
    // difference of the centres.
    let mut nearest = -translation;
    for _ in 0..AXES {
        let length = nearest.length();
        if length <= pad {
            break;
        }
        let u = nearest / -length;
        // The support point of a scaled body along u is the scaled support point along the scaled u.
        let pa = a.core_support(u);
        let pb = translation + rotation * b.core_support(to_b * -u);
        let (a_below, b_above) = (pa.dot(u) + a.rounding, pb.dot(u) - b.rounding);
        let overlap = a_below - b_above;
        if overlap < -2.0 * pad - margin {
            return None;
        }
        if overlap < best_overlap {
            best_overlap = overlap;
            best = NearPair {
                axis: u,
                a_below: a_below + pad,
                b_above: b_above - pad,
                ..best
            };
        }
        let (from, to) = (nearest, (pa - pb) - nearest);
        let t = (-from.dot(to) / to.length_squared()).clamp(0.0, 1.0);
        // This axis gives no nearer point; NaN if both points coincide.
        if t.is_nan() || t <= 0.0 {
            break;
        }
        nearest = from + to * t;
    }
    Some(best)
}

/// Whether a thin core is farther from the box of another body than both roundings and `distance`. Most pairs of a ball
/// and a large box are, and this tells it soon. `rotation` leads to the other's axes, and `at` is the centre of mass of
/// the thin one there.
fn is_beyond_box(thin: &PlacedMesh, other: &PlacedMesh, rotation: Mat3, at: Vec3, distance: f32) -> bool {
    let Some([start, end]) = thin.thin_ends() else {
        return false;
    };
    let aabb = other.mesh.lanes().aabb;
    let [start, end] = [start, end].map(|end| at + rotation * end - other.scale * aabb.center());
    let half = other.scale.abs() * aabb.half_size() + (thin.rounding + other.rounding + distance);
    (start.min(end).cmpgt(half) | start.max(end).cmplt(-half)).any()
}
