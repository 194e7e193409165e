// Begin of a step that may need several collision substeps: keeps groups with different numbers of them apart. The twin
// of `src/step/territories.rs`. One workgroup.
//
// Such groups are at different times of the step while it runs, so their bodies must not come near each other at any
// time. The territory of a group is a box around all places that its bodies may reach, even if impulses within the
// group turn and speed them up. Groups whose territories overlap are joined, unless both have the same number. Here
// only groups with several collision substeps have a box: each other body is compared with them individually.
//
// A joined group may reach farther, so all are compared again, in rounds: each round joins all groups that are near
// each other at its start. So the result does not depend on the order of threads.
#import faceoff::constants::reach::{MAX_COMPARISONS, MAX_SPEED_GAIN}
#import faceoff::math::{ascending, descending, max_component}
#import faceoff::meeting::{add_group, count_substeps, meetings, relative_speed}
#import faceoff::sweep::moves
#import faceoff::types as t
#import faceoff::union_find::{join, root_of}

const THREADS: u32 = 256u;
// Most groups with several collision substeps, and most rounds; beyond these all bodies get the largest number.
const MAX_TERRITORIES: u32 = 64u;
const MOST_ROUNDS: u32 = 8u;

struct Territory {
    low: vec3<f32>,
    // The first body of the group.
    root: u32,
    high: vec3<f32>,
    substeps: u32,
}

@group(0) @binding(0) var<uniform> step: t::Step;
@group(0) @binding(1) var<uniform> division: t::Division;
@group(0) @binding(2) var<storage, read_write> counters: array<atomic<u32>>;
@group(0) @binding(3) var<storage, read> sweeps: array<t::Sweep>;
// In use for the group of each body, as it is at the start of a round.
@group(0) @binding(4) var<storage, read_write> body_paces: array<u32>;

var<workgroup> territories: array<Territory, MAX_TERRITORIES>;
var<workgroup> territory_count: atomic<u32>;
var<workgroup> joined: atomic<u32>;
var<workgroup> shared_value: u32;

@compute @workgroup_size(THREADS)
fn main(@builtin(local_invocation_index) thread: u32) {
    if for_all(thread, atomicLoad(&counters[t::NEEDED_SUBSTEPS])) == 1u {
        return;
    }
    for (var round = 0u; round < MOST_ROUNDS; round += 1u) {
        let count = find_territories(thread);
        if count > MAX_TERRITORIES || count * step.bodies > MAX_COMPARISONS {
            break;
        }
        if join_neighbours(thread, count) == 0u {
            return;
        }
        recount(thread);
    }
    storageBarrier();
    let most = for_all(thread, atomicLoad(&counters[t::NEEDED_SUBSTEPS]));
    for (var i = thread; i < step.bodies; i += THREADS) {
        if moves(sweeps[i]) {
            atomicStore(&meetings[root_of(i)].substeps, most);
        }
    }
}

// The value of the first thread.
fn for_all(thread: u32, value: u32) -> u32 {
    if thread == 0u {
        shared_value = value;
    }
    return workgroupUniformLoad(&shared_value);
}

// Lists the groups with several collision substeps, with the boxes that their bodies reach, and returns their number.
fn find_territories(thread: u32) -> u32 {
    if thread == 0u {
        atomicStore(&territory_count, 0u);
    }
    workgroupBarrier();
    for (var i = thread; i < step.bodies; i += THREADS) {
        if !moves(sweeps[i]) {
            continue;
        }
        let root = root_of(i);
        body_paces[i] = root;
        if root != i || atomicLoad(&meetings[i].substeps) == 1u {
            continue;
        }
        for (var axis = 0u; axis < 3u; axis += 1u) {
            atomicStore(&meetings[i].high[axis], 0u);
            atomicStore(&meetings[i].high_negated[axis], 0u);
        }
        let at = atomicAdd(&territory_count, 1u);
        if at < MAX_TERRITORIES {
            territories[at].root = i;
        }
    }
    storageBarrier();
    for (var i = thread; i < step.bodies; i += THREADS) {
        let root = body_paces[i];
        if !moves(sweeps[i]) || atomicLoad(&meetings[root].substeps) == 1u {
            continue;
        }
        let low = low_of(sweeps[i]);
        let high = high_of(sweeps[i]);
        for (var axis = 0u; axis < 3u; axis += 1u) {
            atomicMax(&meetings[root].high[axis], ascending(high[axis]));
            atomicMax(&meetings[root].high_negated[axis], ascending(-low[axis]));
        }
    }
    storageBarrier();
    workgroupBarrier();
    let count = for_all(thread, atomicLoad(&territory_count));
    for (var k = thread; k < min(count, MAX_TERRITORIES); k += THREADS) {
        let root = territories[k].root;
        let reach = reach_of(root);
        for (var axis = 0u; axis < 3u; axis += 1u) {
            territories[k].high[axis] = descending(atomicLoad(&meetings[root].high[axis])) + reach;
            territories[k].low[axis] = -descending(atomicLoad(&meetings[root].high_negated[axis])) - reach;
        }
        territories[k].substeps = atomicLoad(&meetings[root].substeps);
    }
    workgroupBarrier();
    return count;
}

// Joins groups that can come near each other. Returns 0 if there are none.
fn join_neighbours(thread: u32, count: u32) -> u32 {
    if thread == 0u {
        atomicStore(&joined, 0u);
    }
    workgroupBarrier();
    for (var i = thread; i < step.bodies; i += THREADS) {
        if !moves(sweeps[i]) {
            continue;
        }
        let root = body_paces[i];
        let substeps = atomicLoad(&meetings[root].substeps);
        let reach = reach_of(root);
        let low = low_of(sweeps[i]) - reach;
        let high = high_of(sweeps[i]) + reach;
        for (var k = 0u; k < count; k += 1u) {
            let other = territories[k];
            if other.substeps != substeps && all(low <= other.high) && all(other.low <= high) {
                join(root, other.root);
                atomicStore(&joined, 1u);
            }
        }
    }
    storageBarrier();
    workgroupBarrier();
    return for_all(thread, atomicLoad(&joined));
}

// Counts the collision substeps of the joined groups.
fn recount(thread: u32) {
    for (var i = thread; i < step.bodies; i += THREADS) {
        let was_root = moves(sweeps[i]) && body_paces[i] == i;
        if was_root && root_of(i) != i {
            add_group(root_of(i), i);
        }
    }
    storageBarrier();
    for (var i = thread; i < step.bodies; i += THREADS) {
        if moves(sweeps[i]) && root_of(i) == i {
            let count = count_substeps(i, division, step.dt);
            atomicStore(&meetings[i].substeps, count);
            atomicMax(&counters[t::NEEDED_SUBSTEPS], count);
        }
    }
    storageBarrier();
}

// How far impulses within its group may take a body beyond what it sweeps over, metres.
fn reach_of(root: u32) -> f32 {
    return MAX_SPEED_GAIN * step.dt * relative_speed(root);
}

// The corners of the box that a collider sweeps over.
fn low_of(sweep: t::Sweep) -> vec3<f32> {
    return min(sweep.center, sweep.center + sweep.travel) - rounded_radius(sweep);
}

fn high_of(sweep: t::Sweep) -> vec3<f32> {
    return max(sweep.center, sweep.center + sweep.travel) + rounded_radius(sweep);
}

// With the rounding error of the centre.
fn rounded_radius(sweep: t::Sweep) -> f32 {
    return sweep.radius + 1.0e-6 * max_component(abs(sweep.center));
}
