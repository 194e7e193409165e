// Solver, sleep: wakes the bodies of restless islands, or freezes those of the others.
#import faceoff::dispatch::group_index
#import faceoff::islands as l
#import faceoff::islands::{solver_bodies, constants, interval, islands, states}
#import faceoff::solver_types as s

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= interval.bodies {
        return;
    }
    let asleep = states[i].asleep != 0u;
    let restless = atomicLoad(&islands[l::root_of(i)].restless) != 0u;
    if constants.x == s::WAKE {
        if asleep && restless {
            states[i].asleep = 0u;
            states[i].rest_time = 0.0;
            states[i].neighbours = 0u;
        }
    } else if !asleep && !restless && l::has_mass(solver_bodies[i]) {
        states[i].asleep = 1u;
        states[i].neighbours = atomicLoad(&islands[i].neighbours);
        states[i].linear_velocity = vec3(0.0);
        states[i].angular_velocity = vec3(0.0);
    }
}
