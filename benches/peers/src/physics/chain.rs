//! A chain of rings that hangs from a static one.

use super::world::{Engine, Run, State};
use super::{Case, HZ, mean};
use bevy::math::{DQuat, DVec3};
use bevy_faceoff::testing::scenes::chain::{chain, length, linking_number};

const SECONDS: usize = 10;

/// From ring to ring at first, metres: 2 cm short of where they hang.
const LINK: f32 = 0.74;

/// `count` rings, at least two, each through the next.
pub fn case(count: usize) -> Case {
    let count = count.max(2);
    Case {
        name: format!("chain of {count} rings, {SECONDS} s"),
        quantity: "links that open; error of the length, mean over the last s",
        steps: SECONDS * HZ,
        other: Some(Engine::Parts),
        scenes: Box::new(move |_| vec![chain(count, LINK)]),
        judge: Box::new(judge),
    }
}

fn ring(state: &State) -> (DVec3, DQuat) {
    (state.center, state.rotation)
}

fn judge(runs: &[Run]) -> String {
    let run = &runs[0];
    let links = run.scene.bodies.len() - 1;
    let mut first_open = vec![None; links];
    for (step, states) in run.states.iter().enumerate() {
        for (first_open, pair) in first_open.iter_mut().zip(states.windows(2)) {
            if first_open.is_none() && linking_number(ring(&pair[0]), ring(&pair[1])) == 0 {
                *first_open = Some(step);
            }
        }
    }
    let open = first_open.iter().flatten().count();
    if let Some(first) = first_open.into_iter().flatten().min() {
        return format!(
            "**{open} of {links}, the first after {:.2} s**",
            first as f64 / HZ as f64
        );
    }
    let wanted = length(run.scene.bodies.len());
    let last = run.states.iter().rev().take(HZ);
    let length = mean(last.map(|states| states[0].center.distance(states[links].center)));
    format!("none; {:+.2} %", 100.0 * (length / wanted - 1.0))
}
