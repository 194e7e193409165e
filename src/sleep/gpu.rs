//! Which bodies are frozen, on the device: islands are found by joining pairs, without rounds.

use crate::gpu::kernel::{Binding, Builder, Groups, Kernel, read, uniform, write};
use crate::solver::gpu::layout::{GROUPS_PER_64_BODIES, GROUPS_PER_64_PAIRS};
use crate::solver::gpu::lists::{Inputs, Lists};

const INTERVAL: Binding = uniform(0, "interval", "Interval");
const CONSTANTS: Binding = uniform(1, "constants", "vec4<u32>");
const COUNTERS: Binding = read(2, "counters", "u32");
const CONTACT_PAIRS: Binding = read(3, "contact_pairs", "ContactPair");
const CONTACT_POINTS: Binding = read(4, "contact_points", "ContactPoint");
const BODY: Binding = read(5, "bodies", "SolverBody");
const STATES: Binding = write(6, "states", "BodyState");
const FORCES: Binding = read(7, "forces", "BodyForces");
const ISLANDS: Binding = write(8, "islands", "Island");

/// Every body is an island.
pub const BEGIN: Kernel = Kernel {
    name: "solver/sleep begin",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/sleep/begin.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[INTERVAL, ISLANDS],
};

/// Joins bodies that touch.
pub const JOIN: Kernel = Kernel {
    name: "solver/sleep join",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/sleep/join.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[INTERVAL, COUNTERS, CONTACT_PAIRS, CONTACT_POINTS, BODY, STATES, ISLANDS],
};

/// Bodies that keep an island awake.
pub const BODIES: Kernel = Kernel {
    name: "solver/sleep bodies",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/sleep/bodies.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[INTERVAL, CONSTANTS, BODY, STATES, FORCES, ISLANDS],
};

/// Bodies that keep those awake that they touch or reach.
pub const PAIRS: Kernel = Kernel {
    name: "solver/sleep pairs",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/sleep/pairs.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        INTERVAL,
        CONSTANTS,
        COUNTERS,
        CONTACT_PAIRS,
        CONTACT_POINTS,
        BODY,
        STATES,
        ISLANDS,
    ],
};

/// Wakes or freezes.
pub const APPLY: Kernel = Kernel {
    name: "solver/sleep apply",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/sleep/apply.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[INTERVAL, CONSTANTS, BODY, STATES, ISLANDS],
};

/// Wakes all.
pub const WAKE_ALL: Kernel = Kernel {
    name: "solver/wake all",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/sleep/wake_all.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[INTERVAL, write(1, "states", "BodyState")],
};

/// Adds the calls that wake, before an interval, or put to sleep, after it.
pub(crate) fn record(builder: &mut Builder, i: &Inputs, l: &Lists, what: u32) {
    let [bodies, pairs] = groups(i);
    let constants = &builder.constants([what, 0, 0, 0]);
    builder.call(&BEGIN, &[&l.interval, &l.islands], bodies);
    let join = [
        &l.interval,
        &l.counters,
        i.contact_pairs,
        i.contact_points,
        i.bodies,
        i.states,
        &l.islands,
    ];
    builder.call(&JOIN, &join, pairs);
    let disturbed = [&l.interval, constants, i.bodies, i.states, i.forces, &l.islands];
    builder.call(&BODIES, &disturbed, bodies);
    let visited = [
        &l.interval,
        constants,
        &l.counters,
        i.contact_pairs,
        i.contact_points,
        i.bodies,
        i.states,
        &l.islands,
    ];
    builder.call(&PAIRS, &visited, pairs);
    let apply = [&l.interval, constants, i.bodies, i.states, &l.islands];
    builder.call(&APPLY, &apply, bodies);
}

/// Adds the call of an interval in which nobody sleeps.
pub(crate) fn record_without(builder: &mut Builder, i: &Inputs, l: &Lists) {
    let [bodies, _] = groups(i);
    builder.call(&WAKE_ALL, &[&l.interval, i.states], bodies);
}

fn groups(i: &Inputs) -> [Groups; 2] {
    [GROUPS_PER_64_BODIES, GROUPS_PER_64_PAIRS].map(|slot| Groups::Indirect(i.first_slot + slot))
}
