//! Sleep on the GPU: islands by parallel union-find.

use super::{cpu, rest};
use crate::gpu::kernel::{Kernel, kernel};
use crate::gpu::program::Calls;
use crate::gpu::shader::{Module, Shaders, module, shared_constants};
use crate::solver::gpu::arguments::{per_body, per_pair};
use crate::solver::gpu::layout::{FALL_ASLEEP, WAKE};

/// Makes each body an island of its own.
const BEGIN: Kernel = kernel!("sleep/begin");
/// Unites the islands of bodies that touch.
const JOIN: Kernel = kernel!("sleep/join");
/// Marks islands by the state of their bodies.
const BODIES: Kernel = kernel!("sleep/bodies");
/// Marks islands by bodies that touch or approach them.
const PAIRS: Kernel = kernel!("sleep/pairs");
/// Wakes bodies, or puts them to sleep.
const APPLY: Kernel = kernel!("sleep/apply");
/// Wakes all bodies.
const WAKE_ALL: Kernel = kernel!("sleep/wake_all");

const CONSTANTS: Module = shared_constants!("faceoff::constants::sleep", {
    f32 TOUCH = cpu::TOUCH;
    f32 OVERLAP = cpu::OVERLAP;
    f32 CREEP = rest::CREEP;
    f32 DRIFT = rest::DRIFT;
    f32 FREE_CREEP = rest::FREE_CREEP;
    f32 LONG_WATCH = rest::LONG_WATCH;
    f32 LARGEST = rest::LARGEST;
});

/// The modules and kernels of sleep.
pub const SHADERS: Shaders = Shaders {
    modules: &[CONSTANTS, module!("sleep/islands"), module!("sleep/rest")],
    kernels: &[&BEGIN, &JOIN, &BODIES, &PAIRS, &APPLY, &WAKE_ALL],
};

/// Adds the calls that wake disturbed islands, before the solver. If sleep is disabled, all bodies wake.
pub fn record_wake(calls: &mut Calls, may_sleep: bool) {
    if may_sleep {
        record(calls, WAKE);
    } else {
        calls.call(&WAKE_ALL, per_body());
    }
}

/// Adds the calls that put islands to sleep, after the solver.
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
