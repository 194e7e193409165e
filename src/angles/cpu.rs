//! Angles on the CPU: a parallel filter that keeps the pairs' order.

mod view;

use super::AXES;
use crate::parallel::in_order::InOrder;
use crate::simd::rounding::PAD;
use crate::state::margins::Margins;
use crate::state::mesh_arena::MeshArena;
use crate::state::{Bodies, NearPair, StepConfig, View};
use glam::{DMat3, Vec3};

/// Memory kept between steps.
pub(crate) type Scratch = InOrder<NearPair>;

/// Pairs per task.
const TASK: usize = 64;

/// Writes those of `sphere_pairs` that no support plane separates by more than their margin into `near_pairs`, in the same order.
/// Returns how many of them are tested with some triangles left out.
pub(crate) fn run(
    config: &StepConfig,
    bodies: &Bodies,
    meshes: &MeshArena,
    margins: Margins,
    sphere_pairs: &[[u32; 2]],
    scratch: &mut Scratch,
    near_pairs: &mut Vec<NearPair>,
) -> usize {
    near_pairs.clear();
    scratch.extend(near_pairs, sphere_pairs, TASK, |_, &pair, near_pairs| {
        let margin = margins.of_pair(bodies, config, pair);
        near_pairs.extend(near(bodies, meshes, pair, margin));
    });
    near_pairs.iter().filter(|pair| pair.is_approximate()).count()
}

fn near(bodies: &Bodies, meshes: &MeshArena, pair: [u32; 2], margin: f32) -> Option<NearPair> {
    let [a, b] = pair.map(|i| i as usize);
    let (fa, fb) = (&bodies.frame[a], &bodies.frame[b]);
    let to_a: DMat3 = fa.rotation.transpose();
    let rotation = (to_a * fb.rotation).as_mat3();
    let translation = (to_a * (fb.center - fa.center)).as_vec3();
    let size = bodies.radius[a] + bodies.radius[b];
    let pad = PAD * size;
    let (heights_a, heights_b) = (
        &meshes[bodies.mesh[a]].mesh.heights,
        &meshes[bodies.mesh[b]].mesh.heights,
    );
    let (scale_a, scale_b) = (bodies.scale[a], bodies.scale[b]);

    let mut best = NearPair {
        bodies: pair,
        rotation,
        translation,
        axis: Vec3::ZERO,
        b_above: f32::NEG_INFINITY,
        a_below: f32::INFINITY,
        views: [View::All; 2],
        margin,
    };
    let mut best_overlap = f32::INFINITY;
    // The nearest point known of `a` minus `b`, at first from centre to centre.
    let mut nearest = -translation;
    for _ in 0..AXES {
        let length = nearest.length();
        if length <= pad {
            break;
        }
        let u = nearest / -length;
        // A scaled body's support point along u is the scaled support point along the scaled u.
        let pa = scale_a * heights_a.support(scale_a * u);
        let pb = translation + rotation * (scale_b * heights_b.support(scale_b * (rotation.transpose() * -u)));
        let (a_below, b_above) = (pa.dot(u), pb.dot(u));
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
        // No nearer point along this axis; NaN if both points are one.
        if t.is_nan() || t <= 0.0 {
            break;
        }
        nearest = from + to * t;
    }
    best.views = view::of_pair(bodies, meshes, &best, pad);
    Some(best)
}
