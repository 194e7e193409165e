// Contact generation: pairs of triangles that are near each other. One workgroup per pair of bodies traverses both
// bounding-volume trees, eight children of one node against eight of another at a time, one thread each. It counts the
// pairs and remembers where they are, and writes them once it knows their place in the list. If there are more than it
// can remember, it traverses the trees again to write them. The order of pairs follows the trees, whatever the order of
// threads.
//
// A pair of large meshes may be split (`split.wgsl`). With `PIECES` there is one workgroup per piece of such a pair.
#import faceoff::agree::agree
#import faceoff::arena::{meshes, words, vector}
#import faceoff::constants::manifolds::{AROUND_ERROR, DIRECTION_ERROR, ERROR}
#import faceoff::dispatch::group_index
#import faceoff::math::norm1
#import faceoff::near_boxes::{boxes_near, is_done, pad, reach, set_reach, windowed}
#import faceoff::sides
#import faceoff::tree
#import faceoff::types as t

// x = 0: all features. x = 1: features that overlap, near patches.
@group(0) @binding(2) var<uniform> constants: vec4<u32>;
@group(0) @binding(3) var<uniform> limits: t::ContactLimits;
@group(0) @binding(4) var<storage, read_write> contact_counters: array<atomic<u32>>;
@group(0) @binding(5) var<storage, read_write> pair_setups: array<t::PairSetup>;
// The two triangles; `features.wgsl` uses the rest.
@group(0) @binding(6) var<storage, read_write> near_triangles: array<vec4<u32>>;
#ifdef PIECES
@group(0) @binding(7) var<storage, read_write> near_pieces: array<t::NearPiece>;
#endif

// Pairs of nodes. On each of at most 8 levels, no more than 63 pairs wait while the 64th is opened.
var<workgroup> stack: array<vec2<u32>, 512>;
// Bit sets of the threads, in triplicate: one is in use, the next is cleared meanwhile, and threads that have not
// passed the barrier may still read the last.
var<workgroup> found: array<atomic<u32>, 6>;
var<workgroup> base: u32;

// The first pairs of leaves with triangles that are near: the numbers of the two leaves, and a bit per pair of
// triangles.
const MAX_LEAVES: u32 = 128u;
var<workgroup> near_leaves: array<vec4<u32>, MAX_LEAVES>;

// The pair of nodes at which the search starts.
var<private> roots: vec2<u32>;
// Number of pairs of leaves with triangles that are near; the same in all threads.
var<private> leaf_count: u32;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let deep = constants.x == 1u;
#ifdef PIECES
    let before = select(0u, atomicLoad(&contact_counters[t::NEAR_PIECES]), deep);
    let end = before + atomicLoad(&contact_counters[select(t::NEAR_PIECES, t::DEEP_PIECES, deep)]);
    let number = before + group_index(group);
    if agree(thread, u32(number >= end || end > limits.pieces)) == 1u {
        return;
    }
    let setup = pair_setups[near_pieces[number].pair];
#else
    let number = group_index(group);
    if number >= agree(thread, atomicLoad(&contact_counters[t::BATCH_PAIRS])) {
        return;
    }
    let setup = pair_setups[number];
    if agree(thread, u32(is_done(setup, deep) || setup.is_split != 0u)) == 1u {
        return;
    }
#endif
    set_reach(setup, deep);
    let a = sides::first(setup);
    let b = sides::second(setup);
#ifdef PIECES
    roots = vec2(near_pieces[number].node_a, near_pieces[number].node_b);
#else
    roots = vec2(tree::node(meshes[a.mesh].levels - 1u, 0u), tree::node(meshes[b.mesh].levels - 1u, 0u));
#endif
    if thread < 6u {
        atomicStore(&found[thread], 0u);
    }
    if thread < 2u {
        tree::survey(thread, select(a.mesh, b.mesh, thread == 1u));
    }
    workgroupBarrier();
    var first = t::NOTHING;
    // A loop of two rounds, so that compilers do not write `descend` twice, with two ways of rounding.
    for (var round = 0u; round < 2u; round += 1u) {
        let count = descend(setup, a, b, thread, first);
        if round == 0u {
            if thread == 0u {
                base = reserve(number, count);
            }
            first = workgroupUniformLoad(&base);
            if first == t::NOTHING {
                return;
            }
            if agree(thread, leaf_count) <= MAX_LEAVES {
                write_leaves(thread, first);
                return;
            }
        }
    }
}

