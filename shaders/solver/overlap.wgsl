#define_import_path faceoff::overlap

// Overlaps whose contact points disagree about the separating direction. The twin of `src/solver/overlap.rs`.

#import faceoff::constants::shared::{DEFAULT_DIRECTION, SAFETY}
#import faceoff::constants::solver::{CONFLICT_DEPTH, MIN_DIRECTION_LENGTH, OPPOSED, RESOLVED_DEPTH}
#import faceoff::paces::paces
#import faceoff::solver_math::finite_vector
#import faceoff::solver_types as s
#import faceoff::types as t

@group(0) @binding(0) var<uniform> collision_substep: s::CollisionSubstep;
@group(0) @binding(2) var<storage, read> contact_points: array<t::ContactPoint>;
@group(0) @binding(4) var<storage, read> saved_pairs: array<s::SavedPair>;
@group(0) @binding(5) var<storage, read> saved_points: array<s::SavedPoint>;

// Most points of a pair that are compared with each other.
const MAX_COMPARED: u32 = 64u;

const ORDINARY: u32 = 0u;
const DEEP: u32 = 1u;
const CONFLICTING: u32 = 2u;

struct Overlap {
    kind: u32,
    // Unit vector along which the pair is pushed apart.
    direction: vec3<f32>,
}

fn classify(pair: s::SolverPair) -> Overlap {
    let ordinary = Overlap(ORDINARY, vec3(0.0));
    if !deeper_than(pair, 0.0) {
        return ordinary;
    }
    let is_saved = pair.saved_pair != s::NOT_SAVED;
    var is_deep = false;
    if is_saved {
        is_deep = saved_pairs[pair.saved_pair].depenetrating != 0u;
    } else {
        is_deep = exceeds_motion(pair) || has_opposed_normals(pair, 0.0);
    }
    if is_deep {
        return Overlap(DEEP, depenetration_direction(pair));
    }
    if !is_saved {
        return ordinary;
    }
    let direction = saved_separating_direction(pair);
    var conflicting = false;
    if all(direction == vec3(0.0)) {
        conflicting = has_opposed_normals(pair, CONFLICT_DEPTH * pair.diameter);
    } else {
        conflicting = deeper_than(pair, RESOLVED_DEPTH * pair.diameter);
    }
    if !conflicting {
        return ordinary;
    }
    var separating = unit_or(direction, 0.0, vec3(0.0));
    if all(separating == vec3(0.0)) {
        separating = unit_or(saved_normal_impulse(pair), 0.0, vec3(0.0));
    }
    if all(separating == vec3(0.0)) {
        separating = unit_or(collider_offset(pair), 0.0, DEFAULT_DIRECTION);
    }
    return Overlap(CONFLICTING, separating);
}

// Whether some point is deep and the pair's motion does not explain its depth.
fn exceeds_motion(pair: s::SolverPair) -> bool {
    let dt = paces[pair.pace].dt;
    for (var k = pair.first; k < pair.first + pair.count; k += 1u) {
        let point = contact_points[k];
        let depth = -point.separation;
        let speed = max(dot(pair.approach_velocity, point.normal), 0.0) + pair.surface_speed;
        if depth > collision_substep.deep_penetration * pair.diameter && depth > SAFETY * speed * dt {
            return true;
        }
    }
    return false;
}

fn deeper_than(pair: s::SolverPair, depth: f32) -> bool {
    for (var k = pair.first; k < pair.first + pair.count; k += 1u) {
        if contact_points[k].separation < -depth {
            return true;
        }
    }
    return false;
}

// Whether two points, both deeper than `depth`, have opposed normals.
fn has_opposed_normals(pair: s::SolverPair, depth: f32) -> bool {
    let end = pair.first + min(pair.count, MAX_COMPARED);
    for (var k = pair.first; k < end; k += 1u) {
        if contact_points[k].separation < -depth {
            for (var other = k + 1u; other < end; other += 1u) {
                let deep = contact_points[other].separation < -depth;
                if deep && dot(contact_points[k].normal, contact_points[other].normal) < OPPOSED {
                    return true;
                }
            }
        }
    }
    return false;
}

// From the centre of mass of the first collider to the second's.
fn collider_offset(pair: s::SolverPair) -> vec3<f32> {
    return pair.center_offset + (pair.offset_b - pair.offset_a);
}

// v normalised, if it is longer than `least`; else `otherwise`.
fn unit_or(v: vec3<f32>, least: f32, otherwise: vec3<f32>) -> vec3<f32> {
    let length = sqrt(dot(v, v));
    if finite_vector(v) && length > least && length < s::INFINITE_LENGTH {
        return v / length;
    }
    return otherwise;
}

// The line through the centres of the colliders. If one body has no mass it is the depth-weighted mean normal, because
// that body's centre says little about where its surface is.
fn depenetration_direction(pair: s::SolverPair) -> vec3<f32> {
    let least = MIN_DIRECTION_LENGTH * pair.diameter;
    let centers = unit_or(collider_offset(pair), least, DEFAULT_DIRECTION);
    if (pair.flags & s::FIRST_HAS_MASS) != 0u && (pair.flags & s::SECOND_HAS_MASS) != 0u {
        return centers;
    }
    var sum = vec3(0.0);
    for (var k = pair.first; k < pair.first + pair.count; k += 1u) {
        let separation = contact_points[k].separation;
        if separation < 0.0 {
            sum -= contact_points[k].normal * separation;
        }
    }
    return unit_or(sum, least, centers);
}

// The direction that resolved a conflict in the last collision substep, or zero.
fn saved_separating_direction(pair: s::SolverPair) -> vec3<f32> {
    return saved_sign(pair) * saved_pairs[pair.saved_pair].separating_direction;
}

// -1 if the bodies of the saved pair are in the opposite order.
fn saved_sign(pair: s::SolverPair) -> f32 {
    return select(1.0, -1.0, (pair.flags & s::SWAPPED) != 0u);
}

// The sum of the saved normal impulses as a vector, or of the normals if there was no impulse.
fn saved_normal_impulse(pair: s::SolverPair) -> vec3<f32> {
    let saved = saved_pairs[pair.saved_pair];
    var impulses = vec3(0.0);
    var normals = vec3(0.0);
    for (var k = saved.first; k < saved.first + saved.count; k += 1u) {
        impulses += saved_points[k].normal * saved_points[k].normal_impulse;
        normals += saved_points[k].normal;
    }
    return saved_sign(pair) * select(impulses, normals, all(impulses == vec3(0.0)));
}
