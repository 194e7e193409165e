#define_import_path faceoff::start

// The solver's state of a body at the start of a step.

#import faceoff::math::rotate
#import faceoff::solver_math::coarse_rotation
#import faceoff::solver_types as s
#import faceoff::types as t

// Relative rounding error of a place that the host knows.
const PLACE_ERROR: f32 = 4.0e-6;

// `host` is the state that the host knows, `known` that after the last step, and `motion` the present one in single
// precision. The body `stays` if it continues from the last step and has not moved since. `center` is its centre of mass
// in its own axes. What is not `dynamic` never sleeps; if it has `changed` other than by its velocity, it wakes others.
fn state_at_start(
    host: s::MotionState,
    known: s::MotionState,
    carried: u32,
    stays: bool,
    dynamic: bool,
    changed: bool,
    motion: t::Moved,
    center: vec3<f32>,
) -> s::MotionState {
    var state = host;
    if stays {
        state.center = known.center;
        state.center_low = known.center_low;
        state.rotation = known.rotation;
        state.rotation_low = known.rotation_low;
    } else if (carried & (t::CARRIED_ROTATION | (7u * t::CARRIED_POSITION))) != 0u {
        state.center = motion.position + rotate(motion.rotation, center);
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
    let goes_on = stays && (carried & t::CARRIED_SLEEP) != 0u;
    if !dynamic {
        state.asleep = select(0u, s::CHANGED, changed);
    } else if goes_on && (known.asleep == 0u || (carried & t::WOKEN) == 0u) {
        state.asleep = known.asleep;
        state.rest_time = known.rest_time;
        state.neighbours = known.neighbours;
    }
    return state;
}

// Whether a body was at the same place after the last step, up to rounding. `size` is its radius. The host may place a
// kinematic body where it was to its own rounding.
fn is_near(body: t::Moved, last: t::Moved, size: f32) -> bool {
    let place = abs(body.position);
    let near = PLACE_ERROR * (max(place.x, max(place.y, place.z)) + size);
    return all(abs(body.position - last.position) <= vec3(near))
        && all(abs(body.rotation - last.rotation) <= vec4(PLACE_ERROR));
}
