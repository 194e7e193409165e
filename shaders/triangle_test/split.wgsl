// TriangleTest: splits pairs of large meshes into pieces. One workgroup per pair. Only for steps with a large mesh.
#import faceoff::agree::agree
#import faceoff::dispatch::{group_index, rows}
#import faceoff::placed_pair::{Pair, boxes_meet, near_pairs, placed, rounding_of}
#import faceoff::split
#import faceoff::tree
#import faceoff::types as t

@group(0) @binding(2) var<uniform> step: t::Step;
@group(0) @binding(3) var<storage, read_write> counters: array<atomic<u32>>;
@group(0) @binding(6) var<storage, read_write> results: array<t::PairResult>;
@group(0) @binding(7) var<storage, read_write> pieces: array<t::Piece>;
@group(0) @binding(8) var<storage, read_write> piece_arguments: array<atomic<u32>>;

var<workgroup> base: u32;

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
    if !split::is_large(pair.mesh_a, pair.mesh_b) || rounding_of(pair) > 0.0 {
        return;
    }
    if thread < 2u {
        tree::survey(thread, select(pair.mesh_a, pair.mesh_b, thread == 1u));
    }
    var first = t::NOTHING;
    // A loop of two rounds, so that compilers do not write `descend` twice, with two ways of rounding.
    for (var round = 0u; round < 2u; round += 1u) {
        let found = descend(index, pair, thread, first);
        if round == 0u {
            if thread == 0u {
                base = reserve(index, select(0u, found, found > split::FEW));
            }
            first = workgroupUniformLoad(&base);
            if first == t::NOTHING {
                return;
            }
        }
    }
}

// The place of a pair's pieces; `NOTHING` if it has none or they do not fit.
fn reserve(index: u32, count: u32) -> u32 {
    var first = t::NOTHING;
    if count > 0u {
        let next = atomicAdd(&counters[t::PIECES], count);
        if next <= step.piece_capacity && count <= step.piece_capacity - next {
            first = next;
            let groups = rows(next + count);
            atomicMax(&piece_arguments[0], groups.x);
            atomicMax(&piece_arguments[1], groups.y);
        }
    }
    results[index].first_piece = first;
    results[index].pieces = count;
    return first;
}

// Counts the pieces and, unless `first` is `NOTHING`, writes them from there on.
fn descend(index: u32, pair: Pair, thread: u32, first: u32) -> u32 {
    split::begin(pair.mesh_a, pair.mesh_b, thread);
    loop {
        if split::depth == 0u {
            break;
        }
        let opened = split::open(thread);
        let nodes = opened.pair;
        let own = split::keep(nodes, opened.wanted && boxes_meet(pair, nodes.x, nodes.y), thread);
        if own != t::NOTHING && first != t::NOTHING {
            pieces[first + own].pair = index;
            pieces[first + own].node_a = nodes.x;
            pieces[first + own].node_b = nodes.y;
        }
    }
    // Some devices abort long loops.
    if split::depth != 0u {
        atomicOr(&counters[t::CUT_SHORT], 1u);
    }
    return split::pieces;
}
