// Solver: keys by which pairs are sorted into islands: the root of the island, or a number beyond all bodies for pairs
// that are not solved. One thread per pair.
#import faceoff::dispatch::group_index
#import faceoff::solver_types as s
#import faceoff::union_find::root_of

@group(0) @binding(0) var<uniform> collision_substep: s::CollisionSubstep;
@group(0) @binding(1) var<storage, read> solver_counters: array<u32>;
@group(0) @binding(2) var<storage, read> solver_pairs: array<s::SolverPair>;
@group(0) @binding(3) var<storage, read_write> island_keys: array<u32>;
@group(0) @binding(4) var<storage, read_write> pair_order: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= solver_counters[s::PAIRS] {
        return;
    }
    let pair = solver_pairs[i];
    var key = collision_substep.bodies;
    if (pair.flags & s::FROZEN) == 0u {
        key = root_of(select(pair.b, pair.a, (pair.flags & s::FIRST_HAS_MASS) != 0u));
    }
    island_keys[i] = key;
    pair_order[i] = i;
}
