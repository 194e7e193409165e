// Contact generation: the features and segments of nearby triangles. One workgroup per pair of bodies, one thread per
// pair of triangles. The first round counts them; the second writes them in the order of the triangles.
//
// Without `DEEP`: features that touch or are apart, and segments. With `DEEP`: features that overlap, near patches.
//
// With `PIECES` there is one workgroup per piece of a pair that is split. The kernel is called twice, to count and to
// write; in between the pair's workgroup tells each piece where to write.
#import faceoff::agree::agree
#import faceoff::arena::{meshes, words}
#import faceoff::constants::manifolds::{MIN_AGREEMENT, MAX_DEPTH}
#import faceoff::dispatch::group_index
#import faceoff::features as f
#import faceoff::near_boxes::has_window
#ifdef DEEP
#import faceoff::near_patches::{next_near, patches, search_unfinished}
#endif
#import faceoff::sides
#import faceoff::thread_sums::{before_threads, of_all_threads}
#import faceoff::types as t

#ifdef PIECES
// x = 0: count. x = 1: write.
@group(0) @binding(2) var<uniform> constants: vec4<u32>;
#endif
@group(0) @binding(3) var<uniform> limits: t::ContactLimits;
@group(0) @binding(4) var<storage, read_write> contact_counters: array<atomic<u32>>;
@group(0) @binding(5) var<storage, read_write> pair_setups: array<t::PairSetup>;
// The two triangles, and a bit set of their features and segment.
@group(0) @binding(6) var<storage, read_write> near_triangles: array<vec4<u32>>;
@group(0) @binding(7) var<storage, read_write> features: array<t::Feature>;
#ifndef DEEP
@group(0) @binding(8) var<storage, read_write> segments: array<t::Segment>;
#endif
@group(0) @binding(10) var<storage, read_write> near_pieces: array<t::NearPiece>;

// Bits: six corners, nine pairs of edges, the segment.
const EDGES: u32 = 6u;
const SEGMENT: u32 = 15u;

#ifdef DEEP
const IS_DEEP: bool = true;
#else
const IS_DEEP: bool = false;
#endif

// Counts of features and of segments.
var<workgroup> base: vec2<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
#ifdef PIECES
    let all = pieces();
    let number = all.x + group_index(group);
    if agree(thread, u32(number >= all.y || all.y > limits.pieces)) == 1u {
        return;
    }
    let piece = near_pieces[number];
    let setup = pair_setups[piece.pair];
    let near_count = agree(thread, piece.near_count);
    let writes = constants.x == 1u;
    let start = agree(thread, piece.first_feature);
    if writes && start == t::NOTHING {
        return;
    }
    let found = process(setup, piece.first_near, near_count, vec2(start, piece.first_segment), thread, writes);
    if !writes {
        let all = before_threads(found, thread) + found;
        if thread == 63u {
            near_pieces[number].first_feature = all.x;
            near_pieces[number].first_segment = all.y;
        }
    }
#else
    let index = group_index(group);
    if index >= agree(thread, atomicLoad(&contact_counters[t::BATCH_PAIRS])) {
        return;
    }
    let setup = pair_setups[index];
    let is_done = setup.valid == 0u || (IS_DEEP && !has_window(setup));
    let near_count = agree(thread, select(setup.near_count, t::NOTHING, is_done));
    if near_count == t::NOTHING {
        return;
    }
    if agree(thread, setup.is_split) != 0u {
        // If not all pieces fit, none has told what it found: they hold places of an earlier run.
        let told = agree(thread, select(near_count, 0u, pieces().y > limits.pieces));
        let found = found_by_pieces(setup.first_near, told, thread);
        place_pieces(setup.first_near, told, place_of(index, found, thread), thread);
        return;
    }
    var first = vec2(0u);
    // A loop of two rounds, so that compilers do not write `process` twice.
    for (var phase = 0u; phase < 2u; phase += 1u) {
        let found = process(setup, setup.first_near, near_count, first, thread, phase == 1u);
        if phase == 0u {
            first = place_of(index, found, thread);
            if first.x == t::NOTHING {
                return;
            }
        }
    }
