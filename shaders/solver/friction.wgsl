#define_import_path faceoff::friction

// Coulomb friction: tangential impulses within Coulomb's cone. The twin of `src/solver/friction.rs`.

#import faceoff::contact as c
#import faceoff::contact::point_states

// The friction impulse that stops the sliding at a point, clamped to the length `limit`. If the point `keeps_place`, it
// is at rest in the mean of the substep.
fn friction_impulse(
    pair_velocities: ptr<function, c::PairVelocities>,
    k: u32,
    rows: array<c::Row, 2>,
    limit: f32,
    keeps_place: bool,
) -> vec2<f32> {
    let before = point_states[k].friction_impulse;
    let inverse_effective_mass = point_states[k].inverse_effective_mass.y;
    if !(inverse_effective_mass > 0.0) {
        return before;
    }
    let drift = select(vec2(0.0), point_states[k].drift, keeps_place);
    let sliding = vec2(c::velocity_along(pair_velocities, rows[0]), c::velocity_along(pair_velocities, rows[1])) + drift;
    let impulse = before - sliding / inverse_effective_mass;
    let square = dot(impulse, impulse);
    if square > limit * limit {
        return impulse * (limit / sqrt(square));
    }
    return impulse;
}
