// Contact generation: the features between nearest points that count. One workgroup per pair of bodies, one thread per
// pair of triangles. The first round counts them, the second writes them in the order of the triangles. The twin of
// `src/manifolds/cpu/near_features.rs`.
//
// Features of one-sided triangles count only where the bodies are nearest, and only if no other feature of the pair is
// nearer. Features of two-sided triangles count if they add to others of the same vertices and edges, and those of
// rounded bodies if they add to others of the same edges.
#import faceoff::agree::agree
#import faceoff::constants::manifolds::{BESIDE, NEARER}
#import faceoff::dispatch::group_index
#import faceoff::features::TrianglePair
#import faceoff::known_vertices::{clear, enter, least_separation, put, separation_of, word}
#import faceoff::near_ranges::{range_count, range_of}
#import faceoff::nearest::{CORNER_EDGES, EDGE_CORNERS, EDGE_EDGES, OVER_SECOND, candidates, feature_of}
#import faceoff::sides
#import faceoff::thread_sums::{before_threads, of_all_threads}
#import faceoff::types as t

@group(0) @binding(2) var<uniform> limits: t::ContactLimits;
@group(0) @binding(3) var<storage, read_write> contact_counters: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read_write> pair_setups: array<t::PairSetup>;
// The two triangles. Then a word whose lower half holds what `features.wgsl` has found, and whose upper half holds the
// last of the candidates that count; the last word holds the others.
@group(0) @binding(5) var<storage, read_write> near_triangles: array<vec4<u32>>;

// Where `features.wgsl` has its bits of pairs of edges.
const EDGE_BITS_AT: u32 = 6u;

var<workgroup> least: array<f32, 64>;
var<workgroup> base: u32;

// What this thread has found: features, and the least distance of features of one-sided triangles.
var<private> found: u32;
var<private> nearest: f32;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let index = group_index(group);
    if index >= agree(thread, atomicLoad(&contact_counters[t::BATCH_PAIRS])) {
        return;
    }
    let setup = pair_setups[index];
    if agree(thread, u32(setup.valid == 0u || setup.margin <= 0.0)) == 1u {
        return;
    }
    let a = sides::first(setup);
    let b = sides::second(setup);
    let of_others = distance_of_others(setup, thread);
    // Rounding makes none of two equal distances the shorter one.
    let of_solids = min(setup.margin, NEARER * of_others - 2.0 * setup.rounding);
    let is_rounded = sides::rounding(a, b) > 0.0;
    let some_two_sided = a.some_two_sided || b.some_two_sided;
    if agree(thread, u32(!(some_two_sided || is_rounded) && of_solids <= 0.0)) == 1u {
        return;
    }
    if agree(thread, u32(some_two_sided && !is_rounded)) == 1u {
        list_vertices(setup, thread);
    }
    found = 0u;
    nearest = t::DROPPED;
    let pieces = atomicLoad(&contact_counters[t::NEAR_PIECES]);
    let ranges = agree(thread, range_count(setup, pieces, limits.pieces));
    var first = 0u;
    var most_of_solids = of_solids;
    // A loop of two rounds, so that compilers do not write what they share twice.
    for (var phase = 0u; phase < 2u; phase += 1u) {
        var next = first;
        for (var i = 0u; i < ranges; i += 1u) {
            let range = range_of(setup, i);
            let start = agree(thread, range.x);
            let count = agree(thread, range.y);
            for (var round = 0u; round < count; round += 64u) {
                let is_used = round + thread < count;
                let at = start + min(round + thread, count - 1u);
                if phase == 0u {
                    if is_used {
                        count_features(setup, a, b, at, of_solids);
                    }
                } else {
                    var own = vec2(0u);
                    if is_used {
                        own = known_of(at);
                    }
                    let place = next + before_threads(vec2(countOneBits(own.x) + countOneBits(own.y), 0u), thread).x;
                    next += of_all_threads().x;
                    workgroupBarrier();
                    write_features(setup, a, b, at, own, place, most_of_solids);
                }
            }
        }
        if phase == 0u {
            let before = before_threads(vec2(found, 0u), thread).x;
            if thread == 63u {
                base = reserve(index, before + found);
            }
            first = workgroupUniformLoad(&base);
            if first == t::NOTHING {
                return;
            }
            most_of_solids = least_of_all(nearest, thread) + BESIDE * setup.margin;
        }
    }
}