#endif
}

// The first of the pieces that are searched now, and their end.
fn pieces() -> vec2<u32> {
    let first = select(0u, atomicLoad(&contact_counters[t::NEAR_PIECES]), IS_DEEP);
    return vec2(first, first + atomicLoad(&contact_counters[select(t::NEAR_PIECES, t::DEEP_PIECES, IS_DEEP)]));
}

#ifndef PIECES
// The places of a pair's features and segments, of which this thread has `found` so many; `NOTHING` if they do not fit.
fn place_of(index: u32, found: vec2<u32>, thread: u32) -> vec2<u32> {
    let all = before_threads(found, thread) + found;
    if thread == 63u {
        base = reserve(index, all);
    }
    return workgroupUniformLoad(&base);
}

// What this thread's share of the pieces have found.
fn found_by_pieces(first: u32, count: u32, thread: u32) -> vec2<u32> {
    var found = vec2(0u);
    for (var i = thread; i < count; i += 64u) {
        found += vec2(near_pieces[first + i].first_feature, near_pieces[first + i].first_segment);
    }
    return found;
}

// Tells the pieces where to write what they have found.
fn place_pieces(first: u32, count: u32, places: vec2<u32>, thread: u32) {
    var next = places;
    for (var round = 0u; round < count; round += 64u) {
        let at = first + round + thread;
        var own = vec2(0u);
        if round + thread < count {
            own = vec2(near_pieces[at].first_feature, near_pieces[at].first_segment);
        }
        let place = next + before_threads(own, thread);
        if round + thread < count {
            near_pieces[at].first_feature = select(place.x, t::NOTHING, places.x == t::NOTHING);
            near_pieces[at].first_segment = place.y;
        }
        next += of_all_threads();
        workgroupBarrier();
    }
}
#endif

// Finds the features and segments of a range of nearby triangles, and returns how many this thread has found. With
// `writes` they are known, and are written from these places on.
fn process(
    setup: t::PairSetup, first_near: u32, near_count: u32, first: vec2<u32>, thread: u32, writes: bool
) -> vec2<u32> {
    let a = sides::first(setup);
    let b = sides::second(setup);
    var found = vec2(0u);
    var next = first;
    var round = 0u;
    while round < near_count {
        let i = round + thread;
        let at = first_near + i;
        var known = 0u;
        var place = next;
        if writes {
            if i < near_count {
                known = near_triangles[at].z;
            }
            place += before_threads(counts(known), thread);
            next += of_all_threads();
            workgroupBarrier();
        }
        if i < near_count && (!writes || known != 0u) {
            let mask = process_one(setup, a, b, at, known, place, writes);
            if !writes {
                near_triangles[at].z = mask;
                found += counts(mask);
            }
        }
        round += 64u;
    }
    check(round >= near_count);
    return found;
}

// Some devices abort long loops.
fn check(finished: bool) {
    if !finished {
        atomicOr(&contact_counters[t::CONTACTS_CUT_SHORT], 1u);
    }
#ifdef DEEP
    if search_unfinished {
        atomicOr(&contact_counters[t::CONTACTS_CUT_SHORT], 1u);
    }
#endif
}

fn counts(mask: u32) -> vec2<u32> {
    return vec2(countOneBits(mask & 0x7fffu), mask >> SEGMENT);
}

#ifndef PIECES
// Reserves positions for features and segments, and writes their ranges to the pair's setup.
fn reserve(index: u32, count: vec2<u32>) -> vec2<u32> {
    var first = vec2(atomicAdd(&contact_counters[t::FEATURES], count.x), 0u);
    var fits = first.x <= limits.features && count.x <= limits.features - first.x;
#ifndef DEEP
    first.y = atomicAdd(&contact_counters[t::SEGMENTS], count.y);
    fits = fits && first.y <= limits.segments && count.y <= limits.segments - first.y;
#endif
    let held = select(vec2(0u), count, fits);
#ifdef DEEP
    pair_setups[index].first_deep = first.x;
    pair_setups[index].deep_count = held.x;
#else
    pair_setups[index].first_feature = first.x;
    pair_setups[index].feature_count = held.x;
    pair_setups[index].first_segment = first.y;
    pair_setups[index].segment_count = held.y;
#endif
    return select(vec2(t::NOTHING), first, fits);
}
#endif

