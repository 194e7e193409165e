// Solver: the constraint of each pair, and its saved pair of the last collision substep. One thread per pair.
#import faceoff::constants::solver::{CORNER, SOFTEST}
#import faceoff::dispatch::group_index
#import faceoff::math::rotate
#import faceoff::paces::paces
#import faceoff::solver_math::finite
#import faceoff::solver_types as s
#import faceoff::types as t

@group(0) @binding(0) var<uniform> collision_substep: s::CollisionSubstep;
@group(0) @binding(1) var<storage, read> solver_counters: array<u32>;
@group(0) @binding(2) var<storage, read> contact_pairs: array<t::ContactPair>;
@group(0) @binding(3) var<storage, read> solver_bodies: array<s::SolverBody>;
@group(0) @binding(4) var<storage, read> motion_states: array<s::MotionState>;
@group(0) @binding(5) var<storage, read> body_states: array<s::BodyState>;
@group(0) @binding(6) var<storage, read> old_numbers: array<u32>;
@group(0) @binding(7) var<storage, read> saved_pairs: array<s::SavedPair>;
@group(0) @binding(8) var<storage, read_write> solver_pairs: array<s::SolverPair>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= solver_counters[s::PAIRS] {
        return;
    }
    let contact = contact_pairs[i];
    var pair: s::SolverPair;
    pair.a = contact.a;
    pair.b = contact.b;
    pair.collider_a = contact.a;
    pair.collider_b = contact.b;
    pair.flags = s::FROZEN;
    pair.saved_pair = s::NOT_SAVED;
    // A pair whose range of points exceeds the list or overlaps an earlier one gets no points.
    var before = 0u;
    if i > 0u {
        before = contact_pairs[i - 1u].first_point + contact_pairs[i - 1u].point_count;
    }
    let points = solver_counters[s::POINTS];
    let fits = contact.first_point <= points && contact.point_count <= points - contact.first_point;
    if fits && contact.first_point >= before {
        pair.first = contact.first_point;
        pair.count = contact.point_count;
    }
    let exist = max(contact.a, contact.b) < collision_substep.bodies;
    if exist {
        pair.a = solver_bodies[contact.a].body;
        pair.b = solver_bodies[contact.b].body;
    }
    if exist && pair.a != pair.b && pair.count > 0u {
        let first = body_states[pair.a].mass.flags;
        let second = body_states[pair.b].mass.flags;
        let solid = ((solver_bodies[contact.a].flags | solver_bodies[contact.b].flags) & t::SENSOR) == 0u;
        if (first & second & s::FINITE) != 0u && solid {
            fill(&pair, first, second);
        }
        find_saved_pair(&pair);
    }
    solver_pairs[i] = pair;
}

fn fill(pair: ptr<function, s::SolverPair>, first: u32, second: u32) {
    let a = (*pair).a;
    let b = (*pair).b;
    var flags = s::VALID;
    flags |= select(0u, s::FIRST_HAS_MASS, (first & s::HAS_MASS) != 0u);
    flags |= select(0u, s::SECOND_HAS_MASS, (second & s::HAS_MASS) != 0u);
    if (flags & (s::FIRST_HAS_MASS | s::SECOND_HAS_MASS)) == 0u {
        flags |= s::FROZEN;
    }
    flags |= select(0u, s::DRIVEN, is_driven(a) || is_driven(b));
    (*pair).flags = flags;
    (*pair).softness = 1.0;
    if is_kinematic(a) && (second & s::HAS_MASS) != 0u {
        (*pair).softness = softness_of(a, b);
    } else if is_kinematic(b) && (first & s::HAS_MASS) != 0u {
        (*pair).softness = softness_of(b, a);
    }
    (*pair).pace = pace_of_pair(first, second);
    (*pair).substep = paces[(*pair).pace].h;
    let collider_a = (*pair).collider_a;
    let collider_b = (*pair).collider_b;
    let smaller = 2.0 * min(solver_bodies[collider_a].radius, solver_bodies[collider_b].radius);
    (*pair).diameter = select(0.0, smaller, smaller > 0.0 && smaller < s::INFINITE_LENGTH);
    (*pair).rest_offset = collision_substep.rest_offset * (*pair).diameter;
    (*pair).friction = combined(
        s::FRICTION_RULE,
        solver_bodies[collider_a].flags,
        solver_bodies[collider_b].flags,
        solver_bodies[collider_a].friction,
        solver_bodies[collider_b].friction,
    );
    (*pair).restitution = combined(
        s::RESTITUTION_RULE,
        solver_bodies[collider_a].flags,
        solver_bodies[collider_b].flags,
        solver_bodies[collider_a].restitution,
        solver_bodies[collider_b].restitution,
    );
    (*pair).restitution = min((*pair).restitution, 1.0);
    (*pair).offset_a = offset_of(collider_a, a);
    (*pair).offset_b = offset_of(collider_b, b);
    let coarse = motion_states[b].center - motion_states[a].center;
    (*pair).center_offset = coarse + (motion_states[b].center_low - motion_states[a].center_low);
    (*pair).approach_velocity = motion_states[a].linear_velocity - motion_states[b].linear_velocity;
    (*pair).surface_speed = surface_speed_of(a) + surface_speed_of(b);
    // A light kinematic body needs the exactness of a light dynamic one.
    (*pair).mass_ratio = max(((*pair).softness - 1.0) / CORNER, 1.0);
    if (first & second & s::HAS_MASS) != 0u {
        let ratio = solver_bodies[a].inverse_mass / solver_bodies[b].inverse_mass;
        let larger = max(ratio, 1.0 / ratio);
        (*pair).mass_ratio = select(1.0, larger, finite(larger));
    }
}

