//! Synchronisation with the ECS: reads components before a step, and writes results after it.

mod assemblies;
pub(crate) mod changes;
mod children;
pub(crate) mod collect;
mod collected;
mod component_warnings;
pub(crate) mod components;
pub(crate) mod deep_overlaps;
pub(crate) mod driven;
pub(crate) mod entity_hooks;
mod entity_index_set;
pub(crate) mod hierarchy;
mod kept;
mod key_order;
#[cfg(feature = "gpu")]
pub(crate) mod latent;
pub(crate) mod order;
pub(crate) mod planes;
pub(crate) mod publish;
mod reader;
#[cfg(feature = "gpu")]
pub(crate) mod release;
#[cfg(feature = "gpu")]
mod shadow;
mod sheared;
mod split;
mod tables;
mod touching;

use crate::asset::CollisionMesh;
use crate::plugin::backend::Engine;
#[cfg(feature = "gpu")]
use crate::plugin::settings::LATENCY;
use crate::state::fault::BodyFault;
use crate::state::revision::Revision;
use crate::state::{Counts, Motion, StepInput};
use crate::step::StepState;
#[cfg(feature = "gpu")]
use crate::step::gpu::memory::DeviceMemory;
#[cfg(feature = "gpu")]
use crate::step::gpu::results::{Detail, Output};
use crate::types::settings::Response;
use crate::types::stage::Stage;
use assemblies::{Assembly, AssemblyPart, Candidate};
use bevy::ecs::change_detection::Tick;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use children::ChildColliders;
pub(crate) use collected::{Collected, Rows};
use driven::DrivenBodies;
use entity_hooks::{EntityHooks, Numbered};
use hierarchy::NestedBodies;
use kept::Kept;
use std::collections::BTreeMap;
pub(crate) use touching::Touching;
use touching::TouchingPairs;
use web_time::Instant;

/// The stages' arrays, and the entities to which their elements belong.
#[derive(Resource)]
pub(crate) struct Step {
    pub state: StepState,
    /// Runs the stages on the backend.
    pub engine: Engine,
    /// The bodies and planes of the step that is about to run.
    pub collected: Collected,
    /// The bodies and planes of the results in `state`. `None` while the first results are pending.
    pub results: Option<Collected>,
    /// Counts of the last results.
    pub counts: Counts,
    /// Steps with pending results.
    #[cfg(feature = "gpu")]
    pub latent: latent::Latent,
    /// What is kept of the last step.
    pub kept: Kept,
    /// Scratch: colliders in their order, valid or not.
    pub candidates: Vec<Candidate>,
    /// Scratch: bodies whose colliders are placed in them, ascending by entity, and these colliders.
    pub assemblies: Vec<Assembly>,
    pub parts: Vec<AssemblyPart>,
    /// How many of the assemblies are static ones of earlier steps, where those are kept. They come first.
    pub kept_assemblies: usize,
    /// Colliders below other entities.
    pub children: ChildColliders,
    /// Scratch: bodies that are not single colliders without a parent.
    pub others: Vec<Entity>,
    /// Bodies under other entities.
    pub nested: NestedBodies,
    /// The nested bodies of the last step, until the bodies that leave are known.
    #[cfg(feature = "gpu")]
    pub last_nested: NestedBodies,
    /// Kinematic bodies that move by their `Transform`.
    pub driven: DrivenBodies,
    /// Scratch: planes in their order.
    pub planes: Vec<planes::KeyedPlane>,
    /// Arena slots by asset.
    pub slots: HashMap<AssetId<CollisionMesh>, u32>,
    /// Face tables that culling modes need and meshes lack.
    pub tables: tables::Tables,
    /// Copies of meshes that are sheared.
    pub sheared: sheared::ShearedMeshes,
    /// Rejected bodies and planes with the reason, ascending.
    pub faults: Vec<(Entity, BodyFault)>,
    /// Scratch: faults of this step.
    pub new_faults: Vec<(Entity, BodyFault)>,
    /// Components without effect.
    pub warnings: component_warnings::ComponentWarnings,
    /// Pairs whose collision has started and not ended.
    pub touching: TouchingPairs,
    /// Names the dormant bodies whose contacts are published.
    pub published_dormant: Revision,
    /// Scratch: colliders and bodies of `touching` whose `Transform` others wrote since the last step, ascending.
    pub written: Vec<Entity>,
    /// When the step last wrote `Transform`s.
    pub written_at: Option<Tick>,
    /// The name of the app's hooks.
    pub hooks: Option<&'static str>,
    /// When the step began.
    pub begun: Instant,
    /// Whether a user ran the schedule. Then the step waits for its results.
    pub by_hand: bool,
    /// Whether the last tick of fixed time ran no step, because the clock of physics stood still.
    #[cfg(feature = "gpu")]
    pub stands: bool,
    /// The resource `Time` outside of the step.
    pub outer_time: Option<Time>,
}

