// Solver: every pair measures its points, finds out which of them push, and gives the impulses of the last substep again.
#import faceoff::constants::solver::ACTIVATION_DISTANCE
#import faceoff::contact as c
#import faceoff::contact::{solver_counters, interval, solver_pairs, points}
#import faceoff::dispatch::group_index
#import faceoff::solver_math::across
#import faceoff::solver_types as s

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= solver_counters[s::PAIRS] {
        return;
    }
    let pair = solver_pairs[i];
    if (pair.flags & s::FROZEN) != 0u {
        c::hand_out_nothing(i);
        return;
    }
    var pushes = false;
    var local = c::local_of(pair);
    for (var k = pair.first; k < pair.first + pair.count; k += 1u) {
        if (points[k].flags & s::POINT_USABLE) == 0u {
            continue;
        }
        var point = c::measured(pair, k);
        // As fast as before anything was pushed: what is pushed here shows in the next pass.
        let along = c::row(local.mass_a, local.mass_b, point, point.normal);
        let speed = c::parting(&local, along);
        point.total += point.impulse;
        if point.largest == 0.0 {
            point.impact = speed;
        }
        if point.impulse > 0.0 || point.separation + speed * interval.h < ACTIVATION_DISTANCE * pair.rest_offset {
            pushes = true;
            point.flags |= s::POINT_ACTIVE;
            let side = across(point.normal);
            c::note(&local, along, point.impulse);
            c::note(&local, c::row(local.mass_a, local.mass_b, point, side), point.friction.x);
            let other = cross(point.normal, side);
            c::note(&local, c::row(local.mass_a, local.mass_b, point, other), point.friction.y);
        } else {
            point.flags &= ~s::POINT_ACTIVE;
            point.impulse = 0.0;
            point.friction = vec2(0.0);
        }
        points[k] = point;
    }
    solver_pairs[i].flags = (pair.flags & ~s::ACTIVE) | select(0u, s::ACTIVE, pushes);
    c::hand_out(i, &local);
}
