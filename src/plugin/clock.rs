//! The physics clock, `Time<Physics>`: pause it, step it by hand, slow it down or speed it up.
//!
//! ```
//! use bevy::prelude::*;
//! use bevy_faceoff::prelude::*;
//!
//! /// Bodies stop. The rest of the game continues.
//! fn pause(mut time: ResMut<Time<Physics>>) {
//!     time.pause();
//! }
//!
//! /// One step while the clock is paused.
//! fn step(mut time: ResMut<Time<Physics>>) {
//!     time.step_once();
//! }
//!
//! fn slow_motion(mut time: ResMut<Time<Physics>>) {
//!     time.unpause();
//!     time.set_relative_speed(0.25);
//! }
//! ```
//!
//! With access to the `World`, for example in a test or for rollback, `world.run_schedule(FaceoffStep)` runs one step
//! of the fixed timestep at once, whether a clock is paused or not.
//!
//! `Time<Fixed>` sets the length of a step. At a relative speed that is not an integer steps are shorter
//! ([`PhysicsTime::set_relative_speed`]). `Time<Virtual>` pauses or scales the whole game, including the steps.

use crate::plugin::schedule::FaceoffStep;
use crate::plugin::sync::{Step, publish};
use bevy::prelude::*;
use std::time::Duration;

/// The context of the physics clock, `Time<Physics>`. [`PhysicsTime`] controls the clock.
///
/// `delta` is the length of the last step, and zero while the clock is paused. `elapsed` is the total length of all
/// steps. Within [`FaceoffStep`] the resource `Time` is this clock.
#[derive(Reflect, Clone, Copy, Debug)]
#[reflect(Default, Debug)]
pub struct Physics {
    paused: bool,
    speed: f64,
    /// Steps that were requested while the clock is paused and have not run yet.
    requested: u32,
    /// Whether [`tick`] has advanced the clock for the next run of the schedule. If not, a user runs the schedule.
    advanced: bool,
}

impl Default for Physics {
    fn default() -> Self {
        Self {
            paused: false,
            speed: 1.0,
            requested: 0,
            advanced: false,
        }
    }
}

/// The largest relative speed of `Time<Physics>`. It limits the number of steps in one tick of fixed time.
pub const MAX_SPEED: f32 = 100.0;

/// Controls of `Time<Physics>`, in addition to the methods of every `Time`.
pub trait PhysicsTime {
    /// Pauses the clock: no body moves from the next tick of fixed time on. What you write to components in the
    /// meantime takes effect when the clock runs again.
    ///
    /// The next tick waits for the pending results of a GPU
    /// ([`Readback::Latent`](crate::plugin::settings::Readback::Latent)) and publishes them, so that components hold
    /// the current state of the bodies.
    ///
    /// While the clock is paused, [`PhysicsTime::step_once`] requests a step of the fixed timestep, and `advance_by` a
    /// step of another length. It runs in the next tick.
    fn pause(&mut self);

    /// Resumes the clock. Requested steps that have not run yet are dropped.
    fn unpause(&mut self);

    /// Whether the clock is paused.
    fn is_paused(&self) -> bool;

    /// Requests one step of the fixed timestep in the next tick of fixed time, at any relative speed, while the clock
    /// is paused. Several calls request several steps. Has no effect while the clock runs.
    fn step_once(&mut self);

    /// Sets how fast time passes for bodies relative to fixed time. Default 1.
    ///
    /// Each tick of fixed time runs the smallest number of equal steps that are no longer than the fixed timestep: one
    /// step of a quarter of the timestep at 0.25, two whole steps at 2, three steps at 2.5. So slow motion is smooth,
    /// and fast motion costs more but is as accurate. At integer speeds, results are the same to the bit as at 1.
    ///
    /// At 0 no step runs, and pending results of a GPU are published as by [`PhysicsTime::pause`].
    ///
    /// A speed that is negative, not finite or above [`MAX_SPEED`] is rejected: the old speed stays, and an error is
    /// logged.
    fn set_relative_speed(&mut self, speed: f32);

    /// The relative speed.
    fn relative_speed(&self) -> f32;
}

impl PhysicsTime for Time<Physics> {
    fn pause(&mut self) {
        if !self.is_paused() {
            self.context_mut().paused = true;
            // Otherwise the last step's delta would count as a request for another step.
            self.advance_by(Duration::ZERO);
        }
    }

