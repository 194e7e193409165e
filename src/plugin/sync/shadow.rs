//! Shadow copies of a body's components: their values when the step last read or wrote them, to detect what users wrote
//! since.
//!
//! A **changed** field is detected by its value, axis by axis. **Inserting** a component writes all of it, even with
//! equal values. The docs of [`Readback`](crate::plugin::settings::Readback) define the effect of each.

use crate::plugin::settings::LATENCY;
use crate::state::Motion;
use crate::step::gpu::upload::{Carried, CarriedVector};
use crate::types::body::RigidBody;
use bevy::math::{BVec3, U64Vec3};
use bevy::prelude::*;

#[derive(Clone, Copy)]
pub(super) struct Shadow {
    position: Track,
    linear: Track,
    angular: Track,
    rotation: Quat,
    /// The last step that received a written rotation. Results of earlier steps do not contain it.
    turned: u64,
    /// The last step whose results were written to the components.
    read: u64,
    /// The last step that may have moved the body.
    moved: u64,
    /// The last step that may have changed its velocities.
    pushed: u64,
    /// Components that were inserted since the last step.
    inserted: Inserted,
    /// The value of the component `Sleeping`.
    asleep: bool,
    /// The last step that woke the body. Results of earlier steps do not contain that.
    woken: u64,
    /// Whether it moves by its `Transform`, which holds its current pose.
    driven: bool,
}

/// Shadow of a vector whose axes are written independently.
#[derive(Clone, Copy)]
struct Track {
    /// The value of the component.
    shown: Vec3,
    /// For each axis, the last step that received a written value. Results of earlier steps do not contain it.
    sent: U64Vec3,
    /// Differences that were added in the last steps, indexed by step number modulo [`LATENCY`].
    pushes: [Vec3; LATENCY],
}

/// Components of a body whose insertion matters.
#[derive(Clone, Copy)]
pub(crate) enum StateComponent {
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

/// The effect of a component's value on the state of the body on the device.
#[derive(Clone, Copy, PartialEq)]
enum WriteEffect {
    /// The whole value replaces the state.
    Whole,
    /// The axes that changed replace those of the state.
    Parts,
    /// The difference is added to the state.
    Differences,
}

/// Values to write to a body's components.
pub(crate) struct Written {
    pub pose: Option<(Vec3, Quat)>,
    pub velocities: Option<[Vec3; 2]>,
    pub asleep: Option<bool>,
}

impl Shadow {
    /// The shadow of a body whose whole state step `now` receives.
    pub fn new(seen: &Motion, kind: RigidBody, now: u64) -> Self {
        let track = |shown| Track {
            shown,
            sent: U64Vec3::splat(now),
            pushes: [CarriedVector::ALL.added; LATENCY],
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
            driven: false,
        };
        shadow.moves(kind, now);
        shadow
    }

    /// Starts again: step `now` receives the whole state from the components.
    pub fn restart(&mut self, now: u64) {
        let shown = Motion {
            position: self.position.shown,
            rotation: self.rotation,
            linear_velocity: self.linear.shown,
            angular_velocity: self.angular.shown,
        };
        *self = Self {
            asleep: self.asleep,
            driven: self.driven,
            moved: self.moved,
            pushed: self.pushed,
            ..Self::new(&shown, RigidBody::Static, now)
        };
    }

    /// Records that a component was inserted.
    pub fn insert(&mut self, component: StateComponent) {
        match component {
            StateComponent::Pose => self.inserted.pose = true,
            StateComponent::Linear => self.inserted.linear = true,
            StateComponent::Angular => self.inserted.angular = true,
            StateComponent::Sleeping => self.inserted.sleeping = true,
        }
    }

    /// Records whether a body without velocities moves by its `Transform`: once its components hold its current state.
    pub fn drive(&mut self, is_driven: bool) {
        self.driven = is_driven && self.is_known();
    }

    /// Whether the components hold the state after the last step.
    pub fn is_known(&self) -> bool {
        self.moved <= self.read && self.pushed <= self.read
    }

