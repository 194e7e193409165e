// Solver, sleep: bodies that move wake those that they will have reached at the end of the interval; kinematic ones keep
// those awake that they touch. A ground that is not as it was wakes those on it.
#import faceoff::dispatch::group_index
#import faceoff::islands as l
#import faceoff::islands::{solver_bodies, constants, contact_pairs, contact_points, solver_counters, interval, states}
#import faceoff::solver_types as s
#import faceoff::types as t

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= solver_counters[s::PAIRS] {
        return;
    }
    let pair = contact_pairs[i];
    if !l::is_pair(pair) {
        return;
    }
    if constants.x != s::WAKE && l::overlaps(pair) {
        keep_awake(pair.a);
        keep_awake(pair.b);
    }
    if !meets(pair) {
        return;
    }
    if visits(pair.a) {
        l::disturb(pair.b);
    }
    if visits(pair.b) {
        l::disturb(pair.a);
    }
}

// A body that is being pushed out of another is not at rest.
fn keep_awake(i: u32) {
    states[i].rest_time = 0.0;
    if (solver_bodies[i].flags & t::KIND_MASK) == t::DYNAMIC && states[i].asleep == 0u {
        l::disturb(i);
    }
}

// Whether the two touch, now or at the end of the interval.
fn meets(pair: t::ContactPair) -> bool {
    if constants.x != s::WAKE {
        return l::touches(pair);
    }
    let near = l::nearness(pair);
    let fall = sqrt(dot(interval.gravity, interval.gravity)) * interval.dt;
    for (var k = pair.first_point; k < pair.first_point + pair.point_count; k += 1u) {
        let point = contact_points[k];
        let closing = dot(velocity_at(pair.a, point.arm_a) - velocity_at(pair.b, point.arm_b), point.normal);
        if point.separation - (max(closing, 0.0) + fall) * interval.dt <= near {
            return true;
        }
    }
    return false;
}

fn velocity_at(i: u32, arm: vec3<f32>) -> vec3<f32> {
    return states[i].linear_velocity + cross(states[i].angular_velocity, arm);
}

// Whether a body moves and nothing stops it from waking others.
fn visits(i: u32) -> bool {
    let kind = solver_bodies[i].flags & t::KIND_MASK;
    if kind == t::STATIC {
        return constants.x == s::WAKE && states[i].asleep == s::CHANGED;
    }
    if l::speed_of(i) == 0.0 {
        return false;
    }
    return select(kind == t::KINEMATIC, states[i].asleep == 0u, constants.x == s::WAKE);
}
