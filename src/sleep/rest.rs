//! Whether a body is at rest.
//!
//! It is noted how far a body moves and turns in each half of [`SolverSettings::sleep_time`]. A body at rest goes
//! nearly nowhere, and as far in one half as in the next. If the halves differ, the body accelerates, as on a slope
//! that is a little steeper than its friction holds, or at the turning point of a swing. Distances and not speeds are
//! compared, because a body that trembles in a pile stays where it is. A body that trembles so that the halves differ
//! is watched for longer: a lasting acceleration would take it away. All lengths are fractions of the size of the body,
//! so that small bodies behave as large ones do.
//!
//! The rest time tells how far this has come, in halves of the sleep time:
//!
//! | rest time | the body |
//! |---|---|
//! | below 0 | is watched for longer, until 0 |
//! | 0 to 2 | is watched in the first and the second half |
//! | from 2 on | is at rest |

use crate::solver::SleepState;
use crate::solver::bodies::{SolverBody, SolverMotion, Way};
use crate::types::solver_settings::SolverSettings;

/// The largest distance that a body at rest moves while it is watched, as a fraction of its bounding diameter.
pub(crate) const CREEP: f32 = 1.0e-3;
/// The largest difference between the ways in two halves of the sleep time, as a fraction of the bounding diameter.
pub(crate) const DRIFT: f32 = 2.0e-4;
/// The largest distance that a body which touches nothing moves in half of the sleep time, as a fraction of its
/// bounding diameter. Nothing holds it, so it would go on.
pub(crate) const FREE_CREEP: f32 = 1.0e-5;
/// How many halves of the sleep time a body moves by at most [`CREEP`], if it is at rest or watched for longer.
pub(crate) const LONG_WATCH: f32 = 4.0;

/// Larger bodies count as this large, metres: what gravity does in a time does not grow with their size.
pub(crate) const LARGEST: f32 = 2.0;

/// Advances the rest time of a body that has moved for `dt` seconds.
pub(super) fn advance(
    sleep: &mut SleepState,
    body: &SolverBody,
    motion: &SolverMotion,
    dt: f32,
    settings: &SolverSettings,
) {
    // The body has completed its step.
    if dt == 0.0 {
        return;
    }
    let size = size(body);
    let half = (0.5 * settings.sleep_time).max(dt);
    sleep.way.moved += motion.linear_velocity * dt;
    sleep.way.turned += motion.angular_velocity * dt;
    let way = sleep.way.length(body.extent);
    let before = sleep.rest_time;
    sleep.rest_time += dt;
    let passes = |halves: f32| before < halves * half && sleep.rest_time >= halves * half;
    if !(speed(body, motion) < settings.sleep_speed && way <= CREEP * size) {
        sleep.rest_time = 0.0;
        sleep.way = Way::default();
    } else if passes(0.0) || sleep.rest_time >= (2.0 + LONG_WATCH) * half {
        sleep.rest_time = 2.0 * half;
        sleep.last_way = sleep.way.times(1.0 / LONG_WATCH);
        sleep.way = Way::default();
    } else if passes(1.0) || passes(2.0) {
        let drifts = sleep.way.minus(&sleep.last_way).length(body.extent) > DRIFT * size;
        if passes(2.0) && drifts {
            // A body that slows down is compared again.
            let slows_down = way < sleep.last_way.length(body.extent);
            sleep.rest_time = if slows_down { half } else { -LONG_WATCH * half };
        }
        sleep.last_way = sleep.way;
        sleep.way = Way::default();
    }
}

/// Whether a body that touches nothing moves.
pub(super) fn floats(sleep: &SleepState, body: &SolverBody) -> bool {
    sleep.last_way.length(body.extent) > FREE_CREEP * size(body)
}

/// The size that lengths are fractions of, metres.
fn size(body: &SolverBody) -> f32 {
    (2.0 * body.extent).min(LARGEST)
}

/// Speed of the fastest point of the body's bounding sphere.
pub(super) fn speed(body: &SolverBody, motion: &SolverMotion) -> f32 {
    motion.linear_velocity.length() + motion.angular_velocity.length() * body.extent
}
