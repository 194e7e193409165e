// Begin of a step that may need several collision substeps, last: how many each body has, and its speculative radius in
// the first of them. One thread per collider.
#import faceoff::dispatch::group_index
#import faceoff::margins::with_speculative_radius
#import faceoff::paces::{NO_PACE, travel_time}
#import faceoff::sweep::moves
#import faceoff::types as t
#import faceoff::union_find::root_of

@group(0) @binding(0) var<uniform> step: t::Step;
@group(0) @binding(1) var<storage, read> sweeps: array<t::Sweep>;
@group(0) @binding(2) var<storage, read_write> tally: array<atomic<u32>>;
@group(0) @binding(3) var<storage, read_write> bodies: array<t::Body>;
@group(0) @binding(4) var<storage, read_write> body_paces: array<u32>;
@group(0) @binding(9) var<storage, read_write> meetings: array<t::Meeting>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= step.bodies {
        return;
    }
    var pace = NO_PACE;
    if moves(sweeps[i]) {
        let count = atomicLoad(&meetings[root_of(i)].substeps);
        pace = count - 1u;
        atomicAdd(&tally[t::SCHEDULED_BODIES], 1u);
        atomicAdd(&tally[t::SCHEDULED_SUBSTEPS], count);
    }
    body_paces[i] = pace;
    var body = bodies[i];
    body.travel_time = travel_time(pace);
    bodies[i] = with_speculative_radius(step, body);
}
