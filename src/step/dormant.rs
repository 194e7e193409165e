//! Dormant bodies: they sleep, and nothing that is awake is near. A step does nothing for them.
//!
//! Bodies whose spheres overlap form a group. If all bodies of a group have slept through a whole step, and none is
//! near a body that is awake or kinematic, the group becomes dormant: its bodies leave the list of [`Bodies::movers`]
//! and wait in a grid of their own, and its contacts, manifolds and saved impulses wait here. A group is *roused* as
//! soon as a body comes so near that a step must know the pair, or something static near it changes: its bodies take
//! part again, asleep, as if they had never been dormant. A write by the user to a dormant body rouses all, and so does
//! a static body that comes or goes.
//!
//! No result depends on which bodies are dormant.

use super::memory::StepMemory;
use super::reach::Sweep;
use super::scratch::StepScratch;
use crate::broad_phase::cpu::SPHERE_SLACK;
use crate::geometry::union_find::UnionFind;
use crate::solver::{SolverBodies, WarmStart};
#[cfg(feature = "bevy")]
use crate::state::Counts;
use crate::state::bodies::Flags;
use crate::state::inactive::InactiveBodies;
use crate::state::margins::{BOUND, SAFETY, SpeculativeMargins, sway};
use crate::state::revision::Revision;
use crate::state::{Bodies, Contacts, Manifolds, Plane, StepConfig, StepInput, StepResults};
use crate::types::body::RigidBody;
use crate::types::hooks::ActiveCollisionHooks;
use crate::types::settings::{Culling, Response};
use glam::{DVec3, Vec3};
use std::collections::BTreeMap;

/// Factor that exceeds the rounding error of a sphere's radius.
const ROUNDING: f32 = 1.0 + 1.0e-6;

/// The dormant groups, and what waits for them.
#[derive(Default)]
pub(crate) struct Dormant {
    /// Names the set; see [`DormantSet`](crate::state::dormant_set::DormantSet).
    name: Revision,
    /// The settings and planes with which they became dormant.
    config: StepConfig,
    planes: Vec<Plane>,
    /// By their first collider.
    groups: BTreeMap<u32, Group>,
    /// For each collider, the first one of its group.
    group_of: Vec<u32>,
    /// What touches in these groups, as the last step before reported it.
    pub contacts: Contacts,
    pub manifolds: Manifolds,
    /// The number of the first plane in these.
    first_plane: u32,
    impulses: WarmStart,
    sphere_pairs: Vec<[u32; 2]>,
    candidates: Candidates,
    /// Whether dormancy has ended in this step.
    has_ended: bool,
    /// How often bodies have been roused in this step.
    rounds: u32,
}

/// A dormant group.
#[derive(Debug)]
struct Group {
    members: Vec<u32>,
    /// A box around all its bodies, with their margins.
    bounds: [DVec3; 2],
}

/// The bodies that may become dormant at the end of a step.
#[derive(Default)]
struct Candidates {
    /// For each collider, whether it has been still since the beginning of the step.
    are_still: Vec<bool>,
    any: bool,
    groups: UnionFind,
    /// For each collider, whether it was near something that is awake.
    disturbed: Vec<bool>,
    /// The pairs of still bodies in the first collision substep.
    pairs: Vec<[u32; 2]>,
}

/// Dormant colliders that a step meets.
#[derive(Debug)]
pub(crate) struct MetColliders(Vec<u32>);

/// Most rounds of rousing in a step, because each is a search: roused bodies may meet other dormant ones. After these
/// all bodies are roused.
const MAX_ROUNDS_OF_ROUSING: u32 = 3;

/// What of a step changes when bodies become dormant or are roused.
struct Lists<'a> {
    bodies: &'a mut Bodies,
    solver_bodies: &'a mut SolverBodies,
    inactive: &'a mut InactiveBodies,
    memory: &'a mut StepMemory,
    results: &'a mut StepResults,
}

