#define_import_path faceoff::start

// The solver's state of a body at the start of a step.

#import faceoff::math::rotate
#import faceoff::solver_math::coarse_rotation
#import faceoff::solver_types as s
#import faceoff::types as t

// Relative rounding error of a place that the host knows.
const PLACE_ERROR: f32 = 4.0e-6;

// A body at the start of a step, in single precision.
struct Start {
    motion: t::Moved,
    // Motion after the last step.
    last: t::Moved,
    carried: u32,
    kind: u32,
    // Centre of mass in the body's own axes.
    center: vec3<f32>,
    radius: f32,
}

// `host` is the state that the host knows, `known` the state after the last step. Bodies that are not dynamic never
// sleep; if they have changed other than by their velocity, they wake others.
fn state_at_start(host: s::MotionState, known: s::MotionState, start: Start) -> s::MotionState {
    let motion = start.motion;
    let carried = start.carried;
    var state = host;
    if stays(start) {
        state.center = known.center;
        state.center_low = known.center_low;
        state.rotation = known.rotation;
        state.rotation_low = known.rotation_low;
    } else if (carried & (t::CARRIED_ROTATION | (7u * t::CARRIED_POSITION))) != 0u {
        state.center = motion.position + rotate(motion.rotation, start.center);
        state.center_low = vec3(0.0);
        state.rotation = coarse_rotation(motion.rotation);
        state.rotation_low = motion.rotation - state.rotation;
    }
    if (carried & (7u * t::CARRIED_LINEAR)) != 0u {
        state.linear_velocity = motion.linear_velocity;
    }
    if (carried & (7u * t::CARRIED_ANGULAR)) != 0u {
        state.angular_velocity = motion.angular_velocity;
    }
    if start.kind != t::DYNAMIC {
        state.asleep = select(0u, s::CHANGED, has_changed(start));
    } else if goes_on(start) && (known.asleep == 0u || is_at_rest(start)) {
        state.asleep = known.asleep;
        state.rest_time = known.rest_time;
        state.moved = known.moved;
        state.turned = known.turned;
        state.last_moved = known.last_moved;
        state.last_turned = known.last_turned;
        state.neighbours = known.neighbours;
    }
    return state;
}

// Not 0 if a body with this state is inactive.
fn inactive_at_start(state: s::MotionState, start: Start) -> u32 {
    return select(0u, t::RESTS, goes_on(start) && (start.kind == t::STATIC || state.asleep != 0u));
}

// Whether nothing sets it in motion. Otherwise it is awake from the start of the step: its speed counts for collision
// substeps, and contact points are found for it.
fn is_at_rest(start: Start) -> bool {
    let v = start.motion.linear_velocity;
    let w = start.motion.angular_velocity;
    return (start.carried & t::WOKEN) == 0u && all(v == vec3(0.0)) && all(w == vec3(0.0));
}

// Whether it continues from the last step and has not been moved since.
fn stays(start: Start) -> bool {
    return (start.carried & t::CONTINUES) != 0u && is_same_place(start);
}

// Whether nothing about it has changed but its velocity.
fn goes_on(start: Start) -> bool {
    return stays(start) && (start.carried & t::CARRIED_SLEEP) != 0u;
}

// The host may place a kinematic body where it was to its own rounding.
fn has_changed(start: Start) -> bool {
    let same_state = (start.carried & t::CONTINUES) != 0u && (start.carried & t::CARRIED_SLEEP) != 0u;
    return !(same_state && select(is_near(start), is_same_place(start), start.kind == t::STATIC));
}

fn is_same_place(start: Start) -> bool {
    return all(start.motion.position == start.last.position) && all(start.motion.rotation == start.last.rotation);
}

// Whether it is at the same place up to rounding.
fn is_near(start: Start) -> bool {
    let position = start.motion.position;
    let place = abs(position);
    let near = PLACE_ERROR * (max(place.x, max(place.y, place.z)) + start.radius);
    return all(abs(position - start.last.position) <= vec3(near))
        && all(abs(start.motion.rotation - start.last.rotation) <= vec4(PLACE_ERROR));
}
