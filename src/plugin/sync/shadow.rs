//! What a body's components held when we last read or wrote them, to tell what users wrote since.
//!
//! **Changing** a field is told from leaving it alone by its value, axis by axis. **Inserting** a component writes all of it, even
//! the value that it has. [`Reading`](crate::plugin::settings::Reading) says what becomes of either.

use crate::plugin::settings::LATENCY;
use crate::state::Motion;
use crate::step::gpu::upload::{Carried, Onward};
use crate::types::body::RigidBody;
use bevy::math::{BVec3, U64Vec3};
use bevy::prelude::*;

#[derive(Clone, Copy)]
pub(super) struct Shadow {
    position: Track,
    linear: Track,
    angular: Track,
    rotation: Quat,
    /// The last step that was told the rotation. Results of earlier ones say how it would have been.
    turned: u64,
    /// The last step whose results the components have.
    read: u64,
    /// The last step in which it may have moved by itself.
    moved: u64,
    /// The last step in which its velocities may have changed by themselves.
    pushed: u64,
    /// What was inserted since the last step.
    inserted: Inserted,
    /// Whether the component said that it sleeps.
    asleep: bool,
    /// The last step that was told to wake it. Results of earlier ones say that it would have slept.
    woken: u64,
}

/// A vector of which each axis is written by itself.
#[derive(Clone, Copy)]
struct Track {
    /// What the component held.
    shown: Vec3,
    /// Of each axis the last step that was told its value. Results of earlier ones say what it would have been.
    told: U64Vec3,
    /// What was added in the last steps, by step number.
    pushes: [Vec3; LATENCY],
}

/// Components that a body has that can be inserted anew.
#[derive(Clone, Copy)]
pub(crate) enum Part {
    Pose,
    Linear,
    Angular,
    Sleeping,
}

#[derive(Clone, Copy, Default)]
struct Inserted {
    pose: bool,
    linear: bool,
    angular: bool,
    sleeping: bool,
}

/// What a component's value means.
#[derive(Clone, Copy, PartialEq)]
enum Meaning {
    /// It holds, all of it.
    Whole,
    /// Where it changed, it holds.
    Parts,
    /// Where it changed, the difference is added to what the body has.
    Differences,
}

/// What is to be written to a body's components.
pub(crate) struct Written {
    pub pose: Option<(Vec3, Quat)>,
    pub velocities: Option<[Vec3; 2]>,
    pub asleep: Option<bool>,
}

impl Shadow {
    /// Of a body that step `now` is told all about.
    pub fn new(seen: &Motion, kind: RigidBody, now: u64) -> Self {
        let track = |shown| Track {
            shown,
            told: U64Vec3::splat(now),
            pushes: [Onward::ALL.push; LATENCY],
        };
        let mut shadow = Self {
            position: track(seen.position),
            linear: track(seen.linear_velocity),
            angular: track(seen.angular_velocity),
            rotation: seen.rotation,
            turned: now,
            read: now.saturating_sub(1),
            moved: 0,
            pushed: 0,
            inserted: Inserted::default(),
            asleep: false,
            woken: now,
        };
        shadow.moves(kind, now);
        shadow
    }

    /// Step `now` is told what the components say, after all.
    pub fn restart(&mut self, now: u64) {
        let shown = Motion {
            position: self.position.shown,
            rotation: self.rotation,
            linear_velocity: self.linear.shown,
            angular_velocity: self.angular.shown,
        };
        *self = Self {
            asleep: self.asleep,
            moved: self.moved,
            pushed: self.pushed,
            ..Self::new(&shown, RigidBody::Static, now)
        };
    }

    /// A component was inserted anew.
    pub fn insert(&mut self, part: Part) {
        match part {
            Part::Pose => self.inserted.pose = true,
            Part::Linear => self.inserted.linear = true,
            Part::Angular => self.inserted.angular = true,
            Part::Sleeping => self.inserted.sleeping = true,
        }
    }

