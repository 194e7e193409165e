// Contact generation: the features and segments of nearby triangles. One workgroup per pair of bodies, one thread per
// pair of triangles. The first round counts them; the second writes them in the order of the triangles.
#import faceoff::agree::agree
#import faceoff::arena::{meshes, words}
#import faceoff::constants::manifolds::{MIN_AGREEMENT, MAX_DEPTH}
#import faceoff::dispatch::group_index
#import faceoff::features as f
#import faceoff::sides
#import faceoff::types as t

// x = 0: features that touch or are apart, and segments. x = 1: features that overlap, near patches.
@group(0) @binding(2) var<uniform> constants: vec4<u32>;
@group(0) @binding(3) var<uniform> limits: t::ContactLimits;
@group(0) @binding(4) var<storage, read_write> contact_counters: array<atomic<u32>>;
@group(0) @binding(5) var<storage, read_write> pair_setups: array<t::PairSetup>;
// The two triangles, and a bit set of their features and segment.
@group(0) @binding(6) var<storage, read_write> near_triangles: array<vec4<u32>>;
@group(0) @binding(7) var<storage, read_write> features: array<t::Feature>;
@group(0) @binding(8) var<storage, read_write> segments: array<t::Segment>;
@group(0) @binding(9) var<storage, read> patches: array<t::Patch>;

// Bits: six corners, nine pairs of edges, the segment.
const EDGES: u32 = 6u;
const SEGMENT: u32 = 15u;

// Counts of features and of segments.
var<workgroup> sums: array<vec2<u32>, 64>;
var<workgroup> base: vec2<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let index = group_index(group);
    if index >= agree(thread, atomicLoad(&contact_counters[t::MARGIN_PAIRS])) {
        return;
    }
    let setup = pair_setups[index];
    let deep = constants.x == 1u;
    let is_done = setup.valid == 0u || (deep && setup.patch_count == 0u);
    let near_count = agree(thread, select(setup.near_count, t::NOTHING, is_done));
    if near_count == t::NOTHING {
        return;
    }
    let a = sides::first(setup);
    let b = sides::second(setup);
    var found = vec2(0u);
    var surveyed = thread;
    while surveyed < near_count {
        let at = setup.first_near + surveyed;
        let mask = survey(setup, a, b, at, deep);
        near_triangles[at].z = mask;
        found += counts(mask);
        surveyed += 64u;
    }
    let all = before(found, thread) + found;
    if thread == 63u {
        base = reserve(index, all, deep);
    }
    // The positions of the results, or `NOTHING` if they do not fit.
    let first = workgroupUniformLoad(&base);
    var next = first;
    if first.x == t::NOTHING {
        return;
    }
    var round = 0u;
    while round < near_count {
        let i = round + thread;
        let at = setup.first_near + i;
        var mask = 0u;
        if i < near_count {
            mask = near_triangles[at].z;
        }
        let own = counts(mask);
        let earlier = before(own, thread);
        if mask != 0u {
            write(setup, a, b, at, mask, deep, next + earlier);
        }
        next += sums[63];
        round += 64u;
        workgroupBarrier();
    }
    // Some devices abort long loops.
    if surveyed < near_count || round < near_count {
        atomicOr(&contact_counters[t::CONTACTS_CUT_SHORT], 1u);
    }
}

fn counts(mask: u32) -> vec2<u32> {
    return vec2(countOneBits(mask & 0x7fffu), mask >> SEGMENT);
}

// Exclusive scan over the threads. The total is in `sums[63]`.
fn before(own: vec2<u32>, thread: u32) -> vec2<u32> {
    var inclusive = own;
    for (var reach = 1u; reach < 64u; reach *= 2u) {
        sums[thread] = inclusive;
        workgroupBarrier();
        if thread >= reach {
            inclusive += sums[thread - reach];
        }
        workgroupBarrier();
    }
    sums[thread] = inclusive;
    workgroupBarrier();
    return inclusive - own;
}

// Reserves positions for features and segments, and writes their ranges to the pair's setup.
fn reserve(index: u32, count: vec2<u32>, deep: bool) -> vec2<u32> {
    var first = vec2(atomicAdd(&contact_counters[t::FEATURES], count.x), 0u);
    var fits = first.x <= limits.features && count.x <= limits.features - first.x;
    if !deep {
        first.y = atomicAdd(&contact_counters[t::SEGMENTS], count.y);
        fits = fits && first.y <= limits.segments && count.y <= limits.segments - first.y;
    }
    let held = select(vec2(0u), count, fits);
    if deep {
        pair_setups[index].first_deep = first.x;
        pair_setups[index].deep_count = held.x;
    } else {
        pair_setups[index].first_feature = first.x;
        pair_setups[index].feature_count = held.x;
        pair_setups[index].first_segment = first.y;
        pair_setups[index].segment_count = held.y;
    }
    return select(vec2(t::NOTHING), first, fits);
}

