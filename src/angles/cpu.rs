//! Angles on the CPU: a parallel filter of sphere pairs that keeps their order.

mod support_axis;
mod view;

pub(crate) use support_axis::best_axis;

use crate::parallel::in_order::InOrder;
use crate::state::margins::SpeculativeMargins;
use crate::state::mesh_arena::MeshArena;
use crate::state::{Bodies, NearPair, StepConfig};

/// Memory kept between steps.
pub(crate) type Scratch = InOrder<NearPair>;

/// Pairs per task.
const TASK: usize = 64;

/// Writes the `sphere_pairs` that no support axis separates by more than their speculative margin into `near_pairs`, in
/// the same order. Returns how many of them are tested with some triangles left out.
pub(crate) fn run(
    config: &StepConfig,
    bodies: &Bodies,
    meshes: &MeshArena,
    margins: SpeculativeMargins,
    sphere_pairs: &[[u32; 2]],
    scratch: &mut Scratch,
    near_pairs: &mut Vec<NearPair>,
) -> usize {
    near_pairs.clear();
    scratch.extend(near_pairs, sphere_pairs, TASK, |_, &pair, near_pairs| {
        let margin = margins.of_pair(bodies, meshes, config, pair);
        near_pairs.extend(support_axis::near_pair(bodies, meshes, pair, margin));
    });
    near_pairs.iter().filter(|pair| pair.is_approximate()).count()
}
