//! Between the ECS and the stages: components in before a step, results out after it.

pub(crate) mod collect;
pub(crate) mod publish;
mod tables;

use crate::asset::CollisionMesh;
use crate::backend::Engine;
use crate::stages::bodies::BodyFault;
use crate::stages::state::{Body, StepState};
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use std::time::Instant;

/// The stages' arrays and what ties them to entities.
#[derive(Resource)]
pub(crate) struct Step {
    pub state: StepState,
    /// What runs the stages.
    pub engine: Engine,
    /// Entity of each body, ascending.
    pub entities: Vec<Entity>,
    /// Entity of each plane, ascending.
    pub planes: Vec<Entity>,
    /// Scratch: usable bodies in query order.
    pub collected: Vec<(Entity, Body)>,
    /// Arena slots by asset.
    pub slots: HashMap<AssetId<CollisionMesh>, u32>,
    /// Face tables that bodies asked for and their meshes lack.
    pub tables: tables::Tables,
    /// Bodies out of the step, and why; ascending.
    pub faults: Vec<(Entity, BodyFault)>,
    /// Pairs that touched in the last step, `first < second`, ascending.
    pub touching: Vec<[Entity; 2]>,
    /// When the step began.
    pub begun: Instant,
}

impl Step {
    pub fn new(engine: Engine) -> Self {
        Self {
            state: StepState::default(),
            engine,
            entities: Vec::new(),
            planes: Vec::new(),
            collected: Vec::new(),
            slots: HashMap::default(),
            tables: tables::Tables::default(),
            faults: Vec::new(),
            touching: Vec::new(),
            begun: Instant::now(),
        }
    }
}
