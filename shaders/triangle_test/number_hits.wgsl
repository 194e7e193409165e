// TriangleTest: gives the hits of pieces their pair, and their number within it. One thread per hit. Only for steps
// with a large mesh.
#import faceoff::dispatch::group_index
#import faceoff::types as t

@group(0) @binding(0) var<uniform> step: t::Step;
@group(0) @binding(1) var<storage, read> counters: array<u32>;
@group(0) @binding(2) var<storage, read> pieces: array<t::Piece>;
@group(0) @binding(3) var<storage, read_write> hits: array<t::Hit>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= min(counters[t::HITS], step.hit_capacity) {
        return;
    }
    let owner = hits[i].pair;
    if (owner & t::OF_PIECE) != 0u {
        let piece = owner & ~t::OF_PIECE;
        hits[i].pair = pieces[piece].pair;
        hits[i].index += pieces[piece].first_hit;
    }
}
