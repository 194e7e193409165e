// Begin of a step that may need several collision substeps, last: the speculative radii for the first of them. One thread per
// collider.
#import faceoff::dispatch::group_index
#import faceoff::margins::with_speculative_radius
#import faceoff::types as t

@group(0) @binding(0) var<uniform> step: t::Step;
@group(0) @binding(1) var<storage, read_write> bodies: array<t::Body>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i < step.bodies {
        bodies[i] = with_speculative_radius(step, bodies[i]);
    }
}
