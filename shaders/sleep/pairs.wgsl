// Sleep: moving bodies wake bodies that they touch or will reach within the collision substep, and kinematic bodies
// keep touching bodies awake. A static or kinematic body that has changed wakes the bodies on it. One thread per pair.
#import faceoff::dispatch::group_index
#import faceoff::islands as l
#import faceoff::islands::{solver_bodies, constants, contact_pairs, contact_points, solver_counters}
#import faceoff::islands::{body_paces, collision_substep, motion_states}
#import faceoff::paces::travel_time
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
    let bodies = l::bodies_of(pair);
    if constants.x != s::WAKE && l::overlaps(pair) {
        keep_awake(bodies.x);
        keep_awake(bodies.y);
    }
    if !will_touch(pair, bodies) {
        return;
    }
    if disturbs_others(bodies.x) {
        l::disturb(bodies.y);
    }
    if disturbs_others(bodies.y) {
        l::disturb(bodies.x);
    }
}

// Bodies that overlap are not at rest: the solver is still pushing them apart.
fn keep_awake(i: u32) {
    motion_states[i].rest_time = 0.0;
    if (solver_bodies[i].flags & t::KIND_MASK) == t::DYNAMIC && motion_states[i].asleep == 0u {
        l::disturb(i);
    }
}

// Whether the bodies touch, now or by the end of the collision substep.
fn will_touch(pair: t::ContactPair, bodies: vec2<u32>) -> bool {
    if constants.x != s::WAKE {
        return l::touches(pair);
    }
    let near = l::touch_distance(pair);
    let dt = max(travel_time(body_paces[bodies.x]), travel_time(body_paces[bodies.y]));
    let fall = sqrt(dot(collision_substep.gravity, collision_substep.gravity)) * dt;
    for (var k = pair.first_point; k < pair.first_point + pair.point_count; k += 1u) {
        let point = contact_points[k];
        let velocity = velocity_at(bodies.x, point.anchor_a) - velocity_at(bodies.y, point.anchor_b);
        let approach_speed = dot(velocity, point.normal);
        if point.separation - point.bulge - (max(approach_speed, 0.0) + fall) * dt <= near {
            return true;
        }
    }
    return false;
}

fn velocity_at(i: u32, anchor: vec3<f32>) -> vec3<f32> {
    return motion_states[i].linear_velocity + cross(motion_states[i].angular_velocity, anchor);
}

// Whether a body moves or has changed, so that it wakes others.
fn disturbs_others(i: u32) -> bool {
    let kind = solver_bodies[i].flags & t::KIND_MASK;
    let changed = constants.x == s::WAKE && motion_states[i].asleep == s::CHANGED;
    if kind == t::STATIC {
        return changed;
    }
    let speed = l::speed_of(i);
    if kind == t::KINEMATIC {
        return changed || speed > 0.0;
    }
    // Two islands that come to rest beside each other must not wake each other in turn. Bodies that touch are in the
    // same island.
    return constants.x == s::WAKE && motion_states[i].asleep == 0u && speed >= collision_substep.sleep_speed;
}
