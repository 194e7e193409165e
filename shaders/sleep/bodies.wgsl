// Sleep: bodies that keep their island awake, or wake it. One thread per collider.
#import faceoff::dispatch::group_index
#import faceoff::islands as l
#import faceoff::islands::{solver_bodies, constants, forces, collision_substep, motion_states, body_paces}
#import faceoff::paces::travel_time
#import faceoff::rest as r
#import faceoff::solver_types as s
#import faceoff::types as t
#import faceoff::union_find::islands

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= collision_substep.bodies || solver_bodies[i].body != i {
        return;
    }
    let asleep = motion_states[i].asleep != 0u;
    let kind = solver_bodies[i].flags & t::KIND_MASK;
    let speed = l::speed_of(i);
    let forced = is_forced(i);
    var disturbed = kind == t::DYNAMIC;
    if constants.x == s::WAKE {
        if asleep {
            let others = motion_states[i].neighbours != atomicLoad(&islands[i].neighbours);
            disturbed = speed != 0.0 || forced || kind != t::DYNAMIC || others;
        }
    } else {
        let dt = travel_time(body_paces[i]);
        r::advance(i, speed, dt);
        let rest_time = motion_states[i].rest_time;
        // If it woke in this collision substep it may have moved.
        let was_at_rest = rest_time > dt;
        let ready = asleep || (was_at_rest && rest_time >= collision_substep.sleep_time && !forced);
        let floats = atomicLoad(&islands[i].neighbours) == 0u && r::moves(i);
        disturbed = disturbed && (!ready || floats);
    }
    if disturbed {
        l::disturb(i);
    }
}

fn is_forced(i: u32) -> bool {
    let f = forces[i];
    let none = vec3(0.0);
    return any(f.force != none) || any(f.torque != none) || any(f.impulse != none) || any(f.angular_impulse != none);
}