impl StepScratch {
    /// Rouses the groups of these bodies in collision substep `number`. Returns their colliders, ascending.
    pub(super) fn rouse(
        &mut self,
        met: MetColliders,
        number: u32,
        input: &mut StepInput,
        memory: &mut StepMemory,
        results: &mut StepResults,
    ) -> Vec<u32> {
        let (dormant, mut lists) = self.lists(&mut input.bodies, memory, results);
        dormant.rouse(met, number, &mut lists)
    }

    /// Lets the groups become dormant, at the end of a step, that nothing has disturbed.
    pub(super) fn settle(&mut self, input: &mut StepInput, memory: &mut StepMemory, results: &mut StepResults) {
        let (config, margins) = (input.config, self.margins);
        let (dormant, mut lists) = self.lists(&mut input.bodies, memory, results);
        dormant.settle(&config, &input.planes, margins, &mut lists);
    }

    fn lists<'a>(
        &'a mut self,
        bodies: &'a mut Bodies,
        memory: &'a mut StepMemory,
        results: &'a mut StepResults,
    ) -> (&'a mut Dormant, Lists<'a>) {
        let lists = Lists {
            bodies,
            solver_bodies: &mut self.solver_bodies,
            inactive: &mut self.inactive,
            memory,
            results,
        };
        (&mut self.dormant, lists)
    }
}

impl Dormant {
    /// Whether a step has the bodies that became dormant, and nothing else of the world has changed except what moves.
    fn may_last(&self, input: &StepInput) -> bool {
        let StepInput {
            config, bodies, planes, ..
        } = input;
        let flags = bodies.flags();
        bodies.dormant.name.is(self.name)
            && *config == self.config
            && *planes == self.planes
            && !flags.filters
            && !flags.modifies
    }

    /// Begins a step: rouses dormant bodies for which anything has changed. Their numbers are the same as in the last
    /// step.
    pub fn begin(
        &mut self,
        input: &mut StepInput,
        memory: &mut StepMemory,
        results: &mut StepResults,
    ) -> Result<(), MetColliders> {
        self.has_ended = false;
        self.rounds = 0;
        if self.groups.is_empty() {
            return Ok(());
        }
        let bodies = &input.bodies;
        if self.may_last(input)
            && let Some(changed) = bodies.static_changes_since(memory.revision)
        {
            return self.meet_static(bodies, changed);
        }
        self.has_ended = true;
        self.end(&mut input.bodies, memory, results);
        Ok(())
    }

    /// # Errors
    /// The dormant bodies that are or were near these static ones, which have changed.
    fn meet_static(&self, bodies: &Bodies, changed: &[u32]) -> Result<(), MetColliders> {
        if changed.is_empty() {
            return Ok(());
        }
        let has_changed = |i: &u32| changed.binary_search(i).is_ok();
        let were_near = self.sphere_pairs.iter().filter(|pair| pair.iter().any(has_changed));
        let were_near = were_near.flatten().copied().filter(|i| !has_changed(i));
        let is_near = |i: &u32| {
            let i = *i as usize;
            changed.iter().map(|&other| other as usize).any(|other| {
                let reach = bodies.speculative_radius[i] + bodies.speculative_radius[other];
                bodies.center[i].distance_squared(bodies.center[other]) <= reach * reach * SPHERE_SLACK
            })
        };
        let members = self.groups.values().flat_map(|group| &group.members).copied();
        MetColliders::of(were_near.chain(members.filter(is_near)).collect())
    }

    /// Sets the number of the first plane, which follows those of all colliders.
    pub fn renumber_planes(&mut self, first_plane: u32) {
        let before = std::mem::replace(&mut self.first_plane, first_plane);
        if before == first_plane {
            return;
        }
        let pairs = self.manifolds.pairs.iter_mut().map(|pair| &mut pair.bodies);
        let surfaces = self.manifolds.surfaces.iter_mut().map(|(pair, _)| pair);
        for [_, other] in pairs.chain(surfaces).filter(|pair| pair[1] >= before) {
            *other = *other - before + first_plane;
        }
    }

