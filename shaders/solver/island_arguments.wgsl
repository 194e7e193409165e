// Solver: workgroup counts of the kernels with one workgroup per island.
#import faceoff::dispatch::rows
#import faceoff::solver_types as s

@group(0) @binding(0) var<storage, read> solver_counters: array<u32>;
@group(0) @binding(1) var<storage, read_write> solver_arguments: array<u32>;

@compute @workgroup_size(1)
fn main() {
    put(s::GROUPS_PER_SMALL_ISLAND, solver_counters[s::SMALL_ISLANDS]);
    put(s::GROUPS_PER_LARGE_ISLAND, solver_counters[s::LARGE_ISLANDS]);
}

fn put(slot: u32, groups: u32) {
    let r = rows(groups);
    let at = 3u * slot;
    solver_arguments[at] = r.x;
    solver_arguments[at + 1u] = r.y;
    solver_arguments[at + 2u] = r.z;
}
