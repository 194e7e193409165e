// Sleep: unites the islands of bodies that touch, and sums the keys of the colliders that each body
// touches. One thread per pair.
#import faceoff::dispatch::group_index
#import faceoff::islands as l
#import faceoff::islands::{solver_bodies, contact_pairs, solver_counters, motion_states}
#import faceoff::solver_types as s
#import faceoff::union_find::{islands, join}

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= solver_counters[s::PAIRS] {
        return;
    }
    let pair = contact_pairs[i];
    if !l::is_pair(pair) || !l::touches(pair) {
        return;
    }
    // A sum of integers does not depend on the order of pairs.
    let bodies = l::bodies_of(pair);
    atomicAdd(&islands[bodies.x].neighbours, motion_states[pair.b].key);
    atomicAdd(&islands[bodies.y].neighbours, motion_states[pair.a].key);
    if l::has_mass(solver_bodies[bodies.x]) && l::has_mass(solver_bodies[bodies.y]) {
        join(bodies.x, bodies.y);
    }
}
