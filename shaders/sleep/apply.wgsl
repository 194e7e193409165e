// Sleep: wakes the bodies of disturbed islands, or puts the bodies of the others to sleep. One thread per collider.
#import faceoff::dispatch::group_index
#import faceoff::islands as l
#import faceoff::islands::{solver_bodies, constants, collision_substep, motion_states}
#import faceoff::solver_types as s
#import faceoff::union_find::{islands, root_of}

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= collision_substep.bodies || solver_bodies[i].body != i {
        return;
    }
    let asleep = motion_states[i].asleep != 0u;
    let disturbed = atomicLoad(&islands[root_of(i)].disturbed) != 0u;
    if constants.x == s::WAKE {
        if asleep && disturbed {
            motion_states[i].asleep = 0u;
            motion_states[i].rest_time = 0.0;
            motion_states[i].neighbours = 0u;
            motion_states[i].moved = vec3(0.0);
            motion_states[i].turned = vec3(0.0);
            motion_states[i].last_moved = vec3(0.0);
            motion_states[i].last_turned = vec3(0.0);
        }
    } else if !asleep && !disturbed && l::has_mass(solver_bodies[i]) {
        motion_states[i].asleep = 1u;
        motion_states[i].neighbours = atomicLoad(&islands[i].neighbours);
        motion_states[i].linear_velocity = vec3(0.0);
        motion_states[i].angular_velocity = vec3(0.0);
    }
}
