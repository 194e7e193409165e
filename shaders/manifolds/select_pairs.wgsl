// Contact generation, selection of pairs, last of three kernels: the pairs in ascending order, with margins. One thread
// per pair.
#import faceoff::dispatch::group_index
#import faceoff::margins::speculative_margin
#import faceoff::types as t

@group(0) @binding(0) var<uniform> step: t::Step;
@group(0) @binding(1) var<storage, read> counters: array<u32>;
@group(0) @binding(2) var<storage, read> bodies: array<t::Body>;
@group(0) @binding(3) var<storage, read> near_pairs: array<t::NearPair>;
@group(0) @binding(4) var<storage, read> values: array<u32>;
@group(0) @binding(5) var<storage, read_write> margin_pairs: array<t::MarginPair>;
// Cleared before.
@group(0) @binding(6) var<storage, read_write> contact_counters: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    let count = counters[t::SELECTED];
    if i >= count {
        return;
    }
    if i == 0u {
        contact_counters[t::MARGIN_PAIRS] = count;
    }
    let pair = near_pairs[values[i]];
    let a = bodies[pair.a];
    let b = bodies[pair.b];
    let inactive = u32(a.inactive != 0u && b.inactive != 0u);
    margin_pairs[i] = t::MarginPair(pair.a, pair.b, speculative_margin(step, a, b), inactive);
}
