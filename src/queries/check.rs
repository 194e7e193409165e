//! Overlap queries: which of many placed meshes touch.

use super::placed::Placed;
use crate::asset::CollisionMesh;
use crate::state::fault::BodyFault;
use crate::state::mesh_arena::MeshArena;
use crate::state::{Body, NearPair, PairContact};
#[cfg(feature = "gpu")]
use crate::step::gpu::{GpuStep, StepError};
use crate::step::{self, StepState};
use crate::types::limits::StepLimits;
use crate::types::settings::Culling;
use crate::types::stage::Stage;
use glam::{Quat, Vec3};
use std::mem;
use thiserror::Error;

/// A mesh with a pose: scaled, then rotated, then translated.
#[derive(Clone, Debug)]
pub struct Placement {
    /// The mesh.
    pub mesh: CollisionMesh,
    /// World position of the mesh's origin, metres.
    pub translation: Vec3,
    /// Rotation; normalised before use.
    pub rotation: Quat,
    /// Scale along the mesh's own axes. No component may be zero, but along an axis on which the mesh is flat, at 0.
    pub scale: Vec3,
}

impl Placement {
    /// The placed mesh for a [`ContactWorker`](super::ContactWorker).
    ///
    /// # Errors
    /// If the pose is invalid.
    pub fn placed(&self) -> Result<Placed<'_>, BodyFault> {
        let (translation, rotation) = (self.translation.as_dvec3(), self.rotation.as_dquat());
        Placed::new(&self.mesh, translation, rotation, self.scale)
    }
}

/// An invalid placement.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error("body {body}: {fault}")]
pub struct PlacementError {
    /// Index of the placement.
    pub body: usize,
    /// The error, and how to fix it.
    pub fault: BodyFault,
}

/// Two placements that touch, `a < b`.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct TouchingPair {
    /// The smaller index.
    pub a: u32,
    /// The larger index.
    pub b: u32,
    /// Whether one body is solid and contains the other, or a connected component of it, without intersecting faces.
    /// With an approximate culling mode some intersecting faces may have been missed.
    pub contained: bool,
    /// Intersecting faces as indices of the source meshes, `a`'s first, ascending.
    pub faces: Vec<[u32; 2]>,
}

/// Options of [`check_with`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CheckOptions {
    /// Which triangles are tested, for all placements. With [`Culling::FacesOfCollision`], meshes without a face table
    /// are tested exactly; nothing is baked here.
    pub culling: Culling,
}

/// All touching pairs of placements, ascending, with every triangle tested, on the CPU.
///
/// The poses count as exact. Corners are placed in double precision, and no touch is missed. Triangles that are apart
/// by no more than the rounding of their corners, 1e-14 of the two bodies' size, may count as touching.
///
/// Runs on rayon's current thread pool: call it inside `ThreadPool::install` to choose one.
///
/// # Errors
/// If a placement is invalid. Nothing is tested then.
pub fn check(placements: &[Placement]) -> Result<Vec<TouchingPair>, PlacementError> {
    check_with(placements, &CheckOptions::default())
}

/// [`check`] with options.
///
/// # Errors
/// If a placement is invalid. Nothing is tested then.
pub fn check_with(placements: &[Placement], options: &CheckOptions) -> Result<Vec<TouchingPair>, PlacementError> {
    Ok(Check::new(placements, options)?.flatten().collect())
}

/// [`check_with`] in batches: an iterator over lists of touching pairs, which together are all of them. For scenes
/// whose intersecting faces do not fit in memory at once, and to report progress.
///
/// Runs on rayon's current thread pool, like [`check`].
pub struct Check {
    state: StepState,
    /// All pairs that may touch; `state` holds the current batch.
    pairs: Vec<NearPair>,
    done: usize,
    batch: usize,
}

impl Check {
    /// First and largest number of pairs per batch.
    const BATCH: [usize; 2] = [64, 1024];
    /// Batches grow while they find fewer intersecting faces than this, and shrink otherwise.
    const FACES: usize = 1 << 20;

    /// Finds the pairs that may touch, which takes little time.
    ///
    /// # Errors
    /// If a placement is invalid. Nothing is tested then.
    pub fn new(placements: &[Placement], options: &CheckOptions) -> Result<Self, PlacementError> {
        let mut state = step_of(placements, options)?;
        for stage in [Stage::BroadPhase, Stage::Angles] {
            step::cpu::run(stage, &mut state);
        }
        Ok(Self {
            pairs: mem::take(&mut state.results.near_pairs),
            state,
            done: 0,
            batch: Self::BATCH[0],
        })
    }

