//! Steps whose results come later: which body goes on from where, and what users wrote in the meantime.
//!
//! Bodies are numbered anew every step, in the order of entities. A body goes on from its number in the step before, so
//! that slots, and results that reach the wrong one, do not exist: a step in flight knows its bodies by entity.
//!
//! What users wrote is found by comparing components with a *shadow*, what they held when we last read or wrote them.

use super::Collected;
use crate::components::RigidBody;
use crate::gpu::upload::Carried;
use crate::settings::LATENCY;
use crate::stages::state::{Body, Motion};
use bevy::prelude::*;
use std::collections::{BTreeMap, VecDeque};

/// What is known of the steps in flight.
#[derive(Default)]
pub(crate) struct Latent {
    /// Number of the step that was collected last.
    now: u64,
    /// Whose results are to come, oldest first.
    flights: VecDeque<(u64, Collected)>,
    /// One per body of the last step, ascending.
    shadows: Vec<(Entity, Shadow)>,
    /// One per body of the last step.
    pub carried: Vec<Option<Carried>>,
    /// One per body of the last step: whether a user woke it.
    pub woken: Vec<bool>,
    /// The step whose results are at hand, and where its bodies are.
    arrived: (u64, Vec<Motion>),
}

#[derive(Clone, Copy)]
struct Shadow {
    /// What the components held.
    motion: Motion,
    /// The last step that was told where the body is. Results of earlier ones say where it would have been.
    placed: u64,
    /// The last step that was told how it moves.
    launched: u64,
    /// What was added to its velocities in the last steps, by step number.
    pushes: [[Vec3; 2]; LATENCY],
    /// Whether the component said that it sleeps.
    asleep: bool,
    /// The last step that was told to wake it. Results of earlier ones say that it would have slept.
    woken: u64,
}

/// What is to be written to a body's components.
pub(crate) struct Written {
    pub pose: Option<(Vec3, Quat)>,
    pub velocities: Option<[Vec3; 2]>,
    pub asleep: Option<bool>,
}

impl Latent {
    /// Finds out, for a step over `entities`, which of them go on from the step before, and what users wrote. `bodies` holds
    /// what the components say of these entities, and maybe of others; both are ascending.
    pub fn link(&mut self, entities: &[Entity], bodies: &[(Entity, Body)]) {
        self.now += 1;
        let before = std::mem::take(&mut self.shadows);
        let mut before = (0..).zip(&before).peekable();
        let mut bodies = bodies.iter();
        self.carried.clear();
        self.woken.clear();
        for &entity in entities {
            let Some((_, body)) = bodies.find(|&&(other, _)| other == entity) else {
                break;
            };
            let seen = Motion {
                position: body.position,
                rotation: body.rotation,
                linear_velocity: body.linear_velocity,
                angular_velocity: body.angular_velocity,
            };
            while before.next_if(|&(_, &(other, _))| other < entity).is_some() {}
            let (mut shadow, carried) = match before.next_if(|&(_, &(other, _))| other == entity) {
                Some((source, (_, shadow))) => shadow.next(source, seen, body.kind, self.now),
                None => (Shadow::new(seen, self.now), None),
            };
            // Components of those that fall asleep do not say so before their results are there.
            let says_asleep = !body.handling.woken;
            let woken = shadow.asleep && !says_asleep;
            if woken {
                shadow.woken = self.now;
            }
            shadow.asleep = says_asleep;
            self.shadows.push((entity, shadow));
            self.carried.push(carried);
            self.woken.push(woken);
        }
    }

