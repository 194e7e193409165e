// Solver: gives each body its number in the last collision substep. One thread per body of that substep.
#import faceoff::dispatch::group_index
#import faceoff::solver_types as s

@group(0) @binding(0) var<uniform> collision_substep: s::CollisionSubstep;
// New numbers by old ones; 0xffffffff for bodies that are gone.
@group(0) @binding(1) var<storage, read> new_numbers: array<u32>;
@group(0) @binding(2) var<storage, read_write> old_numbers: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let old = group_index(group) * 64u + thread;
    if old >= min(collision_substep.old_bodies, arrayLength(&new_numbers)) {
        return;
    }
    let body = new_numbers[old];
    if body < collision_substep.bodies {
        old_numbers[body] = old;
    }
}