// The place of the pairs that were counted; `NOTHING` if there are none or they do not fit.
fn reserve(number: u32, count: u32) -> u32 {
    let next = atomicAdd(&contact_counters[t::NEAR_TRIANGLES], count);
    let fits = next <= limits.near_triangles && count <= limits.near_triangles - next;
    let first = select(t::NOTHING, next, fits);
    let held = select(0u, count, fits);
#ifdef PIECES
    near_pieces[number].first_near = first;
    near_pieces[number].near_count = held;
#else
    pair_setups[number].first_near = first;
    pair_setups[number].near_count = held;
#endif
    return select(t::NOTHING, first, held > 0u);
}

// Writes the pairs of triangles in `near_leaves`.
fn write_leaves(thread: u32, first: u32) {
    var at = first;
    for (var i = 0u; i < leaf_count; i++) {
        let leaves = near_leaves[i];
        let mask = leaves.zw;
        if (mask[thread / 32u] & (1u << (thread % 32u))) != 0u {
            near_triangles[at + tree::rank_of(mask, thread)] = vec4(tree::children_of(leaves.xy, thread), 0u, 0u);
        }
        at += countOneBits(mask.x) + countOneBits(mask.y);
    }
}

// Counts the pairs and, unless `first` is `NOTHING`, writes them from there on.
fn descend(setup: t::PairSetup, a: sides::Side, b: sides::Side, thread: u32, first: u32) -> u32 {
    workgroupBarrier();
    if thread == 0u {
        stack[0] = roots;
    }
    workgroupBarrier();
    let bit = 1u << (thread % 32u);
    var depth = 1u;
    var count = 0u;
    leaf_count = 0u;
    // Which of the three bit sets is in use.
    var mask_set = 0u;
    loop {
        if depth == 0u {
            break;
        }
        let next_set = (mask_set + 2u) % 6u;
        if thread < 2u {
            atomicStore(&found[next_set + thread], 0u);
        }
        var next_depth = depth - 1u;
        let nodes = stack[next_depth];
        let opened = tree::open(nodes, thread);
        let pair = opened.pair;
        let leaves = opened.leaves;
        var meets = false;
        if leaves {
            meets = triangles_near(setup, a, b, pair);
        } else {
            meets = opened.wanted && boxes_near(setup, a, b, pair);
        }
        if meets {
            atomicOr(&found[mask_set + thread / 32u], bit);
        }
        workgroupBarrier();
        let mask = vec2(atomicLoad(&found[mask_set]), atomicLoad(&found[mask_set + 1u]));
        let number = countOneBits(mask.x) + countOneBits(mask.y);
        if leaves {
            if meets && first != t::NOTHING {
                near_triangles[first + count + tree::rank_of(mask, thread)] = vec4(pair, 0u, 0u);
            }
            if thread == 0u && number > 0u && leaf_count < MAX_LEAVES {
                near_leaves[leaf_count] = vec4(nodes & vec2(tree::NUMBER), mask);
            }
            leaf_count += u32(number > 0u);
            count += number;
        } else {
            if meets {
                stack[next_depth + tree::rank_of(mask, thread)] = pair;
            }
            next_depth += number;
        }
        mask_set = next_set;
        depth = agree(thread, next_depth);
    }
    // Some devices abort long loops.
    if depth != 0u {
        atomicOr(&contact_counters[t::CONTACTS_CUT_SHORT], 1u);
    }
    // The next traversal starts with empty bit sets.
    if thread < 6u {
        atomicStore(&found[thread], 0u);
    }
    workgroupBarrier();
    return count;
}

// Whether both triangles exist, are in the window, and neither their boxes nor one of their planes separates them by
// more than the reach.
fn triangles_near(setup: t::PairSetup, a: sides::Side, b: sides::Side, numbers: vec2<u32>) -> bool {
    if numbers.x >= a.triangle_count || numbers.y >= b.triangle_count {
        return false;
    }
    let ca = corners(a, numbers.x);
    let cb = corners(b, numbers.y);
    let low_a = min(ca.p, min(ca.q, ca.r));
    let high_a = max(ca.p, max(ca.q, ca.r));
    let low_b = min(cb.p, min(cb.q, cb.r));
    let high_b = max(cb.p, max(cb.q, cb.r));
    if any(low_a > high_b + reach) || any(low_b > high_a + reach) {
        return false;
    }
    if windowed {
        if any(high_a + pad < setup.window_min) || any(low_a - pad > setup.window_max)
            || any(high_b + pad < setup.window_min) || any(low_b - pad > setup.window_max) {
            return false;
        }
        let direction = setup.window_direction;
        let last = max(dot(ca.p, direction), max(dot(ca.q, direction), dot(ca.r, direction)));
        if min(dot(cb.p, direction), min(dot(cb.q, direction), dot(cb.r, direction))) > last + pad {
            return false;
        }
    }
    // Upper bound of the distance between two points of triangles whose boxes are near.
    let spread = norm1(high_a - low_a) + norm1(high_b - low_b) + reach;
    if beyond(ca, cb, spread, reach) || beyond(cb, ca, spread, reach) {
        return false;
    }
    let meet = all(low_a <= high_b + pad) && all(low_b <= high_a + pad)
        && !beyond(ca, cb, spread, pad) && !beyond(cb, ca, spread, pad);
    return meet || has_features(a, b, ca, cb, numbers);
}

