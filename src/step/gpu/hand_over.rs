//! Moves the memory between steps from the CPU to the device and back when steps move there. So bodies stay asleep, and
//! piles keep their impulses.

use super::memory::DeviceMemory;
use super::remap::{LastBodies, LastCompound, LastPart};
use crate::gpu::layout::{ContactPair, ContactPoint, Moved};
use crate::sleep::cpu::hash;
use crate::sleep::inputs::PlacedSleepInputs;
use crate::solver::gpu::layout::{COUNTERS, MotionState, PAIRS, POINTS, SavedPair, SavedPoint};
use crate::solver::gpu::upload;
use crate::solver::{PLANE_KEY, SleepState, SolverMotion, WarmStart};
use crate::state::bodies::Frame;
use crate::state::manifolds::pair_order;
use crate::state::revision::Revision;
use crate::state::{Manifold, ManifoldPoint, Manifolds};
use crate::step::memory::{SavedBody, StepMemory};
use bytemuck::{Pod, cast_slice, pod_collect_to_vec};
use glam::{Quat, Vec3};
use std::collections::BTreeMap;

impl DeviceMemory {
    /// The memory that a device would have if the last step had run on it. `manifolds` are those of the last step.
    pub fn from_cpu(memory: &StepMemory, manifolds: &Manifolds) -> Self {
        let mut manifolds = manifolds.clone();
        manifolds.pairs.sort_unstable_by_key(|pair| pair.bodies);
        let count = memory.keys.len();
        let key_of = |body: u32| {
            let body = body as usize;
            memory
                .keys
                .get(body)
                .copied()
                .unwrap_or_else(|| PLANE_KEY - (body - count) as u64)
        };
        let (pairs, points) = memory.warm.to_device(&manifolds, key_of);
        let mut counters = vec![0; COUNTERS as usize];
        counters[PAIRS as usize] = manifolds.pairs.len() as u32;
        counters[POINTS as usize] = manifolds.points.len() as u32;
        let (compounds, parts) = compounds(&memory.bodies);
        let rows = memory.bodies.iter();
        let compound_rows = compounds
            .iter()
            .map(|compound| &memory.bodies[compound.number as usize]);
        let moved: Vec<_> = rows.chain(compound_rows).map(SavedBody::moved).collect();
        let states = memory.keys.iter().zip(&memory.bodies);
        let states: Vec<_> = states.map(|(&key, body)| body.state(key)).collect();
        let last_pairs: Vec<_> = manifolds.pairs.iter().map(upload::contact_pair).collect();
        let last_points: Vec<_> = manifolds.points.iter().map(upload::contact_point).collect();
        Self {
            last_bodies: LastBodies {
                keys: memory.keys.clone(),
                sleep_inputs: memory.bodies.iter().map(|body| body.inputs.inputs).collect(),
                compounds,
                parts,
                planes: memory.planes.clone(),
                gravity: memory.gravity,
                left_out: Vec::new(),
                impacts: impacts(&memory.bodies),
            },
            moved: words(&moved),
            last_step_states: words(&states),
            counters,
            pairs: words(&pairs),
            points: words(&points),
            last_pairs: words(&last_pairs),
            last_points: words(&last_points),
        }
    }

