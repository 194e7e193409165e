#define_import_path faceoff::contact

// The bindings that all functions over pairs share, and how impulses change the velocities of a pair's bodies. The twin
// of `PairVelocities` in `src/solver/solve.rs`.

#import faceoff::solver_types as s
#import faceoff::tensor::{apply_tensor, Tensor}

@group(0) @binding(0) var<uniform> collision_substep: s::CollisionSubstep;
@group(0) @binding(1) var<storage, read_write> solver_pairs: array<s::SolverPair>;
@group(0) @binding(2) var<storage, read> point_constants: array<s::PointConstants>;
@group(0) @binding(3) var<storage, read_write> point_states: array<s::PointState>;
@group(0) @binding(4) var<storage, read_write> body_states: array<s::BodyState>;

// The velocities of a pair's bodies during a pass, and how impulses change them.
struct PairVelocities {
    inverse_mass_a: vec3<f32>,
    inverse_mass_b: vec3<f32>,
    a: s::Velocity,
    b: s::Velocity,
}

// Velocities of these bodies.
fn velocities_of(a: u32, b: u32) -> PairVelocities {
    return PairVelocities(
        body_states[a].mass.inverse_mass,
        body_states[b].mass.inverse_mass,
        body_states[a].velocity,
        body_states[b].velocity,
    );
}

// Velocities of these bodies before the impulses of this substep.
fn initial_velocities_of(a: u32, b: u32) -> PairVelocities {
    return PairVelocities(
        body_states[a].mass.inverse_mass,
        body_states[b].mass.inverse_mass,
        body_states[a].initial_velocity,
        body_states[b].initial_velocity,
    );
}

fn angular_response(mass: s::Mass, moment: vec3<f32>) -> vec3<f32> {
    return apply_tensor(Tensor(mass.inverse_inertia, mass.inverse_inertia_off_diagonal), moment);
}

// The row along `direction` of impulses that act at these places, from each centre of mass.
fn row(mass_a: s::Mass, mass_b: s::Mass, anchor_a: vec3<f32>, anchor_b: vec3<f32>, direction: vec3<f32>) -> s::Row {
    var result: s::Row;
    result.direction = direction;
    result.moment_a = cross(anchor_a, direction);
    result.moment_b = cross(anchor_b, direction);
    result.angular_response_a = angular_response(mass_a, result.moment_a);
    result.angular_response_b = angular_response(mass_b, result.moment_b);
    result.inverse_effective_mass = dot((mass_a.inverse_mass + mass_b.inverse_mass) * direction, direction)
        + dot(result.moment_a, result.angular_response_a)
        + dot(result.moment_b, result.angular_response_b);
    return result;
}

// One more than the number of the last point that a pair may solve. In deep penetration that is the first point.
fn end_of_points(pair: s::SolverPair) -> u32 {
    return pair.first + select(pair.count, min(pair.count, 1u), (pair.flags & s::DEPENETRATING) != 0u);
}

// Velocity of the second body relative to the first along a row. Along the normal it is positive when they separate.
fn velocity_along(pair_velocities: ptr<function, PairVelocities>, r: s::Row) -> f32 {
    let a = (*pair_velocities).a;
    let b = (*pair_velocities).b;
    return dot(r.direction, b.linear - a.linear) + dot(r.moment_b, b.angular) - dot(r.moment_a, a.angular);
}

// Applies an impulse to the second body, and its opposite to the first.
fn apply_impulse(pair_velocities: ptr<function, PairVelocities>, r: s::Row, impulse: f32) {
    let linear = r.direction * impulse;
    (*pair_velocities).a.linear -= (*pair_velocities).inverse_mass_a * linear;
    (*pair_velocities).a.angular -= r.angular_response_a * impulse;
    (*pair_velocities).b.linear += (*pair_velocities).inverse_mass_b * linear;
    (*pair_velocities).b.angular += r.angular_response_b * impulse;
}

// Applies the impulses of a pair's points, times `factor`.
fn apply_impulses(pair: s::SolverPair, pair_velocities: ptr<function, PairVelocities>, factor: f32) {
    if (pair.flags & s::ACTIVE) == 0u {
        return;
    }
    for (var k = pair.first; k < end_of_points(pair); k += 1u) {
        if (point_states[k].flags & s::POINT_ACTIVE) == 0u {
            continue;
        }
        apply_impulse(pair_velocities, point_states[k].normal_row, factor * point_states[k].normal_impulse);
        let friction = factor * point_states[k].friction_impulse;
        if any(friction != vec2(0.0)) {
            apply_impulse(pair_velocities, point_states[k].first_tangent_row, friction.x);
            apply_impulse(pair_velocities, point_states[k].second_tangent_row, friction.y);
        }
    }
}
