// Contact generation: patches without an overlapping feature get points by rays along their normal, from five places in
// each to where they leave the bodies. A workgroup a pair, a thread a place. `src/manifolds/cpu/ray.rs` explains the
// rays.
#import faceoff::arena::{meshes, words, vector}
#import faceoff::constants::manifolds::{LEAST_PROBED_AREA, PROBED, RAY, SHALLOW}
#import faceoff::dispatch::group_index
#import faceoff::sides
#import faceoff::tree
#import faceoff::types as t

@group(0) @binding(2) var<uniform> limits: t::ContactLimits;
@group(0) @binding(3) var<storage, read_write> contact_counters: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read_write> settings: array<t::ContactSetting>;
@group(0) @binding(5) var<storage, read> patches: array<t::Patch>;
@group(0) @binding(6) var<storage, read_write> features: array<t::Feature>;

// How far outside a triangle a ray may pass, in barycentric coordinates, so that none slips through an edge.
const SLACK_SINGLE: f32 = 1.0e-5;
// Places in a patch.
const PLACES: u32 = 5u;

var<workgroup> base: u32;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let index = group_index(group);
    if index >= atomicLoad(&contact_counters[t::MARGIN_PAIRS]) {
        return;
    }
    let setting = settings[index];
    if setting.valid == 0u || setting.patch_count == 0u {
        return;
    }
    var alone = 0u;
    for (var k = 0u; k < setting.patch_count; k += 1u) {
        alone += 1u - patches[setting.first_segment + k].kept;
    }
    if alone == 0u {
        return;
    }
    let a = sides::first(setting);
    let b = sides::second(setting);
    if thread < 2u {
        tree::survey(thread, select(a.mesh, b.mesh, thread == 1u));
    }
    if thread == 0u {
        let count = PLACES * alone;
        base = atomicAdd(&contact_counters[t::FEATURES], count);
        let fits = base <= limits.features && count <= limits.features - base;
        settings[index].first_probe = base;
        settings[index].probe_count = select(0u, count, fits);
        base = select(t::NOTHING, base, fits);
    }
    workgroupBarrier();
    if base == t::NOTHING {
        return;
    }
    for (var i = thread; i < PLACES * alone; i += 64u) {
        let asked = patches[lonely(setting, i / PLACES)];
        features[base + i] = probe(a, b, asked, place_of(asked, i % PLACES), setting);
    }
    storageBarrier();
    workgroupBarrier();
    for (var n = thread; n < alone; n += 64u) {
        let first = base + PLACES * n;
        // Dropped ones are larger than any.
        var deepest = t::DROPPED;
        for (var k = 0u; k < PLACES; k += 1u) {
            deepest = min(deepest, features[first + k].separation);
        }
        let asked = patches[lonely(setting, n)];
        if deepest == t::DROPPED {
            if asked.area > LEAST_PROBED_AREA * setting.size * setting.size {
                features[first] = shallow(asked, setting.size);
            }
        } else if deepest >= -setting.touch && has_feature(setting, asked) {
            // Where the bodies only touch, their features have said so.
            for (var k = 0u; k < PLACES; k += 1u) {
                features[first + k].separation = t::DROPPED;
            }
        }
    }
}

// Whether a feature that touches or is apart is near a patch.
fn has_feature(setting: t::ContactSetting, asked: t::Patch) -> bool {
    for (var i = setting.first_feature; i < setting.first_feature + setting.feature_count; i += 1u) {
        let way = 0.5 * (features[i].point_a + features[i].point_b) - asked.center;
        if features[i].separation != t::DROPPED && dot(way, way) < asked.reach * asked.reach {
            return true;
        }
    }
    return false;
}

// Where the patch is that is the n-th without a feature.
fn lonely(setting: t::ContactSetting, n: u32) -> u32 {
    var left = n;
    var at = setting.first_segment;
    for (var k = 0u; k < setting.patch_count; k += 1u) {
        at = setting.first_segment + k;
        if patches[at].kept == 0u {
            if left == 0u {
                break;
            }
            left -= 1u;
        }
    }
    return at;
}

// The patch's centre, and the contour's extremes drawn in by a quarter.
fn place_of(asked: t::Patch, k: u32) -> vec3<f32> {
    var arm = vec3(0.0);
    switch k {
        case 1u: { arm = asked.arm_a; }
        case 2u: { arm = asked.arm_b; }
        case 3u: { arm = asked.arm_c; }
        case 4u: { arm = asked.arm_d; }
        default: {}
    }
    return asked.center + PROBED * arm;
}

