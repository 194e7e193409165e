//! ForceScan on the CPU.

use super::{count_contacts, pair_closes, pair_impulses, plane_impulse, plane_pushes};
use crate::settings::Response;
use crate::stages::state::{Impulse, StepState};
use rayon::prelude::*;

/// Memory kept between steps.
#[derive(Default)]
pub(crate) struct Scratch {
    counts: Vec<u32>,
    entries: Vec<(u32, Impulse)>,
    starts: Vec<u32>,
}

/// Fills `state.impulses`, one per body.
pub fn run(state: &mut StepState) {
    let StepState {
        bodies,
        config,
        contacts,
        planes,
        impulses,
        force_scratch: Scratch {
            counts,
            entries,
            starts,
        },
        ..
    } = state;
    impulses.clear();
    impulses.resize(bodies.len(), Impulse::default());
    if config.response == Response::None {
        return;
    }
    count_contacts(bodies, config, planes, contacts, counts);
    entries.clear();
    entries.par_extend(
        contacts
            .pairs
            .par_iter()
            .filter(|pair| pair_closes(bodies, config, pair))
            .flat_map_iter(|pair| pair.bodies.into_iter().zip(pair_impulses(bodies, config, counts, pair))),
    );
    entries.par_extend(
        contacts
            .planes
            .par_iter()
            .map(|contact| (contact, &planes[contact.plane as usize]))
            .filter(|(contact, plane)| plane_pushes(bodies, config, plane, contact))
            .map(|(contact, plane)| (contact.body, plane_impulse(bodies, config, counts, plane, contact))),
    );
    // Stable, so that each body's entries stay in the order of pairs and the sum does not depend on threads.
    entries.par_sort_by_key(|&(body, _)| body);

    // Each segment is summed where it starts.
    starts.clear();
    starts.extend((0..entries.len() as u32).filter(|&i| i == 0 || entries[i as usize - 1].0 != entries[i as usize].0));
    for &start in starts.iter() {
        let segment = &entries[start as usize..];
        let body = segment[0].0;
        let sum = segment
            .iter()
            .take_while(|&&(b, _)| b == body)
            .fold(Impulse::default(), |sum, (_, impulse)| Impulse {
                linear: sum.linear + impulse.linear,
                angular: sum.angular + impulse.angular,
            });
        impulses[body as usize] = sum;
    }
}
