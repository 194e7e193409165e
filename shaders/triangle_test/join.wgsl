// TriangleTest: puts together what the pieces of a pair have found. One workgroup per pair. Only for steps with a large
// mesh.
#import faceoff::agree::agree
#import faceoff::dispatch::group_index
#import faceoff::pair_contact::{Sums, counters, report, results}
#import faceoff::placed_pair::{near_pairs, placed, rounding_of}
#import faceoff::split::is_large
#import faceoff::tree
#import faceoff::types as t

@group(0) @binding(8) var<storage, read_write> pieces: array<t::Piece>;

var<workgroup> first_with_hits: atomic<u32>;
var<workgroup> partial: array<u32, 64>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let index = group_index(group);
    if index >= agree(thread, atomicLoad(&counters[t::PAIRS])) {
        return;
    }
    if near_pairs[index].near != t::OVERLAPPING {
        return;
    }
    let pair = placed(index);
    if !is_large(pair.mesh_a, pair.mesh_b) || rounding_of(pair) > 0.0 {
        return;
    }
    let count = agree(thread, results[index].pieces);
    if count == 0u {
        return;
    }
    let first = agree(thread, results[index].first_piece);
    if first == t::NOTHING {
        // The list is too short: the step will be repeated.
        if thread == 0u {
            results[index].touching = 0u;
        }
        return;
    }
    if thread < 2u {
        tree::survey(thread, select(pair.mesh_a, pair.mesh_b, thread == 1u));
    }
    if thread == 0u {
        atomicStore(&first_with_hits, t::NOTHING);
    }
    workgroupBarrier();
    var hit_count = 0u;
    for (var round = 0u; round < count; round += 64u) {
        let at = first + round + thread;
        var own = 0u;
        if round + thread < count {
            own = pieces[at].hits;
        }
        let inclusive = inclusive_sum(own, thread);
        if own > 0u {
            pieces[at].first_hit = hit_count + inclusive - own;
            atomicMin(&first_with_hits, at);
        }
        hit_count += partial[63];
        workgroupBarrier();
    }
    var sums: Sums;
    var origin = vec3(0.0);
    let start = agree(thread, atomicLoad(&first_with_hits));
    if start != t::NOTHING {
        origin = pieces[start].origin;
        for (var at = first + thread; at < first + count; at += 64u) {
            if pieces[at].hits > 0u {
                // The sums of a piece are relative to its own origin.
                let offset = pieces[at].origin - origin;
                let length = pieces[at].length;
                let closing = pieces[at].closing;
                sums.middle += vec4(pieces[at].middle + offset * length, length);
                sums.area += pieces[at].area + 0.5 * cross(offset, closing);
                sums.closing += closing;
            }
        }
    }
    report(index, pair, hit_count, sums, origin, thread);
}

// The sum of the values of this thread and of all before it. The total is in `partial[63]`.
fn inclusive_sum(own: u32, thread: u32) -> u32 {
    var inclusive = own;
    for (var reach = 1u; reach < 64u; reach *= 2u) {
        partial[thread] = inclusive;
        workgroupBarrier();
        if thread >= reach {
            inclusive += partial[thread - reach];
        }
        workgroupBarrier();
    }
    partial[thread] = inclusive;
    workgroupBarrier();
    return inclusive;
}
