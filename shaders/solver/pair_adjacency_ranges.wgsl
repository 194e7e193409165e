// Solver: the range of each body among the sorted sides.
#import faceoff::dispatch::group_index
#import faceoff::solver_types as s

@group(0) @binding(0) var<uniform> collision_substep: s::CollisionSubstep;
@group(0) @binding(1) var<storage, read> solver_counters: array<u32>;
@group(0) @binding(2) var<storage, read> side_keys: array<u32>;
@group(0) @binding(3) var<storage, read_write> body_adjacency: array<s::BodyAdjacency>;

// One thread per side. There are two sides per pair, so a dispatch with a workgroup per 64 pairs covers all.
@compute @workgroup_size(128)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 128u + thread;
    let length = solver_counters[s::ENTRIES];
    if i >= length {
        return;
    }
    let key = side_keys[i];
    if key >= collision_substep.bodies {
        return;
    }
    if i == 0u || side_keys[i - 1u] != key {
        body_adjacency[key].first_side = i;
    }
    if i + 1u == length || side_keys[i + 1u] != key {
        body_adjacency[key].sides_end = i + 1u;
    }
}