// Reserves positions, and writes their range to the pair's setup. `NOTHING` if there are none or they do not fit.
fn reserve(index: u32, count: u32) -> u32 {
    let next = atomicAdd(&contact_counters[t::FEATURES], count);
    let fits = next <= limits.features && count <= limits.features - next;
    let held = select(0u, count, fits);
    pair_setups[index].first_nearest = next;
    pair_setups[index].nearest_count = held;
    return select(t::NOTHING, next, held > 0u);
}

// The least distance of the points of the pair's other features. It is 0 if any feature overlaps or surfaces cross.
fn distance_of_others(setup: t::PairSetup, thread: u32) -> f32 {
    var distance = select(t::DROPPED, 0.0, setup.segment_count > 0u);
    for (var i = thread; i < setup.feature_count; i += 64u) {
        let at = setup.first_feature + i;
        if separation_of(at) <= 0.0 {
            distance = 0.0;
        } else {
            distance = min(distance, length(vector(at, 4u) - vector(at, 0u)));
        }
    }
    return least_of_all(distance, thread);
}

fn vector(at: u32, offset: u32) -> vec3<f32> {
    return bitcast<vec3<f32>>(vec3(word(at, offset), word(at, offset + 1u), word(at, offset + 2u)));
}

// Lists the vertices that have a feature over a face.
fn list_vertices(setup: t::PairSetup, thread: u32) {
    for (var i = thread; i < setup.feature_count; i += 64u) {
        clear(setup.first_feature + i);
    }
    storageBarrier();
    workgroupBarrier();
    var i = thread;
    while i < setup.feature_count {
        enter(setup, setup.first_feature + i);
        i += 64u;
    }
    // Some devices abort long loops.
    if i < setup.feature_count {
        atomicOr(&contact_counters[t::CONTACTS_CUT_SHORT], 1u);
    }
    storageBarrier();
    workgroupBarrier();
}

// The candidates of a pair of triangles that count.
fn known_of(at: u32) -> vec2<u32> {
    let entry = near_triangles[at];
    return vec2(entry.w, entry.z >> 16u);
}

// The two triangles, with features up to this separation.
fn pair_of(setup: t::PairSetup, a: sides::Side, b: sides::Side, numbers: vec2<u32>) -> TrianglePair {
    var pair: TrianglePair;
    pair.a = sides::triangle(a, numbers.x);
    pair.b = sides::triangle(b, numbers.y);
    pair.heights_a = sides::heights(a, numbers.x, b, pair.b);
    pair.heights_b = sides::heights(b, numbers.y, a, pair.a);
    pair.rounding = setup.rounding;
    pair.is_rounded = sides::rounding(a, b) > 0.0;
    return pair;
}

// Finds the features of a pair of triangles, and notes which count as far as that is known.
fn count_features(setup: t::PairSetup, a: sides::Side, b: sides::Side, at: u32, of_solids: f32) {
    let entry = near_triangles[at];
    let over_a = !sides::is_one_sided(a, entry.x);
    let over_b = !sides::is_one_sided(b, entry.y);
    let is_solid = !over_a && !over_b && sides::rounding(a, b) == 0.0;
    let most = select(setup.margin, of_solids, is_solid);
    var rest = vec2(0u);
    if most > 0.0 {
        rest = candidates(sides::owned(a, entry.x), sides::owned(b, entry.y), over_a, over_b);
    }
    var known = vec2(0u);
    if any(rest != vec2(0u)) {
        let pair = pair_of(setup, a, b, entry.xy);
        if is_beyond(pair.heights_a, most + setup.rounding) || is_beyond(pair.heights_b, most + setup.rounding) {
            rest = vec2(0u);
        }
        while any(rest != vec2(0u)) {
            let number = first_of(rest);
            let bit = bit_of(number);
            rest &= ~bit;
            let feature = feature_of(a, b, pair, number, most);
            if feature.separation != t::DROPPED && (is_solid || is_news(setup, a, b, entry, number, feature)) {
                known |= bit;
                if is_solid {
                    nearest = min(nearest, feature.separation);
                }
            }
        }
    }
    found += countOneBits(known.x) + countOneBits(known.y);
    near_triangles[at].z = (entry.z & 0xffffu) | (known.y << 16u);
    near_triangles[at].w = known.x;
}

