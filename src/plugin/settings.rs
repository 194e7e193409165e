//! Global settings: gravity, hysteresis of collision events, lists of faces, and where the step runs.

pub use crate::types::kernel_cache::KernelCache;
pub use crate::types::limits::StepLimits;
pub use crate::types::solver_settings::SolverSettings;

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

/// Gravitational acceleration of dynamic bodies in metres per second squared. Default `(0, -9.81, 0)`.
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq, Deref, DerefMut, Serialize, Deserialize)]
#[reflect(Resource, Default, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gravity(pub Vec3);

impl Default for Gravity {
    fn default() -> Self {
        Self(Vec3::NEG_Y * 9.81)
    }
}

/// How long two colliders must not have touched before [`CollisionEnd`](crate::plugin::events::CollisionEnd) is sent
/// and [`CollidingEntities`](crate::plugin::components::CollidingEntities) drops them. In seconds, default 0.1.
///
/// A body that bounces, or that rolls along the rim of a sensor, may touch in one step and not in the next. Without
/// hysteresis each gap would be an end and a new start. With hysteresis a start is sent at once, and an end after this
/// time. An end is sent at once
/// * if one of the two is despawned, loses its collider, is disabled or is rejected,
/// * if one of the two became part of another body,
/// * if a written `Transform` puts one of the two elsewhere, so that their bounding spheres are apart (not where
///   results come later),
/// * for a fast body that passed a sensor within one step
///   ([`Collision::passing`](crate::plugin::collisions::Collision::passing)).
///
/// `EventHysteresis(0.0)` turns hysteresis off: starts and ends are then exact to the step. It does not affect
/// [`Collisions`](crate::plugin::collisions::Collisions), which always holds the pairs that touched in the last step.
/// With an infinite time only the ends that are sent at once are sent. A negative time counts as 0, and NaN counts as
/// the default.
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq, Deref, DerefMut, Serialize, Deserialize)]
#[reflect(Resource, Default, Debug, PartialEq, Serialize, Deserialize)]
pub struct EventHysteresis(pub f32);

impl Default for EventHysteresis {
    fn default() -> Self {
        Self(0.1)
    }
}

/// Whether [`Collision::faces`](crate::plugin::collisions::Collision::faces) lists which faces of the two intersect.
/// Default false: it is `None`. Takes effect in the next step.
///
/// On a GPU the lists are most of what a step with many touching bodies reads back. Without them faces are tested just
/// as exactly, but only counted ([`StepReport::face_pairs`](crate::plugin::collisions::StepReport::face_pairs)). On the
/// CPU they cost little.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_faceoff::prelude::*;
///
/// # let mut app = App::new();
/// app.insert_resource(FaceLists(true)).add_systems(Update, report);
///
/// fn report(collisions: Res<Collisions>) {
///     for hit in collisions.iter() {
///         for pair in hit.faces.into_iter().flatten() {
///             println!("face {} meets {} from {} to {}", pair.a, pair.b, pair.start, pair.end);
///         }
///     }
/// }
/// ```
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Deref, DerefMut, Serialize, Deserialize)]
#[reflect(Resource, Default, Debug, PartialEq, Serialize, Deserialize)]
pub struct FaceLists(pub bool);

/// Whether [`StepReport::energy`](crate::plugin::collisions::StepReport::energy) tells the energy of all bodies after
/// each step. Default false: it is `None`. It costs about 0.1 µs a dynamic body, asleep or not, and 1 ns any other.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Deref, DerefMut, Serialize, Deserialize)]
#[reflect(Resource, Default, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeasureEnergy(pub bool);

/// Where the stages run. Read when the app starts; [`ActiveBackend`](crate::plugin::backend::ActiveBackend) holds the
/// result.
///
/// CPU and GPU find the same pairs, up to rounding. Where single precision cannot decide whether two faces touch, the
/// CPU decides in double precision. The GPU counts them as touching; they may be some millionths of the bodies' size
/// apart.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[reflect(Resource, Default, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Backend {
    /// The GPU if there is one, else the CPU. Software adapters, which compute on the CPU, do not count as a GPU. The
    /// choice and its reason are logged. With the feature `bevy_render`, in an app with a renderer, only the renderer's
    /// GPU is considered.
    #[default]
    Auto,
    /// The renderer's device, or the best adapter, including software adapters. If there is none, the step does not
    /// run, and an error is logged.
    Gpu,
    /// The CPU, on a separate thread pool.
    Cpu,
}