    fn unpause(&mut self) {
        let clock = self.context_mut();
        (clock.paused, clock.requested) = (false, 0);
    }

    fn is_paused(&self) -> bool {
        self.context().paused
    }

    fn step_once(&mut self) {
        let clock = self.context_mut();
        if clock.paused {
            clock.requested = clock.requested.saturating_add(1);
        }
    }

    fn set_relative_speed(&mut self, speed: f32) {
        if (0.0..=MAX_SPEED).contains(&speed) {
            self.context_mut().speed = speed.into();
        } else {
            error!(
                "the speed {speed} of Time<Physics> is rejected, and the old one stays: set a number from 0 to \
                 {MAX_SPEED}"
            );
        }
    }

    fn relative_speed(&self) -> f32 {
        self.context().speed as f32
    }
}

/// Runs the steps of a tick of fixed time.
pub(crate) fn tick(world: &mut World) {
    let timestep = world.resource::<Time<Fixed>>().timestep();
    let mut time = world.resource_mut::<Time<Physics>>();
    let paused = time.is_paused();
    let advanced_by = time.delta();
    let clock = time.context_mut();
    // A scene or an inspector may set what `set_relative_speed` refuses.
    if !(0.0..=f64::from(MAX_SPEED)).contains(&clock.speed) {
        error!(
            "the speed {} of Time<Physics> is not a number from 0 to {MAX_SPEED}, and is set to 1",
            clock.speed
        );
        clock.speed = 1.0;
    }
    let (steps, length) = if !paused {
        cut(timestep, clock.speed)
    } else {
        (std::mem::take(&mut clock.requested), timestep)
    };
    let is_advanced = paused && !advanced_by.is_zero();
    if is_advanced {
        run(world);
    }
    #[cfg(feature = "gpu")]
    {
        world.resource_mut::<Step>().stands = !is_advanced && steps == 0;
    }
    for _ in 0..steps {
        // The device may be lost in an earlier step. Then bodies stop, and so does the clock.
        if !world.resource::<Step>().engine.runs() {
            break;
        }
        world.resource_mut::<Time<Physics>>().advance_by(length);
        run(world);
    }
    if paused || steps == 0 {
        settle(world);
    }
}

/// Runs one step. The clock must have been advanced by its length.
fn run(world: &mut World) {
    if world.resource::<Step>().engine.runs() {
        world.resource_mut::<Time<Physics>>().context_mut().advanced = true;
        world.run_schedule(FaceoffStep);
    }
}

/// Number and length of the steps that make up `speed` times a timestep. No steps if their length would be zero.
fn cut(timestep: Duration, speed: f64) -> (u32, Duration) {
    let steps = speed.ceil();
    let length = if speed == steps {
        timestep
    } else {
        timestep.mul_f64(speed / steps)
    };
    (if length.is_zero() { 0 } else { steps as u32 }, length)
}

/// Begins a step: makes `Time` the physics clock. If a user runs the schedule, it also advances that clock.
pub(crate) fn begin(
    mut step: ResMut<Step>,
    mut physics: ResMut<Time<Physics>>,
    fixed: Res<Time<Fixed>>,
    mut time: ResMut<Time>,
) {
    if !step.engine.runs() {
        return;
    }
    step.by_hand = !std::mem::take(&mut physics.context_mut().advanced);
    if step.by_hand {
        physics.advance_by(fixed.timestep());
    }
    step.outer_time = Some(*time);
    *time = physics.as_generic();
}

/// Ends a step: restores the resource `Time`.
pub(crate) fn end(mut step: ResMut<Step>, mut physics: ResMut<Time<Physics>>, mut time: ResMut<Time>) {
    if let Some(outer) = step.outer_time.take() {
        *time = outer;
    }
    if physics.is_paused() {
        physics.advance_by(Duration::ZERO);
    }
}

/// Run condition before [`begin`]: whether a user, not [`tick`], runs the schedule.
pub(crate) fn is_by_hand(physics: Res<Time<Physics>>) -> bool {
    !physics.context().advanced
}

/// Run condition after [`begin`]: whether a user ran the schedule.
pub(crate) fn was_by_hand(step: Res<Step>) -> bool {
    step.by_hand
}

/// Waits for all pending results and publishes them.
pub(crate) fn settle(world: &mut World) {
    while publish::land(world) {}
    if world.resource::<Step>().engine.has_failed()
        && let Err(error) = world.run_system_cached(publish::report_failure)
    {
        error!("{error}");
    }
}