    /// Number of pairs tested so far, and of all pairs.
    pub fn progress(&self) -> (usize, usize) {
        (self.done, self.pairs.len())
    }
}

impl Iterator for Check {
    type Item = Vec<TouchingPair>;

    fn next(&mut self) -> Option<Vec<TouchingPair>> {
        let rest = self.pairs.get(self.done..).filter(|rest| !rest.is_empty())?;
        let batch = &rest[..self.batch.min(rest.len())];
        self.state.results.near_pairs.clear();
        self.state.results.near_pairs.extend_from_slice(batch);
        self.done += batch.len();
        step::cpu::run(Stage::TriangleTest, &mut self.state);
        self.batch = if self.state.results.contacts.faces.len() < Self::FACES {
            (self.batch * 2).min(Self::BATCH[1])
        } else {
            (self.batch / 2).max(1)
        };
        Some(touching_pairs(&self.state))
    }
}

/// Pairs of placements that touch, `a < b`, ascending: the pairs of [`check`] without their faces. Each pair's test
/// stops at the first certain intersection, which is several times as fast.
///
/// Runs on rayon's current thread pool, like [`check`].
///
/// # Errors
/// If a placement is invalid. Nothing is tested then.
pub fn touching(placements: &[Placement]) -> Result<Vec<[u32; 2]>, PlacementError> {
    touching_with(placements, &CheckOptions::default())
}

/// [`touching`] with options: the pairs of [`check_with`].
///
/// # Errors
/// If a placement is invalid. Nothing is tested then.
pub fn touching_with(placements: &[Placement], options: &CheckOptions) -> Result<Vec<[u32; 2]>, PlacementError> {
    let mut state = step_of(placements, options)?;
    for stage in [Stage::BroadPhase, Stage::Angles] {
        step::cpu::run(stage, &mut state);
    }
    Ok(step::cpu::touching(&mut state))
}

/// Why a check on a GPU failed.
#[cfg(feature = "gpu")]
#[derive(Clone, Debug, Error, PartialEq)]
pub enum CheckError {
    /// A placement is invalid.
    #[error(transparent)]
    Placement(#[from] PlacementError),
    /// The device cannot hold the scene, or failed.
    #[error(transparent)]
    Gpu(#[from] StepError),
}

/// [`check_with`] on a GPU. [`Backend`](crate::plugin::settings::Backend) tells how its results may differ.
///
/// # Errors
/// If a placement is invalid, or the device fails.
#[cfg(feature = "gpu")]
pub fn check_on_gpu(
    placements: &[Placement],
    options: &CheckOptions,
    gpu: &mut GpuStep,
) -> Result<Vec<TouchingPair>, CheckError> {
    let mut state = step_of(placements, options)?;
    gpu.run(&mut state)?;
    Ok(touching_pairs(&state))
}

/// The input of a step for these placements.
fn step_of(placements: &[Placement], options: &CheckOptions) -> Result<StepState, PlacementError> {
    let mut state = StepState::default();
    // The caller waits for the whole answer, however long.
    state.input.config.limits = StepLimits::NONE;
    for (body, placement) in placements.iter().enumerate() {
        let slot = slot_of(&placement.mesh, &mut state.input.meshes);
        let entry = Body {
            culling: options.culling,
            ..Body::at_rest(slot, placement.translation, placement.rotation, placement.scale)
        };
        state
            .input
            .bodies
            .push(&entry, &state.input.meshes)
            .map_err(|fault| PlacementError { body, fault })?;
    }
    Ok(state)
}

/// The slot of this mesh, added if needed. Scenes have few meshes, so a linear search will do.
fn slot_of(mesh: &CollisionMesh, meshes: &mut MeshArena) -> u32 {
    let has_it = |slot: &u32| meshes.get(*slot).is_some_and(|other| other.mesh.is_same(mesh));
    let slot = (0..meshes.len() as u32).find(has_it);
    slot.unwrap_or_else(|| meshes.add(mesh.clone()))
}

fn touching_pairs(state: &StepState) -> Vec<TouchingPair> {
    let contacts = &state.results.contacts;
    let touching = |pair: &PairContact| {
        let PairContact { bodies, contained, .. } = *pair;
        let mut faces: Vec<[u32; 2]> = contacts.faces_of(pair).iter().map(|f| [f.a, f.b]).collect();
        faces.sort_unstable();
        TouchingPair {
            a: bodies[0],
            b: bodies[1],
            contained,
            faces,
        }
    };
    contacts.pairs.iter().map(touching).collect()
}
