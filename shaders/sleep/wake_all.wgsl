// Sleep: wakes all bodies, if sleep is disabled. One thread per body.
#import faceoff::dispatch::group_index
#import faceoff::solver_types as s

@group(0) @binding(0) var<uniform> collision_substep: s::CollisionSubstep;
@group(0) @binding(1) var<storage, read_write> motion_states: array<s::MotionState>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i < collision_substep.bodies {
        motion_states[i].asleep = 0u;
        motion_states[i].rest_time = 0.0;
        motion_states[i].neighbours = 0u;
        motion_states[i].moved = vec3(0.0);
        motion_states[i].turned = vec3(0.0);
        motion_states[i].last_moved = vec3(0.0);
        motion_states[i].last_turned = vec3(0.0);
    }
}