/// When the results of a step on a GPU are published to components,
/// [`Collisions`](crate::plugin::collisions::Collisions) and messages. Read when the app starts. On the CPU results are
/// always published at once.
///
/// # What a write means
///
/// A value that a system writes takes effect in the next step, in each mode, and no result of an older step overwrites
/// it. With `Lockstep` the components hold the current state of a body. With the other two modes the body on the GPU is
/// some steps ahead of its components, and everything that was not written continues from the state on the GPU:
///
/// | written | `Lockstep`, or on the CPU | `Latent` | `Resident` |
/// |---|---|---|---|
/// | `Transform`, `LinearVelocity` or `AngularVelocity` **inserted**, with any value | sets the value | sets the whole value | sets the whole value |
/// | an axis of `Transform::translation` or of a velocity **changed** | sets the value | adds the difference to the body's current value | sets the value of this axis |
/// | `Transform::rotation` changed | sets the value | sets the value | sets the value |
/// | the same value assigned again | nothing | nothing | nothing |
/// | `RigidBody` | changes how the body moves from now on | the same | the same |
/// | `MeshCollider` removed, or a component made invalid | the body stops, and continues from there when it is valid again | the same; its `Transform` and velocities are brought up to date | the same |
/// | `Sleeping(false)` | wakes the body | wakes the body | wakes the body if inserted |
///
/// So, in every mode: **insert** a component to set a state, for example to place a body, to stop it or to hold it in
/// place. **Change** a field to modify the state, for example to push a body or to rotate it. For a kinematic body
/// without velocity the components hold the current state, so a change sets the value too, and is a move
/// ([`RigidBody::Kinematic`](crate::types::body::RigidBody::Kinematic)). A dynamic body whose `Transform` is written is
/// placed: it keeps its velocity, and collisions with what is no longer near it end at once.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[reflect(Default, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Readback {
    /// [`Readback::Latent`] where the stages share the device of Bevy's renderer (feature `bevy_render`), else
    /// [`Readback::Lockstep`].
    #[default]
    Auto,
    /// Every step waits for its results. For tests, tools and servers.
    Lockstep,
    /// Results are published [`LATENCY`] steps later, so that the app and the GPU work at the same time.
    ///
    /// For the same input the results are the same to the bit as those of `Lockstep`, with
    /// [`Response::Contacts`](crate::types::settings::Response::Contacts) if the steps have as many collision substeps.
    /// No step is skipped: if results are late, the step waits, and
    /// [`StepReport::waits`](crate::plugin::collisions::StepReport::waits) counts it. Bevy's `Time<Virtual>::max_delta`
    /// limits how many steps run after a slow frame. While `Time<Physics>` is paused, and in a step that you run with
    /// `run_schedule`, all results are waited for: see [`clock`](crate::plugin::clock). While `Time<Virtual>` stands
    /// still, the results of one pending step are published per frame.
    ///
    /// No step runs until the kernels are compiled; then [`BackendReady`](crate::plugin::backend::BackendReady) is
    /// written. If the device is lost, bodies continue from the state in their components as soon as there is a backend
    /// again.
    Latent,
    /// Like `Latent`, but the bodies stay on the GPU: components and `Collisions` are not written, and no messages of
    /// collisions are sent. Components hold what users wrote last.
    ///
    /// To move a kinematic body by its `Transform` after it has moved by its velocity, set both velocities to zero and
    /// insert its `Transform`. If the body was dynamic before, insert both velocities and the `Transform` in the same
    /// step.
    ///
    /// [`StepReport`](crate::plugin::collisions::StepReport) has the counts. Draw from [`poses`](crate::plugin::poses).
    /// To read poses and velocities back, use [`Snapshot::take`](crate::plugin::snapshot::Snapshot::take).
    Resident,
}

/// With [`Readback::Latent`], the number of steps between a step and the publication of its results.
pub const LATENCY: usize = 2;
