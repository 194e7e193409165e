// Solver: lists the islands, small ones from the front of the list and large ones from its back. Their order in the
// list depends on the order of threads; nothing else does. One thread per sorted pair.
#import faceoff::dispatch::group_index
#import faceoff::solver_types as s

@group(0) @binding(0) var<uniform> collision_substep: s::CollisionSubstep;
@group(0) @binding(1) var<storage, read_write> solver_counters: array<atomic<u32>>;
@group(0) @binding(2) var<storage, read> island_keys: array<u32>;
@group(0) @binding(3) var<storage, read_write> island_ranges: array<s::IslandRange>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    let length = atomicLoad(&solver_counters[s::PAIRS]);
    if i >= length {
        return;
    }
    let key = island_keys[i];
    if key >= collision_substep.bodies || (i > 0u && island_keys[i - 1u] == key) {
        return;
    }
    // The first pair of its island finds the last one.
    var low = i + 1u;
    var high = length;
    while low < high {
        let middle = low + (high - low) / 2u;
        if island_keys[middle] == key {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    var at = 0u;
    if low - i <= s::SMALL_ISLAND_PAIRS {
        at = atomicAdd(&solver_counters[s::SMALL_ISLANDS], 1u);
    } else {
        at = arrayLength(&island_ranges) - 1u - atomicAdd(&solver_counters[s::LARGE_ISLANDS], 1u);
    }
    island_ranges[at] = s::IslandRange(i, low, 0u, 0u);
}
