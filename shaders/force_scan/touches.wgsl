// ForceScan of a step with contacts, before bodies fall asleep: records which pairs touched, and where. The twin of
// `src/force_scan/touches.rs`. One thread per pair.
#import faceoff::dispatch::group_index
#import faceoff::solver_types as s
#import faceoff::types as t

@group(0) @binding(0) var<uniform> step: t::Step;
@group(0) @binding(1) var<storage, read> solver_counters: array<u32>;
@group(0) @binding(2) var<storage, read> solver_pairs: array<s::SolverPair>;
@group(0) @binding(3) var<storage, read> contact_points: array<t::ContactPoint>;
@group(0) @binding(4) var<storage, read> point_states: array<s::PointState>;
@group(0) @binding(5) var<storage, read> motion_states: array<s::MotionState>;
@group(0) @binding(6) var<storage, read> body_states: array<s::BodyState>;
@group(0) @binding(7) var<storage, read_write> tally: array<atomic<u32>>;
@group(0) @binding(8) var<storage, read_write> touches: array<t::Touch>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= solver_counters[s::ENTRIES] {
        return;
    }
    let pair = solver_pairs[i];
    if (pair.flags & s::VALID) == 0u || pair.count == 0u {
        return;
    }
    var nearest = pair.first;
    var has_impulse = false;
    for (var k = pair.first; k < pair.first + pair.count; k += 1u) {
        if contact_points[k].separation < contact_points[nearest].separation {
            nearest = k;
        }
        // Points of sleeping bodies have the impulse of their last solved substep.
        has_impulse |= impulse_of(point_states[k]) > 0.0 || point_states[k].normal_impulse > 0.0;
    }
    if !(has_impulse || contact_points[nearest].separation - contact_points[nearest].bulge <= pair.rest_offset) {
        return;
    }
    if pair.collider_b < step.bodies {
        atomicAdd(&tally[t::TOUCHING_NOW], 1u);
    }
    if (body_states[pair.a].mass.flags & body_states[pair.b].mass.flags & s::COMPLETED) != 0u {
        // The touch was recorded in the collision substeps of its bodies.
        return;
    }
    let first = atomicAdd(&tally[t::TOUCHES], pair.count);
    if first + pair.count > step.touch_capacity {
        return;
    }
    // At the start of the collision substep.
    let travel = body_states[pair.a].pose_change.translation;
    let center = motion_states[pair.a].center + (motion_states[pair.a].center_low - travel);
    let substep_number = atomicLoad(&tally[t::COLLISION_SUBSTEPS]);
    for (var k = 0u; k < pair.count; k += 1u) {
        let point = contact_points[pair.first + k];
        let middle = center + (point.anchor_a + point.normal * (0.5 * (point.separation - point.bulge)));
        let impulse = impulse_of(point_states[pair.first + k]);
        touches[first + k] = t::Touch(
            middle, pair.collider_a, point.normal, pair.collider_b, point.separation, impulse, substep_number, k
        );
    }
}

fn impulse_of(point: s::PointState) -> f32 {
    return point.total_normal_impulse + point.normal_impulse;
}
