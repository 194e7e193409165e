// Contact generation: what nearby triangles have to say. A workgroup a pair of bodies, a thread a pair of triangles; the
// first round finds out what there is, the second writes it, in the order of the triangles.
#import faceoff::arena::{meshes, words}
#import faceoff::constants::manifolds::{AGREES, DEEP}
#import faceoff::dispatch::group_index
#import faceoff::features as f
#import faceoff::sides
#import faceoff::types as t

// Which search: for all features that touch or are apart, and segments (0), or for those that overlap, near patches (1).
@group(0) @binding(2) var<uniform> constants: vec4<u32>;
@group(0) @binding(3) var<uniform> limits: t::ContactLimits;
@group(0) @binding(4) var<storage, read_write> contact_counters: array<atomic<u32>>;
@group(0) @binding(5) var<storage, read_write> settings: array<t::ContactSetting>;
// The two triangles, and a bit for each thing that they have to say.
@group(0) @binding(6) var<storage, read_write> near_triangles: array<vec4<u32>>;
@group(0) @binding(7) var<storage, read_write> features: array<t::Feature>;
@group(0) @binding(8) var<storage, read_write> segments: array<t::Segment>;
@group(0) @binding(9) var<storage, read> patches: array<t::Patch>;

// Bits: six corners, nine pairs of edges, the segment.
const EDGES: u32 = 6u;
const SEGMENT: u32 = 15u;

// Numbers of features, and of segments in the upper half.
var<workgroup> sums: array<vec2<u32>, 64>;
var<workgroup> base: vec2<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let index = group_index(group);
    if index >= atomicLoad(&contact_counters[t::MARGIN_PAIRS]) {
        return;
    }
    let setting = settings[index];
    let deep = constants.x == 1u;
    if setting.valid == 0u || (deep && setting.patch_count == 0u) {
        return;
    }
    let a = sides::first(setting);
    let b = sides::second(setting);
    var found = vec2(0u);
    var surveyed = thread;
    while surveyed < setting.near_count {
        let at = setting.first_near + surveyed;
        let mask = survey(setting, a, b, at, deep);
        near_triangles[at].z = mask;
        found += counts(mask);
        surveyed += 64u;
    }
    let all = before(found, thread) + found;
    if thread == 63u {
        base = reserve(index, all, deep);
    }
    workgroupBarrier();
    // How many there are, or none if they do not fit.
    var next = base;
    if next.x == t::NOTHING {
        return;
    }
    var round = 0u;
    while round < setting.near_count {
        let i = round + thread;
        let at = setting.first_near + i;
        var mask = 0u;
        if i < setting.near_count {
            mask = near_triangles[at].z;
        }
        let own = counts(mask);
        let earlier = before(own, thread);
        if mask != 0u {
            write(setting, a, b, at, mask, deep, next + earlier);
        }
        next += sums[63];
        round += 64u;
        workgroupBarrier();
    }
    // Some devices leave a loop that takes long.
    if surveyed < setting.near_count || round < setting.near_count {
        atomicOr(&contact_counters[t::CONTACTS_CUT_SHORT], 1u);
    }
}

fn counts(mask: u32) -> vec2<u32> {
    return vec2(countOneBits(mask & 0x7fffu), mask >> SEGMENT);
}

// The sum over all threads before this one; over all it is in `sums[63]`.
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

// Places for so many features and segments, noted in the pair's setting.
fn reserve(index: u32, count: vec2<u32>, deep: bool) -> vec2<u32> {
    var first = vec2(atomicAdd(&contact_counters[t::FEATURES], count.x), 0u);
    var fits = first.x <= limits.features && count.x <= limits.features - first.x;
    if !deep {
        first.y = atomicAdd(&contact_counters[t::SEGMENTS], count.y);
        fits = fits && first.y <= limits.segments && count.y <= limits.segments - first.y;
    }
    let held = select(vec2(0u), count, fits);
    if deep {
        settings[index].first_deep = first.x;
        settings[index].deep_count = held.x;
    } else {
        settings[index].first_feature = first.x;
        settings[index].feature_count = held.x;
        settings[index].first_segment = first.y;
        settings[index].segment_count = held.y;
    }
    return select(vec2(t::NOTHING), first, fits);
}

