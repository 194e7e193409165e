//! Between the ECS and the stages: components in before a step, results out after it.

pub(crate) mod collect;
#[cfg(feature = "gpu")]
pub(crate) mod latent;
mod oddities;
pub(crate) mod publish;
#[cfg(feature = "gpu")]
mod shadow;
mod tables;

use crate::asset::CollisionMesh;
use crate::manifolds::Manifolds;
use crate::plugin::backend::Engine;
#[cfg(feature = "gpu")]
use crate::plugin::settings::LATENCY;
use crate::state::fault::BodyFault;
use crate::state::{Body, Counts, Motion, Plane};
use crate::step::StepState;
#[cfg(feature = "gpu")]
use crate::step::gpu::contacts::memory::DeviceMemory;
use crate::step::gpu::results::{Detail, Output};
use crate::types::body::RigidBody;
use crate::types::settings::Response;
use crate::types::stage::Stage;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use std::collections::BTreeMap;
use std::time::Instant;

/// The stages' arrays and what ties them to entities.
#[derive(Resource)]
pub(crate) struct Step {
    pub state: StepState,
    /// What runs the stages.
    pub engine: Engine,
    /// What the stages are about to work on.
    pub collected: Collected,
    /// What the results in `state` are about; `None` while the first ones are on their way.
    pub results: Option<Collected>,
    /// How much was found.
    pub counts: Counts,
    /// Steps whose results are on their way.
    #[cfg(feature = "gpu")]
    pub latent: latent::Latent,
    /// Scratch: bodies in the order of entities, usable or not.
    pub bodies: Vec<(Entity, Body)>,
    /// Scratch: half-spaces in the order of entities.
    pub planes: Vec<(Entity, Plane)>,
    /// Arena slots by asset.
    pub slots: HashMap<AssetId<CollisionMesh>, u32>,
    /// Face tables that bodies asked for and their meshes lack.
    pub tables: tables::Tables,
    /// Bodies out of the step, and why; ascending.
    pub faults: Vec<(Entity, BodyFault)>,
    /// What does not do what it says.
    pub oddities: oddities::Oddities,
    /// Pairs that are told to touch, ascending.
    pub touching: Vec<Touching>,
    /// Scratch: those of this step.
    pub touching_now: Vec<Touching>,
    /// Scratch: those that touched before and not in this step.
    pub lingering: Vec<Touching>,
    /// Scratch: the same, each pair in both orders.
    pub touching_both_ways: Vec<[Entity; 2]>,
    /// When the step began.
    pub begun: Instant,
    /// Somebody ran the schedule: results are waited for.
    pub by_hand: bool,
    /// What `Time` is outside of the step.
    pub outer_time: Option<Time>,
}

/// An entity as it is named in the log.
pub(crate) fn named(entity: Entity, name: Option<&Name>) -> String {
    let name = name.map(|name| format!(" \"{name}\""));
    format!("{entity}{}", name.unwrap_or_default())
}

/// A pair that is told to touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Touching {
    /// `first < second`.
    pub pair: [Entity; 2],
    /// For how many more seconds without a touch.
    pub left: f32,
}

/// Who takes part in a step.
#[derive(Default)]
pub(crate) struct Collected {
    /// Entity of each body, ascending.
    pub entities: Vec<Entity>,
    /// How each body moves.
    pub kinds: Vec<RigidBody>,
    /// Entity of each plane, ascending.
    pub planes: Vec<Entity>,
}

impl Collected {
    /// Whether a body or plane took part.
    pub fn has(&self, entity: Entity) -> bool {
        self.entities.binary_search(&entity).is_ok() || self.planes.binary_search(&entity).is_ok()
    }
}

impl Step {
    pub fn new(engine: Engine) -> Self {
        Self {
            state: StepState::default(),
            engine,
            collected: Collected::default(),
            results: None,
            counts: Counts::default(),
            #[cfg(feature = "gpu")]
            latent: latent::Latent::default(),
            bodies: Vec::new(),
            planes: Vec::new(),
            slots: HashMap::default(),
            tables: tables::Tables::default(),
            faults: Vec::new(),
            oddities: oddities::Oddities::default(),
            touching: Vec::new(),
            touching_now: Vec::new(),
            lingering: Vec::new(),
            touching_both_ways: Vec::new(),
            begun: Instant::now(),
            by_hand: false,
            outer_time: None,
        }
    }

    /// The GPU does not stop fast bodies: with such ones the step runs on the CPU, and goes on from where the bodies are.
    pub fn choose_place(&mut self) {
        let stops = self
            .state
            .input
            .bodies
            .handling
            .iter()
            .any(|handling| handling.continuous);
        let on_cpu = stops && self.state.input.config.response == Response::Contacts;
        if self.engine.changes_place(on_cpu) {
            #[cfg(feature = "gpu")]
            self.catch_up_collected();
            self.forget();
            self.state.memory.forget();
            self.state.results.manifolds = Manifolds::default();
        }
        self.engine.keep_on_cpu(on_cpu);
    }

