//! What a user can set.

pub use crate::types::solver_settings::SolverSettings;

use bevy::prelude::*;

/// Acceleration of every dynamic body in metres per second squared. Default `(0, -9.81, 0)`.
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq, Deref, DerefMut)]
#[reflect(Resource, Default, Debug, PartialEq)]
pub struct Gravity(pub Vec3);

impl Default for Gravity {
    fn default() -> Self {
        Self(Vec3::NEG_Y * 9.81)
    }
}

/// For how many seconds two bodies must not have touched before [`CollisionEnd`](crate::plugin::events::CollisionEnd) is told and
/// [`CollidingEntities`](crate::plugin::components::CollidingEntities) drops them. Default 0.1.
///
/// What bounces or rolls in the rim of a sensor touches in one step and not in the next. Without a hysteresis each of these would be
/// an end and a new beginning. With it, a beginning is told at once, and an end when it has lasted. An end is told at
/// once all the same
/// * if one of the two is despawned, loses its collider or is rejected, and
/// * for a fast body that has passed a sensor within one step ([`Collision::passing`](crate::plugin::collisions::Collision::passing)).
///
/// `EventHysteresis(0.0)` turns it off: then beginnings and ends are exact, to the step. [`Collisions`](crate::plugin::collisions::Collisions)
/// always holds those that touched in the last step and no others. An infinite time is one without end; a negative one
/// counts as 0, and NaN as the default.
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq, Deref, DerefMut)]
#[reflect(Resource, Default, Debug, PartialEq)]
pub struct EventHysteresis(pub f32);

impl Default for EventHysteresis {
    fn default() -> Self {
        Self(0.1)
    }
}

/// Where the stages run; read when the app starts. [`ActiveBackend`](crate::plugin::backend::ActiveBackend) tells what was taken.
///
/// Both find the same pairs. Where two faces are nearer to touching than rounding can tell, the CPU decides in double
/// precision; a GPU has none and counts them as touching, up to some millionths of the bodies' size apart.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Resource, Default, Debug, PartialEq)]
#[non_exhaustive]
pub enum Backend {
    /// A GPU if there is one that is not the CPU in disguise, else the CPU. What is taken, and why, is logged. With the
    /// feature `bevy_render` it is the renderer's GPU or none, if the app has a renderer.
    #[default]
    Auto,
    /// The renderer's device, or the best adapter there is, even one that computes on the CPU. Without any the step does not
    /// run, and an error says why.
    Gpu,
    /// The CPU, on a thread pool of the plugin's own.
    Cpu,
}

/// When the results of a step on a GPU reach components, [`Collisions`](crate::plugin::collisions::Collisions) and messages; read
/// when the app starts. On the CPU they are there at once, whatever this says.
///
/// # What a write means
///
/// What a system writes holds from the next step on, in each reading, and no result of an older step overwrites it. With `Lockstep`
/// a body is where its components say. With the other two it is ahead of them, and goes on from where it is in all that was not
/// written:
///
/// | written | `Lockstep`, or on the CPU | `Latent` | `Resident` |
/// |---|---|---|---|
/// | `Transform`, `LinearVelocity` or `AngularVelocity` **inserted**, to any value | holds | holds, all of it | holds, all of it |
/// | an axis of `Transform::translation` or of a velocity **changed** | holds | the difference is added to what the body has by then | holds along this axis |
/// | `Transform::rotation` changed | holds | holds | holds |
/// | the same value assigned again | nothing | nothing | nothing |
/// | `RigidBody` | the body goes on as that | the same | the same |
/// | `MeshCollider` removed, or a component that cannot be used | the body stays where it is, and goes on from there when it returns | the same: its `Transform` and velocities are brought up to date | the same |
/// | `Sleeping(false)` | wakes the body | wakes the body | inserted, it wakes the body |
///
/// So, whatever the reading: **insert** what is to hold as it is, to put a body somewhere, to stop it or to hold it; **change**
/// what is to be different, to push or to turn it. A kinematic body without velocity is where its components say: there a change
/// holds too.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Default, Debug, PartialEq)]
#[non_exhaustive]
pub enum Reading {
    /// [`Reading::Latent`] where the stages share the device of Bevy's renderer (feature `bevy_render`), else
    /// [`Reading::Lockstep`].
    #[default]
    Auto,
    /// Every step waits for its results. For tests, tools and servers.
    Lockstep,
    /// Results are published [`LATENCY`] steps later, so that the GPU works while the app goes on; the same results, to the
    /// bit, as those of `Lockstep` for the same input (with [`Response::Contacts`] if the steps have as many detection
    /// intervals). Steps are never skipped: if results are late the step waits, which
    /// [`StepReport::waits`](crate::plugin::collisions::StepReport::waits) counts. How many steps a slow frame makes up for is
    /// limited by Bevy's `Time<Virtual>::max_delta`. A step by hand, and a paused `Time<Physics>`, wait for all results: see
    /// [`clock`](crate::plugin::clock).
    ///
    /// While time stands still the steps that are on their way are published, one a frame.
    ///
    /// Until the kernels are compiled no step runs; then [`BackendReady`](crate::plugin::backend::BackendReady) is written. If the
    /// device is lost the bodies go on from where their components say, once there is something to go on with.
    Latent,
    /// As `Latent`, but the bodies stay on the GPU: neither their components nor `Collisions` are written, and no message
    /// tells of collisions. [`StepReport`](crate::plugin::collisions::StepReport) has the counts; draw from
    /// [`poses`](crate::plugin::poses), and ask [`Snapshot::take`](crate::plugin::snapshot::Snapshot::take) where the bodies are and how
    /// they move. Components hold what users wrote last.
    Resident,
}

/// Steps between the one that runs and the one whose results are published, with [`Reading::Latent`].
pub const LATENCY: usize = 2;
