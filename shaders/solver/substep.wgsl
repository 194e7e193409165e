// Solver, at the start of a substep: updates the points, decides which are active, and applies the impulses of the last
// substep again. One thread per pair.
#import faceoff::constants::solver::ACTIVATION_DISTANCE
#import faceoff::contact as c
#import faceoff::contact::{solver_counters, collision_substep, solver_pairs, point_states}
#import faceoff::dispatch::group_index
#import faceoff::solver_math::tangent
#import faceoff::solver_types as s

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= solver_counters[s::PAIRS] {
        return;
    }
    let pair = solver_pairs[i];
    if (pair.flags & s::FROZEN) != 0u {
        c::clear_impulses(i);
        return;
    }
    var any_active = false;
    var pair_velocities = c::velocities_of(pair);
    for (var k = pair.first; k < pair.first + pair.count; k += 1u) {
        if (point_states[k].flags & s::POINT_VALID) == 0u {
            continue;
        }
        var point = c::updated_point(pair, k);
        // All points are judged by the velocities before the warm start: its impulses change them only after this pass.
        let normal_row = c::row(pair_velocities.mass_a, pair_velocities.mass_b, point, point.normal);
        let normal_velocity = c::velocity_along(&pair_velocities, normal_row);
        point.total_normal_impulse += point.normal_impulse;
        if point.max_normal_impulse == 0.0 {
            point.impact_velocity = normal_velocity;
        }
        let next_separation = point.separation + normal_velocity * collision_substep.h;
        if point.normal_impulse > 0.0 || next_separation < ACTIVATION_DISTANCE * pair.rest_offset {
            any_active = true;
            point.flags |= s::POINT_ACTIVE;
            let first_tangent = tangent(point.normal);
            c::accumulate(&pair_velocities, normal_row, point.normal_impulse);
            let first_row = c::row(pair_velocities.mass_a, pair_velocities.mass_b, point, first_tangent);
            c::accumulate(&pair_velocities, first_row, point.friction_impulse.x);
            let second_tangent = cross(point.normal, first_tangent);
            let second_row = c::row(pair_velocities.mass_a, pair_velocities.mass_b, point, second_tangent);
            c::accumulate(&pair_velocities, second_row, point.friction_impulse.y);
        } else {
            point.flags &= ~s::POINT_ACTIVE;
            point.normal_impulse = 0.0;
            point.friction_impulse = vec2(0.0);
        }
        point_states[k] = point;
    }
    solver_pairs[i].flags = (pair.flags & ~s::ACTIVE) | select(0u, s::ACTIVE, any_active);
    c::write_impulses(i, &pair_velocities);
}
