//! Which of many placed meshes touch.

use super::placed::Placed;
use crate::asset::CollisionMesh;
use crate::state::fault::BodyFault;
use crate::state::mesh_arena::MeshArena;
use crate::state::{Body, NearPair, PairContact};
#[cfg(feature = "gpu")]
use crate::step::gpu::{GpuStep, StepError};
use crate::step::{self, StepState};
use crate::types::settings::Culling;
use crate::types::stage::Stage;
use glam::{Quat, Vec3};
use std::mem;
use thiserror::Error;

/// A mesh placed in the world: scaled, then rotated, then moved.
#[derive(Clone, Debug)]
pub struct Placement {
    /// What is placed.
    pub mesh: CollisionMesh,
    /// Where its origin lies.
    pub translation: Vec3,
    /// How it is turned; normalised before use.
    pub rotation: Quat,
    /// How it is scaled along its own axes; no component may be zero.
    pub scale: Vec3,
}

impl Placement {
    /// The same for a [`ContactWorker`](super::ContactWorker).
    ///
    /// # Errors
    /// If it cannot be used.
    pub fn placed(&self) -> Result<Placed<'_>, BodyFault> {
        let (translation, rotation) = (self.translation.as_dvec3(), self.rotation.as_dquat());
        Placed::new(&self.mesh, translation, rotation, self.scale)
    }
}

/// A placement that cannot be used.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error("body {body}: {fault}")]
pub struct PlacementError {
    /// Index into the placements.
    pub body: usize,
    /// What is wrong and what to do.
    pub fault: BodyFault,
}

/// Two placements that touch, `a < b`.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct TouchingPair {
    /// The one of smaller index.
    pub a: u32,
    /// The other.
    pub b: u32,
    /// One is solid and has the other, or a connected component of it, inside, and no faces were found to intersect; with an
    /// approximate culling mode some may.
    pub contained: bool,
    /// Intersecting faces as indices of the input meshes, `a`'s first, ascending.
    pub faces: Vec<[u32; 2]>,
}

/// How [`check_with`] checks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CheckOptions {
    /// How triangles are chosen, for all placements. Meshes without a face table run `Exact` where
    /// [`Culling::FacesOfCollision`] is asked for: nothing is baked here.
    pub culling: Culling,
}

/// All pairs of placements that touch, ascending, by the exact mode on the CPU.
///
/// Runs on rayon's current thread pool: call it inside `ThreadPool::install` to choose one.
///
/// # Errors
/// If a placement cannot be used; nothing is checked then.
pub fn check(placements: &[Placement]) -> Result<Vec<TouchingPair>, PlacementError> {
    check_with(placements, &CheckOptions::default())
}

/// [`check`] with a choice of [`Culling`].
///
/// # Errors
/// If a placement cannot be used; nothing is checked then.
pub fn check_with(placements: &[Placement], options: &CheckOptions) -> Result<Vec<TouchingPair>, PlacementError> {
    Ok(Check::new(placements, options)?.flatten().collect())
}

/// [`check_with`] bit by bit: an iterator over lists of touching pairs, which one after the other are all of them. For scenes
/// whose intersecting faces do not fit in memory all at once, and to show how far the check is.
///
/// Runs on rayon's current thread pool, like [`check`].
pub struct Check {
    state: StepState,
    /// All pairs that may touch; `state` has those that are tested at the time.
    pairs: Vec<NearPair>,
    done: usize,
    batch: usize,
}

impl Check {
    /// How many pairs are tested at once, at first and at most.
    const BATCH: [usize; 2] = [64, 1024];
    /// Batches grow while they find fewer intersecting faces than this, and shrink when they find more.
    const FACES: usize = 1 << 20;

    /// Finds the pairs that may touch, which takes little time.
    ///
    /// # Errors
    /// If a placement cannot be used; nothing is checked then.
    pub fn new(placements: &[Placement], options: &CheckOptions) -> Result<Self, PlacementError> {
        let mut state = placed(placements, options)?;
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

    /// How many pairs have been tested, and how many there are to test.
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

/// Which placements touch, `a < b`, ascending: the pairs of [`check`], but not with which faces. A pair's test ends at its
/// first certain hit, which is several times as fast.
///
/// Runs on rayon's current thread pool, like [`check`].
///
/// # Errors
/// If a placement cannot be used; nothing is checked then.
pub fn touching(placements: &[Placement]) -> Result<Vec<[u32; 2]>, PlacementError> {
    touching_with(placements, &CheckOptions::default())
}

/// [`touching`] with a choice of [`Culling`]: the pairs of [`check_with`].
///
/// # Errors
/// If a placement cannot be used; nothing is checked then.
pub fn touching_with(placements: &[Placement], options: &CheckOptions) -> Result<Vec<[u32; 2]>, PlacementError> {
    let mut state = placed(placements, options)?;
    for stage in [Stage::BroadPhase, Stage::Angles] {
        step::cpu::run(stage, &mut state);
    }
    Ok(step::cpu::touching(&mut state))
}

/// Why a check on a GPU failed.
#[cfg(feature = "gpu")]
#[derive(Clone, Debug, Error, PartialEq)]
pub enum CheckError {
    /// A placement cannot be used.
    #[error(transparent)]
    Placement(#[from] PlacementError),
    /// The device cannot hold the scene, or failed.
    #[error(transparent)]
    Gpu(#[from] StepError),
}

/// [`check_with`] on a GPU. See [`Backend`](crate::plugin::settings::Backend) for how its results may differ.
///
/// # Errors
/// If a placement cannot be used, or the device fails.
#[cfg(feature = "gpu")]
pub fn check_on_gpu(
    placements: &[Placement],
    options: &CheckOptions,
    gpu: &mut GpuStep,
) -> Result<Vec<TouchingPair>, CheckError> {
    let mut state = placed(placements, options)?;
    gpu.run(&mut state)?;
    Ok(touching_pairs(&state))
}

/// The stages' input for a scene.
fn placed(placements: &[Placement], options: &CheckOptions) -> Result<StepState, PlacementError> {
    let mut state = StepState::default();
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

/// The slot that has this mesh, or a new one. Scenes have few meshes.
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