fn triangle_pair(
    setup: t::PairSetup, a: sides::Side, b: sides::Side, numbers: vec2<u32>, deep: bool
) -> f::TrianglePair {
    var pair: f::TrianglePair;
    pair.a = sides::triangle(a, numbers.x);
    pair.b = sides::triangle(b, numbers.y);
    pair.heights_a = sides::heights(pair.a, pair.b);
    pair.heights_b = sides::heights(pair.b, pair.a);
    pair.rounding = setup.rounding;
    if deep {
        pair.low = -MAX_DEPTH * setup.size;
        pair.high = -setup.touch;
    } else {
        pair.low = -setup.touch;
        pair.high = setup.margin;
    }
    return pair;
}

// The bit set of the features and the segment of two triangles.
fn survey(setup: t::PairSetup, a: sides::Side, b: sides::Side, at: u32, deep: bool) -> u32 {
    let pair = triangle_pair(setup, a, b, near_triangles[at].xy, deep);
    let reach = max(abs(pair.low), pair.high + setup.touch);
    if beyond(pair.heights_a, reach) || beyond(pair.heights_b, reach) {
        return 0u;
    }
    var wanted = wanted_vertices(sides::owned(a, pair.a.number), pair.heights_a, pair)
        | (wanted_vertices(sides::owned(b, pair.b.number), pair.heights_b, pair) << 3u);
    let edges_a = sides::owned(a, pair.a.number) >> 3u;
    let edges_b = sides::owned(b, pair.b.number) >> 3u;
    for (var k = 0u; k < 3u; k += 1u) {
        if ((edges_a >> k) & 1u) == 1u {
            wanted |= edges_b << (EDGES + 3u * k);
        }
    }
    var mask = 0u;
    while wanted != 0u {
        let bit = countTrailingZeros(wanted);
        wanted &= wanted - 1u;
        let feature = feature_of(a, b, pair, bit);
        if feature.separation != t::DROPPED && (!deep || agrees(setup, feature)) {
            mask |= 1u << bit;
        }
    }
    if !deep && f::crosses(pair) {
        if f::segment(a, b, pair).start_edge != t::NOTHING {
            mask |= 1u << SEGMENT;
        }
    }
    return mask;
}

fn beyond(heights: vec3<f32>, reach: f32) -> bool {
    return all(heights > vec3(reach)) || all(heights < vec3(-reach));
}

// Bits of the corners that the triangle owns and whose height is in the range of separations.
fn wanted_vertices(owned: u32, heights: vec3<f32>, pair: f::TrianglePair) -> u32 {
    var bits = 0u;
    for (var k = 0u; k < 3u; k += 1u) {
        if ((owned >> k) & 1u) == 1u && heights[k] >= pair.low && heights[k] <= pair.high {
            bits |= 1u << k;
        }
    }
    return bits;
}

fn feature_of(a: sides::Side, b: sides::Side, pair: f::TrianglePair, bit: u32) -> t::Feature {
    if bit < 3u {
        return f::vertex_feature(a, pair.a, pair.b, pair.heights_a[bit], bit, pair.rounding);
    }
    if bit < EDGES {
        return f::vertex_feature(b, pair.b, pair.a, pair.heights_b[bit - 3u], bit - 3u, pair.rounding);
    }
    return f::edge_feature(a, b, pair, (bit - EDGES) / 3u, (bit - EDGES) % 3u);
}

// Whether an overlapping feature has a patch nearby, and all patches nearby agree with it.
fn agrees(setup: t::PairSetup, feature: t::Feature) -> bool {
    let middle = 0.5 * (feature.point_a + feature.point_b);
    var any_near = false;
    for (var i = 0u; i < setup.patch_count; i += 1u) {
        let patch_near = patches[setup.first_segment / 2u + i];
        let offset = middle - patch_near.center;
        if dot(offset, offset) < patch_near.reach * patch_near.reach {
            any_near = true;
            if dot(feature.normal, patch_near.normal) < MIN_AGREEMENT {
                return false;
            }
        }
    }
    return any_near;
}

fn write(
    setup: t::PairSetup, a: sides::Side, b: sides::Side, at: u32, mask: u32, deep: bool, first: vec2<u32>
) {
    let pair = triangle_pair(setup, a, b, near_triangles[at].xy, deep);
    var next = first.x;
    var wanted = mask & 0x7fffu;
    while wanted != 0u {
        let bit = countTrailingZeros(wanted);
        wanted &= wanted - 1u;
        features[next] = feature_of(a, b, pair, bit);
        next += 1u;
    }
    if (mask >> SEGMENT) == 1u {
        segments[first.y] = f::segment(a, b, pair);
    }
}
