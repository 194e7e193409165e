// Solver: the points of every pair, with the saved impulses that match them. One thread per pair.
#import faceoff::clearance as g
#import faceoff::constants::warm_start::{MAX_IMPULSE_SCALE, MAX_MATCHED}
#import faceoff::dispatch::group_index
#import faceoff::math::{compose, conjugate, rotate, tangent}
#import faceoff::overlap as o
#import faceoff::overlap::{contact_points, collision_substep, saved_pairs, saved_points}
#import faceoff::patch::{point_constants, point_states, spread_friction}
#import faceoff::solver_math::{finite, finite_vector}
#import faceoff::solver_types as s
#import faceoff::types as t

@group(0) @binding(1) var<storage, read> solver_counters: array<u32>;
@group(0) @binding(3) var<storage, read_write> solver_pairs: array<s::SolverPair>;
@group(0) @binding(6) var<storage, read> body_constants: array<s::BodyConstants>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= solver_counters[s::PAIRS] {
        return;
    }
    var pair = solver_pairs[i];
    for (var k = pair.first; k < pair.first + pair.count; k += 1u) {
        point_constants[k] = default_constants();
        clear_point(k);
    }
    if (pair.flags & s::VALID) == 0u {
        return;
    }
    if (pair.flags & s::KEPT) != 0u {
        keep(i, pair);
        return;
    }
    let overlap = o::classify(pair);
    if overlap.kind == o::DEEP && (pair.flags & s::FROZEN) == 0u {
        solver_pairs[i].flags |= s::DEPENETRATING;
        // In deep penetration one point pushes the centres apart.
        var deepest = 0.0;
        for (var k = pair.first; k < pair.first + pair.count; k += 1u) {
            deepest = min(deepest, contact_points[k].separation);
        }
        point_constants[pair.first].initial_separation = deepest - pair.rest_offset;
        point_states[pair.first].normal = overlap.direction;
        point_states[pair.first].flags = s::POINT_VALID;
        return;
    }
    if overlap.kind == o::CONFLICTING {
        pair.separating_direction = overlap.direction;
        solver_pairs[i].separating_direction = overlap.direction;
    }
    fill(pair);
}

// Takes over all that is saved of a pair.
fn keep(i: u32, pair: s::SolverPair) {
    let saved_pair = saved_pairs[pair.saved_pair];
    let swapped = (pair.flags & s::SWAPPED) != 0u;
    solver_pairs[i].separating_direction = o::saved_separating_direction(pair);
    solver_pairs[i].flags |= select(0u, s::DEPENETRATING, saved_pair.depenetrating != 0u);
    for (var j = 0u; j < pair.count; j += 1u) {
        let saved = saved_points[saved_pair.first + j];
        let k = pair.first + j;
        point_constants[k].anchor_a = select(saved.anchor_a, saved.anchor_b, swapped);
        point_constants[k].anchor_b = select(saved.anchor_b, saved.anchor_a, swapped);
        point_states[k].normal = o::saved_sign(pair) * saved.normal;
        point_states[k].flags = s::POINT_VALID;
        point_states[k].normal_impulse = saved.normal_impulse;
        point_states[k].total_normal_impulse = -saved.normal_impulse;
        point_states[k].search = o::saved_sign(pair) * saved.friction_impulse;
    }
}

fn default_constants() -> s::PointConstants {
    var constants: s::PointConstants;
    constants.contact_fraction = 0.5;
    return constants;
}

// Sets a point without impulses that is not valid. Rows are set before they are read.
fn clear_point(k: u32) {
    point_states[k].normal = vec3(1.0, 0.0, 0.0);
    point_states[k].separation = 0.0;
    point_states[k].friction_offset = vec3(0.0);
    point_states[k].total_normal_impulse = 0.0;
    point_states[k].friction_impulse = vec2(0.0);
    point_states[k].normal_impulse = 0.0;
    point_states[k].flags = 0u;
    point_states[k].change = vec3(0.0);
    point_states[k].impact_velocity = 0.0;
    point_states[k].search = vec3(0.0);
}

fn fill(pair: s::SolverPair) {
    let may_be_tight = g::may_be_tight(pair);
    for (var k = pair.first; k < pair.first + pair.count; k += 1u) {
        let contact = contact_points[k];
        let conflicts = contact.separation < 0.0 && dot(contact.normal, pair.separating_direction) < 0.0;
        if !conflicts && is_valid(contact) {
            var rest_offset = pair.rest_offset;
            if may_be_tight {
                rest_offset = g::rest_offset(pair, contact);
            }
            point_constants[k] = point_constants_of(pair, contact, rest_offset);
            point_states[k].normal = contact.normal;
            point_states[k].flags = s::POINT_VALID;
        }
    }
    if pair.friction > 0.0 {
        spread_friction(pair);
    }
    find_impulses(pair);
}

