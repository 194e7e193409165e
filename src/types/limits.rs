//! Limits on the lists of a step.

#[cfg(feature = "bevy")]
use bevy::prelude::*;
use serde::{Deserialize, Serialize};

/// How many pairs a step on the CPU holds at most. They bound its memory and its time where thousands of bodies are in
/// one place, each of which touches all others.
///
/// The default limits are far beyond what fits in physical space: two gigabytes of pairs of bodies, and one of face
/// pairs. Where a step would exceed a limit, pairs are left out, so that it is **not exact**.
/// [`StepReport::crowded_bodies`](crate::plugin::collisions::StepReport::crowded_bodies) counts the bodies that lose
/// pairs, and an error names one of them.
///
/// * Beyond `body_pairs` the search for the pairs of a body ends after a certain number of them, the same for all
///   bodies. It is the largest number that the limit allows, up to a factor of two. It is at least a quarter of
///   `body_pairs` divided by the number of bodies. If two bodies both overlap fewer others than that, their pair is
///   kept.
/// * Beyond `face_pairs` the pairs of the bodies that overlap the most others are left out first, and pairs with static
///   bodies last.
///
/// A GPU has its own limits: the sizes of its buffers. If a list does not fit there, the step runs on the CPU.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(
    feature = "bevy",
    derive(Resource, Reflect),
    reflect(Resource, Default, Debug, PartialEq, Serialize, Deserialize)
)]
#[serde(default, deny_unknown_fields)]
pub struct StepLimits {
    /// Pairs of bodies whose bounding spheres overlap. Each takes up to 250 bytes.
    pub body_pairs: usize,
    /// Intersecting face pairs. Each takes 64 bytes. A single pair of bodies may have more.
    pub face_pairs: usize,
}

impl StepLimits {
    /// No limits: every step is exact, as long as there is memory and time.
    pub const NONE: Self = Self {
        body_pairs: usize::MAX,
        face_pairs: usize::MAX,
    };
}

impl Default for StepLimits {
    fn default() -> Self {
        Self {
            body_pairs: 1 << 23,
            face_pairs: 1 << 24,
        }
    }
}
