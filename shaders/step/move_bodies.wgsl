// Integrate between collision substeps: moves the bodies of the step to where the solver has put them. Those that have
// completed their step keep their contact points from now on. Compounds follow. One thread per collider.
#import faceoff::arena::meshes
#import faceoff::dispatch::group_index
#import faceoff::paces::NO_PACE
#import faceoff::placed::{position_of, rotation_of}
#import faceoff::scheduled::{after_substep, has_completed}
#import faceoff::solver_types as s
#import faceoff::types as t

@group(0) @binding(2) var<uniform> step: t::Step;
@group(0) @binding(3) var<storage, read> motion_states: array<s::MotionState>;
@group(0) @binding(4) var<storage, read> body_constants: array<s::BodyConstants>;
@group(0) @binding(5) var<storage, read> tally: array<u32>;
@group(0) @binding(6) var<storage, read_write> body_paces: array<u32>;
@group(0) @binding(7) var<storage, read_write> bodies: array<t::Body>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= step.bodies {
        return;
    }
    var body = bodies[i];
    if (body.flags & t::PART) != 0u {
        return;
    }
    let state = motion_states[i];
    if (body_constants[i].flags & s::MOVES) != 0u {
        body.position = position_of(state, body.scale * meshes[body.mesh].center);
        body.rotation = rotation_of(state);
    }
    body.linear_velocity = state.linear_velocity;
    body.angular_velocity = state.angular_velocity;
    let completed = has_completed(body_paces[i], tally[t::COLLISION_SUBSTEPS]);
    if completed {
        body_paces[i] = NO_PACE;
    }
    body.source = i;
    let is_static = (body.flags & t::KIND_MASK) == t::STATIC;
    bodies[i] = after_substep(step, body, is_static || state.asleep != 0u, completed);
}
