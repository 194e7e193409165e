// Contact generation, selection of pairs, second of three kernels: pairs sorted by their second body get the first one
// as their key. One thread per pair.
#import faceoff::dispatch::group_index
#import faceoff::types as t

@group(0) @binding(0) var<uniform> step: t::Step;
@group(0) @binding(1) var<storage, read> counters: array<u32>;
@group(0) @binding(2) var<storage, read> near_pairs: array<t::NearPair>;
@group(0) @binding(3) var<storage, read_write> keys: array<u32>;
@group(0) @binding(4) var<storage, read> values: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i < counters[t::PAIRS] && keys[i] < step.bodies {
        keys[i] = near_pairs[values[i]].a;
    }
}
