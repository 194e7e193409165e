#define_import_path faceoff::margins

// How far bodies look for each other; `stages/manifolds/margins.rs` explains it. `Step::look_ahead` holds the safety that
// is on top of what they move.

#import faceoff::types as t

// The body, with reach and travel as its velocities now are.
fn with_reach(step: t::Step, body: t::Body) -> t::Body {
    var placed = body;
    let kind = body.flags & t::KIND_MASK;
    let v = body.linear_velocity;
    let w = body.angular_velocity;
    var speed = sqrt(dot(v, v)) + sqrt(dot(w, w)) * body.radius;
    if kind == t::STATIC {
        speed = 0.0;
    } else if kind == t::DYNAMIC {
        speed += sqrt(dot(step.gravity, step.gravity)) * abs(body.gravity_scale) * step.dt;
    }
    placed.travel = speed * step.look_ahead;
    placed.reach = body.radius + step.contact_margin * body.radius + min(placed.travel, 2.0 * body.radius);
    return placed;
}

// How near the surfaces of two bodies must come for points to be found, metres.
fn margin_of(step: t::Step, a: t::Body, b: t::Body) -> f32 {
    let diameter = 2.0 * min(a.radius, b.radius);
    return step.contact_margin * diameter + min(a.travel + b.travel, diameter);
}
