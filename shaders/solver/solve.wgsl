// Solver: one pass over the active points of every pair. One thread per pair.
#import faceoff::contact as c
#import faceoff::contact::{solver_counters, collision_substep, solver_pairs, point_states}
#import faceoff::dispatch::group_index
#import faceoff::friction::apply_friction
#import faceoff::solver_types as s

// x: the bits `PASS_...`.
@group(0) @binding(1) var<uniform> constants: vec4<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= solver_counters[s::PAIRS] {
        return;
    }
    let pair = solver_pairs[i];
    if (pair.flags & s::ACTIVE) == 0u {
        // Its impulses are zero already.
        return;
    }
    if (constants.x & s::PASS_UPDATES_POINTS) != 0u {
        for (var k = pair.first; k < pair.first + pair.count; k += 1u) {
            if (point_states[k].flags & s::POINT_ACTIVE) != 0u {
                point_states[k] = c::updated_point(pair, k);
            }
        }
    }
    var pair_velocities = c::velocities_of(pair);
    for (var sweep = 0u; sweep < collision_substep.sweeps; sweep += 1u) {
        for (var k = pair.first; k < pair.first + pair.count; k += 1u) {
            if (point_states[k].flags & s::POINT_ACTIVE) != 0u {
                solve(pair, k, &pair_velocities);
            }
        }
    }
    c::write_impulses(i, &pair_velocities);
}

fn solve(pair: s::SolverPair, k: u32, pair_velocities: ptr<function, c::PairVelocities>) {
    let point = point_states[k];
    let inverse_effective_mass = c::split_inverse_effective_mass(pair_velocities, point);
    if !(inverse_effective_mass.x > 0.0) {
        return;
    }
    let bias = bias_of(pair, point.separation);
    let normal_row = c::row((*pair_velocities).mass_a, (*pair_velocities).mass_b, point, point.normal);
    let velocity_error = c::velocity_along(pair_velocities, normal_row) + bias.speed;
    let change = -collision_substep.relaxation * bias.mass_scale * velocity_error / inverse_effective_mass.x
        - bias.impulse_scale * point.normal_impulse;
    let impulse = max(point.normal_impulse + change, 0.0);
    c::apply_impulse(pair_velocities, normal_row, impulse - point.normal_impulse);
    point_states[k].normal_impulse = impulse;
    point_states[k].max_normal_impulse = max(point.max_normal_impulse, impulse);

    let limit = select(pair.friction * impulse, 0.0, (pair.flags & s::DEPENETRATING) != 0u);
    point_states[k].friction_impulse = apply_friction(
        pair_velocities, point, inverse_effective_mass.y, point.friction_impulse, collision_substep.relaxation, limit
    );
}

// The bias velocity of a point, and the softness of its constraint.
struct Bias {
    speed: f32,
    mass_scale: f32,
    impulse_scale: f32,
}

fn bias_of(pair: s::SolverPair, separation: f32) -> Bias {
    if separation > 0.0 {
        // Speculative contact: the gap may close by the end of the substep, and no sooner.
        return Bias(separation / collision_substep.h, 1.0, 0.0);
    }
    if (constants.x & s::PASS_BIASED) == 0u {
        return Bias(0.0, 1.0, 0.0);
    }
    let spring_speed = collision_substep.bias_rate * separation;
    if (pair.flags & s::DEPENETRATING) != 0u {
        // Near the surface the bias falls below the maximum, to that of the contact spring of other pairs.
        return Bias(max(spring_speed, -collision_substep.deep_depenetration_speed), 1.0, 0.0);
    }
    let speed = max(spring_speed, -collision_substep.max_depenetration_speed);
    return Bias(speed, collision_substep.mass_scale, collision_substep.impulse_scale);
}