// Whether two triangles may have a feature. The twin of `PlacedCluster::has_features` in `src/manifolds/cpu/near.rs`.
fn has_features(a: sides::Side, b: sides::Side, ca: Corners, cb: Corners, numbers: vec2<u32>) -> bool {
    let middle_a = (ca.p + ca.q + ca.r) / 3.0;
    let middle_b = (cb.p + cb.q + cb.r) / 3.0;
    let outward_a = outward(a, ca);
    let outward_b = outward(b, cb);
    let offset = middle_b - middle_a;
    // Lateral distance of the centres, perpendicular to the normal of either triangle; zero if the normal is unknown.
    let across_a = cross(offset, outward_a);
    let across_b = cross(offset, outward_b);
    let lateral = sqrt(vec2(dot(across_a, across_a), dot(across_b, across_b)));
    let around = AROUND_ERROR * (radius(ca, middle_a) + radius(cb, middle_b)) + 8.0 * pad
        + 2.0 * DIRECTION_ERROR * reach;
    if min(lateral.x, lateral.y) <= around {
        return true;
    }
    let edge_rotation = vec2(sides::edge_normal_rotation(a, numbers.x), sides::edge_normal_rotation(b, numbers.y));
    let sum = outward_a + outward_b;
    let square = dot(sum, sum);
    let facing = square <= (edge_rotation.x + edge_rotation.y) * (edge_rotation.x + edge_rotation.y);
    if facing && all(lateral <= around + reach * min(edge_rotation, vec2(1.0))) {
        return true;
    }
    // Between nearest points.
    if windowed || (sides::owned(a, numbers.x) | sides::owned(b, numbers.y)) == 0u {
        return false;
    }
    let rotation = sides::nearest_rotation(a, numbers.x) + sides::nearest_rotation(b, numbers.y);
    let is_known = any(outward_a != vec3(0.0)) && any(outward_b != vec3(0.0));
    return !is_known || square <= rotation * rotation;
}

// The outward unit normal; zero where single precision does not determine it.
fn outward(side: sides::Side, c: Corners) -> vec3<f32> {
    let u = c.q - c.p;
    let v = c.r - c.p;
    let normal = cross(u, v);
    let length = sqrt(dot(normal, normal));
    if !(ERROR * norm1(u) * norm1(v) < DIRECTION_ERROR * length) {
        return vec3(0.0);
    }
    return normal * (side.mirror / length);
}

// Radius of the circle about `middle` that contains the corners.
fn radius(c: Corners, middle: vec3<f32>) -> f32 {
    let p = c.p - middle;
    let q = c.q - middle;
    let r = c.r - middle;
    return sqrt(max(dot(p, p), max(dot(q, q), dot(r, r))));
}

struct Corners {
    p: vec3<f32>,
    q: vec3<f32>,
    r: vec3<f32>,
}

fn corners(side: sides::Side, number: u32) -> Corners {
    let at = side.triangles + 9u * number;
    return Corners(
        sides::place(side, vector(at)), sides::place(side, vector(at + 3u)), sides::place(side, vector(at + 6u))
    );
}

// Whether the plane of one triangle is farther than `distance` from all of the other.
fn beyond(plane: Corners, other: Corners, spread: f32, distance: f32) -> bool {
    let u = plane.q - plane.p;
    let v = plane.r - plane.p;
    let normal = cross(u, v);
    let heights = vec3(dot(normal, other.p - plane.p), dot(normal, other.q - plane.p), dot(normal, other.r - plane.p));
    let limit = distance * sqrt(dot(normal, normal)) + ERROR * spread * norm1(u) * norm1(v);
    return min(heights.x, min(heights.y, heights.z)) > limit || max(heights.x, max(heights.y, heights.z)) < -limit;
}
