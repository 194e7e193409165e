// Integrate of a step with contacts: writes the results of the solver. If a list was too short nothing is written, and
// the host repeats the step. Compounds follow. One thread per collider.
#import faceoff::arena::meshes
#import faceoff::dispatch::group_index
#import faceoff::math::ascending
#import faceoff::placed::{position_of, rotation_of}
#import faceoff::solver_types as s
#import faceoff::types as t

@group(0) @binding(2) var<uniform> step: t::Step;
@group(0) @binding(3) var<storage, read> counters: array<u32>;
@group(0) @binding(4) var<storage, read_write> tally: array<atomic<u32>>;
@group(0) @binding(5) var<storage, read> bodies: array<t::Body>;
@group(0) @binding(6) var<storage, read> body_constants: array<s::BodyConstants>;
@group(0) @binding(7) var<storage, read> motion_states: array<s::MotionState>;
@group(0) @binding(8) var<storage, read_write> moved: array<t::Moved>;
@group(0) @binding(9) var<storage, read_write> last_step_states: array<s::MotionState>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= step.bodies || counters[t::SKIPPED] != 0u {
        return;
    }
    let state = motion_states[i];
    let body = bodies[i];
    let is_part = (body.flags & t::PART) != 0u;
    let is_static = (body.flags & t::KIND_MASK) == t::STATIC;
    if (body.inactive & t::RESTS) == 0u || (state.asleep == 0u && !is_static && !is_part) {
        atomicStore(&tally[t::AWAKE], 1u);
    }
    if is_part {
        return;
    }
    var after: t::Moved;
    after.position = body.position;
    after.rotation = body.rotation;
    // Bodies at rest keep their pose to the bit.
    if (body_constants[i].flags & s::MOVES) != 0u {
        after.position = position_of(state, body.scale * meshes[body.mesh].center);
        after.rotation = rotation_of(state);
    }
    after.linear_velocity = state.linear_velocity;
    after.angular_velocity = state.angular_velocity;
    after.asleep = select(state.asleep, 0u, is_static);
    moved[i] = after;
    atomicAdd(&tally[t::ASLEEP], u32(after.asleep != 0u));
    last_step_states[i] = state;
    if !is_static && (body.flags & t::FAST) == 0u {
        let v = state.linear_velocity;
        let w = state.angular_velocity;
        for (var axis = 0u; axis < 3u; axis += 1u) {
            atomicMax(&tally[t::MAX_VELOCITY + axis], ascending(v[axis]));
            atomicMax(&tally[t::MAX_NEGATED_VELOCITY + axis], ascending(-v[axis]));
        }
        atomicMax(&tally[t::MAX_SPIN], ascending(sqrt(dot(w, w)) * body.radius));
    }
}
