//! Reads components into the stages' arrays, before a step.

use super::changes::ChangesAtRest;
use super::components::BodyComponents;
use super::kept::ReadRules;
use super::planes::{self, IsPlane, KeyedPlane, PlaneComponents};
use super::reader::{Hierarchy, IsBody, Meshes, PreviousBodies, Reader};
use super::{Assembly, Step, named};
use crate::plugin::clock::Physics;
use crate::plugin::events::BodyRejected;
use crate::plugin::settings::{FaceLists, Gravity};
use crate::types::body::ComputedCenterOfMass;
use crate::types::limits::StepLimits;
use crate::types::settings::{Culling, Response};
use crate::types::solver_settings::SolverSettings;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use web_time::Instant;

/// The settings of all bodies.
#[derive(SystemParam)]
pub(crate) struct Rules<'w> {
    time: Res<'w, Time<Physics>>,
    gravity: Res<'w, Gravity>,
    response: Res<'w, Response>,
    culling: Res<'w, Culling>,
    solver: Res<'w, SolverSettings>,
    limits: Res<'w, StepLimits>,
    face_lists: Res<'w, FaceLists>,
}

/// Where invalid bodies and planes are reported.
#[derive(SystemParam)]
pub(crate) struct Rejected<'w, 's> {
    names: Query<'w, 's, &'static Name>,
    messages: MessageWriter<'w, BodyRejected>,
}

/// Fills the stages' input from the world, and reports invalid bodies and planes.
pub(crate) fn collect(
    mut step: ResMut<Step>,
    mut bodies: Query<BodyComponents, IsBody>,
    plane_query: Query<PlaneComponents, IsPlane>,
    hierarchy: Hierarchy,
    meshes: Meshes,
    rules: Rules,
    changes: ChangesAtRest,
    mut rejected: Rejected,
) {
    let step = &mut *step;
    step.begun = Instant::now();
    let has_hooks = step.hooks.is_some();
    let read_rules = ReadRules {
        culling: *rules.culling,
        response: *rules.response,
        has_hooks,
    };
    step.state.input.config.dt = rules.time.delta_secs();
    step.state.input.config.response = *rules.response;
    step.state.input.config.gravity = rules.gravity();
    step.state.input.config.solver = rules.solver();
    step.state.input.config.limits = *rules.limits;
    step.state.input.config.face_lists = rules.face_lists.0;

    step.new_faults.clear();
    step.candidates.clear();
    step.parts.clear();
    step.tables.poll();
    let counts = [bodies.iter().len(), hierarchy.children.iter().len()];
    step.kept.begin(&step.state.input.bodies);
    let before = PreviousBodies {
        nested: step.nested.take_some(&step.kept.movers),
        driven: step.driven.take(),
    };
    let may_be_same = step.kept.may_hold(&step.state.input.bodies, read_rules)
        && !step.engine.is_latent()
        && !meshes.meshes.is_changed()
        && changes.add_movers(&mut step.kept)
        && !changes.are_many(&mut step.kept);
    let mut reader = Reader {
        step,
        meshes: &meshes,
        rules: read_rules,
        before,
        misses_mesh: false,
    };
    let is_same = may_be_same && reader.at_most_moving(&mut bodies, &hierarchy, counts);
    reader.step.kept.has_news = false;
    if !is_same {
        reader.all(&mut bodies, &hierarchy);
    }
    let misses_mesh = reader.misses_mesh;
    finish(step, &mut bodies, &plane_query, &hierarchy, &mut rejected, has_hooks);
    if !is_same {
        if !misses_mesh {
            step.keep_read(&hierarchy, read_rules, counts);
        }
        step.drop_meshes(&meshes);
    }
}

