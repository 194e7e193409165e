#define_import_path faceoff::tree

// The bounding-volume trees over the triangles of a pair's two meshes. A node is a word: its level in the upper four
// bits, and its number within the level. Level 0 are clusters of eight triangles; the root has a level of its own.

#import faceoff::arena::meshes
#import faceoff::constants::shared::TREE_LEVELS
#import faceoff::dispatch::divide_up

const NUMBER: u32 = 0x0fffffffu;

// For each level of both trees, first those of the first mesh, then those of the second: the index of its first word,
// and its number of nodes.
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
