//! What a step finds, and where it says how much that is.

use super::contacts::Contacts;
use super::manifolds::Manifolds;
use super::pairs::NearPair;
use crate::types::stage::Stage;
use glam::Vec3;
use std::time::Duration;

/// What a step finds. Each list is written by one stage, and read by later ones and by the caller.
#[derive(Default)]
pub struct StepResults {
    /// BroadPhase's result: bodies whose spheres overlap, `a < b`, ascending.
    pub sphere_pairs: Vec<[u32; 2]>,
    /// Angles' result: what is left of them, in the same order.
    pub near_pairs: Vec<NearPair>,
    /// How many of them are tested with some triangles left out.
    pub approximate_pairs: usize,
    /// TriangleTest's result.
    pub contacts: Contacts,
    /// Manifolds' result: where solid bodies push each other, or may within the step. Empty with [`Response::Impulse`]. Pairs
    /// that sleep keep theirs in the next step, so this belongs to what a snapshot holds.
    ///
    /// [`Response::Impulse`]: crate::types::settings::Response::Impulse
    pub manifolds: Manifolds,
    /// ForceScan's result: one sum per body. Empty or stale with [`Response::Contacts`].
    ///
    /// [`Response::Contacts`]: crate::types::settings::Response::Contacts
    pub impulses: Vec<Impulse>,
    /// With [`Response::Contacts`], of each body whether it was asleep at the end of the step; else empty.
    ///
    /// [`Response::Contacts`]: crate::types::settings::Response::Contacts
    pub asleep: Vec<bool>,
    /// Into how many collision substeps the step was cut.
    pub collision_substeps: u32,
    /// How long each stage took.
    pub times: [Duration; Stage::COUNT],
}

/// A change of velocity, linear and angular.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Impulse {
    /// m/s.
    pub linear: Vec3,
    /// rad/s, world axes.
    pub angular: Vec3,
}

/// How many of each thing a step found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Pairs of bodies whose spheres overlap.
    pub sphere_pairs: usize,
    /// Pairs tested with some triangles left out.
    pub approximate_pairs: usize,
    /// Pairs of bodies that touch.
    pub touching_pairs: usize,
    /// Pairs of triangles tested.
    pub triangle_tests: u64,
    /// Pairs of faces that intersect.
    pub face_pairs: usize,
    /// Points at which bodies push each other, or may.
    pub contact_points: usize,
    /// Bodies that sleep after the step.
    pub asleep: usize,
}

impl StepResults {
    /// How much the step found.
    pub fn counts(&self) -> Counts {
        Counts {
            sphere_pairs: self.sphere_pairs.len(),
            approximate_pairs: self.approximate_pairs,
            touching_pairs: self.contacts.pairs.len(),
            triangle_tests: self.contacts.triangle_tests,
            face_pairs: self.contacts.faces.len(),
            contact_points: self.manifolds.points.len(),
            asleep: self.asleep.iter().filter(|&&asleep| asleep).count(),
        }
    }
}
