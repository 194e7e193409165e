//! Which bodies are frozen, on the device: islands are found by joining pairs, without rounds.

use super::cpu;
use crate::gpu::kernel::{Kernel, kernel};
use crate::gpu::program::Calls;
use crate::gpu::shader::{Module, Shaders, module, shared_constants};
use crate::solver::gpu::layout::{FALL_ASLEEP, WAKE};
use crate::solver::gpu::arguments::{per_body, per_pair};

/// Every body is an island.
const BEGIN: Kernel = kernel!("sleep/begin");
/// Joins bodies that touch.
const JOIN: Kernel = kernel!("sleep/join");
/// Bodies that keep an island awake.
const BODIES: Kernel = kernel!("sleep/bodies");
/// Bodies that keep those awake that they touch or reach.
const PAIRS: Kernel = kernel!("sleep/pairs");
/// Wakes or freezes.
const APPLY: Kernel = kernel!("sleep/apply");
/// Wakes all.
const WAKE_ALL: Kernel = kernel!("sleep/wake_all");

const CONSTANTS: Module = shared_constants!("faceoff::constants::sleep", {
    f32 TOUCH = cpu::TOUCH;
    f32 OVERLAP = cpu::OVERLAP;
});

/// All of them.
pub const SHADERS: Shaders = Shaders {
    modules: &[CONSTANTS, module!("sleep/islands")],
    kernels: &[&BEGIN, &JOIN, &BODIES, &PAIRS, &APPLY, &WAKE_ALL],
};

/// Adds the calls that wake, before an interval: those that something disturbs or, where nobody may sleep, all.
pub fn record_wake(calls: &mut Calls, may_sleep: bool) {
    if may_sleep {
        record(calls, WAKE);
    } else {
        calls.call(&WAKE_ALL, per_body());
    }
}

/// Adds the calls that put to sleep, after an interval.
pub fn record_fall_asleep(calls: &mut Calls, may_sleep: bool) {
    if may_sleep {
        record(calls, FALL_ASLEEP);
    }
}

fn record(calls: &mut Calls, what: u32) {
    let constants = [what, 0, 0, 0];
    calls.call(&BEGIN, per_body());
    calls.call(&JOIN, per_pair());
    calls.call(&BODIES, per_body()).constants(constants);
    calls.call(&PAIRS, per_pair()).constants(constants);
    calls.call(&APPLY, per_body()).constants(constants);
}
