//! Body remap on the GPU: the numbers of bodies in the last submitted step and in this one, and what carries over.

use crate::gpu::layout::{CARRIED_SLEEP, CONTINUES, WOKEN};
use crate::sleep::inputs::SleepInputs;
use crate::state::inactive::GONE;
use crate::state::{Bodies, LocalPose, Plane, StepInput};
use crate::step::remap;
use crate::types::body::RigidBody;
use glam::{DVec3, Vec3};
use std::collections::{BTreeMap, BTreeSet};

/// State of the last submitted step whose change wakes bodies. Poses are known to the device only.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LastBodies {
    /// Ascending.
    pub(super) keys: Vec<u64>,
    pub(super) sleep_inputs: Vec<SleepInputs>,
    pub(super) compounds: Vec<LastCompound>,
    /// The colliders of compounds, ascending.
    pub(super) parts: Vec<LastPart>,
    pub(super) planes: Vec<Plane>,
    pub(super) gravity: Vec3,
    /// Numbers of bodies whose speeds the device does not report, ascending.
    pub(super) left_out: Vec<u32>,
    /// Bodies that had an impact, with their velocities after it: linear and angular.
    pub(super) impacts: BTreeMap<u32, [Vec3; 2]>,
}

/// A body of the last step whose colliders are placed in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LastCompound {
    /// The number of its first collider.
    pub number: u32,
    pub local_center: DVec3,
}

/// A collider of such a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LastPart {
    pub collider: u32,
    pub compound: u32,
    pub pose: LocalPose,
}

/// Where the state of a compound after the last step is, and what carries over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CompoundRemap {
    /// Row of the compound in `moved`.
    pub row: u32,
    /// The number of its first collider.
    pub collider: u32,
    /// As in `Compound::carried`.
    pub carried: u32,
}

/// A body whose speed was left out in the last step and counts in this one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slowed {
    /// Number of the body.
    pub number: u32,
    /// Number of the body in the last step.
    pub before: u32,
    /// Linear and angular, if the host knows them.
    pub velocities: Option<[Vec3; 2]>,
}

/// The numbers of bodies in two successive steps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodyRemap {
    /// For each collider its number in the last step, and what carries over, as in `Body::carried`.
    pub bodies: Vec<(u32, u32)>,
    /// For each compound, where its state after the last step is, and what carries over.
    pub compounds: Vec<CompoundRemap>,
    /// For each collider of the last step, followed by the planes, its new number; `u32::MAX` if it is gone.
    pub new_numbers: Vec<u32>,
    /// Whether the planes differ.
    pub planes_changed: bool,
    /// Whether some collider has continuous collision.
    pub has_fast_bodies: bool,
    /// The bodies with continuous collision that move, ascending. Their speeds cause no collision substeps.
    pub fast: Vec<u32>,
    /// Bodies that were `fast` in the last step and no longer are. A body that has had an impact is likely to hit the
    /// same body again, so it needs collision substeps too.
    pub slowed: Vec<Slowed>,
}

impl LastBodies {
    /// Forgets all bodies: nothing carries over to the next step.
    pub fn forget(&mut self) {
        *self = Self::default();
    }

    /// Number of colliders in the last step.
    pub fn len(&self) -> usize {
        self.keys.len()
    }

    /// Whether nothing carries over.
    pub fn is_empty(&self) -> bool {
        self.keys.is_empty()
    }

