#define_import_path faceoff::margins

// Speculative margins. The twin of `src/state/margins.rs`.

#import faceoff::constants::shared::BOUND
#import faceoff::types as t

// The body with its speculative radius, which follows from its present velocities.
fn with_speculative_radius(step: t::Step, body: t::Body) -> t::Body {
    var placed = body;
    var travel = 0.0;
    if (body.flags & t::KIND_MASK) != t::STATIC {
        let v = body.linear_velocity - step.drift;
        travel = (sqrt(dot(v, v)) + sway(step, body, body.travel_time)) * (step.travel_scale * body.travel_time);
    }
    if step.has_fast_bodies == 0u {
        travel = min(travel, BOUND * body.thickness);
    }
    placed.speculative_radius = body.radius + step.contact_margin * body.radius + travel;
    return placed;
}

// The body with its sphere enlarged by the rounding error of its centre: four units in the last place.
fn with_rounded_center(body: t::Body) -> t::Body {
    var placed = body;
    let place = abs(body.position);
    placed.radius += 4.8e-7 * max(place.x, max(place.y, place.z));
    return placed;
}

// The speculative margin of a pair, metres.
fn speculative_margin(step: t::Step, a: t::Body, b: t::Body) -> f32 {
    let diameter = 2.0 * min(a.radius, b.radius);
    let v = velocity(b) - velocity(a);
    let time = max(a.travel_time, b.travel_time);
    let travel = (sqrt(dot(v, v)) + sway(step, a, time) + sway(step, b, time)) * (step.travel_scale * time);
    return step.contact_margin * diameter + min(travel, BOUND * min(a.thickness, b.thickness));
}

fn velocity(body: t::Body) -> vec3<f32> {
    return select(body.linear_velocity, vec3(0.0), (body.flags & t::KIND_MASK) == t::STATIC);
}

// Upper bound of the speed that rotation, gravity and external forces add to a body's surface within this time, m/s.
fn sway(step: t::Step, body: t::Body, time: f32) -> f32 {
    let kind = body.flags & t::KIND_MASK;
    if kind == t::STATIC {
        return 0.0;
    }
    let w = body.angular_velocity;
    // The velocity of a collider that circles its body's centre of mass changes direction.
    let spin = sqrt(dot(w, w)) * body.radius + 0.5 * dot(w, w) * time * body.center_offset;
    let fall = sqrt(dot(step.gravity, step.gravity)) * abs(body.gravity_scale);
    let push = (fall + body.force_acceleration + body.torque_acceleration) * time;
    return select(spin, spin + push, kind == t::DYNAMIC);
}
