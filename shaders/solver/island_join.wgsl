// Solver: unites the islands of bodies that pairs connect. Bodies that impulses do not move join nothing. One thread
// per pair.
#import faceoff::dispatch::group_index
#import faceoff::solver_types as s
#import faceoff::union_find::join

@group(0) @binding(0) var<storage, read> solver_counters: array<u32>;
@group(0) @binding(1) var<storage, read> solver_pairs: array<s::SolverPair>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= solver_counters[s::PAIRS] {
        return;
    }
    let pair = solver_pairs[i];
    let both = s::FIRST_HAS_MASS | s::SECOND_HAS_MASS;
    if (pair.flags & s::FROZEN) == 0u && (pair.flags & both) == both {
        join(pair.a, pair.b);
    }
}
