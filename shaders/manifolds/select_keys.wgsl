// Contact generation, selection of pairs, first of three kernels: pairs of near solid bodies, at least one of which has
// mass. They are sorted by their second body, then by the first; other pairs get a key beyond all bodies. One thread
// per pair.
#import faceoff::dispatch::group_index
#import faceoff::types as t

@group(0) @binding(0) var<uniform> step: t::Step;
@group(0) @binding(1) var<storage, read_write> counters: array<atomic<u32>>;
@group(0) @binding(2) var<storage, read> bodies: array<t::Body>;
@group(0) @binding(3) var<storage, read> near_pairs: array<t::NearPair>;
@group(0) @binding(4) var<storage, read_write> keys: array<u32>;
@group(0) @binding(5) var<storage, read_write> values: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= atomicLoad(&counters[t::PAIRS]) {
        return;
    }
    let pair = near_pairs[i];
    let a = bodies[pair.a];
    let b = bodies[pair.b];
    let solid = ((a.flags | b.flags) & t::SENSOR) == 0u;
    let chosen = pair.near != t::FAR && solid && (a.inverse_mass > 0.0 || b.inverse_mass > 0.0);
    if chosen {
        atomicAdd(&counters[t::SELECTED], 1u);
    }
    keys[i] = select(step.bodies, pair.b, chosen);
    values[i] = i;
}