fn encounter(setting: t::ContactSetting, a: sides::Side, b: sides::Side, numbers: vec2<u32>, deep: bool) -> f::Encounter {
    var met: f::Encounter;
    met.a = sides::triangle(a, numbers.x);
    met.b = sides::triangle(b, numbers.y);
    met.heights_a = sides::heights(met.a, met.b);
    met.heights_b = sides::heights(met.b, met.a);
    met.rounding = setting.rounding;
    if deep {
        met.low = -DEEP * setting.size;
        met.high = -setting.touch;
    } else {
        met.low = -setting.touch;
        met.high = setting.margin;
    }
    return met;
}

// A bit for each thing that two triangles have to say.
fn survey(setting: t::ContactSetting, a: sides::Side, b: sides::Side, at: u32, deep: bool) -> u32 {
    let met = encounter(setting, a, b, near_triangles[at].xy, deep);
    let reach = max(abs(met.low), met.high + setting.touch);
    if beyond(met.heights_a, reach) || beyond(met.heights_b, reach) {
        return 0u;
    }
    var wanted = wanted_vertices(sides::owned(a, met.a.number), met.heights_a, met)
        | (wanted_vertices(sides::owned(b, met.b.number), met.heights_b, met) << 3u);
    let edges_a = sides::owned(a, met.a.number) >> 3u;
    let edges_b = sides::owned(b, met.b.number) >> 3u;
    for (var k = 0u; k < 3u; k += 1u) {
        if ((edges_a >> k) & 1u) == 1u {
            wanted |= edges_b << (EDGES + 3u * k);
        }
    }
    var mask = 0u;
    while wanted != 0u {
        let bit = countTrailingZeros(wanted);
        wanted &= wanted - 1u;
        let feature = feature_of(a, b, met, bit);
        if feature.separation != t::DROPPED && (!deep || agrees(setting, feature)) {
            mask |= 1u << bit;
        }
    }
    if !deep && f::crosses(met) {
        if f::segment(a, b, met).start_edge != t::NOTHING {
            mask |= 1u << SEGMENT;
        }
    }
    return mask;
}

fn beyond(heights: vec3<f32>, reach: f32) -> bool {
    return all(heights > vec3(reach)) || all(heights < vec3(-reach));
}

// Bits of the corners that the triangle owns and that are as high as features are.
fn wanted_vertices(owned: u32, heights: vec3<f32>, met: f::Encounter) -> u32 {
    var bits = 0u;
    for (var k = 0u; k < 3u; k += 1u) {
        if ((owned >> k) & 1u) == 1u && heights[k] >= met.low && heights[k] <= met.high {
            bits |= 1u << k;
        }
    }
    return bits;
}

fn feature_of(a: sides::Side, b: sides::Side, met: f::Encounter, bit: u32) -> t::Feature {
    if bit < 3u {
        return f::vertex_feature(a, met.a, met.b, met.heights_a[bit], bit, met.rounding);
    }
    if bit < EDGES {
        return f::vertex_feature(b, met.b, met.a, met.heights_b[bit - 3u], bit - 3u, met.rounding);
    }
    return f::edge_feature(a, b, met, (bit - EDGES) / 3u, (bit - EDGES) % 3u);
}

// Whether a patch speaks for a feature that overlaps, and all those near agree.
fn agrees(setting: t::ContactSetting, feature: t::Feature) -> bool {
    let middle = 0.5 * (feature.point_a + feature.point_b);
    var any_near = false;
    for (var i = 0u; i < setting.patch_count; i += 1u) {
        let patch_near = patches[setting.first_segment + i];
        let way = middle - patch_near.center;
        if dot(way, way) < patch_near.reach * patch_near.reach {
            any_near = true;
            if dot(feature.normal, patch_near.normal) < AGREES {
                return false;
            }
        }
    }
    return any_near;
}

fn write(
    setting: t::ContactSetting, a: sides::Side, b: sides::Side, at: u32, mask: u32, deep: bool, first: vec2<u32>
) {
    let met = encounter(setting, a, b, near_triangles[at].xy, deep);
    var next = first.x;
    var wanted = mask & 0x7fffu;
    while wanted != 0u {
        let bit = countTrailingZeros(wanted);
        wanted &= wanted - 1u;
        features[next] = feature_of(a, b, met, bit);
        next += 1u;
    }
    if (mask >> SEGMENT) == 1u {
        segments[first.y] = f::segment(a, b, met);
    }
}
