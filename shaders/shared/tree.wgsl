#define_import_path faceoff::tree

// The bounding-volume trees over the triangles of a pair's two meshes. A node is a word: its level in the upper four
// bits, and its number within the level. Level 0 are clusters of eight triangles; the root has a level of its own.

#import faceoff::arena::meshes
#import faceoff::constants::shared::TREE_LEVELS
#import faceoff::dispatch::divide_up

const NUMBER: u32 = 0x0fffffffu;

// For each level of the first mesh's tree, then of the second's: the index of its first word, and its number of nodes.
var<workgroup> first: array<u32, 16>;
var<workgroup> count: array<u32, 16>;

// Sets the levels of one of the two trees. `end` is 0 for the first mesh and 1 for the second.
fn survey(end: u32, mesh: u32) {
    var at = meshes[mesh].boxes;
    var nodes = divide_up(meshes[mesh].triangle_count, 8u);
    for (var level = 0u; level < TREE_LEVELS; level += 1u) {
        first[TREE_LEVELS * end + level] = at;
        count[TREE_LEVELS * end + level] = nodes;
        at += 6u * nodes;
        nodes = divide_up(nodes, 8u);
    }
}

fn level_of(node: u32) -> u32 {
    return node >> 28u;
}

fn node(level: u32, number: u32) -> u32 {
    return (level << 28u) | number;
}

// The index of a node's box, centre and half size; 0 if there is no such node.
fn box_of(end: u32, node: u32) -> u32 {
    let level = TREE_LEVELS * end + level_of(node);
    let number = node & NUMBER;
    return select(0u, first[level] + 6u * number, number < count[level]);
}

// A walk of one thread over a tree, from the root down.
struct Walk {
    // The current node.
    level: u32,
    number: u32,
    // Whether the node's children have not been looked at.
    is_new: bool,
    // No node is left.
    is_done: bool,
    // The children of the current node and of the nodes above it that are still to be opened: eight bits per level, the
    // lowest level first.
    waiting: vec2<u32>,
}

// The walk at the root of a tree of `levels` levels.
fn walk(levels: u32) -> Walk {
    return Walk(levels - 1u, 0u, true, false, vec2(0u));
}

// The walk at its next node. `opened` has a bit for each child of a new node that is to be opened.
fn advance(before: Walk, levels: u32, opened: u32) -> Walk {
    var walk = before;
    let bits = 8u * (walk.level % 4u);
    let mask = select(extractBits(walk.waiting[walk.level / 4u], bits, 8u), opened, walk.is_new);
    walk.is_new = mask != 0u;
    if walk.is_new {
        let k = firstLeadingBit(mask);
        walk.waiting[walk.level / 4u] = insertBits(walk.waiting[walk.level / 4u], mask & ~(1u << k), bits, 8u);
        walk.level -= 1u;
        walk.number = 8u * walk.number + k;
    } else {
        walk.level += 1u;
        walk.number /= 8u;
        walk.is_done = walk.level == levels;
    }
    return walk;
}

// What one of 64 threads compares when a pair of nodes is opened.
struct Opened {
    // A pair of nodes or, if both are leaves, the numbers of two triangles.
    pair: vec2<u32>,
    leaves: bool,
    // Whether no other thread compares the same.
    wanted: bool,
}

// Opens the taller one of two nodes, or both if they are equally tall: eight children of one against eight of the
// other.
fn open(nodes: vec2<u32>, thread: u32) -> Opened {
    let levels = nodes >> vec2(28u);
    let children = children_of(nodes & vec2(NUMBER), thread);
    if levels.x == 0u && levels.y == 0u {
        return Opened(children, true, true);
    }
    let opens = vec2(levels.x >= levels.y, levels.y >= levels.x);
    let opened = vec2(node(levels.x - 1u, children.x), node(levels.y - 1u, children.y));
    let is_first = vec2(thread / 8u, thread % 8u) == vec2(0u);
    return Opened(select(nodes, opened, opens), false, all(opens | is_first));
}

// The numbers of the children of two nodes that a thread compares.
fn children_of(numbers: vec2<u32>, thread: u32) -> vec2<u32> {
    return 8u * numbers + vec2(thread / 8u, thread % 8u);
}

// Number of earlier threads whose bit is set in a mask of 64.
fn rank_of(mask: vec2<u32>, thread: u32) -> u32 {
    let below = (1u << (thread % 32u)) - 1u;
    if thread < 32u {
        return countOneBits(mask.x & below);
    }
    return countOneBits(mask.x) + countOneBits(mask.y & below);
}
