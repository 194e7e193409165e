//! Meshes that the transforms above their colliders shear: copies with the shear applied, baked in the background.

use crate::asset::{CollisionMesh, ImportError};
use crate::plugin::assets::LoadError;
use crate::plugin::assets::jobs::on_bake_pool;
use crate::projection::BakeSettings;
use crate::state::mesh_arena::MeshArena;
use bevy::ecs::entity::EntityHashMap;
use bevy::math::DMat3;
use bevy::platform::cell::SyncCell;
use bevy::prelude::*;
use bevy::tasks::futures::check_ready;
use bevy::tasks::futures_lite::future::Boxed;

/// How far two shears of the same mesh may differ, as a fraction of its size. They are one then.
const TOLERANCE: f64 = 1.0e-5;

/// Sheared copies, shared by all colliders with the same mesh and shear. A copy that no collider has used in a step is
/// dropped.
#[derive(Default)]
pub(crate) struct ShearedMeshes {
    copies: Vec<ShearedCopy>,
    /// The copies of each collider of this step and of the last one.
    colliders: EntityHashMap<Used>,
    next_number: u64,
}

/// The copies that a collider uses.
#[derive(Clone, Default)]
struct Used {
    /// The number of the copy that it has.
    has: Option<u64>,
    /// The number of the copy that it waits for.
    awaits: Option<u64>,
    /// Whether the collider asked in this step.
    is_current: bool,
}

struct ShearedCopy {
    number: u64,
    /// The mesh without the shear. After a hot reload it is another one.
    source: CollisionMesh,
    stretch: DMat3,
    state: State,
}

enum State {
    /// Dropping it cancels the bake.
    Baking(SyncCell<Boxed<Result<CollisionMesh, LoadError>>>),
    /// The copy's slot in the arena.
    Baked(u32),
    Failed,
}

/// What became of a request.
#[derive(Clone, Copy)]
pub(crate) enum Sheared {
    /// The slot of the copy in the arena.
    Ready(u32),
    /// The first copy is being baked.
    Waits,
    /// The copy cannot be baked.
    Failed,
}

impl ShearedMeshes {
    /// Whether no collider has one.
    pub fn is_empty(&self) -> bool {
        self.copies.is_empty() && self.colliders.is_empty()
    }

    /// The copy of `source` with each vertex `v` at `stretch * v`, for a collider. While another copy than its last one
    /// is being baked, the last one serves. A collider has one bake at a time. `name` is for the log.
    pub fn request(
        &mut self,
        collider: Entity,
        source: &CollisionMesh,
        stretch: &DMat3,
        arena: &mut MeshArena,
        name: impl FnOnce() -> String,
    ) -> Sheared {
        let wanted = self.copies.iter().position(|copy| copy.fits(source, stretch));
        let mut used = self.colliders.remove(&collider).unwrap_or_default();
        used.is_current = true;
        for copy in &mut self.copies {
            copy.poll(arena);
        }
        let state_of = |copies: &[ShearedCopy], number: Option<u64>| {
            let copy = copies.iter().find(|copy| Some(copy.number) == number);
            copy.filter(|copy| copy.source.is_same(source)).map(ShearedCopy::state)
        };
        match state_of(&self.copies, used.awaits) {
            Some(Sheared::Waits) => {}
            awaited => {
                // What it waited for is newer than what it has, even if the shear has changed again.
                if let Some(Sheared::Ready(_)) = awaited {
                    used.has = used.awaits;
                }
                used.awaits = Some(match wanted {
                    Some(at) => self.copies[at].number,
                    None => self.begin(source, stretch, name),
                });
            }
        }
        let states = [used.awaits, used.has].map(|number| state_of(&self.copies, number));
        self.colliders.insert(collider, used);
        match states {
            [Some(Sheared::Ready(slot)), _] | [_, Some(Sheared::Ready(slot))] => Sheared::Ready(slot),
            [Some(awaited), _] => awaited,
            [None, _] => Sheared::Waits,
        }
    }

    /// The slot of the copy that a collider has.
    pub fn slot_of(&self, collider: Entity) -> Option<u32> {
        let used = self.colliders.get(&collider)?;
        let ready = |number: Option<u64>| match self.copies.iter().find(|copy| Some(copy.number) == number)?.state {
            State::Baked(slot) => Some(slot),
            State::Baking(_) | State::Failed => None,
        };
        ready(used.awaits).or_else(|| ready(used.has))
    }

    /// Drops the copies that no collider has used since the last call.
    pub fn end_step(&mut self, arena: &mut MeshArena) {
        if self.copies.is_empty() && self.colliders.is_empty() {
            return;
        }
        self.colliders.retain(|_, used| std::mem::take(&mut used.is_current));
        let colliders = &self.colliders;
        self.copies.retain(|copy| {
            let number = Some(copy.number);
            let is_used = colliders
                .values()
                .any(|used| used.has == number || used.awaits == number);
            if let State::Baked(slot) = copy.state
                && !is_used
            {
                arena.remove(slot);
            }
            is_used
        });
    }

    /// Starts to bake a copy, and returns its number.
    fn begin(&mut self, source: &CollisionMesh, stretch: &DMat3, name: impl FnOnce() -> String) -> u64 {
        let number = self.next_number;
        self.next_number += 1;
        info!(
            "{}: the unequal scale of an entity above it shears its mesh. A copy with the shear is baked in the background",
            name()
        );
        let (mesh, stretch) = (source.clone(), *stretch);
        let bake = on_bake_pool(move |pool, progress| {
            let sheared = mesh.mesh.mapped(|v| (stretch * v.as_dvec3()).as_vec3());
            let sheared = sheared.map_err(ImportError::from)?;
            let scales = [stretch.x_axis, stretch.y_axis, stretch.z_axis].map(|axis| axis.length());
            let settings = BakeSettings {
                rounding: mesh.settings.rounding * scales.into_iter().fold(f64::INFINITY, f64::min) as f32,
                ..mesh.settings
            };
            Ok(CollisionMesh::bake(&sheared, settings, pool, progress)?)
        });
        self.copies.push(ShearedCopy {
            number,
            source: source.clone(),
            stretch,
            state: State::Baking(SyncCell::new(Box::pin(bake))),
        });
        number
    }
}

impl ShearedCopy {
    fn fits(&self, source: &CollisionMesh, stretch: &DMat3) -> bool {
        let size = stretch.to_cols_array().into_iter().map(f64::abs).fold(0.0, f64::max);
        self.source.is_same(source) && self.stretch.abs_diff_eq(*stretch, TOLERANCE * size)
    }

    fn state(&self) -> Sheared {
        match self.state {
            State::Baking(_) => Sheared::Waits,
            State::Baked(slot) => Sheared::Ready(slot),
            State::Failed => Sheared::Failed,
        }
    }

    /// Stores a finished copy. It does not wait.
    fn poll(&mut self, arena: &mut MeshArena) {
        let State::Baking(bake) = &mut self.state else {
            return;
        };
        match check_ready(bake.get()) {
            Some(Ok(mesh)) => self.state = State::Baked(arena.add(mesh)),
            Some(Err(error)) => {
                debug!("a sheared copy of a mesh could not be baked: {error}");
                self.state = State::Failed;
            }
            None => {}
        }
    }
}
