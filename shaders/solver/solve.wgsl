// Solver: one pass over the points of every pair.
#import faceoff::contact as c
#import faceoff::contact::{solver_counters, interval, solver_pairs, points}
#import faceoff::dispatch::group_index
#import faceoff::friction::rub
#import faceoff::solver_types as s

// What the pass does beside solving.
@group(0) @binding(1) var<uniform> constants: vec4<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= solver_counters[s::PAIRS] {
        return;
    }
    let pair = solver_pairs[i];
    if (pair.flags & s::ACTIVE) == 0u {
        // It hands out nothing already.
        return;
    }
    if (constants.x & s::PASS_MEASURES) != 0u {
        for (var k = pair.first; k < pair.first + pair.count; k += 1u) {
            if (points[k].flags & s::POINT_ACTIVE) != 0u {
                points[k] = c::measured(pair, k);
            }
        }
    }
    var local = c::local_of(pair);
    for (var sweep = 0u; sweep < interval.sweeps; sweep += 1u) {
        for (var k = pair.first; k < pair.first + pair.count; k += 1u) {
            if (points[k].flags & s::POINT_ACTIVE) != 0u {
                solve(pair, k, &local);
            }
        }
    }
    c::hand_out(i, &local);
}

fn solve(pair: s::SolverPair, k: u32, local: ptr<function, c::Local>) {
    let point = points[k];
    let give = c::shared_give(local, point);
    if !(give.x > 0.0) {
        return;
    }
    let soft = softness(pair, point.separation);
    let along = c::row((*local).mass_a, (*local).mass_b, point, point.normal);
    let wanted = c::parting(local, along) + soft.x;
    let more = -interval.relaxation * soft.y * wanted / give.x - soft.z * point.impulse;
    let impulse = max(point.impulse + more, 0.0);
    c::push(local, along, impulse - point.impulse);
    points[k].impulse = impulse;
    points[k].largest = max(point.largest, impulse);

    let limit = select(pair.friction * impulse, 0.0, (pair.flags & s::DEPENETRATING) != 0u);
    points[k].friction = rub(local, point, give.y, point.friction, interval.relaxation, limit);
}

// The speed that a point asks for beyond none at all, the part of the rigid answer that is given, and the part of the
// impulse so far that is taken back.
fn softness(pair: s::SolverPair, separation: f32) -> vec3<f32> {
    if separation > 0.0 {
        // They may meet by the end of the substep, and no sooner.
        return vec3(separation / interval.h, 1.0, 0.0);
    }
    if (constants.x & s::PASS_BIASED) == 0u {
        return vec3(0.0, 1.0, 0.0);
    }
    if (pair.flags & s::DEPENETRATING) != 0u {
        // Slower towards the end, where the spring of other pairs is as fast.
        return vec3(max(interval.bias_rate * separation, -interval.deep_depenetration_speed), 1.0, 0.0);
    }
    let speed = max(interval.bias_rate * separation, -interval.max_depenetration_speed);
    return vec3(speed, interval.mass_scale, interval.impulse_scale);
}
