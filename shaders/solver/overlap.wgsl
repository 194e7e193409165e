#define_import_path faceoff::overlap

// What is made of overlaps whose contact points may disagree about the way out; `src/solver/overlap.rs` explains it.

#import faceoff::constants::shared::SAFETY
#import faceoff::constants::solver::{DEFAULT_DIRECTION, CONFLICT_DEPTH, MIN_DIRECTION_LENGTH, OPPOSED, RESOLVED_DEPTH}
#import faceoff::solver_math::finite_vector
#import faceoff::solver_types as s
#import faceoff::types as t

@group(0) @binding(0) var<uniform> interval: s::Interval;
@group(0) @binding(2) var<storage, read> contact_points: array<t::ContactPoint>;
@group(0) @binding(4) var<storage, read> kept_pairs: array<s::KeptPair>;
@group(0) @binding(5) var<storage, read> kept_points: array<s::KeptPoint>;

// More points than this are not compared with each other.
const MOST_COMPARED: u32 = 64u;

const USUAL: u32 = 0u;
const TANGLED: u32 = 1u;
const DISPUTED: u32 = 2u;

struct Overlap {
    kind: u32,
    // The way out.
    direction: vec3<f32>,
}

fn judge(pair: s::SolverPair) -> Overlap {
    let usual = Overlap(USUAL, vec3(0.0));
    if !deeper_than(pair, 0.0) {
        return usual;
    }
    let known = pair.kept != s::NOT_KEPT;
    var tangled = false;
    if known {
        tangled = kept_pairs[pair.kept].depenetrating != 0u;
    } else {
        tangled = unexplained(pair) || opposed(pair, 0.0);
    }
    if tangled {
        return Overlap(TANGLED, way_out(pair));
    }
    if !known {
        return usual;
    }
    let direction = kept_direction(pair);
    var disputed = false;
    if all(direction == vec3(0.0)) {
        disputed = opposed(pair, CONFLICT_DEPTH * pair.diameter);
    } else {
        disputed = deeper_than(pair, RESOLVED_DEPTH * pair.diameter);
    }
    if !disputed {
        return usual;
    }
    var way = unit_or(direction, 0.0, vec3(0.0));
    if all(way == vec3(0.0)) {
        way = unit_or(kept_push(pair), 0.0, vec3(0.0));
    }
    if all(way == vec3(0.0)) {
        way = unit_or(pair.between, 0.0, DEFAULT_DIRECTION);
    }
    return Overlap(DISPUTED, way);
}

// Whether some point is deep although the pair's motion does not explain it.
fn unexplained(pair: s::SolverPair) -> bool {
    for (var k = pair.first; k < pair.first + pair.count; k += 1u) {
        let point = contact_points[k];
        let depth = -point.separation;
        let way = max(dot(pair.closing, point.normal), 0.0) + pair.swing;
        if depth > interval.deep_penetration * pair.diameter && depth > SAFETY * way * interval.dt {
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

// Whether two points, both deeper than `depth`, push against each other.
fn opposed(pair: s::SolverPair, depth: f32) -> bool {
    let end = pair.first + min(pair.count, MOST_COMPARED);
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

// v as a unit vector if it is longer than `least`.
fn unit_or(v: vec3<f32>, least: f32, otherwise: vec3<f32>) -> vec3<f32> {
    let length = sqrt(dot(v, v));
    if finite_vector(v) && length > least && length < s::ENDLESS {
        return v / length;
    }
    return otherwise;
}

// The line of centres; away from a body without mass the mean of normals, as its centre says little about its surface.
fn way_out(pair: s::SolverPair) -> vec3<f32> {
    let least = MIN_DIRECTION_LENGTH * pair.diameter;
    let centers = unit_or(pair.between, least, DEFAULT_DIRECTION);
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

// The way out of a dispute in the last interval, or zero.
fn kept_direction(pair: s::SolverPair) -> vec3<f32> {
    return sign_of(pair) * kept_pairs[pair.kept].direction;
}

// -1 if the bodies of the remembered pair were the other way round.
fn sign_of(pair: s::SolverPair) -> f32 {
    return select(1.0, -1.0, (pair.flags & s::SWAPPED) != 0u);
}

// The sum of the remembered normal impulses, or of normals where none pushed.
fn kept_push(pair: s::SolverPair) -> vec3<f32> {
    let kept = kept_pairs[pair.kept];
    var impulses = vec3(0.0);
    var normals = vec3(0.0);
    for (var k = kept.first; k < kept.first + kept.count; k += 1u) {
        impulses += kept_points[k].normal * kept_points[k].impulse;
        normals += kept_points[k].normal;
    }
    return sign_of(pair) * select(impulses, normals, all(impulses == vec3(0.0)));
}
