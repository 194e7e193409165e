#define_import_path faceoff::contact

// One pass over one pair: from the velocities of its two bodies to an impulse for each. The twin of
// `src/solver/solve.rs`.
//
// The bindings that all kernels over pairs share are declared here.

#import faceoff::solver_math::{tangent, rotation_displacement}
#import faceoff::solver_types as s
#import faceoff::tensor::{apply_tensor, Tensor}
#import faceoff::types as t

@group(0) @binding(0) var<uniform> collision_substep: s::CollisionSubstep;
@group(0) @binding(2) var<storage, read> solver_counters: array<u32>;
@group(0) @binding(3) var<storage, read_write> solver_pairs: array<s::SolverPair>;
@group(0) @binding(4) var<storage, read> point_constants: array<s::PointConstants>;
@group(0) @binding(5) var<storage, read_write> point_states: array<s::PointState>;
@group(0) @binding(6) var<storage, read> masses: array<s::Mass>;
@group(0) @binding(7) var<storage, read> pose_changes: array<s::PoseChange>;
@group(0) @binding(8) var<storage, read> velocities: array<s::Velocity>;
// Two per pair: the impulse on its first body and on its second.
@group(0) @binding(9) var<storage, read_write> side_impulses: array<t::Impulse>;

// The velocities of a pair's bodies during a pass, and the impulses it has applied so far. Each body has only this
// pair's part of its mass.
struct PairVelocities {
    mass_a: s::Mass,
    mass_b: s::Mass,
    a: s::Velocity,
    b: s::Velocity,
    // Linear impulse on the second body; the first body gets the opposite.
    linear: vec3<f32>,
    angular_a: vec3<f32>,
    angular_b: vec3<f32>,
}

// The normal or a tangent of a point, with the Jacobian along it.
struct Row {
    direction: vec3<f32>,
    // The moment of a unit impulse about each centre of mass.
    moment_a: vec3<f32>,
    moment_b: vec3<f32>,
    // The change of angular velocity by that moment.
    angular_response_a: vec3<f32>,
    angular_response_b: vec3<f32>,
}

fn velocities_of(pair: s::SolverPair) -> PairVelocities {
    var pair_velocities: PairVelocities;
    pair_velocities.mass_a = masses[pair.a];
    pair_velocities.mass_b = masses[pair.b];
    pair_velocities.a = velocities[pair.a];
    pair_velocities.b = velocities[pair.b];
    return pair_velocities;
}

fn angular_response(mass: s::Mass, moment: vec3<f32>) -> vec3<f32> {
    return apply_tensor(Tensor(mass.inverse_inertia, mass.inverse_inertia_off_diagonal), moment);
}

fn row(mass_a: s::Mass, mass_b: s::Mass, point: s::PointState, direction: vec3<f32>) -> Row {
    let moment_a = cross(point.impulse_anchor_a, direction);
    let moment_b = cross(point.impulse_anchor_b, direction);
    return Row(direction, moment_a, moment_b, angular_response(mass_a, moment_a), angular_response(mass_b, moment_b));
}

// The inverse effective mass of each body along a row.
fn inverse_effective_masses(mass_a: s::Mass, mass_b: s::Mass, r: Row) -> vec2<f32> {
    let d = r.direction;
    return vec2(
        dot(mass_a.inverse_mass * d, d) + dot(r.moment_a, r.angular_response_a),
        dot(mass_b.inverse_mass * d, d) + dot(r.moment_b, r.angular_response_b),
    );
}