    /// What the next step carries over from number `source` of the last one, if the components hold `seen`. Nobody reads results
    /// of `resident` bodies.
    pub fn carry(&self, source: u32, seen: &Motion, resident: bool) -> Carried {
        let pose_known = self.moved <= self.read;
        let pose = Meaning::of(self.inserted.pose || pose_known, resident);
        let velocity = |inserted| Meaning::of(inserted || self.pushed <= self.read, resident);
        Carried {
            source,
            position: self.position.carry(seen.position, pose),
            rotation: pose != Meaning::Whole && self.rotation == seen.rotation,
            linear: self.linear.carry(seen.linear_velocity, velocity(self.inserted.linear)),
            angular: self
                .angular
                .carry(seen.angular_velocity, velocity(self.inserted.angular)),
        }
    }

    /// Step `now` is told of what the components hold.
    pub fn tell(&mut self, seen: &Motion, carried: &Carried, kind: RigidBody, now: u64) {
        self.position.tell(seen.position, &carried.position, now);
        self.linear.tell(seen.linear_velocity, &carried.linear, now);
        self.angular.tell(seen.angular_velocity, &carried.angular, now);
        self.rotation = seen.rotation;
        if !carried.rotation {
            self.turned = now;
        }
        self.inserted = Inserted::default();
        self.moves(kind, now);
    }

    /// Notes what step `now` may change.
    fn moves(&mut self, kind: RigidBody, now: u64) {
        let velocity_known = self.pushed <= self.read;
        let rests = velocity_known && self.linear.shown == Vec3::ZERO && self.angular.shown == Vec3::ZERO;
        if kind == RigidBody::Dynamic {
            self.pushed = now;
        }
        if kind == RigidBody::Dynamic || kind == RigidBody::Kinematic && !rests {
            self.moved = now;
        }
    }

    /// Whether step `now` is to wake the body, of which the component says that it sleeps or not.
    pub fn wake(&mut self, says_asleep: bool, now: u64) -> bool {
        let woken = !says_asleep && (self.asleep || self.inserted.sleeping);
        if woken {
            self.woken = now;
        }
        self.asleep = says_asleep;
        woken
    }

    /// What the results of `step` mean for the components, now that step `now` was told what it was told.
    pub fn receive(&mut self, step: u64, now: u64, kind: RigidBody, motion: &Motion, asleep: bool) -> Written {
        self.read = step;
        let mut pose = false;
        if kind != RigidBody::Static {
            pose = self.position.receive(step, now, motion.position);
            if step >= self.turned {
                self.rotation = motion.rotation;
                pose = true;
            }
        }
        let mut velocities = false;
        if kind == RigidBody::Dynamic {
            velocities = self.linear.receive(step, now, motion.linear_velocity);
            velocities |= self.angular.receive(step, now, motion.angular_velocity);
        }
        let sleep_known = step >= self.woken;
        if sleep_known {
            self.asleep = asleep;
        }
        Written {
            asleep: sleep_known.then_some(asleep),
            pose: pose.then_some((self.position.shown, self.rotation)),
            velocities: velocities.then_some([self.linear.shown, self.angular.shown]),
        }
    }
}

impl Track {
    fn carry(&self, seen: Vec3, meaning: Meaning) -> Onward {
        let same = self.shown.cmpeq(seen);
        let axes = match meaning {
            Meaning::Whole => BVec3::FALSE,
            Meaning::Parts => same,
            Meaning::Differences => BVec3::TRUE,
        };
        Onward {
            axes,
            push: Vec3::select(axes & !same, seen - self.shown, Onward::ALL.push),
        }
    }

    fn tell(&mut self, seen: Vec3, carried: &Onward, now: u64) {
        self.shown = seen;
        self.told = U64Vec3::select(carried.axes, self.told, U64Vec3::splat(now));
        self.pushes[now as usize % LATENCY] = carried.push;
    }

    /// Takes over results, and tells whether they say anything new.
    fn receive(&mut self, step: u64, now: u64, result: Vec3) -> bool {
        let known = self.told.cmple(U64Vec3::splat(step));
        let later = (step + 1..=now).map(|later| self.pushes[later as usize % LATENCY]);
        let sum = later.fold(result, |sum, push| sum + push);
        self.shown = Vec3::select(known, sum, self.shown);
        known.any()
    }
}

impl Meaning {
    fn of(whole: bool, resident: bool) -> Self {
        match (whole, resident) {
            (true, _) => Self::Whole,
            (false, true) => Self::Parts,
            (false, false) => Self::Differences,
        }
    }
}