// Finds the saved impulses of all points.
fn find_impulses(pair: s::SolverPair) {
    // From each body's present rotation back to its saved one.
    var back_a = vec4(0.0, 0.0, 0.0, 1.0);
    var back_b = back_a;
    var saved_pair: s::SavedPair;
    let swapped = (pair.flags & s::SWAPPED) != 0u;
    if pair.saved_pair != s::NOT_SAVED {
        saved_pair = saved_pairs[pair.saved_pair];
        if saved_pair.depenetrating != 0u {
            saved_pair.count = 0u;
        }
        let first = select(saved_pair.rotation_a, saved_pair.rotation_b, swapped);
        let second = select(saved_pair.rotation_b, saved_pair.rotation_a, swapped);
        back_a = compose(first, conjugate(body_constants[pair.a].initial_rotation));
        back_b = compose(second, conjugate(body_constants[pair.b].initial_rotation));
    }
    // The impulse that supports a weight is proportional to the length of the substep.
    let ratio = pair.substep / max(saved_pair.substep, 1.0e-30);
    let impulse_scale = select(1.0, min(ratio, MAX_IMPULSE_SCALE), saved_pair.substep > 0.0);
    let match_distance = collision_substep.match_distance * pair.diameter;
    // One bit for each saved point that is used.
    var used_points = vec2(0u);
    for (var k = pair.first; k < pair.first + pair.count; k += 1u) {
        if (point_states[k].flags & s::POINT_VALID) == 0u {
            continue;
        }
        let contact = contact_points[k];
        let anchor_a = rotate(back_a, contact.anchor_a);
        let anchor_b = rotate(back_b, contact.anchor_b);
        // The nearest saved point. Distances are measured on both bodies and the smaller one counts, because a point
        // that slides along one body may be at rest on the other.
        var nearest = match_distance * match_distance;
        var found = s::NOT_SAVED;
        for (var j = 0u; j < min(saved_pair.count, MAX_MATCHED); j += 1u) {
            let saved = saved_points[saved_pair.first + j];
            let normal_cosine = o::saved_sign(pair) * dot(saved.normal, contact.normal);
            let used = ((used_points[j / 32u] >> (j % 32u)) & 1u) != 0u;
            if used || saved.normal_impulse <= 0.0 || normal_cosine < collision_substep.match_normal {
                continue;
            }
            let first = anchor_a - select(saved.anchor_a, saved.anchor_b, swapped);
            let second = anchor_b - select(saved.anchor_b, saved.anchor_a, swapped);
            let distance = min(dot(first, first), dot(second, second));
            if distance < nearest {
                nearest = distance;
                found = j;
            }
        }
        if found != s::NOT_SAVED {
            used_points[found / 32u] |= 1u << (found % 32u);
            let saved = saved_points[saved_pair.first + found];
            let impulse = impulse_scale * saved.normal_impulse;
            point_states[k].normal_impulse = impulse;
            // The saved impulse belongs to the last collision substep, so it does not count in this one's total.
            point_states[k].total_normal_impulse = -impulse;
            point_states[k].flags |= s::TOUCHED;
            let friction = impulse_scale * o::saved_sign(pair) * saved.friction_impulse;
            let side = tangent(contact.normal);
            point_states[k].friction_impulse = vec2(dot(side, friction), dot(cross(contact.normal, side), friction));
        }
    }
}

fn is_valid(contact: t::ContactPoint) -> bool {
    let square = dot(contact.normal, contact.normal);
    return finite_vector(contact.normal)
        && abs(square - 1.0) <= 2.0e-4
        && finite(contact.separation - contact.bulge)
        && finite(contact.normal_rotation)
        && finite_vector(contact.anchor_a)
        && finite_vector(contact.anchor_b);
}

fn point_constants_of(pair: s::SolverPair, contact: t::ContactPoint, rest_offset: f32) -> s::PointConstants {
    var constants = default_constants();
    constants.anchor_a = contact.anchor_a;
    constants.anchor_b = contact.anchor_b;
    let n = contact.normal;
    constants.curvature_center_a = curvature_center(contact.anchor_a, pair.offset_a, n, contact.curvature_radius_a);
    constants.curvature_center_b = curvature_center(contact.anchor_b, pair.offset_b, -n, contact.curvature_radius_b);
    constants.anchor_offset = pair.center_offset + (contact.anchor_b - contact.anchor_a);
    constants.initial_normal = contact.normal;
    constants.normal_rotation = contact.normal_rotation;
    constants.initial_separation = contact.separation - contact.bulge - rest_offset;
    // Impulses act on the sharper body: 0 is the first, 1 the second.
    let sum = contact.curvature_radius_a + contact.curvature_radius_b;
    if finite(sum) && sum > 0.0 {
        constants.contact_fraction = contact.curvature_radius_a / sum;
    }
    return constants;
}

// The centre of curvature, but no deeper than the centre of mass of the collider, which is at `offset`. For a ball that
// is exactly its centre of curvature.
fn curvature_center(anchor: vec3<f32>, offset: vec3<f32>, out: vec3<f32>, curvature_radius: f32) -> vec3<f32> {
    if !finite(curvature_radius) || curvature_radius >= s::INFINITE_LENGTH {
        return anchor;
    }
    return anchor - min(curvature_radius, max(dot(anchor - offset, out), 0.0)) * out;
}
