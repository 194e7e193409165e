// Solver: lists the two sides of each pair, keyed by body, for the sort. Sides of frozen pairs, and of bodies without
// mass, get a key beyond all bodies. One thread per pair.
#import faceoff::dispatch::group_index
#import faceoff::solver_types as s

@group(0) @binding(0) var<uniform> collision_substep: s::CollisionSubstep;
@group(0) @binding(1) var<storage, read> solver_counters: array<u32>;
@group(0) @binding(2) var<storage, read> solver_pairs: array<s::SolverPair>;
@group(0) @binding(3) var<storage, read_write> side_keys: array<u32>;
@group(0) @binding(4) var<storage, read_write> sides: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= solver_counters[s::PAIRS] {
        return;
    }
    let pair = solver_pairs[i];
    let moves = (pair.flags & s::FROZEN) == 0u;
    side_keys[2u * i] = select(collision_substep.bodies, pair.a, moves && (pair.flags & s::FIRST_HAS_MASS) != 0u);
    side_keys[2u * i + 1u] = select(collision_substep.bodies, pair.b, moves && (pair.flags & s::SECOND_HAS_MASS) != 0u);
    sides[2u * i] = 2u * i;
    sides[2u * i + 1u] = 2u * i + 1u;
}
