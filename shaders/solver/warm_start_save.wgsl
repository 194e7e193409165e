// Solver: saves pairs, points and impulses for the next collision substep. One thread per pair.
#import faceoff::dispatch::group_index
#import faceoff::math::tangent
#import faceoff::solver_types as s

@group(0) @binding(0) var<uniform> collision_substep: s::CollisionSubstep;
@group(0) @binding(1) var<storage, read> solver_counters: array<u32>;
@group(0) @binding(2) var<storage, read> solver_pairs: array<s::SolverPair>;
@group(0) @binding(3) var<storage, read> point_constants: array<s::PointConstants>;
@group(0) @binding(4) var<storage, read> point_states: array<s::PointState>;
@group(0) @binding(5) var<storage, read> body_constants: array<s::BodyConstants>;
@group(0) @binding(6) var<storage, read_write> saved_pairs: array<s::SavedPair>;
@group(0) @binding(7) var<storage, read_write> saved_points: array<s::SavedPoint>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= solver_counters[s::PAIRS] {
        return;
    }
    let pair = solver_pairs[i];
    var saved_pair: s::SavedPair;
    saved_pair.a = pair.collider_a;
    saved_pair.b = pair.collider_b;
    saved_pair.first = pair.first;
    if pair.a < collision_substep.bodies && pair.b < collision_substep.bodies {
        saved_pair.count = pair.count;
        saved_pair.rotation_a = body_constants[pair.a].initial_rotation;
        saved_pair.rotation_b = body_constants[pair.b].initial_rotation;
    }
    saved_pair.separating_direction = pair.separating_direction;
    saved_pair.substep = pair.substep;
    saved_pair.depenetrating = u32((pair.flags & s::DEPENETRATING) != 0u);
    saved_pairs[i] = saved_pair;
    for (var k = pair.first; k < pair.first + saved_pair.count; k += 1u) {
        let point = point_states[k];
        var saved_point: s::SavedPoint;
        saved_point.anchor_a = point_constants[k].anchor_a;
        saved_point.anchor_b = point_constants[k].anchor_b;
        saved_point.normal = point.normal;
        let first_tangent = tangent(point.normal);
        let second_tangent = cross(point.normal, first_tangent);
        saved_point.friction_impulse =
            first_tangent * point.friction_impulse.x + second_tangent * point.friction_impulse.y;
        if (pair.flags & s::KEPT) != 0u {
            // To the bit: the tangents would round it.
            saved_point.friction_impulse = point.search;
        }
        // A point with restitution separates: the impulse of its impact must not be applied again.
        if (point.flags & (s::POINT_VALID | s::BOUNCED)) == s::POINT_VALID {
            saved_point.normal_impulse = point.normal_impulse;
        }
        saved_points[k] = saved_point;
    }
}