    /// The state that the next step carries over from body `source` of the last one, if the components hold `seen`.
    /// `resident` bodies stay on the device.
    pub fn carry(&self, source: u32, seen: &Motion, resident: bool) -> Carried {
        let pose_known = self.moved <= self.read;
        let pose = WriteEffect::of(self.inserted.pose || pose_known, resident);
        let velocity = |inserted| WriteEffect::of(inserted || self.pushed <= self.read, resident);
        Carried {
            source,
            position: self.position.carry(seen.position, pose),
            rotation: pose != WriteEffect::Whole && self.rotation == seen.rotation,
            linear: self.linear.carry(seen.linear_velocity, velocity(self.inserted.linear)),
            angular: self
                .angular
                .carry(seen.angular_velocity, velocity(self.inserted.angular)),
        }
    }

    /// Records that step `now` receives the values `seen` of the components.
    pub fn send(&mut self, seen: &Motion, carried: &Carried, kind: RigidBody, now: u64) {
        self.position.send(seen.position, &carried.position, now);
        self.linear.send(seen.linear_velocity, &carried.linear, now);
        self.angular.send(seen.angular_velocity, &carried.angular, now);
        self.rotation = seen.rotation;
        if !carried.rotation {
            self.turned = now;
        }
        self.inserted = Inserted::default();
        if kind != RigidBody::Dynamic {
            // Nothing is left of what earlier steps did.
            let is_whole = |vector: &CarriedVector| vector.axes == BVec3::FALSE;
            if is_whole(&carried.linear) && is_whole(&carried.angular) {
                self.pushed = 0;
            }
            if is_whole(&carried.position) && !carried.rotation {
                self.moved = 0;
            }
        }
        self.moves(kind, now);
    }

    /// Records what step `now` may change.
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

    /// Whether step `now` must wake the body, if its component `Sleeping` is `says_asleep`.
    pub fn wake(&mut self, says_asleep: bool, now: u64) -> bool {
        let woken = !says_asleep && (self.asleep || self.inserted.sleeping);
        if woken {
            self.woken = now;
        }
        self.asleep = says_asleep;
        woken
    }

    /// The values to write to the components when the results of `step` come. Step `now` was submitted last.
    pub fn receive(&mut self, step: u64, now: u64, kind: RigidBody, motion: &Motion, asleep: bool) -> Written {
        self.read = step;
        let mut pose = false;
        if kind != RigidBody::Static && !self.driven {
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
    fn carry(&self, seen: Vec3, effect: WriteEffect) -> CarriedVector {
        let same = self.shown.cmpeq(seen);
        let axes = match effect {
            WriteEffect::Whole => BVec3::FALSE,
            WriteEffect::Parts => same,
            WriteEffect::Differences => BVec3::TRUE,
        };
        CarriedVector {
            axes,
            added: Vec3::select(axes & !same, seen - self.shown, CarriedVector::ALL.added),
        }
    }

    fn send(&mut self, seen: Vec3, carried: &CarriedVector, now: u64) {
        self.shown = seen;
        self.sent = U64Vec3::select(carried.axes, self.sent, U64Vec3::splat(now));
        self.pushes[now as usize % LATENCY] = carried.added;
    }

    /// Updates the shadow from a result of `step`, except for axes that were written later. Returns whether any axis
    /// was updated.
    fn receive(&mut self, step: u64, now: u64, result: Vec3) -> bool {
        let known = self.sent.cmple(U64Vec3::splat(step));
        let later = (step + 1..=now).map(|later| self.pushes[later as usize % LATENCY]);
        let sum = later.fold(result, |sum, push| sum + push);
        self.shown = Vec3::select(known, sum, self.shown);
        known.any()
    }
}

impl WriteEffect {
    fn of(whole: bool, resident: bool) -> Self {
        match (whole, resident) {
            (true, _) => Self::Whole,
            (false, true) => Self::Parts,
            (false, false) => Self::Differences,
        }
    }
}
