// Begin of a step that may need several collision substeps: bodies that can meet are one group. What is static joins
// nothing. One thread per pair.
#import faceoff::dispatch::group_index
#import faceoff::sweep::moves
#import faceoff::types as t
#import faceoff::union_find::join

@group(0) @binding(0) var<storage, read> counters: array<u32>;
@group(0) @binding(1) var<storage, read> sphere_pairs: array<vec2<u32>>;
@group(0) @binding(2) var<storage, read> sweeps: array<t::Sweep>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= counters[t::PAIRS] {
        return;
    }
    let pair = sphere_pairs[i];
    if moves(sweeps[pair.x]) && moves(sweeps[pair.y]) {
        join(pair.x, pair.y);
    }
}