// A point at the present poses: its separation, normal, anchors and effective masses.
fn updated_point(pair: s::SolverPair, k: u32) -> s::PointState {
    var point = point_states[k];
    let constants = point_constants[k];
    let translation = pose_changes[pair.b].translation - pose_changes[pair.a].translation;
    if (pair.flags & s::DEPENETRATING) != 0u {
        point.separation = constants.initial_separation + dot(point.normal, translation);
        point.impulse_anchor_a = vec3(0.0);
        point.impulse_anchor_b = vec3(0.0);
    } else {
        let displacement_a = rotation_displacement(pose_changes[pair.a].rotation, constants.curvature_center_a);
        let displacement_b = rotation_displacement(pose_changes[pair.b].rotation, constants.curvature_center_b);
        let displacement = translation + displacement_b - displacement_a;
        // The normal of curved surfaces that have not touched yet rotates as that of two balls that pass each other:
        // their impulse acts along the normal at the moment of contact.
        if constants.normal_rotation > 0.0 && point.max_normal_impulse == 0.0 && point.normal_impulse == 0.0 {
            let normal = constants.initial_normal + constants.normal_rotation * displacement;
            let square = dot(normal, normal);
            if square > 0.0 {
                point.normal = normal / sqrt(square);
            }
        }
        point.separation = constants.initial_separation + dot(point.normal, displacement);
        if constants.normal_rotation > 0.0 {
            // The distance between the centres of curvature is shorter along the rotated normal.
            let change_of_normal = point.normal - constants.initial_normal;
            point.separation -= 0.5 * dot(change_of_normal, change_of_normal) / constants.normal_rotation;
        }
        // Both impulses act at one position. Otherwise they would exert a moment on the pair.
        let offset = constants.anchor_offset + displacement;
        point.impulse_anchor_a = constants.anchor_a + displacement_a + constants.contact_fraction * offset;
        point.impulse_anchor_b = constants.anchor_b + displacement_b - (1.0 - constants.contact_fraction) * offset;
    }
    let mass_a = masses[pair.a];
    let mass_b = masses[pair.b];
    let first_tangent = tangent(point.normal);
    let second_tangent = cross(point.normal, first_tangent);
    let normal = inverse_effective_masses(mass_a, mass_b, row(mass_a, mass_b, point, point.normal));
    let one = inverse_effective_masses(mass_a, mass_b, row(mass_a, mass_b, point, first_tangent));
    let other = inverse_effective_masses(mass_a, mass_b, row(mass_a, mass_b, point, second_tangent));
    // Both tangents use the same value. Otherwise friction would not point against the sliding direction.
    let tangential = max(one, other);
    point.inverse_effective_mass = vec4(normal.x, tangential.x, normal.y, tangential.y);
    return point;
}

// The inverse effective mass of a point along the normal and along the tangents, with mass splitting.
fn split_inverse_effective_mass(pair_velocities: ptr<function, PairVelocities>, point: s::PointState) -> vec2<f32> {
    let split_a = (*pair_velocities).mass_a.split_count;
    let split_b = (*pair_velocities).mass_b.split_count;
    return split_a * point.inverse_effective_mass.xy + split_b * point.inverse_effective_mass.zw;
}

// Velocity of the second body relative to the first along a row. Along the normal it is positive when they separate.
fn velocity_along(pair_velocities: ptr<function, PairVelocities>, r: Row) -> f32 {
    let a = (*pair_velocities).a;
    let b = (*pair_velocities).b;
    return dot(r.direction, b.linear - a.linear) + dot(r.moment_b, b.angular) - dot(r.moment_a, a.angular);
}

// Adds an impulse on the second body, and its opposite on the first, to the pair's impulses. Velocities stay the same.
fn accumulate(pair_velocities: ptr<function, PairVelocities>, r: Row, impulse: f32) {
    (*pair_velocities).linear += r.direction * impulse;
    (*pair_velocities).angular_a -= r.moment_a * impulse;
    (*pair_velocities).angular_b += r.moment_b * impulse;
}

// Applies an impulse to the second body, and its opposite to the first.
fn apply_impulse(pair_velocities: ptr<function, PairVelocities>, r: Row, impulse: f32) {
    accumulate(pair_velocities, r, impulse);
    let linear = r.direction * impulse;
    let split_a = (*pair_velocities).mass_a.split_count;
    let split_b = (*pair_velocities).mass_b.split_count;
    (*pair_velocities).a.linear -= split_a * (*pair_velocities).mass_a.inverse_mass * linear;
    (*pair_velocities).a.angular -= r.angular_response_a * (split_a * impulse);
    (*pair_velocities).b.linear += split_b * (*pair_velocities).mass_b.inverse_mass * linear;
    (*pair_velocities).b.angular += r.angular_response_b * (split_b * impulse);
}

// Writes the sum of the pair's impulses on each body.
fn write_impulses(i: u32, pair_velocities: ptr<function, PairVelocities>) {
    side_impulses[2u * i] = t::Impulse(-(*pair_velocities).linear, 0.0, (*pair_velocities).angular_a, 0.0);
    side_impulses[2u * i + 1u] = t::Impulse((*pair_velocities).linear, 0.0, (*pair_velocities).angular_b, 0.0);
}

fn clear_impulses(i: u32) {
    side_impulses[2u * i] = t::Impulse(vec3(0.0), 0.0, vec3(0.0), 0.0);
    side_impulses[2u * i + 1u] = t::Impulse(vec3(0.0), 0.0, vec3(0.0), 0.0);
}
