// Solver: the points of every pair, ready to be solved, with last interval's impulses where they fit.
#import faceoff::constants::solver::{MAX_IMPULSE_SCALE, MAX_MATCHED}
#import faceoff::dispatch::group_index
#import faceoff::math::{compose, conjugate, rotate}
#import faceoff::overlap as o
#import faceoff::overlap::{contact_points, interval, kept_pairs, kept_points}
#import faceoff::solver_math::{across, finite, finite_vector}
#import faceoff::solver_types as s
#import faceoff::types as t

@group(0) @binding(1) var<storage, read> solver_counters: array<u32>;
@group(0) @binding(3) var<storage, read_write> solver_pairs: array<s::SolverPair>;
@group(0) @binding(6) var<storage, read> movers: array<s::Mover>;
@group(0) @binding(7) var<storage, read_write> shapes: array<s::PointShape>;
@group(0) @binding(8) var<storage, read_write> points: array<s::PointState>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= solver_counters[s::PAIRS] {
        return;
    }
    var pair = solver_pairs[i];
    for (var k = pair.first; k < pair.first + pair.count; k += 1u) {
        shapes[k] = no_shape();
        points[k] = no_point();
    }
    if (pair.flags & s::VALID) == 0u {
        return;
    }
    let overlap = o::judge(pair);
    if overlap.kind == o::TANGLED && (pair.flags & s::FROZEN) == 0u {
        solver_pairs[i].flags |= s::DEPENETRATING;
        // One point, which pushes the centres themselves apart.
        var deepest = 0.0;
        for (var k = pair.first; k < pair.first + pair.count; k += 1u) {
            deepest = min(deepest, contact_points[k].separation);
        }
        shapes[pair.first].first_separation = deepest - pair.rest_offset;
        points[pair.first].normal = overlap.direction;
        points[pair.first].flags = s::POINT_USABLE;
        return;
    }
    if overlap.kind == o::DISPUTED {
        pair.direction = overlap.direction;
        solver_pairs[i].direction = overlap.direction;
    }
    fill(pair);
}

fn no_shape() -> s::PointShape {
    var shape: s::PointShape;
    shape.along = 0.5;
    return shape;
}

fn no_point() -> s::PointState {
    var point: s::PointState;
    point.normal = vec3(1.0, 0.0, 0.0);
    return point;
}

fn fill(pair: s::SolverPair) {
    // How to turn the bodies back to where they were.
    var back_a = vec4(0.0, 0.0, 0.0, 1.0);
    var back_b = back_a;
    var old: s::KeptPair;
    let swapped = (pair.flags & s::SWAPPED) != 0u;
    if pair.kept != s::NOT_KEPT {
        old = kept_pairs[pair.kept];
        if old.depenetrating != 0u {
            old.count = 0u;
        }
        let first = select(old.rotation_a, old.rotation_b, swapped);
        let second = select(old.rotation_b, old.rotation_a, swapped);
        back_a = compose(first, conjugate(movers[pair.a].rotation));
        back_b = compose(second, conjugate(movers[pair.b].rotation));
    }
    let substep = bitcast<f32>(solver_counters[s::KEPT_SUBSTEP]);
    // What holds up a weight is proportional to time.
    let growth = select(1.0, min(interval.h / max(substep, 1.0e-30), MAX_IMPULSE_SCALE), substep > 0.0);
    let reach = interval.match_distance * pair.diameter;
    // A bit for each old point that is given away.
    var taken = vec2(0u);
    for (var k = pair.first; k < pair.first + pair.count; k += 1u) {
        let contact = contact_points[k];
        let left_out = contact.separation < 0.0 && dot(contact.normal, pair.direction) < 0.0;
        if left_out || !is_sound(contact) {
            continue;
        }
        shapes[k] = shape_of(pair, contact);
        var point = no_point();
        point.normal = contact.normal;
        point.flags = s::POINT_USABLE;
        let arm_a = rotate(back_a, contact.arm_a);
        let arm_b = rotate(back_b, contact.arm_b);
        // The nearest old point, as near as either body sees it: what slides along one body rests on the other.
        var nearest = reach * reach;
        var found = s::NOT_KEPT;
        for (var j = 0u; j < min(old.count, MAX_MATCHED); j += 1u) {
            let kept = kept_points[old.first + j];
            let turned = o::sign_of(pair) * dot(kept.normal, contact.normal);
            if ((taken[j / 32u] >> (j % 32u)) & 1u) != 0u || kept.impulse <= 0.0 || turned < interval.match_normal {
                continue;
            }
            let first = arm_a - select(kept.arm_a, kept.arm_b, swapped);
            let second = arm_b - select(kept.arm_b, kept.arm_a, swapped);
            let distance = min(dot(first, first), dot(second, second));
            if distance < nearest {
                nearest = distance;
                found = j;
            }
        }
        if found != s::NOT_KEPT {
            taken[found / 32u] |= 1u << (found % 32u);
            let kept = kept_points[old.first + found];
            point.impulse = growth * kept.impulse;
            // Belongs to the last interval.
            point.total = -point.impulse;
            let friction = growth * o::sign_of(pair) * kept.friction;
            let side = across(contact.normal);
            point.friction = vec2(dot(side, friction), dot(cross(contact.normal, side), friction));
        }
        points[k] = point;
    }
}

fn is_sound(contact: t::ContactPoint) -> bool {
    let square = dot(contact.normal, contact.normal);
    return finite_vector(contact.normal)
        && abs(square - 1.0) <= 2.0e-4
        && finite(contact.separation)
        && finite(contact.turn)
        && finite_vector(contact.arm_a)
        && finite_vector(contact.arm_b);
}

fn shape_of(pair: s::SolverPair, contact: t::ContactPoint) -> s::PointShape {
    var shape = no_shape();
    shape.arm_a = contact.arm_a;
    shape.arm_b = contact.arm_b;
    shape.round_a = curvature_center(contact.arm_a, contact.normal, contact.roundness_a);
    shape.round_b = curvature_center(contact.arm_b, -contact.normal, contact.roundness_b);
    shape.offset = pair.between + (contact.arm_b - contact.arm_a);
    shape.normal = contact.normal;
    shape.turn = contact.turn;
    shape.first_separation = contact.separation - pair.rest_offset;
    // 0 if the first surface is the sharper by far, 1 if the second is.
    let sum = contact.roundness_a + contact.roundness_b;
    if finite(sum) && sum > 0.0 {
        shape.along = contact.roundness_a / sum;
    }
    return shape;
}

// No farther in than to beside the centre of mass: of a ball that is just where its centre is.
fn curvature_center(arm: vec3<f32>, out: vec3<f32>, roundness: f32) -> vec3<f32> {
    if !finite(roundness) || roundness >= s::ENDLESS {
        return arm;
    }
    return arm - min(roundness, max(dot(arm, out), 0.0)) * out;
}
