//! Settings of the whole simulation: the response to collisions, and culling of triangles.

#[cfg(feature = "bevy")]
use bevy::prelude::*;
use serde::{Deserialize, Serialize};

/// How bodies respond to collisions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(
    feature = "bevy",
    derive(Resource, Reflect),
    reflect(Resource, Default, Debug, PartialEq, Serialize, Deserialize)
)]
#[non_exhaustive]
pub enum Response {
    /// Collisions are detected and reported, with contact points, but bodies do not push each other. They move by their
    /// velocities and gravity, and pass through planes too.
    ///
    /// For triggers, and for a solver of your own: see
    /// [`Collisions::manifolds`](crate::plugin::collisions::Collisions::manifolds). Mass, damping, speed limits,
    /// [`LockedAxes`](crate::types::body::LockedAxes), [`ExternalForces`](crate::types::body::ExternalForces),
    /// continuous collision and sleep have no effect.
    None,
    /// Each touching pair gets one impulse per step against its closing velocity, with the mean
    /// [`Restitution`](crate::types::material::Restitution). For swarms of thousands of bodies that bounce off each
    /// other. There is no friction, nothing comes to rest, and overlapping bodies are not pushed apart.
    Impulse,
    /// Each pair gets several contact points, and a solver with friction, restitution, stacking, interlocking and
    /// sleeping: see [`SolverSettings`](crate::types::solver_settings::SolverSettings). All triangles take part,
    /// whatever the [`Culling`].
    ///
    /// It runs on the GPU too. The CPU stops bodies that have
    /// [`ContinuousCollision`](crate::plugin::components::ContinuousCollision) during a step. With
    /// [`Readback::Latent`](crate::plugin::settings::Readback::Latent) and
    /// [`Readback::Resident`](crate::plugin::settings::Readback::Resident) a step has only one collision substep if the
    /// speeds of [`LATENCY`](crate::plugin::settings::LATENCY) steps before do not need more.
    #[default]
    Contacts,
}

/// Which triangles of a pair of bodies are tested against each other.
///
/// The resource applies to all bodies. [`BodyCulling`](crate::plugin::components::BodyCulling) overrides it for one
/// body. The two bodies of a pair may have different modes: the mode of each body chooses among its own triangles, seen
/// from the other body.
///
/// All modes use the same conservative culls. An approximate mode finds exactly those intersecting face pairs of
/// `Exact` in which both faces are in view, and never a pair that does not intersect. What it misses lies behind other
/// faces, seen along the line between the centres. A finer table would not find it.
///
/// Measured recall (`cargo bench --bench recall`). The first figure is the share of touching pairs of bodies for which
/// any intersecting faces are found. The second is the share of their intersecting face pairs that are found.
/// Scenes are random, with diameters from 0.25 to 2.
///
/// | 240-triangle torus | `FacesOfCollision` | `FrontFacing` |
/// |---|---|---|
/// | first contact, 0.1 % of the diameter deep | 99.4 % / 98.7 % | 99.4 % / 98.7 % |
/// | first contact, 5 % deep | 99.4 % / 96.4 % | 99.4 % / 96.4 % |
/// | overlapping in a scene | 98.2 % / 48.2 % | 98.4 % / 50.1 % |
/// | the same, sizes below 0.3 to 1 | 81.5 % / 36.9 % | 82.0 % / 38.9 % |
/// | centres nearer than half the radii | 92.4 % / 31.5 % | 93.4 % / 34.8 % |
/// | linked through the holes | **8.8 % / 3.1 %** | **57.6 % / 33.7 %** |
///
/// | 1120-triangle knot | `FacesOfCollision` | `FrontFacing` |
/// |---|---|---|
/// | first contact, 0.1 % of the diameter deep | 99.8 % / 95.7 % | 99.8 % / 95.7 % |
/// | first contact, 5 % deep | 99.7 % / 80.1 % | 99.7 % / 80.6 % |
/// | overlapping in a scene | 98.8 % / 30.4 % | 98.9 % / 35.1 % |
/// | the same, sizes below 0.3 to 1 | 94.2 % / 26.9 % | 95.8 % / 32.1 % |
/// | centres nearer than half the radii | 98.9 % / 25.1 % | 99.6 % / 31.3 % |
/// | linked through the holes | 44.4 % / 38.6 % | 45.6 % / 50.8 % |
///
/// If none of a pair's intersecting faces are found, the pair is neither reported nor pushed apart, unless the test for
/// one body inside the other finds it. If some are found, the contact is computed from these.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(
    feature = "bevy",
    derive(Resource, Reflect),
    reflect(Resource, Default, Debug, PartialEq, Serialize, Deserialize)
)]
#[non_exhaustive]
pub enum Culling {
    /// Only conservative culls: every intersecting face pair is found.
    #[default]
    Exact,
    /// **Approximate**, see the recall above. Tests only the *faces of collision*: triangles that are visible from the
    /// direction of the other body. They are read from the mesh's baked [`FaceTable`](crate::projection::FaceTable)
    /// (Aly & Elawady 2010).
    ///
    /// If a mesh has no table, a warning is logged once, and a table is baked in the background with the mesh's own
    /// [`BakeSettings`](crate::projection::BakeSettings). Until it is ready, bodies with this mesh use `Exact`. Bake
    /// the table ahead of time (`faces: true`, or `faceoff bake --faces`) if results must not depend on the time that
    /// the bake takes.
    FacesOfCollision,
    /// **Approximate**, see the recall above. Tests only triangles whose outer side faces the other body: `n . u > 0`,
    /// where `n` is the normal and `u` is the direction from centre to centre. Nothing is baked.
    ///
    /// A mesh that is open, inconsistently oriented, or a room has no front. Bodies with such a mesh use `Exact`.
    FrontFacing,
}
