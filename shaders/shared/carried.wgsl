// The state of a body at the start of a step: what carries over from the last step, and what the host has changed.
#define_import_path faceoff::carried
#import faceoff::types as t

// `body` as the host sent it, with what carries over from `last`, its state after the last step.
fn carry_over(body: t::Body, last: t::Moved) -> t::Body {
    var next = body;
    next.position = carry_axes(body.carried, t::CARRIED_POSITION, last.position, body.position);
    next.linear_velocity = carry_axes(body.carried, t::CARRIED_LINEAR, last.linear_velocity, body.linear_velocity);
    next.angular_velocity = carry_axes(body.carried, t::CARRIED_ANGULAR, last.angular_velocity, body.angular_velocity);
    if (body.carried & t::CARRIED_ROTATION) != 0u {
        next.rotation = last.rotation;
    }
    return next;
}

// `compound` as the host sent it, with what carries over from `last`.
fn carry_over_compound(compound: t::Compound, last: t::Moved) -> t::Compound {
    let carried = compound.carried;
    var next = compound;
    next.position = carry_axes(carried, t::CARRIED_POSITION, last.position, compound.position);
    next.linear_velocity = carry_axes(carried, t::CARRIED_LINEAR, last.linear_velocity, compound.linear_velocity);
    next.angular_velocity = carry_axes(carried, t::CARRIED_ANGULAR, last.angular_velocity, compound.angular_velocity);
    if (carried & t::CARRIED_ROTATION) != 0u {
        next.rotation = last.rotation;
    }
    return next;
}

// Axis by axis: the value that the host sent, or the last value plus what the host adds.
fn carry_axes(carried: u32, first: u32, last: vec3<f32>, sent: vec3<f32>) -> vec3<f32> {
    let goes_on = (vec3(carried) & (vec3(1u, 2u, 4u) * first)) != vec3(0u);
    return select(sent, last + sent, goes_on);
}
