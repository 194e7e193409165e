// Solver: what holds for all points of a pair, and which remembered pair it is.
#import faceoff::dispatch::group_index
#import faceoff::solver_types as s
#import faceoff::types as t

@group(0) @binding(0) var<uniform> interval: s::Interval;
@group(0) @binding(1) var<storage, read> solver_counters: array<u32>;
@group(0) @binding(2) var<storage, read> contact_pairs: array<t::ContactPair>;
@group(0) @binding(3) var<storage, read> solver_bodies: array<s::SolverBody>;
@group(0) @binding(4) var<storage, read> states: array<s::BodyState>;
@group(0) @binding(5) var<storage, read> masses: array<s::Mass>;
@group(0) @binding(6) var<storage, read> links: array<vec4<u32>>;
@group(0) @binding(7) var<storage, read> kept_pairs: array<s::KeptPair>;
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
    pair.flags = s::FROZEN;
    pair.kept = s::NOT_KEPT;
    // A pair that names points that are not there, or those of the pair before, has none.
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
    let there = pair.a < interval.bodies && pair.b < interval.bodies && pair.a != pair.b && pair.count > 0u;
    if there {
        let first = masses[pair.a].flags;
        let second = masses[pair.b].flags;
        let solid = ((solver_bodies[pair.a].flags | solver_bodies[pair.b].flags) & t::SENSOR) == 0u;
        if (first & second & s::SOUND) != 0u && solid {
            fill(&pair, first, second);
        }
        remember(&pair);
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
    (*pair).flags = flags;
    let smaller = 2.0 * min(solver_bodies[a].radius, solver_bodies[b].radius);
    (*pair).diameter = select(0.0, smaller, smaller > 0.0 && smaller < s::ENDLESS);
    (*pair).rest_offset = interval.rest_offset * (*pair).diameter;
    (*pair).friction = combined(s::FRICTION_RULE, solver_bodies[a].flags, solver_bodies[b].flags, solver_bodies[a].friction, solver_bodies[b].friction);
    (*pair).restitution = min(
        combined(s::RESTITUTION_RULE, solver_bodies[a].flags, solver_bodies[b].flags, solver_bodies[a].restitution, solver_bodies[b].restitution),
        1.0,
    );
    let coarse = states[b].center - states[a].center;
    (*pair).between = coarse + (states[b].center_low - states[a].center_low);
    (*pair).closing = states[a].linear_velocity - states[b].linear_velocity;
    (*pair).swing = swing_of(a) + swing_of(b);
}

// How fast a body's surface turns about its centre.
fn swing_of(i: u32) -> f32 {
    let w = states[i].angular_velocity;
    return sqrt(dot(w, w)) * min(solver_bodies[i].radius, s::ENDLESS);
}

// One coefficient from two, by the later rule in the order of `CombineRule`.
fn combined(shift: u32, first: u32, second: u32, x: f32, y: f32) -> f32 {
    let p = max(x, 0.0);
    let q = max(y, 0.0);
    switch max((first >> shift) & 15u, (second >> shift) & 15u) {
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

// Looks the pair up among those remembered, which are ascending.
fn remember(pair: ptr<function, s::SolverPair>) {
    let first = links[(*pair).a].z;
    let second = links[(*pair).b].z;
    if first == s::NOT_KEPT || second == s::NOT_KEPT {
        return;
    }
    let a = min(first, second);
    let b = max(first, second);
    var low = 0u;
    var high = min(solver_counters[s::KEPT_PAIRS], arrayLength(&kept_pairs));
    while low < high {
        let middle = low + (high - low) / 2u;
        let kept = kept_pairs[middle];
        if kept.a < a || (kept.a == a && kept.b < b) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    if low >= solver_counters[s::KEPT_PAIRS] {
        return;
    }
    let kept = kept_pairs[low];
    if kept.a == a && kept.b == b && kept.count > 0u {
        (*pair).kept = low;
        if first > second {
            (*pair).flags |= s::SWAPPED;
        }
    }
}
