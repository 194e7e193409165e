#define_import_path faceoff::near_patches

// The patches of a pair that reach a point. Patches are ordered along the meshes' trees, so a tree of spheres over that
// order leaves out most: node q of level j covers patches 8^j q to 8^j (q + 1), and is kept in the patch at its start
// plus j - 1. Nodes with a single child are left out.

#import faceoff::math::max_component
#import faceoff::types as t

@group(0) @binding(9) var<storage, read_write> patches: array<t::Patch>;

// Enough for 2^32 patches.
const MAX_LEVEL: u32 = 10u;

// The device aborted a loop.
var<private> search_unfinished: bool = false;

// The number of the first patch, from number `start` on, that reaches the point; `count` if there is none. The pair's
// patches begin at index `first`.
fn next_near(first: u32, count: u32, start: u32, p: vec3<f32>) -> u32 {
    var k = start;
    var is_near = false;
    while k < count && !is_near {
        var level = highest_level(k, count);
        while level > 0u && reaches(node_at(first + k, level), p) {
            level -= 1u;
        }
        if level == 0u {
            is_near = reaches(sphere_of(first + k), p);
        }
        if !is_near {
            k += 1u << (3u * level);
        }
    }
    search_unfinished = search_unfinished || (k < count && !is_near);
    return select(count, k, is_near);
}

// The level of the highest node that starts at a patch; 0 if only the patch itself does.
fn highest_level(k: u32, count: u32) -> u32 {
    var level = min(countTrailingZeros(k) / 3u, MAX_LEVEL);
    while level > 0u && (count - k - 1u) >> (3u * (level - 1u)) == 0u {
        level -= 1u;
    }
    return level;
}

// Centre and radius.
fn node_at(at: u32, level: u32) -> vec4<f32> {
    let holder = at + level - 1u;
    return vec4(patches[holder].node_center, patches[holder].node_radius);
}

fn sphere_of(at: u32) -> vec4<f32> {
    return vec4(patches[at].center, patches[at].reach);
}

fn reaches(sphere: vec4<f32>, p: vec3<f32>) -> bool {
    let offset = p - sphere.xyz;
    return dot(offset, offset) < sphere.w * sphere.w;
}

// Computes the nodes of a level, whose children are complete. All 64 threads of a workgroup share the work.
fn build_level(first: u32, count: u32, level: u32, thread: u32) {
    let child_size = 1u << (3u * (level - 1u));
    for (var start = 8u * child_size * thread; start + child_size < count; start += 8u * child_size * 64u) {
        var low = vec3(3.0e38);
        var high = vec3(-3.0e38);
        for (var child = start; child < min(start + 8u * child_size, count); child += child_size) {
            let sphere = child_at(first, count, child, level - 1u);
            low = min(low, sphere.xyz);
            high = max(high, sphere.xyz);
        }
        let center = 0.5 * (low + high);
        var radius = 0.0;
        for (var child = start; child < min(start + 8u * child_size, count); child += child_size) {
            let sphere = child_at(first, count, child, level - 1u);
            let offset = sphere.xyz - center;
            radius = max(radius, sqrt(dot(offset, offset)) + sphere.w);
        }
        patches[first + start + level - 1u].node_center = center;
        // Rounding must not leave a patch out.
        patches[first + start + level - 1u].node_radius = 1.00001 * radius + 1.0e-6 * max_component(abs(center));
    }
}

// The sphere of a child: a node of at most this level, or a patch.
fn child_at(first: u32, count: u32, start: u32, level: u32) -> vec4<f32> {
    let own = min(level, highest_level(start, count));
    if own == 0u {
        return sphere_of(first + start);
    }
    return node_at(first + start, own);
}