/// Completes a step whose colliders have been read, and reports what is wrong with them.
fn finish(
    step: &mut Step,
    bodies: &mut Query<BodyComponents, IsBody>,
    plane_query: &Query<PlaneComponents, IsPlane>,
    hierarchy: &Hierarchy,
    rejected: &mut Rejected,
    has_hooks: bool,
) {
    step.check_driven();
    for (assembly, center) in step.centers() {
        if let Ok(mut body) = bodies.get_mut(assembly)
            && let Some(computed) = &mut body.computed_center
        {
            computed.set_if_neq(ComputedCenterOfMass(center));
        }
    }
    step.write_keys();
    read_planes(step, plane_query, hierarchy, has_hooks);

    let Rejected { names, messages } = rejected;
    let named = |entity: Entity| named(entity, names.get(entity).ok());
    step.new_faults.sort_unstable_by_key(|&(entity, _)| entity);
    for &(entity, fault) in &step.new_faults {
        let known = step.faults.binary_search_by_key(&entity, |&(entity, _)| entity);
        if !known.is_ok_and(|at| step.faults[at].1.is_like(&fault)) {
            error!("{} is left out of collisions: {fault}", named(entity));
            messages.write(BodyRejected { entity, fault });
        }
    }
    std::mem::swap(&mut step.faults, &mut step.new_faults);
    step.warnings
        .report(|entity, warning| warn!("{}: {warning}", named(entity)));
}

/// Reads the planes of a step, whose colliders are known.
fn read_planes(step: &mut Step, query: &Query<PlaneComponents, IsPlane>, hierarchy: &Hierarchy, has_hooks: bool) {
    planes::read(
        query,
        |entity| hierarchy.to_world(entity),
        has_hooks,
        &mut step.planes,
        &mut step.new_faults,
        &mut step.warnings,
    );
    step.collected.planes.clear();
    step.state.input.planes.clear();
    for &KeyedPlane { id, plane } in &step.planes {
        if id.is_stable() && step.collected.entities.has_key(id.key) {
            step.warnings.add_same_key(id);
        }
        step.collected.planes.push(id);
        step.state.input.planes.push(plane);
    }
    step.collected.planes.finish();
}

impl Step {
    /// Keeps a step in which all was read and is in order, so that the next one may read less.
    fn keep_read(&mut self, hierarchy: &Hierarchy, rules: ReadRules, counts: [usize; 2]) {
        let is_complete = self.faults.is_empty()
            && self.tables.in_bake() == 0
            && self.warnings.were_none()
            && self.sheared.is_empty()
            && !self.engine.is_latent();
        if !is_complete {
            return;
        }
        let children = self.children.all();
        hierarchy.list_above(children, &self.others, &mut self.kept);
        let bodies = &mut self.state.input.bodies;
        let asleep = self.counts.asleep;
        self.kept
            .keep(bodies, &self.collected.rows, children, rules, counts, asleep);
    }

    /// Drops what belongs to meshes that are there no more.
    fn drop_meshes(&mut self, meshes: &Meshes) {
        self.tables.retain(|id| meshes.meshes.contains(id));
        self.sheared.end_step(&mut self.state.input.meshes);
        let (arena, slots) = (&mut self.state.input.meshes, &mut self.slots);
        slots.retain(|&id, &mut slot| {
            let keep = meshes.meshes.contains(id);
            if !keep {
                arena.remove(slot);
            }
            keep
        });
    }

    /// Writes the keys of all colliders, except keys that remain from the last step.
    fn write_keys(&mut self) {
        let [fixed, moving] = self.collected.rows.entities.keys();
        let keys = &mut self.state.input.keys;
        let known = self.state.input.bodies.revision.is_known();
        if known && self.kept.has_keys {
            return;
        }
        if known {
            keys.truncate(fixed.len());
        } else {
            keys.clear();
            keys.extend_from_slice(fixed);
        }
        keys.extend_from_slice(moving);
        self.kept.has_keys = true;
    }

    /// The body of each [`Assembly`] with its centre of mass, in the coordinates of its entity.
    fn centers(&self) -> Vec<(Entity, Vec3)> {
        let center = |assembly: &Assembly| {
            let compound = self.state.input.bodies.compounds.get(assembly.compound? as usize)?;
            let center = assembly.stretch.inverse() * compound.local_center;
            Some((assembly.body, center.as_vec3()))
        };
        self.assemblies.iter().filter_map(center).collect()
    }
}

impl Rules<'_> {
    fn gravity(&self) -> Vec3 {
        if self.gravity.is_finite() {
            return self.gravity.0;
        }
        error_once!("Gravity is {}, which is not finite, and counts as zero", self.gravity.0);
        Vec3::ZERO
    }

    fn solver(&self) -> SolverSettings {
        match self.solver.fault() {
            None => *self.solver,
            Some(name) => {
                error_once!(
                    "SolverSettings::{name} is negative, not finite or too large: all settings of the solver count as \
                     their defaults until it is a finite number of 0 or more, and within the limit in its documentation"
                );
                SolverSettings::default()
            }
        }
    }
}