    /// Whether any body is dormant.
    #[cfg(feature = "bevy")]
    pub fn any(&self) -> bool {
        !self.groups.is_empty()
    }

    /// Returns all that waits to the lists of the last step. No body is dormant any more.
    pub fn end(&mut self, bodies: &mut Bodies, memory: &mut StepMemory, results: &mut StepResults) {
        self.renumber_planes(memory.keys.len() as u32);
        results.manifolds = results.manifolds.merged(&self.manifolds, self.first_plane);
        memory.warm = memory.warm.merged(&self.impulses);
        self.forget(bodies);
    }

    /// Copies of the memory and the manifolds of the last step, with what waits.
    #[cfg(feature = "bevy")]
    pub fn complete(&self, memory: &StepMemory, manifolds: &Manifolds) -> (StepMemory, Manifolds) {
        let warm = memory.warm.merged(&self.impulses);
        // After a step, its planes have the same numbers as the dormant ones.
        let manifolds = manifolds.merged(&self.manifolds, self.first_plane);
        (StepMemory { warm, ..memory.clone() }, manifolds)
    }

    /// Drops all that waits. No body is dormant any more.
    fn forget(&mut self, bodies: &mut Bodies) {
        bodies.end_dormancy();
        self.name = Revision::UNKNOWN;
        self.groups.clear();
        self.contacts = Contacts::default();
        self.manifolds.clear();
        self.impulses.clear();
        self.sphere_pairs.clear();
    }

    /// # Errors
    /// The dormant bodies in `pairs`; all of them if the list is not complete.
    pub fn meet(&self, bodies: &Bodies, pairs: &[[u32; 2]], is_crowded: bool) -> Result<(), MetColliders> {
        if self.groups.is_empty() {
            return Ok(());
        }
        let all = self.groups.keys().copied().filter(|_| is_crowded);
        let some = pairs.iter().flatten().copied();
        let some = some.filter(|&i| !is_crowded && bodies.dormant.has(i as usize));
        MetColliders::of(all.chain(some).collect())
    }

    /// # Errors
    /// The groups whose boxes are within reach.
    pub fn meet_boxes(&self, is_in_reach: impl Fn([DVec3; 2]) -> bool) -> Result<(), MetColliders> {
        let near = self.groups.iter().filter(|(_, group)| is_in_reach(group.bounds));
        MetColliders::of(near.map(|(&first, _)| first).collect())
    }

    fn rouse(&mut self, MetColliders(met): MetColliders, number: u32, lists: &mut Lists) -> Vec<u32> {
        let Lists {
            bodies,
            solver_bodies,
            inactive,
            memory,
            results,
        } = lists;
        self.rounds += 1;
        let met = match self.rounds > MAX_ROUNDS_OF_ROUSING {
            true => self.groups.keys().copied().collect(),
            false => met,
        };
        let mut roused = Vec::new();
        for i in met {
            if let Some(group) = self.groups.remove(&self.group_of[i as usize]) {
                roused.extend(group.members);
            }
        }
        roused.sort_unstable();
        for &i in &roused {
            bodies.dormant.flags[i as usize] = false;
        }
        self.set_name(bodies);
        bodies.list_movers();
        solver_bodies.take_movers(bodies);
        inactive.any = true;

        // At first there are the manifolds of the last step, whose planes may have other numbers.
        let first_plane = if number == 0 { memory.keys.len() } else { bodies.len() } as u32;
        self.renumber_planes(first_plane);
        let has = |pair: [u32; 2]| pair.iter().any(|i| roused.binary_search(i).is_ok());
        let has_key = any_of(&roused, &solver_bodies.keys);
        results.manifolds = results.manifolds.merged(&self.manifolds.select(has), first_plane);
        self.manifolds = self.manifolds.select(|pair| !has(pair));
        memory.warm = memory.warm.merged(&self.impulses.select(&has_key));
        self.impulses = self.impulses.select(|keys| !has_key(keys));
        self.contacts = self.contacts.select(first_plane, |pair| !has(pair));
        self.sphere_pairs.retain(|&pair| !has(pair));
        roused
    }