// The point of a patch by rays from p, if both leave a body. They start a little before it: where the bodies only touch,
// rounding may have p outside of one.
fn probe(a: sides::Side, b: sides::Side, asked: t::Patch, p: vec3<f32>, setting: t::ContactSetting) -> t::Feature {
    var feature: t::Feature;
    feature.separation = t::DROPPED;
    let n = asked.normal;
    let back = setting.touch;
    let most = RAY * setting.size + back;
    let up = leave(a, 0u, p - n * back, n, most);
    if up.triangle == t::NOTHING {
        return feature;
    }
    let down = leave(b, 1u, p + n * back, -n, most);
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

// What stands for a patch that no ray leaves.
fn shallow(asked: t::Patch, size: f32) -> t::Feature {
    // Twice the area over the length is the radius of a circle.
    let depth = min(2.0 * asked.area / asked.length, SHALLOW * size);
    var feature: t::Feature;
    feature.point_a = asked.center + asked.normal * (0.5 * depth);
    feature.point_b = asked.center - asked.normal * (0.5 * depth);
    feature.normal = asked.normal;
    feature.separation = -depth;
    feature.vertex = t::NOTHING;
    feature.a = asked.a;
    feature.b = asked.b;
    return feature;
}

struct Exit {
    distance: f32,
    triangle: u32,
}

// How far the ray from `start` along the unit vector `way` runs until it meets the body, and which triangle is there;
// `NOTHING` if that is beyond `most` or the ray does not leave the body there. `end` is the body's place in the pair.
fn leave(side: sides::Side, end: u32, start: vec3<f32>, way: vec3<f32>, most: f32) -> Exit {
    // In the body's own axes, scaled.
    let origin = sides::to_own(side, start);
    let along = way * side.rotation;
    // Far from overflow, and never zero.
    let inverse = 1.0 / select(along, vec3(1.0e-12), abs(along) < vec3(1.0e-12));
    let whole = abs(side.scale) * meshes[side.mesh].box_half;
    let pad = 4.0e-6 * (whole.x + whole.y + whole.z);
    var nearest = Exit(most, t::NOTHING);
    // Of each level at most eight wait, less the one that is opened.
    var waiting: array<u32, 64>;
    waiting[0] = tree::node(meshes[side.mesh].levels - 1u, 0u);
    var depth = 1u;
    while depth > 0u {
        depth -= 1u;
        let node = waiting[depth];
        let level = tree::level_of(node);
        let number = node & tree::NUMBER;
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
                    waiting[depth] = tree::node(level - 1u, child);
                    depth += 1u;
                }
            }
        }
    }
    // Some devices leave a loop that takes long.
    if depth > 0u {
        atomicOr(&contact_counters[t::CONTACTS_CUT_SHORT], 1u);
    }
    if nearest.triangle != t::NOTHING && dot(way, sides::baked_normal(side, nearest.triangle)) <= 0.0 {
        nearest.triangle = t::NOTHING;
    }
    return nearest;
}

// Whether the ray meets a box before it has run as far as `most`.
fn passes(side: sides::Side, at: u32, origin: vec3<f32>, inverse: vec3<f32>, pad: f32, most: f32) -> bool {
    let apart = side.scale * vector(at) - origin;
    let half = abs(side.scale) * vector(at + 3u) + pad;
    let s = (apart - half) * inverse;
    let e = (apart + half) * inverse;
    let low = min(s, e);
    let high = max(s, e);
    let enter = max(0.0, max(low.x, max(low.y, low.z)));
    let leaves = min(most, min(high.x, min(high.y, high.z)));
    return enter <= leaves + 1.0e-6 * (abs(enter) + abs(leaves)) + pad;
}

// How far along the way the ray meets the triangle; `DROPPED` if it does not.
fn meets(side: sides::Side, number: u32, origin: vec3<f32>, way: vec3<f32>) -> f32 {
    let at = side.triangles + 9u * number;
    let a = side.scale * vector(at) - origin;
    let ab = side.scale * vector(at + 3u) - origin - a;
    let ac = side.scale * vector(at + 6u) - origin - a;
    let normal = cross(ab, ac);
    let slope = dot(way, normal);
    if slope * slope <= 1.0e-12 * dot(normal, normal) {
        return t::DROPPED;
    }
    let turn = cross(a, way);
    let v = dot(turn, ac) / slope;
    let w = -dot(turn, ab) / slope;
    let distance = dot(a, normal) / slope;
    if v >= -SLACK_SINGLE && w >= -SLACK_SINGLE && v + w <= 1.0 + SLACK_SINGLE && distance >= 0.0 {
        return distance;
    }
    return t::DROPPED;
}
