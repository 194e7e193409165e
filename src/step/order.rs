//! The order of a step: its parts, for every [`Response`] and every collision substep. Both backends run this list.
//!
//! `step::cpu` calls one function for each part. `step::gpu` records the kernels of each part; some parts need none.

use crate::types::settings::Response;
use crate::types::stage::Stage;

/// One part of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Part {
    /// Loads the bodies, restores their state from the last step, and chooses the number of collision substeps.
    Begin,
    /// Finds the pairs of bodies whose bounding spheres overlap.
    FindSpherePairs,
    /// Leaves out pairs by the caller's hooks. Runs on the CPU only: steps with hooks run there.
    FilterPairs,
    /// Finds the sphere pairs that no support axis separates.
    FindNearPairs,
    /// Tests the triangles of near pairs.
    TestTriangles,
    /// Finds the contact points of pairs that are awake.
    FindContactPoints,
    /// Has contacts modified by the caller's hooks. Runs on the CPU only: steps with hooks run there.
    ModifyContacts,
    /// Reuses the contact points of sleeping pairs from the last collision substep.
    ReuseContactPoints,
    /// Reports the contact points of pairs that touch, without impulses.
    ReportContactPoints,
    /// Sums one impulse per contact for each body.
    SumImpulses,
    /// Moves the bodies by these sums.
    ApplyImpulses,
    /// Wakes islands that something disturbs.
    Wake,
    /// Solves the contacts and moves the solver's bodies.
    Solve,
    /// Records which pairs touch in this collision substep.
    RecordTouches,
    /// Puts islands to sleep that have been at rest for long enough.
    FallAsleep,
    /// Stops bodies with continuous collision detection at their first impact. Runs on the CPU only, during a step
    /// on a device too.
    StopFastBodies,
    /// Copies the motion of the solver's bodies to the bodies of the step.
    MoveBodies,
    /// Reports which pairs touched in any collision substep.
    ReportTouches,
    /// Saves the state that the next step needs.
    Remember,
}

/// Position of a collision substep in its step. Without [`Response::Contacts`] there is one, which is both the first
/// and the last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SubstepPosition {
    /// Whether it is the first of the step.
    pub is_first: bool,
    /// Whether it is the last of the step.
    pub is_last: bool,
}

/// The collision substeps in which a part runs.
#[derive(Clone, Copy)]
enum Substeps {
    First,
    All,
    Last,
}

/// The responses with which a part runs.
struct Responses {
    none: bool,
    impulse: bool,
    contacts: bool,
}

const ANY: Responses = responses(true, true, true);
const NONE: Responses = responses(true, false, false);
const CONTACTS: Responses = responses(false, false, true);
/// Responses that compute contact points.
const POINTS: Responses = responses(true, false, true);
/// Responses that move the bodies once per step.
const SIMPLE: Responses = responses(true, true, false);

const fn responses(none: bool, impulse: bool, contacts: bool) -> Responses {
    Responses {
        none,
        impulse,
        contacts,
    }
}

/// The whole step.
const ORDER: [(Part, Substeps, Responses); 19] = [
    (Part::Begin, Substeps::First, ANY),
    (Part::FindSpherePairs, Substeps::All, ANY),
    (Part::FilterPairs, Substeps::All, ANY),
    (Part::FindNearPairs, Substeps::All, ANY),
    // The results of the triangle test describe the start of the step.
    (Part::TestTriangles, Substeps::First, ANY),
    (Part::FindContactPoints, Substeps::All, POINTS),
    (Part::ModifyContacts, Substeps::All, POINTS),
    (Part::ReuseContactPoints, Substeps::All, CONTACTS),
    (Part::ReportContactPoints, Substeps::First, NONE),
    // With `Response::None` all sums are zero.
    (Part::SumImpulses, Substeps::All, SIMPLE),
    (Part::ApplyImpulses, Substeps::All, SIMPLE),
    (Part::Wake, Substeps::All, CONTACTS),
    (Part::Solve, Substeps::All, CONTACTS),
    (Part::RecordTouches, Substeps::All, CONTACTS),
    (Part::FallAsleep, Substeps::All, CONTACTS),
    (Part::StopFastBodies, Substeps::All, CONTACTS),
    (Part::MoveBodies, Substeps::All, CONTACTS),
    (Part::ReportTouches, Substeps::Last, CONTACTS),
    (Part::Remember, Substeps::Last, ANY),
];

/// The parts of one collision substep, in order.
pub fn parts(response: Response, position: SubstepPosition) -> impl Iterator<Item = Part> {
    ORDER
        .iter()
        .filter(move |(_, substeps, responses)| substeps.holds(position) && responses.holds(response))
        .map(|&(part, ..)| part)
}

/// The parts of one stage in a collision substep, in order.
pub fn parts_of(stage: Stage, response: Response, position: SubstepPosition) -> impl Iterator<Item = Part> {
    parts(response, position).filter(move |part| part.stage() == stage)
}

impl Part {
    /// The stage that runs it and whose time includes it.
    pub fn stage(self) -> Stage {
        match self {
            Self::Begin | Self::FindSpherePairs | Self::FilterPairs => Stage::BroadPhase,
            Self::FindNearPairs => Stage::Angles,
            Self::TestTriangles => Stage::TriangleTest,
            Self::FindContactPoints | Self::ModifyContacts | Self::ReuseContactPoints | Self::ReportContactPoints => {
                Stage::Manifolds
            }
            Self::SumImpulses | Self::Wake | Self::Solve | Self::RecordTouches | Self::FallAsleep => Stage::ForceScan,
            Self::ApplyImpulses | Self::StopFastBodies | Self::MoveBodies | Self::ReportTouches | Self::Remember => {
                Stage::Integrate
            }
        }
    }
}

impl SubstepPosition {
    /// The position of collision substep `number` of `count`.
    pub fn of(number: u32, count: u32) -> Self {
        Self {
            is_first: number == 0,
            is_last: number + 1 >= count,
        }
    }
}

impl Substeps {
    fn holds(self, position: SubstepPosition) -> bool {
        match self {
            Self::First => position.is_first,
            Self::All => true,
            Self::Last => position.is_last,
        }
    }
}

impl Responses {
    fn holds(&self, response: Response) -> bool {
        match response {
            Response::None => self.none,
            Response::Impulse => self.impulse,
            Response::Contacts => self.contacts,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_run_in_the_order_of_stages() {
        for response in [Response::None, Response::Impulse, Response::Contacts] {
            for position in [
                SubstepPosition::of(0, 1),
                SubstepPosition::of(0, 3),
                SubstepPosition::of(1, 3),
                SubstepPosition::of(2, 3),
            ] {
                let stages: Vec<_> = parts(response, position).map(|part| part.stage() as usize).collect();
                assert!(stages.is_sorted(), "{response:?} {position:?}");
            }
        }
    }

    #[test]
    fn every_step_begins_and_ends_once() {
        for response in [Response::None, Response::Impulse, Response::Contacts] {
            let all = (0..3).flat_map(|number| parts(response, SubstepPosition::of(number, 3)));
            let all: Vec<_> = all.collect();
            for part in [Part::Begin, Part::TestTriangles, Part::Remember] {
                assert_eq!(
                    all.iter().filter(|&&other| other == part).count(),
                    1,
                    "{response:?} {part:?}"
                );
            }
        }
    }
}