// Whether a feature of two-sided triangles or rounded bodies counts. Features of edges that have another feature do not
// count. Nor do, without rounding, features of a vertex that is nearer to a face of the other body. A rounded vertex
// may touch a face and an edge.
fn is_news(
    setup: t::PairSetup, a: sides::Side, b: sides::Side, entry: vec4<u32>, number: u32, feature: t::Feature
) -> bool {
    if number < CORNER_EDGES {
        return true;
    }
    if number >= EDGE_EDGES && number < OVER_SECOND {
        return ((entry.z >> (EDGE_BITS_AT + number - EDGE_EDGES)) & 1u) == 0u;
    }
    if sides::rounding(a, b) > 0.0 {
        return true;
    }
    var vertex = feature.vertex;
    if number < EDGE_CORNERS {
        vertex = sides::vertices(a, entry.x)[(number - CORNER_EDGES) / 3u];
    } else if number < EDGE_EDGES {
        vertex = sides::vertices(b, entry.y)[(number - EDGE_CORNERS) % 3u] | t::OF_SECOND;
    }
    return NEARER * least_separation(setup, vertex) - setup.rounding > feature.separation;
}

// Writes the features of a pair of triangles that count. Features of one-sided triangles that do not count are farther
// apart than `most_of_solids`.
fn write_features(
    setup: t::PairSetup, a: sides::Side, b: sides::Side, at: u32, known: vec2<u32>, place: u32, most_of_solids: f32
) {
    if all(known == vec2(0u)) {
        return;
    }
    let entry = near_triangles[at];
    let is_solid = sides::is_one_sided(a, entry.x) && sides::is_one_sided(b, entry.y) && sides::rounding(a, b) == 0.0;
    let pair = pair_of(setup, a, b, entry.xy);
    var rest = known;
    var next = place;
    while any(rest != vec2(0u)) {
        let number = first_of(rest);
        rest &= ~bit_of(number);
        var feature = feature_of(a, b, pair, number, setup.margin);
        if is_solid && feature.separation > most_of_solids {
            feature.separation = t::DROPPED;
        }
        write(next, feature);
        next += 1u;
    }
}

fn write(at: u32, feature: t::Feature) {
    put_vector(at, 0u, feature.point_a);
    put(at, 3u, bitcast<u32>(feature.separation));
    put_vector(at, 4u, feature.point_b);
    put_vector(at, 8u, feature.normal);
    put(at, 11u, feature.vertex);
    put(at, 12u, feature.a);
    put(at, 13u, feature.b);
    put(at, 14u, feature.origin);
}

fn put_vector(at: u32, offset: u32, v: vec3<f32>) {
    put(at, offset, bitcast<u32>(v.x));
    put(at, offset + 1u, bitcast<u32>(v.y));
    put(at, offset + 2u, bitcast<u32>(v.z));
}

fn first_of(bits: vec2<u32>) -> u32 {
    return select(countTrailingZeros(bits.x), 32u + countTrailingZeros(bits.y), bits.x == 0u);
}

fn bit_of(number: u32) -> vec2<u32> {
    let bit = 1u << (number % 32u);
    return select(vec2(bit, 0u), vec2(0u, bit), number >= 32u);
}

fn is_beyond(heights: vec3<f32>, reach: f32) -> bool {
    return all(heights > vec3(reach)) || all(heights < vec3(-reach));
}

// The least value of all threads.
fn least_of_all(own: f32, thread: u32) -> f32 {
    least[thread] = own;
    workgroupBarrier();
    for (var half = 32u; half > 0u; half /= 2u) {
        if thread < half {
            least[thread] = min(least[thread], least[thread + half]);
        }
        workgroupBarrier();
    }
    let result = least[0];
    workgroupBarrier();
    return result;
}
