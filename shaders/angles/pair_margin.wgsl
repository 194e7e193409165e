#define_import_path faceoff::pair_margin

// The speculative margin of a pair. The twin of `SpeculativeMargins::of_pair` in `src/state/margins.rs`.

#import faceoff::arm::arm
#import faceoff::constants::shared::BOUND
#import faceoff::margins::{sway, sway_at}
#import faceoff::types as t

// The speculative margin of a pair, metres.
fn speculative_margin(step: t::Step, a: t::Body, b: t::Body) -> f32 {
    let at_rest = step.contact_margin * 2.0 * min(a.radius, b.radius);
    let v = velocity(b) - velocity(a);
    let relative = sqrt(dot(v, v));
    let time = max(a.travel_time, b.travel_time);
    let travel_time = step.travel_scale * time;
    let whole_a = sway(step, a, time);
    let whole_b = sway(step, b, time);
    let near_a = sway_near(step, a, b, time, at_rest, whole_a, relative + whole_b);
    let near_b = sway_near(step, b, a, time, at_rest, whole_b, relative + whole_a);
    let travel = (relative + near_a + near_b) * travel_time;
    return at_rest + min(travel, BOUND * min(a.thickness, b.thickness));
}

// The sway of a body's surface where the other may touch it, m/s. `whole` is that of all of it; points of the other move no
// faster than `speed` relative to its centre, but for what forces add.
fn sway_near(step: t::Step, own: t::Body, other: t::Body, time: f32, at_rest: f32, whole: f32, speed: f32) -> f32 {
    let travel_time = step.travel_scale * time;
    let spin = sqrt(dot(own.angular_velocity, own.angular_velocity)) * own.radius;
    // Where rotation adds little, a smaller margin saves less than it costs to know.
    if whole == 0.0 || spin * travel_time <= at_rest {
        return whole;
    }
    let motion = (speed + sway_at(step, own, time, 0.0)) * travel_time;
    return sway_at(step, own, time, arm(own, other, motion));
}

fn velocity(body: t::Body) -> vec3<f32> {
    return select(body.linear_velocity, vec3(0.0), (body.flags & t::KIND_MASK) == t::STATIC);
}