    /// The bodies of the last step.
    pub fn entities(&self) -> impl Iterator<Item = Entity> + '_ {
        self.shadows.iter().map(|&(entity, _)| entity)
    }

    /// Nothing of what is in flight will be carried over or published.
    pub fn forget(&mut self) {
        self.flights.clear();
        self.shadows.clear();
        self.carried.clear();
        self.woken.clear();
    }

    /// Nothing of what is in flight will come, and the step that was linked last begins where the components say.
    pub fn restart(&mut self) {
        self.flights.clear();
        self.carried.clear();
        for (_, shadow) in &mut self.shadows {
            *shadow = Shadow {
                asleep: shadow.asleep,
                ..Shadow::new(shadow.motion, self.now)
            };
        }
    }

    /// The step that was linked last is on its way.
    pub fn sent(&mut self, collected: Collected) {
        self.flights.push_back((self.now, collected));
    }

    /// The results of the oldest step in flight are there.
    pub fn arrived(&mut self, motions: Vec<Motion>) -> Option<Collected> {
        let (step, collected) = self.flights.pop_front()?;
        self.arrived = (step, motions);
        Some(collected)
    }

    /// Tells for each body of the step whose results are at hand what to write to its components.
    pub fn write(&mut self, of: &Collected, asleep: &[bool], mut write: impl FnMut(Entity, Written)) {
        let (step, motions) = &self.arrived;
        let mut shadows = self.shadows.iter_mut().peekable();
        for (i, ((&entity, &kind), motion)) in of.entities.iter().zip(&of.kinds).zip(motions).enumerate() {
            while shadows.next_if(|(other, _)| *other < entity).is_some() {}
            if let Some((_, shadow)) = shadows.next_if(|(other, _)| *other == entity) {
                let asleep = asleep.get(i) == Some(&true);
                write(entity, shadow.receive(*step, self.now, kind, motion, asleep));
            }
        }
    }

    /// Brings `bodies` from what their components say to where they are after the last step, with `motions` for each body
    /// of it, and with what users wrote since.
    pub fn catch_up(&self, motions: &[Motion], bodies: &mut BTreeMap<Entity, Motion>) {
        for ((entity, shadow), motion) in self.shadows.iter().zip(motions) {
            let Some(body) = bodies.get_mut(entity) else { continue };
            let before = shadow.motion;
            if before.same_pose(body) {
                (body.position, body.rotation) = (motion.position, motion.rotation);
            }
            body.linear_velocity = motion.linear_velocity + push(before.linear_velocity, body.linear_velocity);
            body.angular_velocity = motion.angular_velocity + push(before.angular_velocity, body.angular_velocity);
        }
    }
}

impl Shadow {
    fn new(seen: Motion, now: u64) -> Self {
        Self {
            motion: seen,
            placed: now,
            launched: now,
            pushes: [[NO_PUSH; 2]; LATENCY],
            asleep: false,
            woken: now,
        }
    }

    /// The shadow for step `now`, and what that step carries over from number `source` of the step before.
    fn next(&self, source: u32, seen: Motion, kind: RigidBody, now: u64) -> (Self, Option<Carried>) {
        let mut next = Self { motion: seen, ..*self };
        let push = [
            push(self.motion.linear_velocity, seen.linear_velocity),
            push(self.motion.angular_velocity, seen.angular_velocity),
        ];
        next.pushes[now as usize % LATENCY] = push;
        let pose = kind != RigidBody::Static && self.motion.same_pose(&seen);
        if !pose {
            next.placed = now;
        }
        // Only dynamic bodies have velocities that the step changes.
        let push = (kind == RigidBody::Dynamic).then_some(push);
        if push.is_none() {
            next.launched = now;
        }
        (next, Some(Carried { source, pose, push }))
    }

    /// What the results of `step` mean for the components, now that step `now` was told what it was told.
    fn receive(&mut self, step: u64, now: u64, kind: RigidBody, motion: &Motion, asleep: bool) -> Written {
        let pose = kind != RigidBody::Static && step >= self.placed;
        if pose {
            (self.motion.position, self.motion.rotation) = (motion.position, motion.rotation);
        }
        let velocities = kind == RigidBody::Dynamic && step >= self.launched;
        if velocities {
            let mut sums = [motion.linear_velocity, motion.angular_velocity];
            for later in step + 1..=now {
                let pushes = self.pushes[later as usize % LATENCY];
                sums = [sums[0] + pushes[0], sums[1] + pushes[1]];
            }
            [self.motion.linear_velocity, self.motion.angular_velocity] = sums;
        }
        let sleep_known = step >= self.woken;
        if sleep_known {
            self.asleep = asleep;
        }
        Written {
            asleep: sleep_known.then_some(asleep),
            pose: pose.then_some((self.motion.position, self.motion.rotation)),
            velocities: velocities.then_some([self.motion.linear_velocity, self.motion.angular_velocity]),
        }
    }
}

/// Minus zero: adding it changes no bit of any number, adding zero would those of minus zero.
const NO_PUSH: Vec3 = Vec3::splat(-0.0);

fn push(before: Vec3, after: Vec3) -> Vec3 {
    Vec3::select(before.cmpeq(after), NO_PUSH, after - before)
}

impl Motion {
    fn same_pose(&self, other: &Self) -> bool {
        self.position == other.position && self.rotation == other.rotation
    }
}
