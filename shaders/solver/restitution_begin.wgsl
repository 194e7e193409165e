// Solver: makes only the pairs active that met fast enough for restitution. One thread per pair.
#import faceoff::contact as c
#import faceoff::contact::{solver_counters, collision_substep, solver_pairs, point_states}
#import faceoff::dispatch::group_index
#import faceoff::solver_types as s

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= solver_counters[s::PAIRS] {
        return;
    }
    c::clear_impulses(i);
    let pair = solver_pairs[i];
    var any_active = false;
    if (pair.flags & (s::FROZEN | s::DEPENETRATING)) == 0u && pair.restitution > 0.0 {
        for (var k = pair.first; k < pair.first + pair.count; k += 1u) {
            let point = point_states[k];
            let valid = (point.flags & s::POINT_VALID) != 0u;
            let fast = point.impact_velocity < -collision_substep.restitution_threshold;
            if valid && fast && point.max_normal_impulse > 0.0 {
                any_active = true;
                point_states[k] = c::updated_point(pair, k);
                point_states[k].flags |= s::POINT_ACTIVE;
            } else {
                point_states[k].flags &= ~s::POINT_ACTIVE;
            }
        }
    }
    solver_pairs[i].flags = (pair.flags & ~s::ACTIVE) | select(0u, s::ACTIVE, any_active);
}
