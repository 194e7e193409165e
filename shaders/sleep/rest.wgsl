#define_import_path faceoff::rest

// Sleep: whether a body is at rest. The twin of `src/sleep/rest.rs`.

#import faceoff::constants::sleep::{CREEP, DRIFT, FREE_CREEP, LARGEST, LONG_WATCH}
#import faceoff::islands::{collision_substep, motion_states, solver_bodies}

// Advances the rest time of a body that has this speed and has moved for `dt` seconds.
fn advance(i: u32, speed: f32, dt: f32) {
    // The body has completed its step.
    if dt == 0.0 {
        return;
    }
    let extent = solver_bodies[i].extent;
    let size = size_of(extent);
    let half = max(0.5 * collision_substep.sleep_time, dt);
    let moved = motion_states[i].moved + motion_states[i].linear_velocity * dt;
    let turned = motion_states[i].turned + motion_states[i].angular_velocity * dt;
    let last_moved = motion_states[i].last_moved;
    let last_turned = motion_states[i].last_turned;
    let way = length_of(moved, turned, extent);
    let before = motion_states[i].rest_time;
    let now = before + dt;
    motion_states[i].moved = moved;
    motion_states[i].turned = turned;
    motion_states[i].rest_time = now;
    if !(speed < collision_substep.sleep_speed && way <= CREEP * size) {
        motion_states[i].rest_time = 0.0;
        begin_way(i);
    } else if (before < 0.0 && now >= 0.0) || now >= (2.0 + LONG_WATCH) * half {
        motion_states[i].rest_time = 2.0 * half;
        motion_states[i].last_moved = moved / LONG_WATCH;
        motion_states[i].last_turned = turned / LONG_WATCH;
        begin_way(i);
    } else if (before < half && now >= half) || (before < 2.0 * half && now >= 2.0 * half) {
        let drifts = length_of(moved - last_moved, turned - last_turned, extent) > DRIFT * size;
        if now >= 2.0 * half && drifts {
            // What slows down is compared again.
            let slows_down = way < length_of(last_moved, last_turned, extent);
            motion_states[i].rest_time = select(-LONG_WATCH * half, half, slows_down);
        }
        motion_states[i].last_moved = moved;
        motion_states[i].last_turned = turned;
        begin_way(i);
    }
}

fn begin_way(i: u32) {
    motion_states[i].moved = vec3(0.0);
    motion_states[i].turned = vec3(0.0);
}

// Whether a body that touches nothing moves.
fn moves(i: u32) -> bool {
    let extent = solver_bodies[i].extent;
    return length_of(motion_states[i].last_moved, motion_states[i].last_turned, extent) > FREE_CREEP * size_of(extent);
}

// The size in metres of which allowed motions are fractions.
fn size_of(extent: f32) -> f32 {
    return min(2.0 * extent, LARGEST);
}

// How far some point of a body with this extent went, at most.
fn length_of(moved: vec3<f32>, turned: vec3<f32>, extent: f32) -> f32 {
    return sqrt(dot(moved, moved)) + sqrt(dot(turned, turned)) * extent;
}
