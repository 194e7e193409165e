// Begins a collision substep of a step that may have several. If fewer are recorded than the step needs, the step does
// nothing, and the host repeats it with more. If more are recorded, the last ones do nothing. One thread.
#import faceoff::solver_types as s
#import faceoff::types as t

@group(0) @binding(0) var<uniform> division: t::Division;
@group(0) @binding(1) var<storage, read_write> tally: array<u32>;
@group(0) @binding(2) var<storage, read_write> counters: array<u32>;
@group(0) @binding(3) var<storage, read_write> status: array<u32>;
@group(0) @binding(4) var<storage, read_write> step: array<t::Step>;
@group(0) @binding(5) var<storage, read_write> collision_substep: array<s::CollisionSubstep>;

@compute @workgroup_size(1)
fn main() {
    let needed = counters[t::NEEDED_SUBSTEPS];
    let done = tally[t::COLLISION_SUBSTEPS];
    // The previous search has used these counters. The counters of the triangle test stay: it runs in the first
    // collision substep only.
    tally[t::MAX_SPHERE_PAIRS] = max(tally[t::MAX_SPHERE_PAIRS], counters[t::SPHERE_PAIRS]);
    counters[t::LEVELS] = 0u;
    counters[t::LEVELS + 1u] = 0u;
    counters[t::SPHERE_PAIRS] = 0u;
    counters[t::APPROXIMATE] = 0u;
    counters[t::SELECTED] = 0u;
    if needed > division.recorded {
        status[t::OVERFLOW] = 1u;
        counters[t::SKIPPED] = 1u;
    }
    if done > 0u {
        // The first collision substep has handled the changes of the planes since the last step.
        step[0].planes_changed = 0u;
    }
    if done >= needed {
        step[0].is_over = 1u;
        // Nothing is solved.
        collision_substep[0].paces = 0u;
    }
}
