//! The fixed step: from moving bodies to collided bodies.
//!
//! A step is divided into *collision substeps*, and contact points are computed and solved in each of them. Their
//! number depends on the relative speeds of the bodies, so that no surface passes through a thin body within one of
//! them. Only [`Response::Contacts`](crate::types::settings::Response::Contacts) uses more than one. Each
//! collision substep runs the stages in order, and each stage runs a few parts:
//!
//! | stage | part | what it does | reads | writes |
//! |---|---|---|---|---|
//! | [`broad_phase`] | begin (first) | restores sleeping bodies, rouses dormant ones, chooses the number of collision substeps and the speculative margins | [`StepInput`], [`StepMemory`] | solver bodies, margins |
//! | | find sphere pairs | finds overlapping bounding spheres with a hashed grid | bounding spheres and margins | pairs |
//! | | filter pairs | leaves out pairs by the caller's [`hooks`] | pairs | pairs |
//! | [`angles`] | find near pairs | separates most of these pairs by support axes | pairs, poses, support heights, face tables | near pairs with relative poses |
//! | [`triangle_test`] | test triangles (first) | tests the remaining pairs triangle by triangle | near pairs, triangles | touching pairs, intersecting faces, contacts |
//! | [`manifolds`] | find contact points (N, C) | computes points with normals from vertices, edges and faces that are near each other; pairs that fly past them get the point of [`ccd`]'s first contact | near pairs, features | manifolds |
//! | | modify contacts (N, C) | has contacts modified by the caller's [`hooks`] | manifolds | manifolds |
//! | | reuse contact points (C) | keeps the points of sleeping pairs | manifolds of the last collision substep | manifolds |
//! | | report contact points (N) | reports the points of touching pairs | manifolds | contacts |
//! | [`force_scan`] | sum impulses (N, I) | computes one impulse per contact and sums them for each body | contacts | impulses |
//! | | wake (C) | [`sleep`]: wakes islands that something disturbs | manifolds | solver bodies |
//! | | solve (C) | [`solver`]: substeps with warm start, friction, bias and relaxation, then restitution | manifolds, warm start | solver bodies, warm start |
//! | | record touches (C) | records which pairs touch, where, and their impulses | manifolds, impulses of points | touches |
//! | | fall asleep (C) | [`sleep`]: puts islands at rest to sleep | manifolds | solver bodies |
//! | [`integrate`] | apply impulses (N, I) | velocities change by gravity and impulses, poses by velocities | impulses | bodies |
//! | | stop fast bodies (C) | [`ccd`]: stops them at their first impact | solver bodies, poses before | solver bodies, touches |
//! | | move bodies (C) | copies poses and velocities from the solver | solver bodies | bodies |
//! | | report touches (C, last) | merges the touches with the results of the triangle test | touches | contacts, sleeping bodies |
//! | | remember (last) | saves what the next step needs, and lets bodies become dormant | solver bodies | [`StepMemory`] |
//!
//! N, I, C: only with the response None, Impulse, Contacts. First, last: only in the first or last collision substep.
//! [`order`] is this table as code, and both backends run it. `step::cpu` calls one function per part, which is in the
//! folder of its stage; `step::gpu` records the kernels of that folder. Hooks exist on the CPU
//! only: steps with them run there. Continuous collision detection runs on the CPU during a step on the device.
//!
//! A [`StepState`] owns all data of a step in four structs, and the function of a stage takes those that it needs:
//! * [`StepInput`]: the caller's input. The step moves its bodies.
//! * [`StepResults`]: the output of the stages, for later stages and for the caller.
//! * [`StepMemory`]: what the next step needs from this one.
//! * [`StepScratch`]: scratch memory, without meaning between steps.
//!
//! Stages do not depend on an engine: the plugin copies components into the input and results out of the output.
//!
//! [`broad_phase`]: crate::broad_phase
//! [`angles`]: crate::angles
//! [`triangle_test`]: crate::triangle_test
//! [`manifolds`]: crate::manifolds
//! [`force_scan`]: crate::force_scan
//! [`integrate`]: crate::integrate
//! [`solver`]: crate::solver
//! [`sleep`]: crate::sleep
//! [`ccd`]: crate::ccd

mod begin;
mod cost;
pub mod cpu;
mod crowds;
pub(crate) mod dormant;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod hooks;
#[cfg(feature = "bevy")]
mod loaded;
pub mod memory;
pub mod order;
#[cfg(feature = "bevy")]
pub(crate) mod pool;
mod reach;
pub(crate) mod remap;
mod schedule;
pub mod scratch;
mod territories;

pub use memory::StepMemory;
pub use scratch::StepScratch;

#[cfg(feature = "bevy")]
use crate::state::{Counts, Manifolds};
use crate::state::{StepInput, StepResults};

/// All data of a step. Use the same one for every step of a world, because it has the state that persists and the
/// allocations.
#[derive(Default)]
pub struct StepState {
    /// The caller's input.
    pub input: StepInput,
    /// The results of the last step.
    pub results: StepResults,
    /// What the next step needs from the last one.
    pub memory: StepMemory,
    /// Scratch memory of the CPU's stages.
    pub scratch: StepScratch,
}

impl StepState {
    /// The sizes of the results of a step on the CPU.
    #[cfg(feature = "bevy")]
    pub(crate) fn counts(&self) -> Counts {
        let mut counts = self.results.counts();
        self.scratch.dormant.add_to(&mut counts);
        counts.dormant = self.input.bodies.left_out();
        counts
    }

    /// Copies of the memory and the manifolds of the last step, including dormant bodies.
    #[cfg(feature = "bevy")]
    pub(crate) fn complete_memory(&self) -> (StepMemory, Manifolds) {
        let Self {
            results,
            memory,
            scratch,
            ..
        } = self;
        match scratch.dormant.any() {
            true => scratch.dormant.complete(memory, &results.manifolds),
            false => (memory.clone(), results.manifolds.clone()),
        }
    }

    /// Ends the dormancy of all bodies, so that memory and results are complete.
    #[cfg(feature = "bevy")]
    pub(crate) fn rouse_all(&mut self) {
        let Self {
            input,
            results,
            memory,
            scratch,
        } = self;
        if scratch.dormant.any() {
            scratch.dormant.end(&mut input.bodies, memory, results);
        }
    }
}
