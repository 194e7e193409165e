// Contact generation: splits pairs of large meshes into pieces. One workgroup per pair of bodies. Only for steps with a
// large mesh.
#import faceoff::agree::agree
#import faceoff::dispatch::{group_index, rows}
#import faceoff::near_boxes::{boxes_near, has_window, is_done, set_reach}
#import faceoff::sides
#import faceoff::split
#import faceoff::tree
#import faceoff::types as t

// x = 0: the search for all features. x = 1: for features that overlap, near patches.
@group(0) @binding(2) var<uniform> constants: vec4<u32>;
@group(0) @binding(3) var<uniform> limits: t::ContactLimits;
@group(0) @binding(4) var<storage, read_write> contact_counters: array<atomic<u32>>;
@group(0) @binding(5) var<storage, read_write> pair_setups: array<t::PairSetup>;
@group(0) @binding(6) var<storage, read_write> near_pieces: array<t::NearPiece>;
@group(0) @binding(7) var<storage, read_write> near_arguments: array<atomic<u32>>;

var<workgroup> base: u32;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let index = group_index(group);
    if index >= agree(thread, atomicLoad(&contact_counters[t::BATCH_PAIRS])) {
        return;
    }
    let setup = pair_setups[index];
    let deep = constants.x == 1u;
    // A split pair is searched again in any case: the kernels of the second search know its own pieces only.
    let was_split = deep && setup.is_split != 0u && has_window(setup);
    let wanted = was_split || (!is_done(setup, deep) && split::is_large(setup.mesh_a, setup.mesh_b));
    if agree(thread, u32(wanted)) == 0u {
        return;
    }
    set_reach(setup, deep);
    let a = sides::first(setup);
    let b = sides::second(setup);
    if thread < 2u {
        tree::survey(thread, select(a.mesh, b.mesh, thread == 1u));
    }
    var first = t::NOTHING;
    // A loop of two rounds, so that compilers do not write `descend` twice, with two ways of rounding.
    for (var round = 0u; round < 2u; round += 1u) {
        let found = descend(setup, index, a, b, thread, first);
        if round == 0u {
            if thread == 0u {
                base = reserve(index, select(0u, found, was_split || found > split::FEW), deep);
            }
            first = workgroupUniformLoad(&base);
            if first == t::NOTHING {
                return;
            }
        }
    }
}

// The place of a pair's pieces; `NOTHING` if it has none or they do not fit.
fn reserve(index: u32, count: u32, deep: bool) -> u32 {
    var first = t::NOTHING;
    if count > 0u {
        let before = select(0u, atomicLoad(&contact_counters[t::NEAR_PIECES]), deep);
        let own = atomicAdd(&contact_counters[select(t::NEAR_PIECES, t::DEEP_PIECES, deep)], count);
        let next = before + own;
        if next <= limits.pieces && count <= limits.pieces - next {
            first = next;
            let groups = rows(own + count);
            atomicMax(&near_arguments[3u * constants.x], groups.x);
            atomicMax(&near_arguments[3u * constants.x + 1u], groups.y);
        }
    }
    pair_setups[index].is_split = u32(count > 0u);
    pair_setups[index].first_near = first;
    pair_setups[index].near_count = select(count, 0u, first == t::NOTHING);
    return first;
}

// Counts the pieces and, unless `first` is `NOTHING`, writes them from there on.
fn descend(setup: t::PairSetup, index: u32, a: sides::Side, b: sides::Side, thread: u32, first: u32) -> u32 {
    split::begin(a.mesh, b.mesh, thread);
    loop {
        if split::depth == 0u {
            break;
        }
        let opened = split::open(thread);
        let nodes = opened.pair;
        let own = split::keep(nodes, opened.wanted && boxes_near(setup, a, b, nodes), thread);
        if own != t::NOTHING && first != t::NOTHING {
            near_pieces[first + own].pair = index;
            near_pieces[first + own].node_a = nodes.x;
            near_pieces[first + own].node_b = nodes.y;
        }
    }
    // Some devices abort long loops.
    if split::depth != 0u {
        atomicOr(&contact_counters[t::CONTACTS_CUT_SHORT], 1u);
    }
    return split::pieces;
}
