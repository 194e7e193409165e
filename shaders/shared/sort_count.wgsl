// Radix sort, first of two kernels per digit: counts the digits in each block. Counts of one digit are adjacent, so
// that their scan gives the position of each block's first key with that digit.
#import faceoff::constants::shared::SORT_BLOCK
#import faceoff::dispatch::{divide_up, group_index}

// x: the counter that holds the number of keys. y: the shift of the digit.
@group(0) @binding(0) var<uniform> constants: vec4<u32>;
@group(0) @binding(1) var<storage, read> counters: array<u32>;
@group(0) @binding(2) var<storage, read> keys: array<u32>;
@group(0) @binding(3) var<storage, read_write> digits: array<u32>;

var<workgroup> found: array<atomic<u32>, 256>;

@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let length = counters[constants.x];
    let block = group_index(group);
    let blocks = divide_up(length, SORT_BLOCK);
    if block >= blocks {
        return;
    }
    atomicStore(&found[thread], 0u);
    workgroupBarrier();
    for (var i = block * SORT_BLOCK + thread; i < min(length, (block + 1u) * SORT_BLOCK); i += 256u) {
        atomicAdd(&found[(keys[i] >> constants.y) & 255u], 1u);
    }
    workgroupBarrier();
    digits[thread * blocks + block] = atomicLoad(&found[thread]);
}
