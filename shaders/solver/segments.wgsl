// Solver: where each body's ends begin and end.
#import faceoff::dispatch::group_index
#import faceoff::solver_types as s

@group(0) @binding(0) var<uniform> interval: s::Interval;
@group(0) @binding(1) var<storage, read> solver_counters: array<u32>;
@group(0) @binding(2) var<storage, read> end_keys: array<u32>;
@group(0) @binding(3) var<storage, read_write> links: array<vec4<u32>>;

// Two ends a thread, so that a dispatch for 64 pairs reaches all.
@compute @workgroup_size(128)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 128u + thread;
    let length = solver_counters[s::ENTRIES];
    if i >= length {
        return;
    }
    let key = end_keys[i];
    if key >= interval.bodies {
        return;
    }
    if i == 0u || end_keys[i - 1u] != key {
        links[key].x = i;
    }
    if i + 1u == length || end_keys[i + 1u] != key {
        links[key].y = i + 1u;
    }
}
