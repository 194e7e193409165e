// BroadPhase: the bodies in the order of their buckets, and the range of each bucket. One thread per body.
#import faceoff::dispatch::group_index
#import faceoff::grid::{center_of, level_of}
#import faceoff::types::{Body, GridEntry, Mesh, Step}

@group(0) @binding(0) var<uniform> step: Step;
@group(0) @binding(1) var<storage, read> bodies: array<Body>;
@group(0) @binding(2) var<storage, read> meshes: array<Mesh>;
@group(0) @binding(3) var<storage, read> keys: array<u32>;
@group(0) @binding(4) var<storage, read> values: array<u32>;
@group(0) @binding(5) var<storage, read_write> entries: array<GridEntry>;
// Cleared before, so empty buckets are empty ranges.
@group(0) @binding(6) var<storage, read_write> buckets: array<vec2<u32>>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= step.bodies {
        return;
    }
    let body = bodies[values[i]];
    let center = center_of(body, meshes[body.mesh].center);
    let radius = body.speculative_radius;
    entries[i] = GridEntry(center, radius, values[i], level_of(radius), body.flags, 0u);
    let key = keys[i];
    if i == 0u || keys[i - 1u] != key {
        buckets[key].x = i;
    }
    if i + 1u == step.bodies || keys[i + 1u] != key {
        buckets[key].y = i + 1u;
    }
}
