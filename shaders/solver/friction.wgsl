#define_import_path faceoff::friction

// Coulomb friction: tangential impulses within Coulomb's cone. The twin of `src/solver/friction.rs`.

#import faceoff::contact as c
#import faceoff::solver_types as s

// The friction impulse that stops the sliding along the tangents of a point, clamped to the length `limit`.
fn friction_impulse(
    pair_velocities: ptr<function, c::PairVelocities>,
    before: vec2<f32>,
    first: s::Row,
    second: s::Row,
    limit: f32,
) -> vec2<f32> {
    let sliding = vec2(c::velocity_along(pair_velocities, first), c::velocity_along(pair_velocities, second));
    let impulse = before - (sliding + vec2(first.bias, second.bias)) * first.response;
    let square = dot(impulse, impulse);
    if square > limit * limit {
        return impulse * (limit / sqrt(square));
    }
    return impulse;
}
