// BroadPhase of a step with contacts, first: pose, velocity and sleep state of each body at the start of the step.
// Bodies continue from the last step, in full precision, except for what the host has changed. One thread per body.
#import faceoff::arena::meshes
#import faceoff::carried::carry_over
#import faceoff::dispatch::group_index
#import faceoff::margins::with_speculative_radius
#import faceoff::math::rotate
#import faceoff::solver_math::coarse_rotation
#import faceoff::solver_types as s
#import faceoff::types as t

@group(0) @binding(2) var<uniform> step: t::Step;
@group(0) @binding(3) var<storage, read> moved: array<t::Moved>;
@group(0) @binding(4) var<storage, read> last_step_states: array<s::MotionState>;
// The states that the host knows, of bodies and half-spaces.
@group(0) @binding(5) var<storage, read> host_states: array<s::MotionState>;
@group(0) @binding(6) var<storage, read_write> bodies: array<t::Body>;
@group(0) @binding(7) var<storage, read_write> motion_states: array<s::MotionState>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= step.bodies + step.planes {
        return;
    }
    var state = host_states[i];
    if i >= step.bodies {
        motion_states[i] = state;
        return;
    }
    let last = moved[bodies[i].source];
    let known = last_step_states[bodies[i].source];
    var body = carry_over(bodies[i], last);
    let same_place = all(body.position == last.position) && all(body.rotation == last.rotation);
    let stays = same_place && (body.carried & t::CONTINUES) != 0u;
    if stays {
        state.center = known.center;
        state.center_low = known.center_low;
        state.rotation = known.rotation;
        state.rotation_low = known.rotation_low;
    } else if (body.carried & (t::CARRIED_ROTATION | (7u * t::CARRIED_POSITION))) != 0u {
        state.center = body.position + rotate(body.rotation, body.scale * meshes[body.mesh].center);
        state.center_low = vec3(0.0);
        state.rotation = coarse_rotation(body.rotation);
        state.rotation_low = body.rotation - state.rotation;
    }
    if (body.carried & (7u * t::CARRIED_LINEAR)) != 0u {
        state.linear_velocity = body.linear_velocity;
    }
    if (body.carried & (7u * t::CARRIED_ANGULAR)) != 0u {
        state.angular_velocity = body.angular_velocity;
    }
    let is_static = (body.flags & t::KIND_MASK) == t::STATIC;
    let goes_on = stays && (body.carried & t::CARRIED_SLEEP) != 0u;
    if is_static {
        state.asleep = select(s::CHANGED, 0u, goes_on);
    } else if goes_on && (known.asleep == 0u || (body.carried & t::WOKEN) == 0u) {
        state.asleep = known.asleep;
        state.rest_time = known.rest_time;
        state.neighbours = known.neighbours;
    }
    let rests = all(body.linear_velocity == vec3(0.0)) && all(body.angular_velocity == vec3(0.0));
    body.inactive = u32(goes_on && (is_static || (state.asleep != 0u && rests)));
    // The sphere grows by the rounding error of its centre: four units in the last place.
    let place = abs(body.position);
    body.radius += 4.8e-7 * max(place.x, max(place.y, place.z));
    bodies[i] = with_speculative_radius(step, body);
    motion_states[i] = state;
}
