// Contact generation, last: records the lengths that its lists would need. If a list of the step so far is too short,
// the rest of the step does nothing.
#import faceoff::types as t

@group(0) @binding(0) var<uniform> step: t::Step;
@group(0) @binding(1) var<storage, read> contact_counters: array<u32>;
@group(0) @binding(2) var<storage, read_write> tally: array<u32>;
@group(0) @binding(3) var<storage, read_write> status: array<u32>;
@group(0) @binding(4) var<storage, read_write> counters: array<u32>;

@compute @workgroup_size(1)
fn main() {
    if step.is_over != 0u {
        return;
    }
    for (var k = 0u; k < t::CONTACT_COUNTERS; k += 1u) {
        tally[k] = max(tally[k], contact_counters[k]);
    }
    tally[t::MAX_SPHERE_PAIRS] = max(tally[t::MAX_SPHERE_PAIRS], counters[t::SPHERE_PAIRS]);
    tally[t::COLLISION_SUBSTEPS] += 1u;
    tally[t::TOUCHING_NOW] = 0u;
    tally[t::LAST_CONTACT_PAIRS] = contact_counters[t::CONTACT_PAIRS];
    tally[t::LAST_CONTACT_POINTS] = contact_counters[t::CONTACT_POINTS];
    tally[t::LAST_SPHERE_PAIRS] = counters[t::SPHERE_PAIRS];
    tally[t::LAST_APPROXIMATE] = counters[t::APPROXIMATE];
    if contact_counters[t::CONTACTS_SKIPPED] != 0u
        || counters[t::HITS] > step.hit_limit
        || counters[t::PLANE_CONTACTS] > step.plane_contact_capacity
        || counters[t::PIECES] > step.piece_capacity {
        status[t::OVERFLOW] = 1u;
        counters[t::SKIPPED] = 1u;
    }
}
