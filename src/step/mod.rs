//! The fixed step, from bodies that move to bodies that have collided.
//!
//! A step is cut into *collision substeps*, in each of which contact points are found and solved. How many there are depends
//! on how fast bodies move against each other: no surface may pass a thin body between two looks. Only
//! [`Response::Contacts`](crate::types::settings::Response::Contacts) needs more than one. Each interval runs the stages in order,
//! and each stage a few parts:
//!
//! | stage | part | what happens | reads | writes |
//! |---|---|---|---|---|
//! | [`broad_phase`] | begin (first interval) | sleepers are recognized, intervals are counted, speculative margins are chosen | [`StepInput`], [`StepMemory`] | solver bodies, margins |
//! | | find sphere pairs | a hashed grid finds bounding spheres that overlap | bounding spheres and how far bodies reach | pairs |
//! | [`angles`] | find near pairs | support planes separate most of these pairs | pairs, poses, support heights, face tables | near pairs with relative poses |
//! | [`triangle_test`] | test triangles (first interval) | what is left is tested triangle by triangle | near pairs, triangles | touching pairs, intersecting faces, contacts |
//! | [`manifolds`] | find contact points (N, C) | vertices, edges and faces that are near each other give points with normals | near pairs, features | manifolds |
//! | | reuse contact points (C) | sleeping pairs keep the points they had | the last interval's manifolds | manifolds |
//! | | report contact points (N) | those of touching pairs are reported | manifolds | contacts |
//! | [`force_scan`] | sum impulses (N, I) | one impulse per contact, summed for each body | contacts | impulses |
//! | | wake (C) | [`sleep`]: islands that something disturbs wake | manifolds | solver bodies |
//! | | solve (C) | [`solver`]: substeps of warm start, friction, push and relaxation, then restitution | manifolds, warm start | solver bodies, warm start |
//! | | note touches (C) | who touched whom, where and how strongly | manifolds, impulses of points | touches |
//! | | fall asleep (C) | [`sleep`]: islands that rest freeze | manifolds | solver bodies |
//! | [`integrate`] | apply impulses (N, I) | velocities take gravity and impulses, poses take velocities | impulses | bodies |
//! | | stop fast bodies (C) | [`ccd`]: they stop where they first meet others | solver bodies, poses before | solver bodies, touches |
//! | | move bodies (C) | all go where the solver moved them | solver bodies | bodies |
//! | | report touches (C, last interval) | touches join what the triangle test found | touches | contacts, who sleeps |
//! | | remember (last interval) | what the next step needs is kept | solver bodies | [`StepMemory`] |
//!
//! N, I, C: only with the response None, Impulse, Contacts. [`order`] is this table as code, and both backends run it. `step::cpu`
//! calls one function per part, which lies in the folder of its stage; `step::gpu` records the kernels of that folder.
//! Continuous collision is the CPU's alone: steps with a body that asks for it run there.
//!
//! A [`StepState`] owns all data of a step in four parts, and a stage's function takes those that it needs:
//! * [`StepInput`]: what the caller says; the step moves its bodies.
//! * [`StepResults`]: what stages find, for later stages and for the caller.
//! * [`StepMemory`]: what the next step needs of this one.
//! * [`StepScratch`]: what stages work on, without meaning between steps.
//!
//! Stages know nothing of an engine: the plugin copies components in and results out.
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
pub mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod memory;
pub mod order;
pub(crate) mod remap;
pub mod scratch;

pub use memory::StepMemory;
pub use scratch::StepScratch;

use crate::state::{StepInput, StepResults};

/// All data of a step. Keep one from step to step: what it remembers and its memory are used again.
#[derive(Default)]
pub struct StepState {
    /// What the caller says.
    pub input: StepInput,
    /// What the last step found.
    pub results: StepResults,
    /// What the next step needs of the last one.
    pub memory: StepMemory,
    /// What the CPU's stages work on.
    pub scratch: StepScratch,
}
