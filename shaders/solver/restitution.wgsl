// Solver: one pass that turns round the speed at which a pair's points met (Newton's law of impact), with the friction that
// goes with it.
#import faceoff::constants::solver::RESTITUTION_SWEEPS
#import faceoff::contact as c
#import faceoff::contact::{solver_counters, solver_pairs, points}
#import faceoff::dispatch::group_index
#import faceoff::friction::rub
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
    var local = c::local_of(pair);
    for (var sweep = 0u; sweep < RESTITUTION_SWEEPS; sweep += 1u) {
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
    let along = c::row((*local).mass_a, (*local).mass_b, point, point.normal);
    let wanted = c::parting(local, along) + pair.restitution * point.impact;
    let impulse = max(point.bounce - wanted / give.x, 0.0);
    c::push(local, along, impulse - point.bounce);
    points[k].bounce = impulse;
    points[k].bounce_friction = rub(local, point, give.y, point.bounce_friction, 1.0, pair.friction * impulse);
}
