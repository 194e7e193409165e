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

// Upper bound of the speed that rotation, gravity and external forces add to a body's surface within this time, m/s.
fn sway(step: t::Step, body: t::Body, time: f32) -> f32 {
    return sway_at(step, body, time, body.radius);
}

// `sway` of the surface within `arm` metres of the axis of rotation.
fn sway_at(step: t::Step, body: t::Body, time: f32, arm: f32) -> f32 {
    let kind = body.flags & t::KIND_MASK;
    if kind == t::STATIC {
        return 0.0;
    }
    let w = body.angular_velocity;
    // The velocity of a collider that circles its body's centre of mass changes direction.
    let spin = sqrt(dot(w, w)) * arm + 0.5 * dot(w, w) * time * body.center_offset;
    let fall = sqrt(dot(step.gravity, step.gravity)) * abs(body.gravity_scale);
    let push = (fall + body.force_acceleration + body.torque_acceleration) * time;
    return select(spin, spin + push, kind == t::DYNAMIC);
}
