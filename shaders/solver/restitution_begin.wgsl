// Solver: which pairs met fast enough to bounce.
#import faceoff::contact as c
#import faceoff::contact::{solver_counters, interval, solver_pairs, points}
#import faceoff::dispatch::group_index
#import faceoff::solver_types as s

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= solver_counters[s::PAIRS] {
        return;
    }
    c::hand_out_nothing(i);
    let pair = solver_pairs[i];
    var pushes = false;
    if (pair.flags & (s::FROZEN | s::DEPENETRATING)) == 0u && pair.restitution > 0.0 {
        for (var k = pair.first; k < pair.first + pair.count; k += 1u) {
            let point = points[k];
            let usable = (point.flags & s::POINT_USABLE) != 0u;
            if usable && point.impact < -interval.restitution_threshold && point.largest > 0.0 {
                pushes = true;
                points[k] = c::measured(pair, k);
                points[k].flags |= s::POINT_ACTIVE;
            } else {
                points[k].flags &= ~s::POINT_ACTIVE;
            }
        }
    }
    solver_pairs[i].flags = (pair.flags & ~s::ACTIVE) | select(0u, s::ACTIVE, pushes);
}
