//! BroadPhase on the CPU: a parallel sort by cell, then one binary search per cell and row.

use super::{BITS, CELLS, cell, key};
use crate::components::RigidBody;
use crate::stages::state::{Bodies, StepState};
use glam::Vec3;
use rayon::prelude::*;

/// Memory kept between steps.
#[derive(Default)]
pub(crate) struct Scratch {
    sorted: Vec<(u64, u32)>,
    spheres: Vec<(Vec3, f32)>,
    found: Vec<Vec<[u32; 2]>>,
}

/// Bodies per task.
const TASK: usize = 256;

/// Fills `state.sphere_pairs`.
pub fn run(state: &mut StepState) {
    let StepState {
        bodies,
        sphere_pairs,
        grid_scratch: Scratch { sorted, spheres, found },
        ..
    } = state;
    sphere_pairs.clear();
    let largest = bodies.radius.iter().copied().fold(0.0, f32::max);
    if largest == 0.0 {
        return;
    }
    // A little more than the largest diameter, so that rounding cannot move a pair two cells apart.
    let per_meter = 1.0 / (2.0 * largest as f64 * (1.0 + 1.0e-6));

    sorted.clear();
    sorted.par_extend(bodies.center.par_iter().enumerate().map(|(i, c)| {
        let [x, y, z] = c.to_array().map(|x| cell(x, per_meter));
        (key(x, y, z), i as u32)
    }));
    sorted.par_sort_unstable();
    spheres.clear();
    spheres.par_extend(
        sorted
            .par_iter()
            .map(|&(_, i)| (bodies.center[i as usize], bodies.radius[i as usize])),
    );

    found.resize_with(sorted.len().div_ceil(TASK), Vec::new);
    found.par_iter_mut().enumerate().for_each(|(task, found)| {
        found.clear();
        let first = task * TASK;
        let last = (first + TASK).min(sorted.len());
        let mut rows = [(0, 0); 4];
        let mut current = None;
        for i in first..last {
            let cell = sorted[i].0;
            if current.replace(cell) != Some(cell) {
                rows = later_rows(sorted, cell);
            }
            // Same cell or the next one along x.
            let mut rest = i + 1;
            while rest < sorted.len() && sorted[rest].0 <= cell + 1 {
                rest += 1;
            }
            for (from, to) in [(i + 1, rest), rows[0], rows[1], rows[2], rows[3]] {
                for j in from..to {
                    if overlap(spheres[i], spheres[j]) {
                        let (a, b) = (sorted[i].1, sorted[j].1);
                        let pair = [a.min(b), a.max(b)];
                        if may_collide(bodies, pair) {
                            found.push(pair);
                        }
                    }
                }
            }
        }
    });
    for found in found.iter() {
        sphere_pairs.extend_from_slice(found);
    }
    // The one order that depends on nothing but the bodies.
    sphere_pairs.par_sort_unstable();
}

/// Runs of `sorted` that hold the three neighbours along x in each of the four neighbouring rows after the cell's own.
fn later_rows(sorted: &[(u64, u32)], cell: u64) -> [(usize, usize); 4] {
    let mask = (1 << BITS) - 1;
    let (x, y, z) = (cell & mask, (cell >> BITS) & mask, cell >> (2 * BITS));
    let last = 2 * CELLS as u64 - 1;
    [(1, 0), (-1, 1), (0, 1), (1, 1)].map(|(dy, dz)| {
        let (Some(y), z) = (y.checked_add_signed(dy), z + dz) else {
            return (0, 0);
        };
        if y > last || z > last {
            return (0, 0);
        }
        let low = key(x.saturating_sub(1), y, z);
        let high = key((x + 1).min(last), y, z);
        let from = sorted.partition_point(|&(k, _)| k < low);
        let count = sorted[from..].iter().take_while(|&&(k, _)| k <= high).count();
        (from, from + count)
    })
}

fn overlap((p, r): (Vec3, f32), (q, s): (Vec3, f32)) -> bool {
    p.distance_squared(q) <= (r + s) * (r + s) * (1.0 + 1.0e-6)
}

fn may_collide(bodies: &Bodies, [a, b]: [u32; 2]) -> bool {
    let (a, b) = (a as usize, b as usize);
    let either = |kind| bodies.kind[a] == kind || bodies.kind[b] == kind;
    let sensor = bodies.sensor[a] || bodies.sensor[b];
    let moved = either(RigidBody::Dynamic) || (sensor && either(RigidBody::Kinematic));
    moved && bodies.layers[a].interacts_with(bodies.layers[b])
}
