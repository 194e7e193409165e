// Contact generation: patches without an overlapping feature get their points from rays along the normal, cast from
// five points in the patch to where they leave the bodies, and from the vertices that reach deepest. One workgroup per
// pair, one thread per point.
#import faceoff::agree::agree
#import faceoff::constants::manifolds::{HALFWAY_DEPTH, MIN_PROBED_AREA, PROBE_FRACTION, SHALLOW}
#import faceoff::deepest::{deepest_unfinished, probe_of_vertex}
#import faceoff::dispatch::group_index
#import faceoff::empty_patches::{HAS_FEATURE, count_at, list_at}
#import faceoff::probes::{Probe, cast_through, rays_unfinished}
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

// Points per patch: five in it, and the vertex of each body that reaches deepest.
const PLACES: u32 = 7u;
const FIRST_VERTEX: u32 = 5u;
// Points of a patch at a rim: in the middle of the part of the rim that is in the other body, and halfway to both of
// its ends.
const RIM_PLACES: u32 = 3u;

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
        features[base + i] = point_of(a, b, at, i % PLACES, setup);
    }
    // Some devices abort long loops.
    if rays_unfinished || deepest_unfinished {
        atomicOr(&contact_counters[t::CONTACTS_CUT_SHORT], 1u);
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
    return setup.first_segment + (entry & ~HAS_FEATURE);
}

// The centre of the patch at an index, or an extreme of its contour moved inward by a quarter.
fn place_of(at: u32, k: u32) -> vec3<f32> {
    let center = patches[at].center;
    if k == 0u || k >= FIRST_VERTEX {
        return center;
    }
    return center + PROBE_FRACTION * (segments[patches[at].extremes[k - 1u]].start - center);
}

// The k-th point of the patch at an index, if both rays leave a body.
fn point_of(a: sides::Side, b: sides::Side, at: u32, k: u32, setup: t::PairSetup) -> t::Feature {
    var feature: t::Feature;
    let own = patches[at];
    if own.rim != 0u {
        return rim_point(own, k);
    }
    let n = own.normal;
    var p = place_of(at, k);
    var probe = cast_through(a, b, n, p, setup);
    if k >= FIRST_VERTEX {
        let deepest = probe_of_vertex(a, b, setup, own, probe, k - FIRST_VERTEX);
        probe = deepest.probe;
        p = deepest.place;
    }
    feature.separation = probe.separation;
    if probe.separation == t::DROPPED {
        return feature;
    }
    feature.point_a = p + n * probe.ways.x;
    feature.point_b = p - n * probe.ways.y;
    feature.normal = n;
    feature.vertex = t::NOTHING;
    feature.a = probe.triangles.x;
    feature.b = probe.triangles.y;
    return feature;
}

// The k-th point of a patch at a rim, with the depth of a parabola.
fn rim_point(own: t::Patch, k: u32) -> t::Feature {
    var feature: t::Feature;
    feature.separation = t::DROPPED;
    if k >= RIM_PLACES || (k > 0u && all(own.rim_half == vec3(0.0))) {
        return feature;
    }
    let along = select(select(-0.5, 0.5, k == 1u), 0.0, k == 0u);
    let depth = own.rim_depth * select(HALFWAY_DEPTH, 1.0, k == 0u);
    let at = own.rim_middle + own.rim_half * along;
    let way = own.normal * depth;
    feature.point_a = select(at + way, at, own.rim == 1u);
    feature.point_b = select(at, at - way, own.rim == 1u);
    feature.normal = own.normal;
    feature.separation = -depth;
    feature.vertex = t::NOTHING;
    feature.a = own.a;
    feature.b = own.b;
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
