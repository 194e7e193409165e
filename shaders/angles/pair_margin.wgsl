#define_import_path faceoff::pair_margin

// The speculative margin of a pair. The twin of `SpeculativeMargins::of_pair` in `src/state/margins.rs`.

#import faceoff::arm::{arm_within, relative_speed}
#import faceoff::constants::shared::BOUND
#import faceoff::margins::{sway, sway_at}
#import faceoff::types as t

// The speculative margin of a pair, metres.
fn speculative_margin(step: t::Step, a: t::Body, b: t::Body) -> f32 {
    let at_rest = step.contact_margin * 2.0 * min(a.radius, b.radius);
    let time = max(a.travel_time, b.travel_time);
    let sways = sway_near(step, a, b, time, at_rest) + sway_near(step, b, a, time, at_rest);
    let travel = (relative_speed(a, b) + sways) * (step.travel_scale * time);
    return at_rest + min(travel, BOUND * min(a.thickness, b.thickness));
}

// The sway of a body's surface where the other may touch it, m/s, or a larger number where that adds little to the
// margin.
fn sway_near(step: t::Step, own: t::Body, other: t::Body, time: f32, at_rest: f32) -> f32 {
    let spin = sqrt(dot(own.angular_velocity, own.angular_velocity)) * own.radius;
    if (own.flags & t::KIND_MASK) == t::STATIC || spin * (step.travel_scale * time) <= at_rest {
        return sway(step, own, time);
    }
    return sway_at(step, own, time, arm_within(step, own, other, time));
}