    /// Brings the collected bodies, which are where their components say, to where steps in flight take them.
    #[cfg(feature = "gpu")]
    fn catch_up_collected(&mut self) {
        if self.engine.latent().is_none() {
            return;
        }
        let entities = self.collected.entities.iter().copied().enumerate();
        let mut motions = entities
            .map(|(i, entity)| (entity, self.state.input.bodies.motion(i)))
            .collect();
        self.catch_up(&mut motions);
        self.state.input.bodies.clear();
        for (entity, body) in &self.bodies {
            let Some(motion) = motions.get(entity) else { continue };
            let moved = Body {
                position: motion.position,
                rotation: motion.rotation,
                linear_velocity: motion.linear_velocity,
                angular_velocity: motion.angular_velocity,
                ..*body
            };
            // Where the components say it was fit to take part.
            if self.state.input.bodies.push(&moved, &self.state.input.meshes).is_err() {
                let _ = self.state.input.bodies.push(body, &self.state.input.meshes);
            }
        }
    }

    /// Runs a stage, or on a device all of them when asked for the first.
    pub fn run(&mut self, stage: Stage) {
        #[cfg(feature = "gpu")]
        if self.advance(stage) {
            return;
        }
        self.engine.run(stage, &mut self.state);
        if stage == Stage::Integrate {
            self.counts = self.state.results.counts();
            // What was there is overwritten by the next step, in the same memory.
            std::mem::swap(self.results.get_or_insert_default(), &mut self.collected);
        }
    }

    /// Runs a step whose results come later, if they are to; false if not.
    #[cfg(feature = "gpu")]
    fn advance(&mut self, stage: Stage) -> bool {
        if stage != Stage::BroadPhase {
            return self.engine.latent().is_some();
        }
        if let Some(detail) = self.engine.latent() {
            let resident = detail == Detail::Counts;
            self.latent.link(&self.collected.entities, &self.bodies, resident);
            let handling = &mut self.state.input.bodies.handling;
            for (handling, &woken) in handling.iter_mut().zip(&self.latent.woken) {
                handling.woken = woken;
            }
        }
        while let Some(detail) = self.engine.latent() {
            let carried = &self.latent.carried;
            let Some(output) = self.engine.advance(&self.state.input, carried, detail, LATENCY) else {
                // The device failed. Whoever takes over begins where the components say.
                self.latent.restart();
                continue;
            };
            self.latent.sent(std::mem::take(&mut self.collected));
            self.results = None;
            if let Some(output) = output {
                self.take_in(output);
            }
            return true;
        }
        false
    }

    /// Waits for the results of the oldest step that is on its way; false if there is none.
    pub fn land(&mut self) -> bool {
        #[cfg(feature = "gpu")]
        if self.engine.latent().is_some() && self.engine.flights().0 > 0 {
            self.begun = Instant::now();
            match self.engine.land() {
                Some(output) => self.take_in(output),
                // The device failed. Whoever takes over begins where the components say.
                None => self.forget(),
            }
            return self.results.is_some();
        }
        false
    }

    /// Puts results of a step that was sent off where others look for them.
    #[cfg(feature = "gpu")]
    fn take_in(&mut self, output: Output) {
        self.counts = output.counts;
        let motions = output.put_lists(&mut self.state.results);
        self.results = self.latent.arrived(motions);
    }

    /// Brings `bodies`, which hold what the components say, up to the last step that was sent off.
    #[cfg(feature = "gpu")]
    pub fn catch_up(&mut self, bodies: &mut BTreeMap<Entity, Motion>) {
        let (Some(_), Some(gpu)) = (self.engine.latent(), self.engine.gpu_step()) else {
            return;
        };
        match gpu.motions() {
            Ok(motions) => self.latent.catch_up(&motions, bodies),
            Err(error) => {
                // What the components say is all that is left.
                self.engine.replace(&error);
                self.latent.forget();
            }
        }
    }

    /// What a device remembers of the last step.
    #[cfg(feature = "gpu")]
    pub fn device_memory(&mut self) -> DeviceMemory {
        let Some(gpu) = self.engine.gpu_step() else {
            return DeviceMemory::default();
        };
        gpu.memory().unwrap_or_else(|error| {
            self.engine.replace(&error);
            self.latent.forget();
            DeviceMemory::default()
        })
    }

    /// Drops what is on its way: bodies go on from where the components say, and a device from what it is to remember.
    #[cfg(feature = "gpu")]
    pub fn remember(&mut self, memory: &DeviceMemory) {
        self.forget();
        if let Some(gpu) = self.engine.gpu_step()
            && let Err(error) = gpu.remember(memory)
        {
            self.engine.replace(&error);
        }
    }

    /// On the CPU the components say all.
    #[cfg(not(feature = "gpu"))]
    pub fn catch_up(&mut self, _: &mut BTreeMap<Entity, Motion>) {}

    /// Drops what is on its way: bodies go on from where the components say.
    pub fn forget(&mut self) {
        #[cfg(feature = "gpu")]
        {
            if let Some(gpu) = self.engine.gpu_step() {
                gpu.forget();
            }
            self.latent.forget();
        }
        self.results = None;
    }
}
