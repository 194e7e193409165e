// BroadPhase of a step with contacts, first: pose, velocity and sleep state of each body at the start of the step.
// Bodies continue from the last step, in full precision, except for what the host has changed. Compounds follow. One
// thread per collider and half-space.
#import faceoff::arena::meshes
#import faceoff::carried::carry_over
#import faceoff::dispatch::group_index
#import faceoff::margins::{with_rounded_center, with_speculative_radius}
#import faceoff::paces::NO_PACE
#import faceoff::solver_types as s
#import faceoff::start::{inactive_at_start, Start, state_at_start}
#import faceoff::types as t

@group(0) @binding(2) var<uniform> step: t::Step;
@group(0) @binding(3) var<storage, read> moved: array<t::Moved>;
@group(0) @binding(4) var<storage, read> last_step_states: array<s::MotionState>;
// The states that the host knows, of bodies and half-spaces.
@group(0) @binding(5) var<storage, read> host_states: array<s::MotionState>;
@group(0) @binding(6) var<storage, read_write> bodies: array<t::Body>;
@group(0) @binding(7) var<storage, read_write> motion_states: array<s::MotionState>;
@group(0) @binding(8) var<storage, read_write> body_paces: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= step.bodies + step.planes {
        return;
    }
    if i >= step.bodies {
        motion_states[i] = host_states[i];
        body_paces[i] = NO_PACE;
        return;
    }
    // If there may be several collision substeps, `schedule.wgsl` sets it again.
    body_paces[i] = select(0u, NO_PACE, (bodies[i].flags & t::KIND_MASK) == t::STATIC);
    if (bodies[i].flags & t::PART) != 0u {
        return;
    }
    let last = moved[bodies[i].source];
    let known = last_step_states[bodies[i].source];
    var body = carry_over(bodies[i], last);
    let motion = t::Moved(body.position, 0u, body.rotation, body.linear_velocity, 0u, body.angular_velocity, 0u);
    let center = body.scale * meshes[body.mesh].center;
    let start = Start(motion, last, body.carried, body.flags & t::KIND_MASK, center, body.radius);
    let state = state_at_start(host_states[i], known, start);
    body.inactive = inactive_at_start(state, start);
    bodies[i] = with_speculative_radius(step, with_rounded_center(body));
    motion_states[i] = state;
}