fn triangle_pair(setup: t::PairSetup, a: sides::Side, b: sides::Side, numbers: vec2<u32>) -> f::TrianglePair {
    var pair: f::TrianglePair;
    pair.a = sides::triangle(a, numbers.x);
    pair.b = sides::triangle(b, numbers.y);
    pair.heights_a = sides::heights(a, numbers.x, b, pair.b);
    pair.heights_b = sides::heights(b, numbers.y, a, pair.a);
    pair.rounding = setup.rounding;
    pair.is_rounded = sides::rounding(a, b) > 0.0;
    if IS_DEEP {
        pair.low = -MAX_DEPTH * setup.size;
        pair.high = -setup.touch;
    } else {
        pair.low = -setup.touch;
        pair.high = setup.margin;
    }
    return pair;
}

// Finds the features and the segment of two triangles, and returns their bit set; or writes the `known` ones.
fn process_one(
    setup: t::PairSetup, a: sides::Side, b: sides::Side, at: u32, known: u32, place: vec2<u32>, writes: bool
) -> u32 {
    let pair = triangle_pair(setup, a, b, near_triangles[at].xy);
    var wanted = known;
    if !writes {
        wanted = wanted_of(setup, a, b, pair);
    }
    var mask = 0u;
    var next = place.x;
    var rest = wanted & 0x7fffu;
    while rest != 0u {
        let bit = countTrailingZeros(rest);
        rest &= rest - 1u;
        let feature = feature_of(a, b, pair, bit);
        if writes {
            features[next] = feature;
            next += 1u;
        } else if is_kept(setup, feature) {
            mask |= 1u << bit;
        }
    }
#ifndef DEEP
    if (wanted >> SEGMENT) == 1u {
        let segment = f::segment(a, b, pair);
        if writes {
            segments[place.y] = segment;
        } else if segment.start_edge != t::NOTHING {
            mask |= 1u << SEGMENT;
        }
    }
#endif
    return mask;
}

// The bit set of what two triangles may have.
fn wanted_of(setup: t::PairSetup, a: sides::Side, b: sides::Side, pair: f::TrianglePair) -> u32 {
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
#ifndef DEEP
    if f::crosses(pair) {
        wanted |= 1u << SEGMENT;
    }
#endif
    return wanted;
}

fn is_kept(setup: t::PairSetup, feature: t::Feature) -> bool {
    if feature.separation == t::DROPPED {
        return false;
    }
#ifdef DEEP
    return agrees(setup, feature);
#else
    return true;
#endif
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
        return f::vertex_feature(a, pair.a.number, b, pair.b, pair.heights_a[bit], bit, pair.rounding);
    }
    if bit < EDGES {
        return f::vertex_feature(b, pair.b.number, a, pair.a, pair.heights_b[bit - 3u], bit - 3u, pair.rounding);
    }
    return f::edge_feature(a, b, pair, (bit - EDGES) / 3u, (bit - EDGES) % 3u);
}

#ifdef DEEP
// Whether an overlapping feature has a patch nearby that is not too deep, and all patches nearby agree with it.
fn agrees(setup: t::PairSetup, feature: t::Feature) -> bool {
    let middle = 0.5 * (feature.point_a + feature.point_b);
    let first = setup.first_segment;
    let count = setup.patch_count;
    var k = next_near(first, count, 0u, middle);
    var agrees = true;
    var is_allowed = false;
    while k < count && agrees {
        agrees = dot(feature.normal, patches[first + k].normal) >= MIN_AGREEMENT;
        is_allowed = is_allowed || patches[first + k].too_deep == 0u;
        k = next_near(first, count, k + 1u, middle);
    }
    return agrees && is_allowed;
}
#endif
