// Contact generation: how deep the bodies overlap at the centre of each patch and at their deepest vertices there, and
// the window in which the second search looks for features that overlap. One workgroup per pair, one thread per patch.
// The twin of `find_overlaps` in `src/manifolds/cpu/pair.rs`.
#import faceoff::agree::agree
#import faceoff::constants::manifolds::MAX_DEPTH
#import faceoff::deepest::{deepest_unfinished, probe_of_vertex}
#import faceoff::dispatch::group_index
#import faceoff::probes::{cast_through, rays_unfinished}
#import faceoff::sides
#import faceoff::tree
#import faceoff::types as t

@group(0) @binding(2) var<storage, read_write> contact_counters: array<atomic<u32>>;
@group(0) @binding(3) var<storage, read_write> pair_setups: array<t::PairSetup>;
@group(0) @binding(4) var<storage, read_write> patches: array<t::Patch>;

// The window of each thread's searched patches, and the number of all searched patches.
var<workgroup> lows: array<vec3<f32>, 64>;
var<workgroup> highs: array<vec3<f32>, 64>;
var<workgroup> searched: atomic<u32>;
// The last searched patch.
var<workgroup> last: atomic<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let index = group_index(group);
    if index >= agree(thread, atomicLoad(&contact_counters[t::BATCH_PAIRS])) {
        return;
    }
    let setup = pair_setups[index];
    let count = agree(thread, select(setup.patch_count, 0u, setup.valid == 0u));
    if count == 0u {
        return;
    }
    let a = sides::first(setup);
    let b = sides::second(setup);
    if thread < 2u {
        tree::survey(thread, select(a.mesh, b.mesh, thread == 1u));
    }
    if thread == 0u {
        atomicStore(&searched, 0u);
        atomicStore(&last, 0u);
    }
    workgroupBarrier();
    let first = setup.first_segment;
    let max_depth = MAX_DEPTH * setup.size;
    var low = vec3(3.0e38);
    var high = vec3(-3.0e38);
    var k = thread;
    while k < count {
        let own = patches[first + k];
        let middle = own.center;
        var deepest = t::DROPPED;
        if own.rim == 0u {
            // Rays that miss tell nothing: their separation is larger than any other.
            let probe = cast_through(a, b, own.normal, middle, setup);
            deepest = probe.separation;
            for (var end = 0u; end < 2u; end += 1u) {
                deepest = min(deepest, probe_of_vertex(a, b, setup, own, probe, end).probe.separation);
            }
        }
        let too_deep = -deepest > max_depth;
        patches[first + k].too_deep = u32(too_deep);
        if !too_deep {
            let half = vec3(patches[first + k].reach + 0.5 * max_depth);
            low = min(low, middle - half);
            high = max(high, middle + half);
            atomicAdd(&searched, 1u);
            atomicMax(&last, k);
        }
        k += 64u;
    }
    // Some devices abort long loops.
    if k < count || rays_unfinished || deepest_unfinished {
        atomicOr(&contact_counters[t::CONTACTS_CUT_SHORT], 1u);
    }
    lows[thread] = low;
    highs[thread] = high;
    workgroupBarrier();
    for (var half = 32u; half > 0u; half /= 2u) {
        if thread < half {
            lows[thread] = min(lows[thread], lows[thread + half]);
            highs[thread] = max(highs[thread], highs[thread + half]);
        }
        workgroupBarrier();
    }
    if thread == 0u {
        pair_setups[index].window_min = lows[0];
        pair_setups[index].window_max = highs[0];
        // Features that agree with a single patch overlap along its normal. Several patches have no common direction.
        if atomicLoad(&searched) == 1u {
            pair_setups[index].window_direction = patches[first + atomicLoad(&last)].normal;
        }
    }
}
