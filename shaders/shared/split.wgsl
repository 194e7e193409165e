#define_import_path faceoff::split

// Splits a pair of large meshes into pieces: pairs of nodes of bounded size whose boxes meet. The pair's workgroup of
// 64 threads opens the nodes above the pieces, and each piece has its own workgroup. The pieces of a pair are
// contiguous, in the order of the trees.

#import faceoff::agree::agree
#import faceoff::arena::meshes
#import faceoff::constants::shared::{LARGE_PAIR, VAST_LEVELS}
#import faceoff::tree
#import faceoff::types as t

// Most pieces with which a pair is not split: one workgroup is faster.
const FEW: u32 = 16u;

// Pairs of nodes. On each of at most 8 levels, no more than 63 pairs wait while the 64th is opened.
var<workgroup> stack: array<vec2<u32>, 512>;
var<workgroup> found: array<atomic<u32>, 2>;

var<private> depth: u32;
// Highest level of the nodes of a piece.
var<private> level: u32;
// Number of pieces so far.
var<private> pieces: u32;

// Whether a pair of meshes may be split.
fn is_large(mesh_a: u32, mesh_b: u32) -> bool {
    return meshes[mesh_a].triangle_count > LARGE_PAIR / max(meshes[mesh_b].triangle_count, 1u);
}

// Starts at the roots of the trees, which `tree::survey` has set.
fn begin(mesh_a: u32, mesh_b: u32, thread: u32) {
    depth = 1u;
    level = select(1u, 2u, max(meshes[mesh_a].levels, meshes[mesh_b].levels) >= VAST_LEVELS);
    pieces = 0u;
    workgroupBarrier();
    if thread == 0u {
        stack[0] = vec2(tree::node(meshes[mesh_a].levels - 1u, 0u), tree::node(meshes[mesh_b].levels - 1u, 0u));
    }
    if thread < 2u {
        atomicStore(&found[thread], 0u);
    }
    workgroupBarrier();
}

// Opens the next pair of nodes, of `depth`.
fn open(thread: u32) -> tree::Opened {
    return tree::open(stack[depth - 1u], thread);
}

// Keeps the opened pairs that meet. Returns the number of a thread's piece within the pair, or `NOTHING`.
fn keep(opened: vec2<u32>, meets: bool, thread: u32) -> u32 {
    if meets {
        atomicOr(&found[thread / 32u], 1u << (thread % 32u));
    }
    workgroupBarrier();
    let mask = vec2(atomicLoad(&found[0]), atomicLoad(&found[1]));
    let number = countOneBits(mask.x) + countOneBits(mask.y);
    let rank = tree::rank_of(mask, thread);
    // All opened pairs are at the same levels.
    let is_piece = max(tree::level_of(opened.x), tree::level_of(opened.y)) <= level;
    var own = t::NOTHING;
    var next = depth - 1u;
    if is_piece {
        own = select(t::NOTHING, pieces + rank, meets);
        pieces += number;
    } else {
        if meets {
            stack[next + rank] = opened;
        }
        next += number;
    }
    depth = agree(thread, next);
    if thread < 2u {
        atomicStore(&found[thread], 0u);
    }
    workgroupBarrier();
    return own;
}
