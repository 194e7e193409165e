// Begin of a step that may need several collision substeps: the largest number that a group needs. In each of them no two of
// its surfaces move farther relative to each other than a part of its thinnest body. The twin of `Speeds` in
// `src/solver/speeds.rs`. One thread per collider.
#import faceoff::dispatch::group_index
#import faceoff::math::descending
#import faceoff::types as t
#import faceoff::union_find::islands

@group(0) @binding(0) var<uniform> step: t::Step;
@group(0) @binding(1) var<uniform> division: t::Division;
@group(0) @binding(2) var<storage, read_write> counters: array<atomic<u32>>;
@group(0) @binding(3) var<storage, read_write> meetings: array<t::Meeting>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= step.bodies || atomicLoad(&islands[i].parent) != i || atomicLoad(&meetings[i].exists) == 0u {
        return;
    }
    var speed = bitcast<f32>(atomicLoad(&meetings[i].spin));
    if atomicLoad(&meetings[i].highest[0]) != 0u {
        var between: vec3<f32>;
        for (var axis = 0u; axis < 3u; axis += 1u) {
            let highest = descending(atomicLoad(&meetings[i].highest[axis]));
            let lowest = -descending(atomicLoad(&meetings[i].highest_negated[axis]));
            between[axis] = highest - lowest;
        }
        speed += length(between);
    }
    let thinnest = bitcast<f32>(atomicLoad(&meetings[i].thinnest));
    let wanted = ceil(speed * step.dt / (division.travel * thinnest));
    var count = 1u;
    if wanted > 1.0 {
        count = u32(min(wanted, f32(division.most)));
    }
    atomicMax(&counters[t::NEEDED_SUBSTEPS], count);
}