    /// Matches the bodies of `input` with those of the last call, and replaces these.
    pub fn advance_to(&mut self, input: &StepInput) -> BodyRemap {
        let StepInput {
            bodies, planes, config, ..
        } = input;
        let count = bodies.len();
        let mut keys = Vec::new();
        input.write_keys(&mut keys, 0);
        let (mut fast, mut has_fast_bodies) = (Vec::new(), false);
        let inputs = (0..count).map(|i| {
            if bodies.params[i].continuous {
                has_fast_bodies = true;
                if bodies.kind[i] == RigidBody::Dynamic && bodies.is_body(i) {
                    fast.push(i as u32);
                }
            }
            SleepInputs::of(input, i)
        });
        let sleep_inputs: Vec<_> = inputs.collect();
        let mut remap = BodyRemap {
            fast,
            has_fast_bodies,
            bodies: vec![(0, 0); count],
            compounds: Vec::new(),
            new_numbers: vec![GONE; self.keys.len()],
            planes_changed: self.planes != *planes,
            ..BodyRemap::default()
        };
        let same_gravity = self.gravity == config.gravity;
        for (i, before) in remap::previous_numbers(&self.keys, &keys).into_iter().enumerate() {
            let Some(before) = before else { continue };
            let is_static = |inputs: &SleepInputs| inputs.kind == RigidBody::Static;
            // One that begins or ends to move has another place among the numbers, and its pairs are new.
            if is_static(&sleep_inputs[i]) == is_static(&self.sleep_inputs[before as usize]) {
                remap.new_numbers[before as usize] = i as u32;
            }
            let sleeps = keeps_sleep(bodies, i, same_gravity);
            // Another scale or mesh may move the centre of mass.
            let (now, then) = (&sleep_inputs[i], &self.sleep_inputs[before as usize]);
            let single = self.part(before).is_none() && bodies.part(i as u32).is_none();
            let same_center = single && (now.center, now.scale) == (then.center, then.scale);
            let mut carried = if same_center { CONTINUES } else { 0 };
            carried |= if single && sleeps && now == then {
                CARRIED_SLEEP
            } else {
                0
            };
            carried |= if is_woken(bodies, i) { WOKEN } else { 0 };
            remap.bodies[i] = (before, carried);
        }
        self.slow_down(&mut remap);
        if !self.keys.is_empty() {
            remap::renumber_planes(&mut remap.new_numbers, self.planes.len(), count, planes.len());
        }
        remap.compounds = self.continued_compounds(bodies, &sleep_inputs, same_gravity, &remap.new_numbers);
        *self = Self {
            keys,
            sleep_inputs,
            compounds: (bodies.compounds.iter())
                .map(|compound| LastCompound {
                    number: compound.number,
                    local_center: compound.local_center,
                })
                .collect(),
            parts: (bodies.parts.iter())
                .map(|part| LastPart {
                    collider: part.collider,
                    compound: part.compound,
                    pose: part.pose,
                })
                .collect(),
            planes: planes.clone(),
            gravity: config.gravity,
            left_out: remap.fast.clone(),
            impacts: BTreeMap::new(),
        };
        remap
    }

    /// Finds the bodies of the last step that were fast and no longer are, and removes those with an impact from the
    /// fast ones.
    fn slow_down(&self, remap: &mut BodyRemap) {
        let before: BTreeSet<u32> = self.left_out.iter().chain(self.impacts.keys()).copied().collect();
        for before in before {
            let number = remap.new_numbers[before as usize];
            let velocities = self.impacts.get(&before).copied();
            match (remap.fast.binary_search(&number), velocities) {
                (Ok(at), Some(_)) => {
                    remap.fast.remove(at);
                }
                (Err(_), _) if number != GONE => {}
                _ => continue,
            }
            remap.slowed.push(Slowed {
                number,
                before,
                velocities,
            });
        }
    }

    /// What carries over to each compound of `bodies`. It continues the one to which its first collider belonged.
    fn continued_compounds(
        &self,
        bodies: &Bodies,
        sleep_inputs: &[SleepInputs],
        same_gravity: bool,
        new_numbers: &[u32],
    ) -> Vec<CompoundRemap> {
        if bodies.compounds.is_empty() {
            return Vec::new();
        }
        let mut old_numbers = vec![GONE; bodies.len()];
        for (before, &now) in (0..).zip(&new_numbers[..self.keys.len()]) {
            if let Some(old) = old_numbers.get_mut(now as usize) {
                *old = before;
            }
        }
        let last_part = |collider: u32| self.part(old_numbers[collider as usize]);
        let mut compounds: Vec<_> = (bodies.compounds.iter())
            .map(|compound| {
                let Some(last) = last_part(compound.number) else {
                    return CompoundRemap::default();
                };
                let LastCompound { number, local_center } = self.compounds[last.compound as usize];
                let continues = local_center == compound.local_center;
                CompoundRemap {
                    row: self.len() as u32 + last.compound,
                    collider: number,
                    carried: if continues { CONTINUES | CARRIED_SLEEP } else { 0 },
                }
            })
            .collect();
        for part in &bodies.parts {
            let i = part.collider as usize;
            let compound = &mut compounds[part.compound as usize];
            let same = last_part(part.collider).is_some_and(|last| {
                let same_inputs = sleep_inputs[i] == self.sleep_inputs[last.collider as usize];
                self.len() as u32 + last.compound == compound.row && last.pose == part.pose && same_inputs
            });
            if !(same && keeps_sleep(bodies, i, same_gravity)) {
                compound.carried &= !CARRIED_SLEEP;
            }
            compound.carried |= if is_woken(bodies, i) { WOKEN } else { 0 };
        }
        compounds
    }

    /// The part that a collider of the last step was of a compound.
    pub(super) fn part(&self, collider: u32) -> Option<&LastPart> {
        let at = self.parts.binary_search_by_key(&collider, |part| part.collider);
        at.ok().map(|at| &self.parts[at])
    }
}

/// Whether a sleeping collider wakes at the start of the step.
fn is_woken(bodies: &Bodies, i: usize) -> bool {
    bodies.params[i].woken || !bodies.params[i].forces.is_zero()
}

/// Whether the sleep state of a collider carries over while nothing about it changes. What is not dynamic never sleeps.
fn keeps_sleep(bodies: &Bodies, i: usize, same_gravity: bool) -> bool {
    bodies.params[i].can_sleep && same_gravity || bodies.kind[i] != RigidBody::Dynamic
}
