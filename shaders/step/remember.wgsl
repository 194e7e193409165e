// Integrate of a step with contacts, last: saves the solver's memory for the next step, unless this one has to be
// repeated. A step at rest leaves the memory as it is, to the bit: sleeping bodies wake the same after any number of
// steps.
#import faceoff::dispatch::group_index
#import faceoff::types as t

// x: which of the solver's counters holds the number of elements, or `NOTHING` for one element. y: length of an
// element, in 16 bytes.
@group(0) @binding(0) var<uniform> constants: vec4<u32>;
@group(0) @binding(1) var<storage, read> counters: array<u32>;
@group(0) @binding(2) var<storage, read> solver_counters: array<u32>;
@group(0) @binding(3) var<storage, read> source: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read_write> stored: array<vec4<u32>>;
@group(0) @binding(5) var<uniform> step: t::Step;
@group(0) @binding(6) var<storage, read> tally: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    var count = 1u;
    if constants.x != t::NOTHING {
        count = solver_counters[constants.x];
    }
    let rests = step.same_numbers != 0u && tally[t::AWAKE] == 0u && tally[t::COLLISION_SUBSTEPS] == 1u;
    if counters[t::SKIPPED] == 0u && !rests && i < count * constants.y {
        stored[i] = source[i];
    }
}
