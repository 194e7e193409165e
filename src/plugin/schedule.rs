//! The schedule of a step and its ordered sets.

use crate::types::stage::Stage;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;

/// The schedule of one step. Add systems around [`FaceoffSystems`] to it to see or change what passes between components and
/// stages; in it `Time` is the clock of the steps, [`Time<Physics>`](super::clock::Physics).
///
/// It runs in `FixedPostUpdate`, in the system set of the same name: other systems there can be ordered before or after
/// `FaceoffStep`, and a run condition of the set decides whether there are steps at all.
///
/// To do a step by hand run it yourself, wherever and whenever: `world.run_schedule(FaceoffStep)`. Such a step is as long as the
/// fixed timestep, even if a clock is paused, and is waited for: results of a GPU are published in it, whatever the
/// [`Reading`](super::settings::Reading). While [`ActiveBackend`](super::backend::ActiveBackend) has nothing to run on it does nothing.
#[derive(ScheduleLabel, SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub struct FaceoffStep;

/// The parts of [`FaceoffStep`], in order.
///
/// With [`Response::Contacts`](crate::types::settings::Response) a step may consist of several detection intervals: systems between the stages run in the first
/// one, and the stages of the others in [`FaceoffSystems::Integrate`]. On a GPU all stages are one submission, made and
/// waited for in [`FaceoffSystems::BroadPhase`]; systems between them see its results.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FaceoffSystems {
    /// Copies components into the stages' arrays and leaves out what cannot be used.
    Collect,
    /// See [`broad_phase`](crate::broad_phase).
    BroadPhase,
    /// See [`angles`](crate::angles).
    Angles,
    /// See [`triangle_test`](crate::triangle_test).
    TriangleTest,
    /// See [`manifolds`](crate::manifolds).
    Manifolds,
    /// See [`force_scan`](crate::force_scan).
    ForceScan,
    /// See [`integrate`](crate::integrate).
    Integrate,
    /// Writes poses, velocities, [`Collisions`](super::collisions::Collisions), messages and events.
    Publish,
}

impl From<Stage> for FaceoffSystems {
    fn from(stage: Stage) -> Self {
        match stage {
            Stage::BroadPhase => Self::BroadPhase,
            Stage::Angles => Self::Angles,
            Stage::TriangleTest => Self::TriangleTest,
            Stage::Manifolds => Self::Manifolds,
            Stage::ForceScan => Self::ForceScan,
            Stage::Integrate => Self::Integrate,
        }
    }
}