    /// The contacts of these bodies, which are ascending and still dormant.
    pub fn contacts_of(&self, MetColliders(met): &MetColliders, first_plane: u32) -> Contacts {
        let of = |i: u32| self.group_of.get(i as usize);
        let mut groups: Vec<u32> = met.iter().filter_map(|&i| of(i).copied()).collect();
        groups.sort_unstable();
        let has = |i: &u32| of(*i).is_some_and(|group| groups.binary_search(group).is_ok());
        self.contacts.select(first_plane, |pair| pair.iter().any(has))
    }

    /// Notes which bodies are still at the beginning of a step. None may become dormant in a step with hooks, or in
    /// which bodies may wake and fall asleep again.
    pub fn watch(&mut self, input: &StepInput, solver_bodies: &SolverBodies, inactive: &InactiveBodies) {
        let StepInput {
            config, bodies, planes, ..
        } = input;
        let own = &mut self.candidates;
        own.any = false;
        own.pairs.clear();
        let flags = bodies.flags();
        let may_be = bodies.revision.is_known()
            && config.response == Response::Contacts
            && config.solver.sleep_time >= config.dt
            && !flags.filters
            && !flags.modifies
            && planes.iter().all(|plane| plane.hooks == ActiveCollisionHooks::NONE);
        if !may_be {
            return;
        }
        let is_still = |i: usize| {
            let travel = SAFETY * sway(bodies, config, i, config.dt) * config.dt;
            bodies.kind[i] == RigidBody::Dynamic
                && solver_bodies.sleep[i].asleep
                && inactive.flags[i]
                && bodies.part(i as u32).is_none()
                && !bodies.params[i].always_read
                // With several collision substeps its contacts have the points of each.
                && bodies.travel_time[i] == config.dt
                && bodies.culling[i] == Culling::Exact
                // With a capped margin a body might meet others outside of its sphere.
                && travel <= BOUND * bodies.thickness[i]
        };
        own.are_still.resize(bodies.len(), false);
        own.disturbed.resize(bodies.len(), false);
        for i in bodies.movers() {
            own.are_still[i] = is_still(i);
            own.disturbed[i] = false;
            own.any |= own.are_still[i];
        }
        if own.any {
            own.groups.reset_members(bodies.len(), bodies.movers());
        }
    }

    /// Notes which bodies are near each other in collision substep `number`.
    pub fn note(&mut self, number: u32, bodies: &Bodies, pairs: &[[u32; 2]]) {
        let Candidates {
            are_still,
            any,
            groups,
            disturbed,
            pairs: still,
        } = &mut self.candidates;
        if !*any {
            return;
        }
        let moves = |i: u32| bodies.kind[i as usize] != RigidBody::Static;
        // Approximate pairs are counted.
        let is_exact = |i: u32| bodies.culling[i as usize] == Culling::Exact;
        for &[a, b] in pairs {
            let [still_a, still_b] = [a, b].map(|i| moves(i) && are_still[i as usize]);
            if number == 0 && (still_a || still_b) {
                still.push([a, b]);
            }
            match [still_a, still_b] {
                [true, true] => groups.join(a, b),
                [true, false] if moves(b) || !is_exact(b) => disturbed[a as usize] = true,
                [false, true] if moves(a) || !is_exact(a) => disturbed[b as usize] = true,
                _ => {}
            }
        }
    }

