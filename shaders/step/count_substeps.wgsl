// Begin of a step that may need several collision substeps: the number that each group needs. One thread per collider.
#import faceoff::dispatch::group_index
#import faceoff::meeting::{count_substeps, meetings}
#import faceoff::sweep::moves
#import faceoff::types as t
#import faceoff::union_find::islands

@group(0) @binding(0) var<uniform> step: t::Step;
@group(0) @binding(1) var<uniform> division: t::Division;
@group(0) @binding(2) var<storage, read_write> counters: array<atomic<u32>>;
@group(0) @binding(3) var<storage, read> sweeps: array<t::Sweep>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= step.bodies || !moves(sweeps[i]) || atomicLoad(&islands[i].parent) != i {
        return;
    }
    let count = count_substeps(i, division, step.dt);
    atomicStore(&meetings[i].substeps, count);
    atomicMax(&counters[t::NEEDED_SUBSTEPS], count);
}
