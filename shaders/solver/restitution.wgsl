// Solver: one restitution pass (Newton's law of restitution), with the friction that follows from it. One thread per
// pair.
#import faceoff::constants::restitution::RESTITUTION_SWEEPS
#import faceoff::contact as c
#import faceoff::contact::{solver_counters, solver_pairs, point_states}
#import faceoff::dispatch::group_index
#import faceoff::friction::apply_friction
#import faceoff::solver_types as s

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= solver_counters[s::PAIRS] {
        return;
    }
    let pair = solver_pairs[i];
    if (pair.flags & s::ACTIVE) == 0u {
        return;
    }
    var pair_velocities = c::velocities_of(pair);
    for (var sweep = 0u; sweep < RESTITUTION_SWEEPS; sweep += 1u) {
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
    let normal_row = c::row((*pair_velocities).mass_a, (*pair_velocities).mass_b, point, point.normal);
    let velocity_error = c::velocity_along(pair_velocities, normal_row) + pair.restitution * point.impact_velocity;
    let impulse = max(point.restitution_impulse - velocity_error / inverse_effective_mass.x, 0.0);
    c::apply_impulse(pair_velocities, normal_row, impulse - point.restitution_impulse);
    point_states[k].restitution_impulse = impulse;
    point_states[k].restitution_friction_impulse = apply_friction(
        pair_velocities, point, inverse_effective_mass.y, point.restitution_friction_impulse, 1.0, pair.friction * impulse
    );
}