/// The name of an entity in the log.
pub(crate) fn named(entity: Entity, name: Option<&Name>) -> String {
    let name = name.map(|name| format!(" \"{name}\""));
    format!("{entity}{}", name.unwrap_or_default())
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
            kept: Kept::default(),
            candidates: Vec::new(),
            assemblies: Vec::new(),
            parts: Vec::new(),
            kept_assemblies: 0,
            children: ChildColliders::default(),
            others: Vec::new(),
            nested: NestedBodies::default(),
            #[cfg(feature = "gpu")]
            last_nested: NestedBodies::default(),
            driven: DrivenBodies::default(),
            planes: Vec::new(),
            slots: HashMap::default(),
            tables: tables::Tables::default(),
            sheared: sheared::ShearedMeshes::default(),
            faults: Vec::new(),
            new_faults: Vec::new(),
            warnings: component_warnings::ComponentWarnings::default(),
            touching: TouchingPairs::default(),
            published_dormant: Revision::UNKNOWN,
            written: Vec::new(),
            written_at: None,
            hooks: None,
            begun: Instant::now(),
            by_hand: false,
            #[cfg(feature = "gpu")]
            stands: false,
            outer_time: None,
        }
    }

    /// Whether the step that is about to run follows on the CPU to steps on a device that may be pending.
    #[cfg(feature = "gpu")]
    pub fn leaves_device(&self) -> bool {
        let on_cpu = self.state.input.has_hooks();
        on_cpu && self.engine.changes_place(on_cpu)
    }

    /// Moves the simulation to the CPU while hooks are active, and back to the GPU afterwards. Bodies keep their state.
    pub fn choose_place(&mut self) {
        let StepInput { bodies, config, .. } = &self.state.input;
        self.engine.has_fast_bodies = bodies.flags().continuous && config.response == Response::Contacts;
        let on_cpu = self.state.input.has_hooks();
        #[cfg(feature = "gpu")]
        if self.engine.changes_place(on_cpu) {
            self.hand_over(on_cpu);
        }
        self.engine.keep_on_cpu(on_cpu);
        if self.engine.has_fast_bodies
            && self.engine.is_latent()
            && let bodies = &self.state.input.bodies
            && let fast = bodies.params.iter().position(|params| params.continuous)
            && let Some(&entity) = fast.and_then(|collider| self.collected.bodies.get(collider))
        {
            info_once!(
                "the CPU waits for the GPU during a step because {entity} has ContinuousCollision, which runs on the CPU; \
                 results come as late as before"
            );
        }
    }

    /// Moves bodies, sleep states and saved impulses between the device and the CPU.
    #[cfg(feature = "gpu")]
    fn hand_over(&mut self, to_cpu: bool) {
        if to_cpu {
            self.catch_up_collected();
            // The CPU writes the poses of the others to their components.
            self.driven.keep(|entity| self.latent.shows(entity));
            let memory = self.device_memory();
            (self.state.memory, self.state.results.manifolds) = memory.to_cpu();
            self.forget();
        } else {
            self.rouse_all();
            self.remember(&DeviceMemory::from_cpu(
                &self.state.memory,
                &self.state.results.manifolds,
            ));
        }
    }

    /// Updates the collected bodies, which have the state of their components, to the state after the pending steps.
    #[cfg(feature = "gpu")]
    fn catch_up_collected(&mut self) {
        if !self.engine.is_latent() {
            return;
        }
        let arrays = &self.state.input.bodies;
        let bodies = (0..arrays.len()).filter(|&i| arrays.is_body(i));
        let mut motions = bodies
            .map(|i| (self.collected.bodies[i], arrays.body_motion(i)))
            .collect();
        self.catch_up(&mut motions);
        self.refill(|entity| motions.get(&entity).copied());
    }

    /// Runs a stage. A device runs all stages in the call for the first one.
    pub fn run(&mut self, stage: Stage, hooks: &mut dyn EntityHooks) {
        if stage == Stage::BroadPhase {
            self.begin();
        }
        #[cfg(feature = "gpu")]
        if self.advance(stage) {
            return;
        }
        let mut hooks = Numbered {
            hooks,
            collected: &self.collected,
        };
        self.engine.run(stage, &mut self.state, &mut hooks);
        if stage == Stage::Integrate {
            self.counts = self.state.counts();
            self.counts.asleep = self.bodies_asleep();
            // Swapped instead of moved, so that the next step reuses the memory.
            std::mem::swap(self.results.get_or_insert_default(), &mut self.collected);
        }
    }

    /// Completes the input of the stages.
    fn begin(&mut self) {
        #[cfg(feature = "gpu")]
        if let Some(detail) = self.engine.latent() {
            self.link(detail == Detail::Counts);
            self.driven.keep(|entity| self.latent.shows(entity));
        }
        self.depart();
    }

    /// Checks the driven bodies of this step.
    pub fn check_driven(&mut self) {
        let (mut driven, mut warnings) = (std::mem::take(&mut self.driven), std::mem::take(&mut self.warnings));
        let number_of = |entity| self.number_of(entity);
        driven.check(&self.state.input.bodies, number_of, &mut warnings);
        (self.driven, self.warnings) = (driven, warnings);
    }

    /// Moves driven bodies back to where their way begins.
    fn depart(&mut self) {
        let departures = self.driven.departures(|entity| self.number_of(entity));
        let dt = self.state.input.config.dt;
        self.state.input.bodies.depart(&departures, dt);
        let mut driven = std::mem::take(&mut self.driven);
        driven.note_velocities(|entity| {
            let motion = self.state.input.bodies.body_motion(self.number_of(entity)?);
            Some([motion.linear_velocity, motion.angular_velocity])
        });
        self.driven = driven;
    }

    /// Number of bodies asleep after a step on the CPU.
    fn bodies_asleep(&self) -> usize {
        let (bodies, asleep) = (&self.state.input.bodies, &self.state.results.asleep);
        let dormant = &bodies.dormant;
        let is_asleep = |&i: &usize| asleep.get(i) == Some(&true) && bodies.is_body(i) && !dormant.has(i);
        dormant.count + bodies.movers().filter(is_asleep).count()
    }

    /// Whether other bodies are dormant than those whose contacts are published.
    pub fn has_new_dormant(&self) -> bool {
        let now = self.state.input.bodies.dormant.name;
        !now.is(self.published_dormant) && (now.is_known() || self.published_dormant.is_known())
    }

    /// Ends the dormancy of all bodies, so that the memory of the last step is complete.
    pub fn rouse_all(&mut self) {
        self.state.rouse_all();
        self.touching.join_dormant();
    }

    /// Runs a step if its results come later. Returns false if results are not to come later.
    #[cfg(feature = "gpu")]
    fn advance(&mut self, stage: Stage) -> bool {
        if stage != Stage::BroadPhase {
            return self.engine.is_latent();
        }
        if self.engine.latent().is_some() && self.state.input.config.response == Response::Contacts {
            self.latent.apply_impulses(&mut self.state.input.bodies);
        }
        while let Some(detail) = self.engine.latent() {
            self.state.scratch.age(&mut self.state.results);
            let carried = &self.latent.carried;
            let Some(output) = self.engine.advance(&self.state.input, carried, detail, LATENCY) else {
                // The device failed. The next backend starts from the components.
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

    /// Whether a body was in the step that ran last, even if its results come later. Call it before they are published.
    pub fn has_run(&self, body: Entity) -> bool {
        if let Some(assembly) = self.assembly(body) {
            return assembly.number.is_some();
        }
        #[cfg(feature = "gpu")]
        if self.engine.is_latent() {
            return self.latent.contains(body);
        }
        let results = self.results.as_ref();
        results.is_some_and(|results| results.entities.number_of(body).is_some())
    }

    /// Waits for the results of the oldest pending step. Returns false if there is none.
    pub fn land(&mut self) -> bool {
        #[cfg(feature = "gpu")]
        if self.engine.is_latent() && self.engine.flights().0 > 0 {
            self.begun = Instant::now();
            match self.engine.land() {
                Some(output) => self.take_in(output),
                // The device failed. The next backend starts from the components.
                None => self.forget(),
            }
            return self.results.is_some();
        }
        false
    }

    /// Stores the results of a submitted step, to be published.
    #[cfg(feature = "gpu")]
    fn take_in(&mut self, output: Output) {
        self.counts = output.counts;
        let motions = output.put_lists(&mut self.state.results);
        self.results = self.latent.arrived(motions);
    }

    /// Updates `bodies` from the state of their components to the state after the last submitted step.
    #[cfg(feature = "gpu")]
    pub fn catch_up(&mut self, bodies: &mut BTreeMap<Entity, Motion>) {
        let (Some(_), Some(gpu)) = (self.engine.latent(), self.engine.gpu_step()) else {
            return;
        };
        match gpu.motions() {
            Ok(motions) => self.latent.catch_up(&motions, bodies),
            Err(error) => {
                // Only the state in the components is left.
                self.engine.replace(&error);
                self.latent.forget();
            }
        }
    }

    /// The device's memory of the last step.
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

    /// Drops pending results and restores the device's `memory`. Bodies continue from the state in their components.
    #[cfg(feature = "gpu")]
    pub fn remember(&mut self, memory: &DeviceMemory) {
        self.forget();
        if let Some(gpu) = self.engine.gpu_step()
            && let Err(error) = gpu.remember(memory)
        {
            self.engine.replace(&error);
        }
    }

    /// Does nothing: without a GPU the components hold the current state.
    #[cfg(not(feature = "gpu"))]
    pub fn catch_up(&mut self, _: &mut BTreeMap<Entity, Motion>) {}

    /// Whether bodies stay on the device.
    pub fn is_resident(&self) -> bool {
        #[cfg(feature = "gpu")]
        let is_resident = self.engine.latent() == Some(Detail::Counts);
        #[cfg(not(feature = "gpu"))]
        let is_resident = false;
        is_resident
    }

    /// The sheared copy of its mesh that a collider has.
    pub fn sheared_mesh(&self, collider: Entity) -> Option<&CollisionMesh> {
        let slot = self.sheared.slot_of(collider)?;
        Some(&self.state.input.meshes[slot].mesh)
    }

    /// Drops pending results. Bodies continue from the state in their components.
    pub fn forget(&mut self) {
        self.rouse_all();
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

/// An app that is ready for its first step, and a cube with edges of 1 m.
#[cfg(test)]
fn app_with_cube() -> (App, crate::plugin::components::MeshCollider) {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, crate::plugin::FaceoffHeadlessPlugins::default()));
    app.finish();
    app.cleanup();
    let cube = CollisionMesh::new(&crate::geometry::shapes::cube(1.0));
    let cube = app.world_mut().resource_mut::<Assets<CollisionMesh>>().add(cube);
    (app, crate::plugin::components::MeshCollider(cube))
}
