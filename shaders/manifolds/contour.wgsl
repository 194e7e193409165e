// Contact generation: joins the segments of a pair into closed contours, and computes their patches. One workgroup per
// pair. The twin of `src/manifolds/cpu/contour.rs`.
#import faceoff::agree::agree
#import faceoff::arena::{meshes, words}
#import faceoff::constants::manifolds::{MIN_ENCLOSED_AREA, REACH_FACTOR}
#import faceoff::contours::{
    TIED, contour_links, count, end_of, first, label_of, ordered, partner_of, place, root_of, segments, set_segments, size_of, slot
}
#import faceoff::contour_sums::{maximum, total}
#import faceoff::dispatch::group_index
#import faceoff::near_patches::{build_level, patches}
#import faceoff::rims::{Rim, ends_at_rim, rim_of}
#import faceoff::sides
#import faceoff::thread_sums::{before_threads, of_all_threads}
#import faceoff::types as t

@group(0) @binding(4) var<storage, read_write> contact_counters: array<atomic<u32>>;
@group(0) @binding(5) var<storage, read_write> pair_setups: array<t::PairSetup>;

// Loose ends closer than this are the same point, in units of the rounding of heights.
const TIE_ROUNDINGS: f32 = 4.0;
// With more loose ends than this, none are tied.
const MAX_LOOSE_ENDS: u32 = 1024u;

var<workgroup> loose: atomic<u32>;
var<workgroup> changed: array<atomic<u32>, 3>;
// Labels of 64 segments.
var<workgroup> labels: array<u32, 64>;
var<workgroup> best_reach: array<vec4<f32>, 64>;
var<workgroup> best_end: array<vec4<u32>, 64>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let index = group_index(group);
    if index >= agree(thread, atomicLoad(&contact_counters[t::BATCH_PAIRS])) {
        return;
    }
    let setup = pair_setups[index];
    let number = agree(thread, select(setup.segment_count, 0u, setup.valid == 0u));
    if number == 0u {
        return;
    }
    set_segments(setup.first_segment, number);
    let a = sides::first(setup);
    let b = sides::second(setup);
    let has_rims = agree(thread, u32(a.some_two_sided || b.some_two_sided)) == 1u;
    join(thread);
    tie_loose_ends(thread, TIE_ROUNDINGS * setup.rounding);
    label(thread);
    let contours = agree(thread, group_by_contour(a, b, has_rims, thread));
    find_patches(index, setup, a, b, has_rims, contours, thread);
}

// The crossing at an end: an edge of one body, and the triangle of the other that it pierces.
fn key(end: u32) -> vec2<u32> {
    let segment = segments[first + end / 2u];
    let edge = select(segment.start_edge, segment.end_edge, end % 2u == 1u);
    return vec2(edge, select(segment.b, segment.a, (edge & t::OF_SECOND) != 0u));
}

// Finds for each end another with the same key.
fn join(thread: u32) {
    for (var i = thread; i < 4u * count; i += 64u) {
        atomicStore(&contour_links[slot(i)], 0u);
    }
    for (var i = thread; i < 2u * count; i += 64u) {
        atomicStore(&contour_links[partner_of(i)], t::NOTHING);
    }
    for (var i = thread; i < count; i += 64u) {
        atomicStore(&contour_links[label_of(i)], i);
        atomicStore(&contour_links[size_of(i)], 0u);
    }
    if thread == 0u {
        atomicStore(&loose, 0u);
    }
    sync();
    var end = thread;
    while end < 2u * count {
        let own = key(end);
        var at = hash(own) % (4u * count);
        loop {
            var held = atomicLoad(&contour_links[slot(at)]);
            if held == 0u {
                let put = atomicCompareExchangeWeak(&contour_links[slot(at)], 0u, end + 1u);
                if put.exchanged {
                    break;
                }
                held = put.old_value;
            }
            // The slot may still be empty: weak exchanges can fail.
            if held != 0u {
                if all(key(held - 1u) == own) {
                    // The first end owns the slot. If there are several others, any of them may be the partner.
                    atomicStore(&contour_links[partner_of(end)], held - 1u);
                    atomicStore(&contour_links[partner_of(held - 1u)], end);
                    break;
                }
                at = (at + 1u) % (4u * count);
            }
        }
        end += 64u;
    }
    check(end >= 2u * count);
    sync();
}

// Some devices abort long loops.
fn check(finished: bool) {
    if !finished {
        atomicOr(&contact_counters[t::CONTACTS_CUT_SHORT], 1u);
    }
}

fn hash(key: vec2<u32>) -> u32 {
    var h = key.x * 0x9e3779b1u ^ (key.y + 0x7f4a7c15u) * 0x85ebca77u;
    h = (h ^ (h >> 15u)) * 0xc2b2ae3du;
    return h ^ (h >> 13u);
}

