//! The schedule of a step, [`FaceoffStep`], and its ordered system sets, [`FaceoffSystems`].

use crate::types::stage::Stage;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;

/// The schedule of one step. To read or write components between the parts of a step, add systems before or after one
/// of the [`FaceoffSystems`]. Within the schedule the resource `Time` is the physics clock,
/// [`Time<Physics>`](super::clock::Physics).
///
/// The schedule runs in `FixedPostUpdate`, in the system set `FaceoffStep`. Order other systems there before or after
/// this set. A run condition on the set enables or disables the steps. In `RunFixedMainLoop` the set holds the systems
/// that publish late results while time stands still.
///
/// `world.run_schedule(FaceoffStep)` runs one step at once, at any place. If bodies are interpolated, call it in fixed
/// time, for example in `FixedPostUpdate`, because in `Update` it would start from the poses that are drawn. Such a
/// step has the length of the fixed timestep, even if a clock is paused. It waits for the results of a GPU and
/// publishes them, whatever the [`Readback`](super::settings::Readback). It does nothing while
/// [`ActiveBackend`](super::backend::ActiveBackend) is neither `Cpu` nor `Gpu`.
#[derive(ScheduleLabel, SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub struct FaceoffStep;

/// The parts of [`FaceoffStep`], in order.
///
/// With [`Response::Contacts`](crate::types::settings::Response::Contacts) a step may have several collision substeps.
/// Systems between the stages run in the first collision substep. The stages of the others run in
/// [`FaceoffSystems::Integrate`].
///
/// On a GPU all stages are one submission, or a few with
/// [`ContinuousCollision`](crate::plugin::components::ContinuousCollision). [`FaceoffSystems::BroadPhase`] submits
/// them. With [`Readback::Lockstep`](super::settings::Readback::Lockstep) it also waits for their results. With
/// [`Readback::Latent`](super::settings::Readback::Latent) it waits for the results of
/// [`LATENCY`](super::settings::LATENCY) steps before, and with
/// [`Readback::Resident`](super::settings::Readback::Resident) only for the counts of that step. The other stages do
/// nothing. Components and [`Collisions`](super::collisions::Collisions) change in [`FaceoffSystems::Publish`].
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FaceoffSystems {
    /// Reads components into the stages' arrays and rejects invalid bodies.
    Collect,
    /// See [`Stage::BroadPhase`].
    BroadPhase,
    /// See [`Stage::Angles`].
    Angles,
    /// See [`Stage::TriangleTest`].
    TriangleTest,
    /// See [`Stage::Manifolds`].
    Manifolds,
    /// See [`Stage::ForceScan`].
    ForceScan,
    /// See [`Stage::Integrate`].
    Integrate,
    /// Writes poses and velocities to components, and publishes [`Collisions`](super::collisions::Collisions), messages
    /// and events.
    Publish,
    /// Empty, for your own systems that use the results within the step, such as a solver. Spatial queries know the new
    /// poses here. A system that is only ordered after `Publish` may run when the resource `Time` is no longer the
    /// physics clock.
    Respond,
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
