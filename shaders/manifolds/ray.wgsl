// Contact generation: patches without an overlapping feature get their points from rays along the normal, cast from
// five points in the patch to where they leave the bodies. One workgroup per pair, one thread per point. The twin of
// `src/manifolds/cpu/ray.rs`.
#import faceoff::agree::agree
#import faceoff::arena::{meshes, words, vector}
#import faceoff::constants::manifolds::{MIN_PROBED_AREA, PROBE_FRACTION, RAY_LENGTH, SHALLOW}
#import faceoff::dispatch::group_index
#import faceoff::empty_patches::{HAS_FEATURE, count_at, list_at}
#import faceoff::sides
#import faceoff::tree
#import faceoff::types as t

@group(0) @binding(2) var<uniform> limits: t::ContactLimits;
@group(0) @binding(3) var<storage, read_write> contact_counters: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read_write> pair_setups: array<t::PairSetup>;
@group(0) @binding(5) var<storage, read> patches: array<t::Patch>;
@group(0) @binding(6) var<storage, read_write> features: array<t::Feature>;
@group(0) @binding(7) var<storage, read> segments: array<t::Segment>;
// The list of patches without an overlapping feature.
@group(0) @binding(8) var<storage, read> contour_links: array<u32>;

// Tolerance of a hit in barycentric coordinates, so that no ray slips through an edge.
const SLACK_SINGLE: f32 = 1.0e-5;
// Points per patch.
const PLACES: u32 = 5u;

var<workgroup> base: u32;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let index = group_index(group);
    if index >= agree(thread, atomicLoad(&contact_counters[t::BATCH_PAIRS])) {
        return;
    }
    let setup = pair_setups[index];
    var listed = 0u;
    if setup.valid != 0u && setup.patch_count > 0u {
        listed = contour_links[count_at(setup)];
    }
    let empty_count = agree(thread, listed);
    if empty_count == 0u {
        return;
    }
    let a = sides::first(setup);
    let b = sides::second(setup);
    if thread < 2u {
        tree::survey(thread, select(a.mesh, b.mesh, thread == 1u));
    }
    if thread == 0u {
        let count = PLACES * empty_count;
        base = atomicAdd(&contact_counters[t::FEATURES], count);
        let fits = base <= limits.features && count <= limits.features - base;
        pair_setups[index].first_probe = base;
        pair_setups[index].probe_count = select(0u, count, fits);
        base = select(t::NOTHING, base, fits);
    }
    if workgroupUniformLoad(&base) == t::NOTHING {
        return;
    }
    for (var i = thread; i < PLACES * empty_count; i += 64u) {
        let at = empty_patch_at(setup, contour_links[list_at(setup, i / PLACES)]);
        features[base + i] = probe(a, b, patches[at].normal, place_of(at, i % PLACES), setup);
    }
    storageBarrier();
    workgroupBarrier();
    for (var n = thread; n < empty_count; n += 64u) {
        let first = base + PLACES * n;
        // The separation of dropped features is larger than any other.
        var deepest = t::DROPPED;
        for (var k = 0u; k < PLACES; k += 1u) {
            deepest = min(deepest, features[first + k].separation);
        }
        let entry = contour_links[list_at(setup, n)];
        let empty_patch = patches[empty_patch_at(setup, entry)];
        if deepest == t::DROPPED {
            if empty_patch.area > MIN_PROBED_AREA * setup.size * setup.size {
                features[first] = shallow(empty_patch, setup.size);
            }
        } else if deepest >= -setup.touch && (entry & HAS_FEATURE) != 0u {
            // Where the bodies only touch, their other features suffice.
            for (var k = 0u; k < PLACES; k += 1u) {
                features[first + k].separation = t::DROPPED;
            }
        }
    }
}

// Index of the patch of an entry of the list.
fn empty_patch_at(setup: t::PairSetup, entry: u32) -> u32 {
    return setup.first_segment / 2u + (entry & ~HAS_FEATURE);
}

// The centre of the patch at an index, or an extreme of its contour moved inward by a quarter.
fn place_of(at: u32, k: u32) -> vec3<f32> {
    let center = patches[at].center;
    if k == 0u {
        return center;
    }
    return center + PROBE_FRACTION * (segments[patches[at].extremes[k - 1u]].start - center);
}

// The contact point of a patch from two rays through p, if both leave a body. The rays start slightly before p, because
// rounding may put p outside where the bodies only touch.
fn probe(a: sides::Side, b: sides::Side, n: vec3<f32>, p: vec3<f32>, setup: t::PairSetup) -> t::Feature {
    var feature: t::Feature;
    feature.separation = t::DROPPED;
    let back = setup.touch;
    let max_distance = RAY_LENGTH * setup.size + back;
    let up = exit(a, 0u, p - n * back, n, max_distance);
    if up.triangle == t::NOTHING {
        return feature;
    }
    let down = exit(b, 1u, p + n * back, -n, max_distance);
    if down.triangle == t::NOTHING {
        return feature;
    }
    feature.point_a = p + n * (up.distance - back);
    feature.point_b = p - n * (down.distance - back);
    feature.normal = n;
    feature.separation = 2.0 * back - (up.distance + down.distance);
    feature.vertex = t::NOTHING;
    feature.a = up.triangle;
    feature.b = down.triangle;
    return feature;
}

