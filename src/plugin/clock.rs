//! The clock of the steps: `Time<Physics>`, which can be paused, stepped by hand, slowed down and sped up.
//!
//! ```
//! use bevy::prelude::*;
//! use bevy_faceoff::prelude::*;
//!
//! /// Bodies stand still, and everything else goes on.
//! fn pause(mut time: ResMut<Time<Physics>>) {
//!     time.pause();
//! }
//!
//! /// Still paused, one step forward.
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
//! Where there is a `World`, in a test or for rollback, `world.run_schedule(FaceoffStep)` does one step of the fixed timestep at
//! once, whether a clock is paused or not.
//!
//! `Time<Fixed>` says how long a step is, and nothing here changes it. `Time<Virtual>`, paused or at another speed, holds or
//! drives the whole game, steps too.

use crate::plugin::schedule::FaceoffStep;
use crate::plugin::sync::{Step, publish};
use bevy::prelude::*;
use std::time::Duration;

/// Makes a [`Time`] the clock of the steps: `Time<Physics>`. [`PhysicsTime`] controls it.
///
/// Its `delta` is the length of the last step, and zero while it is paused; its `elapsed` is how long bodies have moved. Within
/// [`FaceoffStep`] plain `Time` is this clock.
#[derive(Reflect, Clone, Copy, Debug)]
#[reflect(Default, Debug)]
pub struct Physics {
    paused: bool,
    speed: f64,
    /// Steps that were asked for while it is paused and have not run.
    wanted: u32,
    /// It stands where the step that is about to run ends. If not, somebody runs the schedule by hand.
    advanced: bool,
}

impl Default for Physics {
    fn default() -> Self {
        Self {
            paused: false,
            speed: 1.0,
            wanted: 0,
            advanced: false,
        }
    }
}

/// The largest speed of a [`Time<Physics>`](Physics): a tick of fixed time must end.
pub const MAX_SPEED: f32 = 100.0;

/// What `Time<Physics>` can do beside what every clock can.
pub trait PhysicsTime {
    /// No body moves from the next tick of fixed time on. What is written to components meanwhile holds when the clock goes on.
    ///
    /// In that tick the results of a GPU that are on their way ([`Reading::Latent`](crate::plugin::settings::Reading)) are waited for and
    /// published, so that components say where the bodies are.
    ///
    /// While it is paused [`PhysicsTime::step_once`] asks for a step of the fixed timestep, and `advance_by` for one of another
    /// length; it runs in the next tick.
    fn pause(&mut self);

    /// Bodies move again. Steps that were asked for and have not run are dropped.
    fn unpause(&mut self);

    /// Whether it is paused.
    fn is_paused(&self) -> bool;

    /// Asks for a step of the fixed timestep, whatever the speed, in the next tick of fixed time although the clock is paused;
    /// several calls for as many. Has no effect on a clock that runs.
    fn step_once(&mut self);

    /// How fast time passes for bodies, beside fixed time; 1 by default.
    ///
    /// A tick of fixed time is cut into as few equal steps as make none longer than the fixed timestep: at 0.25 one step of a
    /// quarter of it, at 2 two whole ones, at 2.5 three. So slow motion is smooth, and fast motion costs more and is as exact as
    /// ever. At whole speeds steps give the same bits as at 1.
    ///
    /// A speed that is negative, not finite or more than [`MAX_SPEED`] is refused: an error in the log, and the old one stays.
    fn set_relative_speed(&mut self, speed: f32);

    /// The speed that was set.
    fn relative_speed(&self) -> f32;
}

impl PhysicsTime for Time<Physics> {
    fn pause(&mut self) {
        if !self.is_paused() {
            self.context_mut().paused = true;
            // What is left of the last step is no wish for another one.
            self.advance_by(Duration::ZERO);
        }
    }

    fn unpause(&mut self) {
        let clock = self.context_mut();
        (clock.paused, clock.wanted) = (false, 0);
    }

    fn is_paused(&self) -> bool {
        self.context().paused
    }

    fn step_once(&mut self) {
        let clock = self.context_mut();
        if clock.paused {
            clock.wanted = clock.wanted.saturating_add(1);
        }
    }

    fn set_relative_speed(&mut self, speed: f32) {
        if (0.0..=MAX_SPEED).contains(&speed) {
            self.context_mut().speed = speed.into();
        } else {
            error!(
                "the speed {speed} of Time<Physics> is refused, and the old one stays: set a number from 0 to {MAX_SPEED}"
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
    let (steps, length) = if !paused {
        cut(timestep, clock.speed)
    } else {
        (std::mem::take(&mut clock.wanted), timestep)
    };
    if paused && !advanced_by.is_zero() {
        run(world);
    }
    for _ in 0..steps {
        // The device may have been lost in the step before, and time in which no body moves does not pass.
        if !world.resource::<Step>().engine.runs() {
            break;
        }
        world.resource_mut::<Time<Physics>>().advance_by(length);
        run(world);
    }
    if paused {
        settle(world);
    }
}

/// Runs a step to where the clock stands.
fn run(world: &mut World) {
    if world.resource::<Step>().engine.runs() {
        world.resource_mut::<Time<Physics>>().context_mut().advanced = true;
        world.run_schedule(FaceoffStep);
    }
}

/// How many steps of what length make `speed` times a timestep. None if they would have no length.
fn cut(timestep: Duration, speed: f64) -> (u32, Duration) {
    let steps = speed.ceil();
    let length = if speed == steps {
        timestep
    } else {
        timestep.mul_f64(speed / steps)
    };
    (if length.is_zero() { 0 } else { steps as u32 }, length)
}

/// Begins a step: makes `Time` the clock of the step, and advances that for a step by hand.
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

/// Ends a step: makes `Time` the clock again that it was.
pub(crate) fn end(mut step: ResMut<Step>, mut physics: ResMut<Time<Physics>>, mut time: ResMut<Time>) {
    if let Some(outer) = step.outer_time.take() {
        *time = outer;
    }
    if physics.is_paused() {
        physics.advance_by(Duration::ZERO);
    }
}

/// Whether the step that is about to run does so because somebody ran the schedule.
pub(crate) fn is_by_hand(physics: Res<Time<Physics>>) -> bool {
    !physics.context().advanced
}

/// The same at its end.
pub(crate) fn was_by_hand(step: Res<Step>) -> bool {
    step.by_hand
}

/// Waits for all results that are on their way, and publishes them.
pub(crate) fn settle(world: &mut World) {
    while publish::land(world) {}
    if world.resource::<Step>().engine.has_failed()
        && let Err(error) = world.run_system_cached(publish::tell_failure)
    {
        error!("{error}");
    }
}