    /// The memory and the manifolds of the last step, as if it had been on the CPU.
    pub fn to_cpu(&self) -> (StepMemory, Manifolds) {
        let LastBodies {
            keys,
            sleep_inputs,
            compounds,
            planes,
            gravity,
            impacts,
            ..
        } = &self.last_bodies;
        if keys.is_empty() {
            return Default::default();
        }
        let key_of = |body: u32| {
            let plane = (body as usize).checked_sub(keys.len());
            match plane {
                None => Some(keys[body as usize]),
                Some(plane) => (plane < planes.len()).then(|| PLANE_KEY - plane as u64),
            }
        };
        let moved: Vec<Moved> = list(&self.moved);
        let states: Vec<MotionState> = list(&self.last_step_states);
        let bodies = sleep_inputs.iter().enumerate().map(|(i, inputs)| {
            let part = self.last_bodies.part(i as u32);
            let compound = part.map(|part| &compounds[part.compound as usize]);
            let body = compound.map_or(i, |compound| compound.number as usize);
            let moved = &moved[part.map_or(i, |part| keys.len() + part.compound as usize)];
            SavedBody {
                sleep: SleepState::from(&states[body]),
                inputs: PlacedSleepInputs {
                    inputs: *inputs,
                    place: part
                        .zip(compound)
                        .map(|(part, compound)| (part.pose, compound.local_center)),
                    position: moved.position.into(),
                    rotation: Quat::from_array(moved.rotation),
                },
                body: body as u32,
                had_impact: impacts.contains_key(&(body as u32)),
            }
        });
        let [pairs, points] = [PAIRS, POINTS].map(|counter| self.counters[counter as usize] as usize);
        let saved: (Vec<SavedPair>, Vec<SavedPoint>) = (list(&self.pairs), list(&self.points));
        let last: (Vec<ContactPair>, Vec<ContactPoint>) = (list(&self.last_pairs), list(&self.last_points));
        let memory = StepMemory {
            keys: keys.clone(),
            bodies: bodies.collect(),
            planes: planes.clone(),
            gravity: *gravity,
            warm: WarmStart::from_device(&saved.0[..pairs], &saved.1[..points], key_of),
            left_out: Vec::new(),
            revision: Revision::UNKNOWN,
            layout: Revision::UNKNOWN,
        };
        let mut last_pairs: Vec<_> = last.0[..pairs].iter().map(Manifold::from).collect();
        last_pairs.sort_unstable_by_key(|pair| pair_order(pair.bodies, keys.len() as u32));
        let manifolds = Manifolds {
            pairs: last_pairs,
            points: last.1.iter().map(ManifoldPoint::from).collect(),
            surfaces: Vec::new(),
        };
        (memory, manifolds)
    }
}

impl SavedBody {
    /// The pose, at rest: bodies that move bring their velocities along.
    fn moved(&self) -> Moved {
        Moved {
            position: self.inputs.position.to_array(),
            asleep: u32::from(self.sleep.asleep),
            rotation: self.inputs.rotation.to_array(),
            ..Default::default()
        }
    }

    fn state(&self, key: u64) -> MotionState {
        let PlacedSleepInputs {
            inputs,
            place,
            position,
            rotation,
        } = &self.inputs;
        let rotation = rotation.as_dquat().normalize();
        let center = match place {
            Some((_, local_center)) => position.as_dvec3() + rotation * local_center,
            None => Frame::new(position.as_dvec3(), rotation, inputs.scale.as_dvec3(), inputs.center).center,
        };
        let motion = SolverMotion {
            rotation,
            ..SolverMotion::at(center)
        };
        upload::state(&motion, &self.sleep, hash(key))
    }
}

/// The bodies among these whose colliders are placed in them, and these colliders.
fn compounds(bodies: &[SavedBody]) -> (Vec<LastCompound>, Vec<LastPart>) {
    let mut compounds: Vec<LastCompound> = Vec::new();
    let mut parts = Vec::new();
    for (collider, saved) in (0..).zip(bodies) {
        let Some((pose, local_center)) = saved.inputs.place else {
            continue;
        };
        // A body has the number of its first collider, so compounds are found in ascending order.
        let at = compounds.binary_search_by_key(&saved.body, |compound| compound.number);
        let compound = at.unwrap_or_else(|end| {
            let number = saved.body;
            compounds.push(LastCompound { number, local_center });
            end
        }) as u32;
        parts.push(LastPart {
            collider,
            compound,
            pose,
        });
    }
    (compounds, parts)
}

/// The bodies that had an impact. They bring their velocities along.
fn impacts(bodies: &[SavedBody]) -> BTreeMap<u32, [Vec3; 2]> {
    let impacts = bodies.iter().filter(|saved| saved.had_impact);
    impacts.map(|saved| (saved.body, [Vec3::ZERO; 2])).collect()
}

fn words<T: Pod>(list: &[T]) -> Vec<u32> {
    cast_slice(list).to_vec()
}

fn list<T: Pod>(words: &[u32]) -> Vec<T> {
    pod_collect_to_vec(words)
}
