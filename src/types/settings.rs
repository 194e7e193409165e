//! What can be chosen for all bodies: how they respond, and which triangles are tested.

#[cfg(feature = "bevy")]
use bevy::prelude::*;

/// What happens to bodies that touch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "bevy",
    derive(Resource, Reflect),
    reflect(Resource, Default, Debug, PartialEq)
)]
#[non_exhaustive]
pub enum Response {
    /// Collisions are found and reported, with contact points; nothing is pushed. Bodies move by their velocities and
    /// gravity.
    None,
    /// One impulse per touching pair and step, against the closing speed, with the mean
    /// [`Restitution`](crate::types::material::Restitution): for swarms of thousands that bounce off each other, on CPU and GPU.
    /// Without friction; nothing rests, and bodies that overlap are not pushed apart.
    Impulse,
    /// Several points per pair, with friction, restitution, resting, stacking, interlocking and sleeping: see
    /// [`stages::solver`](crate::solver), and [`SolverSettings`] for what can be set. All triangles take part, whatever the [`Culling`].
    ///
    /// On a GPU too, but for steps with a [`ContinuousCollision`](crate::plugin::components::ContinuousCollision) body in the world,
    /// which run on the CPU. With [`Reading::Latent`] and [`Reading::Resident`] the number of detection intervals of a step
    /// follows from speeds of [`LATENCY`] steps before.
    #[default]
    Contacts,
}

/// How the triangles of a pair are chosen that are tested against each other.
///
/// As a resource it holds for all bodies; [`BodyCulling`](crate::plugin::components::BodyCulling) on a body overrules it there.
/// The two ends of a pair need not agree: each body's mode chooses among that body's own triangles, as they are seen
/// from the other body.
///
/// All modes share the conservative culls, so the approximate ones find exactly those of `Exact`'s intersecting pairs of
/// faces in which both faces are in view, and never one that does not intersect. What they miss lies behind other
/// faces, seen along the line of centres; no finer table finds it.
///
/// Measured recall (`cargo bench --bench recall`): of the pairs of bodies that touch, the share of which any intersecting
/// faces are found, and the share of their intersecting pairs of faces. Scenes are random, diameters 0.25 to 2.
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
/// A pair none of whose faces are found is neither reported nor pushed apart, unless the test for one body inside the other
/// finds it; of a pair found in part, the contact is that of the part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "bevy",
    derive(Resource, Reflect),
    reflect(Resource, Default, Debug, PartialEq)
)]
#[non_exhaustive]
pub enum Culling {
    /// Conservative culls only: every intersecting pair of faces is found.
    #[default]
    Exact,
    /// **Approximate**, see the recall above. Only the *faces of collision*: triangles that can be seen from the other
    /// body's direction, read from the mesh's baked [`FaceTable`](crate::projection::FaceTable) (Aly & Elawady 2010).
    ///
    /// A mesh without a table is logged once and gets one baked in the background with the
    /// [`BakeSettings`](crate::projection::BakeSettings) it was made with; until then its bodies run `Exact`. Bake the
    /// table beforehand (`faces: true`, or `faceoff bake --faces`) for results that do not depend on when that is done.
    FacesOfCollision,
    /// **Approximate**, see the recall above. Only triangles whose outer side faces the other body: `n . u > 0` with the
    /// normal `n` and the direction `u` from centre to centre. Nothing is baked.
    ///
    /// A mesh that is open, whose faces disagree about the outside, or that is a room, has no front and runs `Exact`.
    FrontFacing,
}