// Joins loose ends by position. Rounding may break a contour where corners of one body lie on edges of the other.
fn tie_loose_ends(thread: u32, reach: f32) {
    for (var end = thread; end < 2u * count; end += 64u) {
        if atomicLoad(&contour_links[partner_of(end)]) == t::NOTHING {
            // The table is long enough for twice as many.
            atomicStore(&contour_links[slot(atomicAdd(&loose, 1u))], end);
        }
    }
    sync();
    let number = agree(thread, atomicLoad(&loose));
    if number > MAX_LOOSE_ENDS {
        return;
    }
    for (var i = thread; i < number; i += 64u) {
        let end = atomicLoad(&contour_links[slot(i)]);
        let p = place(end);
        var nearest = t::NOTHING;
        for (var j = 0u; j < number; j += 1u) {
            let other = atomicLoad(&contour_links[slot(j)]);
            let offset = place(other) - p;
            if other != end && dot(offset, offset) <= reach * reach {
                nearest = min(nearest, other);
            }
        }
        atomicStore(&contour_links[partner_of(end)], nearest | TIED);
    }
    sync();
}

// Gives all segments of a contour the number of its first segment.
fn label(thread: u32) {
    if thread < 3u {
        atomicStore(&changed[thread], 0u);
    }
    workgroupBarrier();
    var flag = 0u;
    var go_on = true;
    for (var round = 0u; round <= count; round += 1u) {
        var any_change = false;
        for (var end = thread; end < 2u * count; end += 64u) {
            let partner = atomicLoad(&contour_links[partner_of(end)]);
            if partner != t::NOTHING {
                let near = (partner & ~TIED) / 2u;
                let own = atomicLoad(&contour_links[label_of(end / 2u)]);
                let other = atomicLoad(&contour_links[label_of(near)]);
                if own != other {
                    any_change = true;
                    let least = min(own, other);
                    atomicMin(&contour_links[label_of(end / 2u)], least);
                    atomicMin(&contour_links[label_of(near)], least);
                    // The segment after which the larger label was named gets the smaller one too.
                    atomicMin(&contour_links[label_of(max(own, other))], least);
                }
            }
            let named = atomicLoad(&contour_links[label_of(end / 2u)]);
            let root = atomicLoad(&contour_links[label_of(named)]);
            if root < named {
                any_change = true;
                atomicMin(&contour_links[label_of(end / 2u)], root);
            }
        }
        if any_change {
            atomicStore(&changed[flag], 1u);
        }
        sync();
        go_on = agree(thread, atomicLoad(&changed[flag])) == 1u;
        // Clears the flag of the round after the next. Other threads may still read this round's.
        if thread == 0u {
            atomicStore(&changed[(flag + 2u) % 3u], 0u);
        }
        flag = (flag + 1u) % 3u;
        if !go_on {
            break;
        }
    }
    check(!go_on);
    for (var i = thread; i < count; i += 64u) {
        atomicAdd(&contour_links[size_of(atomicLoad(&contour_links[label_of(i)]))], 1u);
    }
    sync();
}

// Orders the segments by contour. Contours come in the order of their first segments, and the segments of each in their
// own order. Returns the number of contours that may have a patch: contours of more than one segment, or that end at a
// rim.
fn group_by_contour(a: sides::Side, b: sides::Side, has_rims: bool, thread: u32) -> u32 {
    var before = vec2(0u);
    for (var round = 0u; round < count; round += 64u) {
        let i = round + thread;
        var own = vec2(0u);
        if i < count {
            own.x = atomicLoad(&contour_links[size_of(i)]);
            own.y = u32(own.x > 1u || (own.x == 1u && has_rims && ends_at_rim(a, b, i)));
        }
        let earlier = before + before_threads(own, thread);
        if i < count {
            // This start grows to the end while segments are placed.
            atomicStore(&contour_links[end_of(i)], earlier.x);
        }
        if own.y == 1u {
            atomicStore(&contour_links[root_of(earlier.y)], i);
        }
        before += of_all_threads();
        workgroupBarrier();
    }
    sync();
    for (var round = 0u; round < count; round += 64u) {
        let i = round + thread;
        var root = t::NOTHING;
        if i < count {
            root = atomicLoad(&contour_links[label_of(i)]);
        }
        labels[thread] = root;
        workgroupBarrier();
        if i < count {
            var at = atomicLoad(&contour_links[end_of(root)]);
            for (var other = 0u; other < thread; other += 1u) {
                at += u32(labels[other] == root);
            }
            atomicStore(&contour_links[ordered(at)], i);
        }
        sync();
        if i < count {
            atomicAdd(&contour_links[end_of(root)], 1u);
        }
        sync();
    }
    return before.y;
}