    fn settle(&mut self, config: &StepConfig, planes: &[Plane], margins: SpeculativeMargins, lists: &mut Lists) {
        let own = &mut self.candidates;
        let has_drift = margins != SpeculativeMargins::Moving { drift: Vec3::ZERO };
        // What ends again and again costs more than it saves.
        if !own.any || has_drift || self.has_ended || lists.results.crowd.bodies > 0 {
            return;
        }
        let Lists {
            bodies,
            solver_bodies,
            memory,
            results,
            ..
        } = lists;
        for i in bodies.movers() {
            let is_disturbed = !own.are_still[i] || own.disturbed[i] || !solver_bodies.sleep[i].asleep;
            if is_disturbed {
                own.disturbed[own.groups.root(i as u32) as usize] = true;
            }
        }
        let mut fallen = Vec::new();
        self.group_of.resize(bodies.len(), 0);
        for i in bodies.movers() {
            let root = own.groups.root(i as u32);
            if own.disturbed[root as usize] {
                continue;
            }
            let [low, high] = Sweep::of(bodies, config, i as u32).bounds();
            let group = self.groups.entry(root).or_insert_with(|| Group {
                members: Vec::new(),
                bounds: [low, high],
            });
            group.members.push(i as u32);
            group.bounds = [group.bounds[0].min(low), group.bounds[1].max(high)];
            self.group_of[i] = root;
            fallen.push(i as u32);
        }
        if fallen.is_empty() {
            return;
        }
        bodies.dormant.flags.resize(bodies.len(), false);
        for &i in &fallen {
            bodies.dormant.flags[i as usize] = true;
            // The largest that a body asleep has in any collision substep.
            bodies.speculative_radius[i as usize] = ROUNDING * Sweep::of(bodies, config, i).radius;
        }
        let first_plane = bodies.len() as u32;
        let pairs = std::mem::take(&mut own.pairs);
        self.renumber_planes(first_plane);
        let has = |pair: [u32; 2]| pair.iter().any(|i| fallen.binary_search(i).is_ok());
        let has_key = any_of(&fallen, &solver_bodies.keys);
        let (contacts, manifolds) = (&mut results.contacts, &mut results.manifolds);
        self.contacts = contacts.select(first_plane, has).merged(&self.contacts);
        *contacts = contacts.select(first_plane, |pair| !has(pair));
        self.manifolds = self.manifolds.merged(&manifolds.select(has), first_plane);
        *manifolds = manifolds.select(|pair| !has(pair));
        self.impulses = self.impulses.merged(&memory.warm.select(&has_key));
        memory.warm = memory.warm.select(|keys| !has_key(keys));
        self.sphere_pairs.extend(pairs.iter().filter(|&&pair| has(pair)));
        results.sphere_pairs.retain(|&pair| !has(pair));
        self.config = *config;
        planes.clone_into(&mut self.planes);
        self.set_name(bodies);
        bodies.dormant.filled = bodies.dormant.name;
    }

    /// Names the present set.
    fn set_name(&mut self, bodies: &mut Bodies) {
        let set = &mut bodies.dormant;
        set.count = set.flags.iter().filter(|&&flag| flag).count();
        if set.count == 0 {
            bodies.end_dormancy();
            self.name = Revision::UNKNOWN;
            return;
        }
        set.name = Revision::new();
        let params = bodies.params.iter().zip(&set.flags).filter(|(_, flag)| **flag);
        set.has = Flags::of(params.map(|(params, _)| params));
        self.name = set.name;
    }

    /// Adds the results that wait to the counts of a step.
    #[cfg(feature = "bevy")]
    pub fn add_to(&self, counts: &mut Counts) {
        counts.sphere_pairs += self.sphere_pairs.len();
        counts.touching_pairs += self.contacts.pairs.len();
        counts.face_pairs += self.contacts.faces.len();
        counts.contact_points += self.manifolds.points.len();
    }
}

impl MetColliders {
    fn of(met: Vec<u32>) -> Result<(), Self> {
        if met.is_empty() { Ok(()) } else { Err(Self(met)) }
    }
}

/// Tells whether a pair of keys has that of one of these bodies.
fn any_of(bodies: &[u32], keys: &[u64]) -> impl Fn([u64; 2]) -> bool + use<> {
    let mut own: Vec<u64> = bodies.iter().map(|&i| keys[i as usize]).collect();
    own.sort_unstable();
    move |pair| pair.iter().any(|key| own.binary_search(key).is_ok())
}
