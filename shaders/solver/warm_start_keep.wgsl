// Solver: what is kept of every pair until the next interval.
#import faceoff::dispatch::group_index
#import faceoff::solver_math::across
#import faceoff::solver_types as s

@group(0) @binding(0) var<uniform> interval: s::Interval;
@group(0) @binding(1) var<storage, read> solver_counters: array<u32>;
@group(0) @binding(2) var<storage, read> solver_pairs: array<s::SolverPair>;
@group(0) @binding(3) var<storage, read> shapes: array<s::PointShape>;
@group(0) @binding(4) var<storage, read> points: array<s::PointState>;
@group(0) @binding(5) var<storage, read> movers: array<s::Mover>;
@group(0) @binding(6) var<storage, read_write> kept_pairs: array<s::KeptPair>;
@group(0) @binding(7) var<storage, read_write> kept_points: array<s::KeptPoint>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= solver_counters[s::PAIRS] {
        return;
    }
    let pair = solver_pairs[i];
    var kept: s::KeptPair;
    kept.a = pair.a;
    kept.b = pair.b;
    kept.first = pair.first;
    if pair.a < interval.bodies && pair.b < interval.bodies {
        kept.count = pair.count;
        kept.rotation_a = movers[pair.a].rotation;
        kept.rotation_b = movers[pair.b].rotation;
    }
    kept.direction = pair.direction;
    kept.depenetrating = u32((pair.flags & s::DEPENETRATING) != 0u);
    kept_pairs[i] = kept;
    for (var k = pair.first; k < pair.first + kept.count; k += 1u) {
        let point = points[k];
        var old: s::KeptPoint;
        old.arm_a = shapes[k].arm_a;
        old.arm_b = shapes[k].arm_b;
        old.normal = point.normal;
        let side = across(point.normal);
        old.friction = side * point.friction.x + cross(point.normal, side) * point.friction.y;
        // What bounces has left, or is about to: the impulse that stopped it must not be given again.
        if (point.flags & s::POINT_USABLE) != 0u && point.bounce == 0.0 {
            old.impulse = point.impulse;
        }
        kept_points[k] = old;
    }
}
