// Sleep: at first every body is an island of its own. One thread per body.
#import faceoff::dispatch::group_index
#import faceoff::islands::{collision_substep}
#import faceoff::union_find::islands

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= collision_substep.bodies {
        return;
    }
    atomicStore(&islands[i].parent, i);
    atomicStore(&islands[i].neighbours, 0u);
    atomicStore(&islands[i].disturbed, 0u);
}
