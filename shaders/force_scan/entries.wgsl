// ForceScan: two entries per pair, keyed by body, for solid bodies that touch and approach each other. Other entries
// get a key beyond all bodies. One thread per pair.
#import faceoff::arena::meshes
#import faceoff::dispatch::group_index
#import faceoff::math::rotate
#import faceoff::response::velocity
#import faceoff::types as t

@group(0) @binding(2) var<uniform> step: t::Step;
@group(0) @binding(3) var<storage, read> counters: array<u32>;
@group(0) @binding(4) var<storage, read> bodies: array<t::Body>;
@group(0) @binding(5) var<storage, read> results: array<t::PairResult>;
@group(0) @binding(6) var<storage, read_write> keys: array<u32>;
@group(0) @binding(7) var<storage, read_write> values: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= counters[t::PAIRS] {
        return;
    }
    var key = vec2(step.bodies);
    let result = results[i];
    if result.touching != 0u {
        let a = bodies[result.a];
        let b = bodies[result.b];
        let anchor_b = result.point - apart(a, b);
        let closing = dot(velocity(step, a, result.point) - velocity(step, b, anchor_b), result.normal);
        if closing > 0.0 && ((a.flags | b.flags) & t::SENSOR) == 0u {
            key = vec2(result.a, result.b);
        }
    }
    keys[2u * i] = key.x;
    keys[2u * i + 1u] = key.y;
    values[2u * i] = 2u * i;
    values[2u * i + 1u] = 2u * i + 1u;
}

// From a's centre of mass to b's, in the world.
fn apart(a: t::Body, b: t::Body) -> vec3<f32> {
    let anchor_a = rotate(a.rotation, a.scale * meshes[a.mesh].center);
    let anchor_b = rotate(b.rotation, b.scale * meshes[b.mesh].center);
    return (b.position - a.position) + (anchor_b - anchor_a);
}