fn is_kinematic(i: u32) -> bool {
    return (solver_bodies[i].flags & t::KIND_MASK) == t::KINEMATIC;
}

// Whether it is kinematic and moves.
fn is_driven(i: u32) -> bool {
    let none = vec3(0.0);
    return is_kinematic(i)
        && (any(motion_states[i].linear_velocity != none) || any(motion_states[i].angular_velocity != none));
}

// The twin of `beside_kinematic` in `src/solver/softness.rs`.
fn softness_of(kinematic: u32, other: u32) -> f32 {
    let softness = 1.0 + CORNER * solver_bodies[kinematic].own_inverse_mass / solver_bodies[other].inverse_mass;
    return select(1.0, clamp(softness, 1.0, SOFTEST), finite(softness));
}

// The number of the pace of a pair, by the flags of its bodies. Bodies that meet nearly always have the same pace. They
// differ only if an impulse in this step changed a velocity beyond what was foreseen.
fn pace_of_pair(first: u32, second: u32) -> u32 {
    let numbers = vec2(first, second) >> vec2(s::PACE_SHIFT);
    let has_mass = (vec2(first, second) & vec2(s::HAS_MASS)) != vec2(0u);
    let longest = select(vec2(0xffffu), numbers, has_mass);
    return select(0u, min(longest.x, longest.y), any(has_mass));
}

// From the centre of mass of a body to its collider's, in world axes.
fn offset_of(collider: u32, body: u32) -> vec3<f32> {
    let rotation = motion_states[body].rotation + motion_states[body].rotation_low;
    return rotate(rotation, solver_bodies[collider].offset);
}

// Upper bound of the speed of a body's surface relative to its centre, m/s.
fn surface_speed_of(i: u32) -> f32 {
    let w = motion_states[i].angular_velocity;
    return sqrt(dot(w, w)) * min(solver_bodies[i].extent, s::INFINITE_LENGTH);
}

// The largest number of single precision.
const MAX_COEFFICIENT: f32 = 3.4028234e38;

// The combined coefficient of two bodies, by the rule that comes later in the order of `CombineRule`. `shift` locates
// the rule in the flags.
fn combined(shift: u32, first: u32, second: u32, x: f32, y: f32) -> f32 {
    // An infinite one is no bound where nothing presses.
    return min(combined_by(max((first >> shift) & 15u, (second >> shift) & 15u), x, y), MAX_COEFFICIENT);
}

fn combined_by(rule: u32, x: f32, y: f32) -> f32 {
    let p = max(x, 0.0);
    let q = max(y, 0.0);
    switch rule {
        case 0u: {
            return 0.5 * (p + q);
        }
        case 1u: {
            return sqrt(p * q);
        }
        case 2u: {
            return min(p, q);
        }
        case 3u: {
            return p * q;
        }
        default: {
            return max(p, q);
        }
    }
}

// Finds the saved pair by binary search: saved pairs are in ascending order.
fn find_saved_pair(pair: ptr<function, s::SolverPair>) {
    let first = old_numbers[(*pair).collider_a];
    let second = old_numbers[(*pair).collider_b];
    let moves = ((body_states[(*pair).a].mass.flags | body_states[(*pair).b].mass.flags) & s::MOVES) != 0u;
    if first == s::NOT_SAVED || second == s::NOT_SAVED {
        return;
    }
    let a = min(first, second);
    let b = max(first, second);
    var low = 0u;
    var high = min(solver_counters[s::SAVED_PAIRS], arrayLength(&saved_pairs));
    while low < high {
        let middle = low + (high - low) / 2u;
        let saved = saved_pairs[middle];
        if saved.a < a || (saved.a == a && saved.b < b) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    if low >= solver_counters[s::SAVED_PAIRS] {
        return;
    }
    let saved = saved_pairs[low];
    if saved.a == a && saved.b == b && saved.count > 0u {
        (*pair).saved_pair = low;
        if first > second {
            (*pair).flags |= s::SWAPPED;
        }
        if !moves && saved.count == (*pair).count {
            (*pair).flags |= s::KEPT;
            (*pair).substep = saved.substep;
        }
    }
}
