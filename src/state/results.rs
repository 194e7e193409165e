//! The results of a step, and their counts.

use super::contacts::Contacts;
use super::crowd::Crowd;
use super::manifolds::Manifolds;
use super::pairs::NearPair;
use crate::types::gpu_work::GpuWork;
use crate::types::stage::Stage;
use glam::Vec3;
use std::time::Duration;

/// The results of a step. One stage writes each list; later stages and the caller read it.
#[derive(Default)]
pub struct StepResults {
    /// BroadPhase: pairs of bodies whose bounding spheres overlap, `a < b`, ascending.
    pub sphere_pairs: Vec<[u32; 2]>,
    /// Angles: the sphere pairs that no support axis separates, in the same order.
    pub near_pairs: Vec<NearPair>,
    /// Number of `near_pairs` that are tested with some triangles left out.
    pub approximate_pairs: usize,
    /// Manifolds: number of searches for contact features on the CPU, in all collision substeps. A pair at rest has
    /// none.
    pub searches: usize,
    /// TriangleTest: touching pairs, intersecting faces and contact points.
    pub contacts: Contacts,
    /// Manifolds: contact points of solid bodies that touch or may touch within the step. Empty with
    /// [`Response::Impulse`]. Sleeping pairs keep their points in the next step, so snapshots contain this list.
    ///
    /// [`Response::Impulse`]: crate::types::settings::Response::Impulse
    pub manifolds: Manifolds,
    /// ForceScan: the summed velocity change of each body. Empty or stale with [`Response::Contacts`].
    ///
    /// [`Response::Contacts`]: crate::types::settings::Response::Contacts
    pub impulses: Vec<Impulse>,
    /// With [`Response::Contacts`], whether each body is asleep at the end of the step; otherwise empty.
    ///
    /// [`Response::Contacts`]: crate::types::settings::Response::Contacts
    pub asleep: Vec<bool>,
    /// Number of collision substeps of the step: the largest of any body.
    pub collision_substeps: u32,
    /// The mean number of collision substeps of the bodies that move.
    pub mean_collision_substeps: f32,
    /// The bodies that lost pairs; none, unless the step exceeded its limits.
    pub crowd: Crowd,
    /// Duration of each stage.
    pub times: [Duration; Stage::COUNT],
    /// What the step asked of a GPU; `None` if it ran on the CPU.
    pub gpu: Option<GpuWork>,
}

/// A change of velocity, linear and angular.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Impulse {
    /// Linear, m/s.
    pub linear: Vec3,
    /// Angular in world axes, rad/s.
    pub angular: Vec3,
}

/// Sizes of the results of a step.
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
    /// Contact points, speculative ones included.
    pub contact_points: usize,
    /// Bodies asleep after the step.
    pub asleep: usize,
    /// Bodies for which the step did nothing.
    pub dormant: usize,
    /// Number of bodies that lost pairs; see [`StepLimits`](crate::types::limits::StepLimits).
    pub crowded: usize,
}

impl StepResults {
    /// Returns memory beyond twice what is used.
    pub(crate) fn shrink(&mut self) {
        self.sphere_pairs.shrink_to(2 * self.sphere_pairs.len());
        self.near_pairs.shrink_to(2 * self.near_pairs.len());
        self.contacts.shrink();
        self.manifolds.shrink();
    }

    /// The sizes of the results.
    pub fn counts(&self) -> Counts {
        Counts {
            sphere_pairs: self.sphere_pairs.len(),
            approximate_pairs: self.approximate_pairs,
            touching_pairs: self.contacts.pairs.len(),
            triangle_tests: self.contacts.triangle_tests,
            face_pairs: self.contacts.face_pairs,
            contact_points: self.manifolds.points.len(),
            asleep: self.asleep.iter().filter(|&&asleep| asleep).count(),
            dormant: 0,
            crowded: self.crowd.bodies,
        }
    }
}
