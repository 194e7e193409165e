#define_import_path faceoff::friction

// Coulomb friction: tangential impulses within Coulomb's cone. The twin of `src/solver/friction.rs`.

#import faceoff::contact as c
#import faceoff::solver_math::tangent
#import faceoff::solver_types as s

// Applies the friction impulse that stops the sliding at a point, clamped to the length `limit`, and returns it.
// `friction_impulse` is the impulse so far, `relaxation` the fraction of the correction that is applied.
fn apply_friction(
    pair_velocities: ptr<function, c::PairVelocities>,
    point: s::PointState,
    inverse_effective_mass: f32,
    friction_impulse: vec2<f32>,
    relaxation: f32,
    limit: f32,
) -> vec2<f32> {
    if !(inverse_effective_mass > 0.0) {
        return friction_impulse;
    }
    let mass_a = (*pair_velocities).mass_a;
    let mass_b = (*pair_velocities).mass_b;
    let first_tangent = tangent(point.normal);
    let first_row = c::row(mass_a, mass_b, point, first_tangent);
    let second_row = c::row(mass_a, mass_b, point, cross(point.normal, first_tangent));
    let sliding = vec2(c::velocity_along(pair_velocities, first_row), c::velocity_along(pair_velocities, second_row));
    var impulse = friction_impulse - (relaxation / inverse_effective_mass) * sliding;
    let square = dot(impulse, impulse);
    if square > limit * limit {
        impulse *= limit / sqrt(square);
    }
    c::apply_impulse(pair_velocities, first_row, impulse.x - friction_impulse.x);
    c::apply_impulse(pair_velocities, second_row, impulse.y - friction_impulse.y);
    return impulse;
}
