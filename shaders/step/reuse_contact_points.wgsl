// Contact generation in a step with contacts: inactive pairs keep the contact points of the last collision substep. One
// thread per slot, before the lists are compacted.
#import faceoff::dispatch::group_index
#import faceoff::solver_types as s
#import faceoff::types as t

@group(0) @binding(0) var<uniform> step: t::Step;
@group(0) @binding(1) var<uniform> collision_substep: s::CollisionSubstep;
@group(0) @binding(2) var<storage, read> bodies: array<t::Body>;
@group(0) @binding(3) var<storage, read_write> contact_counters: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read_write> slots: array<t::ContactPair>;
@group(0) @binding(5) var<storage, read_write> staged: array<t::ContactPoint>;
// The results of the last collision substep, ascending by the numbers that bodies had then.
@group(0) @binding(6) var<storage, read> contact_pairs: array<t::ContactPair>;
@group(0) @binding(7) var<storage, read> contact_points: array<t::ContactPoint>;
@group(0) @binding(8) var<storage, read> solver_counters: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= atomicLoad(&contact_counters[t::CONTACT_SLOTS]) {
        return;
    }
    let slot = slots[i];
    if slot.point_count != 0u || bodies[slot.a].inactive == 0u {
        return;
    }
    var then = vec2(bodies[slot.a].source, 0u);
    if slot.b < step.bodies {
        if bodies[slot.b].inactive == 0u {
            return;
        }
        then.y = bodies[slot.b].source;
    } else {
        if step.planes_changed != 0u {
            return;
        }
        then.y = slot.b - step.bodies + (collision_substep.old_bodies - step.planes);
    }
    let known = find(then);
    if known.point_count == 0u {
        return;
    }
    let first = atomicAdd(&contact_counters[t::STAGED_POINTS], known.point_count);
    if first + known.point_count > arrayLength(&staged) {
        // The counter says how long the list must be; the host repeats the step.
        return;
    }
    for (var k = 0u; k < known.point_count; k += 1u) {
        staged[first + k] = contact_points[known.first_point + k];
    }
    slots[i] = t::ContactPair(slot.a, slot.b, first, known.point_count);
}

// The pair with these old numbers; without points if there was none.
fn find(bodies_then: vec2<u32>) -> t::ContactPair {
    let count = min(solver_counters[s::PAIRS], arrayLength(&contact_pairs));
    var low = 0u;
    var high = count;
    while low < high {
        let middle = (low + high) / 2u;
        let pair = contact_pairs[middle];
        if pair.a < bodies_then.x || (pair.a == bodies_then.x && pair.b < bodies_then.y) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    var found: t::ContactPair;
    if low < count && contact_pairs[low].a == bodies_then.x && contact_pairs[low].b == bodies_then.y {
        found = contact_pairs[low];
    }
    return found;
}
