//! ForceScan on the CPU.

use super::impulse::{count_contacts, pair_closes, pair_impulses, plane_impulse, plane_pushes};
use crate::parallel::in_order::InOrder;
use crate::parallel::loops;
use crate::sleep::cpu::{Sleeper, wake_on_changed_support};
use crate::solver::{Pace, Solver, SolverBodies, WarmStart};
use crate::state::inactive::InactiveBodies;
use crate::state::{Bodies, Contacts, Impulse, Manifolds, Plane, StepConfig};
use crate::types::settings::Response;
use crate::types::solver_settings::SolverSettings;

/// Memory kept between steps.
#[derive(Default)]
pub(crate) struct Scratch {
    counts: Vec<u32>,
    lists: InOrder<Entry>,
    entries: Vec<Entry>,
    starts: Vec<u32>,
}

/// The change of a body's velocity by one contact.
#[derive(Clone, Copy)]
struct Entry {
    body: u32,
    /// Number of the contact; contacts with planes come after pairs.
    contact: u32,
    impulse: Impulse,
}

/// Contacts per task.
const TASK: usize = 256;

/// Sums the impulses of all `contacts` into `impulses`, one per body. With [`Response::None`] all are zero.
pub(crate) fn sum_impulses(
    config: &StepConfig,
    bodies: &Bodies,
    planes: &[Plane],
    contacts: &Contacts,
    scratch: &mut Scratch,
    impulses: &mut Vec<Impulse>,
) {
    let Scratch {
        counts,
        lists,
        entries,
        starts,
    } = scratch;
    impulses.clear();
    impulses.resize(bodies.len(), Impulse::default());
    if config.response == Response::None {
        return;
    }
    count_contacts(bodies, config, planes, contacts, counts);
    entries.clear();
    lists.extend(entries, &contacts.pairs, TASK, |number, pair, entries| {
        if pair_closes(bodies, config, pair) {
            let impulses = pair_impulses(bodies, config, counts, pair);
            entries.extend(pair.bodies.iter().zip(impulses).map(|(&i, impulse)| Entry {
                body: bodies.body_of(i),
                contact: number as u32,
                impulse,
            }));
        }
    });
    lists.extend(entries, &contacts.planes, TASK, |number, contact, entries| {
        let plane = &planes[contact.plane as usize];
        if plane_pushes(bodies, config, plane, contact) {
            entries.push(Entry {
                body: bodies.body_of(contact.body),
                contact: (contacts.pairs.len() + number) as u32,
                impulse: plane_impulse(bodies, config, counts, plane, contact),
            });
        }
    });
    // Each body's entries are in the order of contacts, so the sum does not depend on the number of threads.
    loops::sort_unstable_by_key(entries, |entry| (entry.body, entry.contact));

    // One segment per body; the first entry of a segment is its start.
    starts.clear();
    starts.extend(
        (0..entries.len() as u32).filter(|&i| i == 0 || entries[i as usize - 1].body != entries[i as usize].body),
    );
    for &start in starts.iter() {
        let segment = &entries[start as usize..];
        let body = segment[0].body;
        let sum = segment
            .iter()
            .take_while(|entry| entry.body == body)
            .fold(Impulse::default(), |sum, entry| Impulse {
                linear: sum.linear + entry.impulse.linear,
                angular: sum.angular + entry.impulse.angular,
            });
        impulses[body as usize] = sum;
    }
}

/// Wakes islands that something disturbs.
pub(crate) fn wake(
    config: &StepConfig,
    colliders: &Bodies,
    manifolds: &Manifolds,
    inactive: &InactiveBodies,
    sleeper: &mut Sleeper,
    bodies: &mut SolverBodies,
) {
    wake_on_changed_support(bodies, inactive, manifolds);
    let dt = |i: u32| colliders.travel_time_of(i as usize);
    sleeper.wake_each(bodies, manifolds, &config.solver, config.gravity, dt);
}

/// Solves the contacts in `manifolds` and moves each of `bodies` over its collision substep.
pub(crate) fn solve(
    config: &StepConfig,
    pace_of: impl Fn(usize) -> Pace,
    manifolds: &Manifolds,
    solver: &mut Solver,
    warm: &mut WarmStart,
    bodies: &mut SolverBodies,
) {
    solver.solve_each(bodies, manifolds, warm, &config.solver, config.gravity, pace_of);
}

/// Puts islands to sleep that have been at rest for long enough, after a collision substep. Bodies that woke in it
/// become active.
pub(crate) fn fall_asleep(
    settings: &SolverSettings,
    colliders: &Bodies,
    manifolds: &Manifolds,
    sleeper: &mut Sleeper,
    bodies: &mut SolverBodies,
    inactive: &mut InactiveBodies,
) {
    sleeper.settle_each(bodies, manifolds, settings, |i| colliders.travel_time_of(i));
    inactive.keep_only(bodies.movers(), |i| bodies.sleep[i].asleep);
}