fn find_patches(
    index: u32, setup: t::PairSetup, a: sides::Side, b: sides::Side, has_rims: bool, contours: u32, thread: u32
) {
    var number = 0u;
    var contour = 0u;
    while contour < contours {
        let found = patch_of(setup, a, b, has_rims, atomicLoad(&contour_links[root_of(contour)]), thread);
        contour += 1u;
        if found.reach > 0.0 {
            if thread == 0u {
                patches[first + number] = found;
            }
            number += 1u;
        }
    }
    check(contour >= contours);
    sync();
    let patch_count = agree(thread, number);
    var level = 1u;
    while patch_count > 1u << (3u * (level - 1u)) && level <= 10u {
        build_level(first, patch_count, level, thread);
        level += 1u;
        sync();
    }
    if thread == 0u {
        pair_setups[index].patch_count = patch_count;
    }
}

// The patch of the contour whose first segment is `root`. Its reach is zero if it encloses no area and ends at no rim.
fn patch_of(
    setup: t::PairSetup, a: sides::Side, b: sides::Side, has_rims: bool, root: u32, thread: u32
) -> t::Patch {
    var result: t::Patch;
    result.reach = 0.0;
    let end = atomicLoad(&contour_links[end_of(root)]);
    let range = vec2(end - atomicLoad(&contour_links[size_of(root)]), end);
    // Sums are relative to the first point, for precision.
    let origin = segments[first + root].start;
    var sum = vec4(0.0);
    for (var i = range.x + thread; i < range.y; i += 64u) {
        let segment = segments[first + atomicLoad(&contour_links[ordered(i)])];
        let along = segment.end - segment.start;
        let length = sqrt(dot(along, along));
        sum += vec4(((segment.start - origin) + (segment.end - origin)) * (0.5 * length), length);
    }
    sum = total(sum, thread);
    let length = sum.w;
    if agree(thread, u32(length > 0.0)) == 0u {
        return result;
    }
    let center = origin + sum.xyz / length;
    var area = vec3(0.0);
    var square = 0.0;
    for (var i = range.x + thread; i < range.y; i += 64u) {
        let segment = segments[first + atomicLoad(&contour_links[ordered(i)])];
        let anchor = segment.start - center;
        let other = segment.end - center;
        area += 0.5 * cross(anchor, segment.end - segment.start);
        square = max(square, max(dot(anchor, anchor), dot(other, other)));
    }
    area = total(vec4(area, 0.0), thread).xyz;
    let radius = sqrt(maximum(square, thread));
    let size = sqrt(dot(area, area));
    // A contour that retraces itself encloses only rounding errors.
    let encloses = size > MIN_ENCLOSED_AREA * setup.size * setup.size && size > 0.5 * setup.rounding * length;
    var rim: Rim;
    rim.owner = 0u;
    if has_rims {
        rim = rim_of(setup, a, b, range, center, length, thread);
    }
    if agree(thread, u32(encloses || rim.owner != 0u)) == 0u {
        return result;
    }
    result.center = center;
    result.normal = rim.normal;
    if rim.owner == 0u {
        result.normal = area / size;
    }
    result.rim = rim.owner;
    result.rim_middle = rim.middle;
    result.rim_half = rim.half;
    result.rim_depth = rim.depth;
    result.area = size;
    result.length = length;
    result.reach = REACH_FACTOR * radius + setup.margin;
    result.a = segments[first + root].a;
    result.b = segments[first + root].b;

    // The first extreme is the farthest from the centre, so the order of the bodies does not matter.
    let n = result.normal;
    let to_first = farthest(thread, range, center, mat3x3(vec3(0.0), vec3(0.0), vec3(0.0)), n).x;
    let out = segments[first + to_first].start - center;
    let across = cross(n, out);
    let others = farthest(thread, range, center, mat3x3(-out, across, -across), n).yzw;
    result.extremes = vec4(first) + vec4(to_first, others);
    return result;
}

// The segments of a contour whose starts are farthest from the centre: perpendicular to the normal, and along each of
// three directions.
fn farthest(thread: u32, range: vec2<u32>, center: vec3<f32>, ways: mat3x3<f32>, normal: vec3<f32>) -> vec4<u32> {
    var best = vec4(-3.0e38);
    var number = vec4(0u);
    for (var i = range.x + thread; i < range.y; i += 64u) {
        let segment = atomicLoad(&contour_links[ordered(i)]);
        let anchor = segments[first + segment].start - center;
        let lateral = anchor - normal * dot(anchor, normal);
        let reach = vec4(dot(lateral, lateral), anchor * ways);
        number = select(number, vec4(segment), reach > best);
        best = max(best, reach);
    }
    best_reach[thread] = best;
    best_end[thread] = number;
    workgroupBarrier();
    for (var half = 32u; half > 0u; half /= 2u) {
        if thread < half {
            let other = best_reach[thread + half];
            let other_end = best_end[thread + half];
            let own = best_reach[thread];
            let own_end = best_end[thread];
            let better = (other > own) | ((other == own) & (other_end < own_end));
            best_reach[thread] = select(own, other, better);
            best_end[thread] = select(own_end, other_end, better);
        }
        workgroupBarrier();
    }
    let result = best_end[0];
    workgroupBarrier();
    return result;
}

// Barrier for all threads, and for their writes to storage.
fn sync() {
    storageBarrier();
    workgroupBarrier();
}