// A contact for a patch without ray hits.
fn shallow(empty_patch: t::Patch, size: f32) -> t::Feature {
    // Twice the area over the length of a circle is its radius.
    let depth = min(2.0 * empty_patch.area / empty_patch.length, SHALLOW * size);
    var feature: t::Feature;
    feature.point_a = empty_patch.center + empty_patch.normal * (0.5 * depth);
    feature.point_b = empty_patch.center - empty_patch.normal * (0.5 * depth);
    feature.normal = empty_patch.normal;
    feature.separation = -depth;
    feature.vertex = t::NOTHING;
    feature.a = empty_patch.a;
    feature.b = empty_patch.b;
    return feature;
}

struct Exit {
    distance: f32,
    triangle: u32,
}

// Distance and triangle of the first hit of the ray from `start` along the unit vector `direction`. The triangle is
// `NOTHING` if the hit is farther than `max_distance` or the ray does not leave the body there. `end` is the body's
// position in the pair.
fn exit(side: sides::Side, end: u32, start: vec3<f32>, direction: vec3<f32>, max_distance: f32) -> Exit {
    // In the body's own axes, scaled.
    let origin = sides::to_own(side, start);
    let along = direction * side.rotation;
    // Keeps the reciprocal finite.
    let inverse = 1.0 / select(along, vec3(1.0e-12), abs(along) < vec3(1.0e-12));
    let whole = abs(side.scale) * meshes[side.mesh].box_half;
    let pad = 4.0e-6 * (whole.x + whole.y + whole.z);
    var nearest = Exit(max_distance, t::NOTHING);
    // The node at hand. Of it and its ancestors, the children that are still to be opened: eight bits per level, the
    // lowest level first.
    var level = meshes[side.mesh].levels - 1u;
    var number = 0u;
    var waiting = vec2(0u);
    var is_new = true;
    var done = false;
    while !done {
        var mask = 0u;
        if is_new {
            for (var k = 0u; k < 8u; k += 1u) {
                let child = 8u * number + k;
                if level == 0u {
                    if child < side.triangle_count {
                        let distance = meets(side, child, origin, along);
                        if distance < nearest.distance {
                            nearest = Exit(distance, child);
                        }
                    }
                } else {
                    let at = tree::box_of(end, tree::node(level - 1u, child));
                    if at != 0u && passes(side, at, origin, inverse, pad, nearest.distance) {
                        mask |= 1u << k;
                    }
                }
            }
        } else {
            mask = extractBits(waiting[level / 4u], 8u * (level % 4u), 8u);
        }
        is_new = mask != 0u;
        if is_new {
            let k = firstLeadingBit(mask);
            waiting[level / 4u] = insertBits(waiting[level / 4u], mask & ~(1u << k), 8u * (level % 4u), 8u);
            level -= 1u;
            number = 8u * number + k;
        } else {
            level += 1u;
            number /= 8u;
            done = level == meshes[side.mesh].levels;
        }
    }
    // Some devices abort long loops.
    if !done {
        atomicOr(&contact_counters[t::CONTACTS_CUT_SHORT], 1u);
    }
    if nearest.triangle != t::NOTHING && dot(direction, sides::baked_normal(side, nearest.triangle)) <= 0.0 {
        nearest.triangle = t::NOTHING;
    }
    return nearest;
}

// Whether the ray meets a box within `max_distance`.
fn passes(side: sides::Side, at: u32, origin: vec3<f32>, inverse: vec3<f32>, pad: f32, max_distance: f32) -> bool {
    let apart = side.scale * vector(at) - origin;
    let half = abs(side.scale) * vector(at + 3u) + pad;
    let s = (apart - half) * inverse;
    let e = (apart + half) * inverse;
    let low = min(s, e);
    let high = max(s, e);
    let enter = max(0.0, max(low.x, max(low.y, low.z)));
    let leaves = min(max_distance, min(high.x, min(high.y, high.z)));
    return enter <= leaves + 1.0e-6 * (abs(enter) + abs(leaves)) + pad;
}

// Distance at which the ray hits the triangle; `DROPPED` if it misses.
fn meets(side: sides::Side, number: u32, origin: vec3<f32>, direction: vec3<f32>) -> f32 {
    let at = side.triangles + 9u * number;
    let a = side.scale * vector(at) - origin;
    let ab = side.scale * vector(at + 3u) - origin - a;
    let ac = side.scale * vector(at + 6u) - origin - a;
    let normal = cross(ab, ac);
    let slope = dot(direction, normal);
    if slope * slope <= 1.0e-12 * dot(normal, normal) {
        return t::DROPPED;
    }
    let moment = cross(a, direction);
    let v = dot(moment, ac) / slope;
    let w = -dot(moment, ab) / slope;
    let distance = dot(a, normal) / slope;
    if v >= -SLACK_SINGLE && w >= -SLACK_SINGLE && v + w <= 1.0 + SLACK_SINGLE && distance >= 0.0 {
        return distance;
    }
    return t::DROPPED;
}
