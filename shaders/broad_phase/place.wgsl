// BroadPhase, first: the pose of each body at the start of the step. Bodies continue from the last step, whose results
// the host need not know yet. Those of compounds follow. One thread per collider.
#import faceoff::carried::carry_over
#import faceoff::dispatch::group_index
#import faceoff::margins::{with_rounded_center, with_speculative_radius}
#import faceoff::types as t

@group(0) @binding(0) var<uniform> step: t::Step;
@group(0) @binding(1) var<storage, read> moved: array<t::Moved>;
@group(0) @binding(2) var<storage, read_write> bodies: array<t::Body>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= step.bodies || (bodies[i].flags & t::PART) != 0u {
        return;
    }
    let body = carry_over(bodies[i], moved[bodies[i].source]);
    bodies[i] = with_speculative_radius(step, with_rounded_center(body));
}
