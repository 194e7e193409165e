// Radix sort, second of two kernels per digit: moves each key to its place. Keys with the same digit keep their order.
#import faceoff::constants::shared::SORT_BLOCK
#import faceoff::dispatch::{divide_up, group_index}

// x: the counter that holds the number of keys. y: the shift of the digit.
@group(0) @binding(0) var<uniform> constants: vec4<u32>;
@group(0) @binding(1) var<storage, read> counters: array<u32>;
@group(0) @binding(2) var<storage, read> digits: array<u32>;
@group(0) @binding(3) var<storage, read> keys: array<u32>;
@group(0) @binding(4) var<storage, read> values: array<u32>;
@group(0) @binding(5) var<storage, read_write> sorted_keys: array<u32>;
@group(0) @binding(6) var<storage, read_write> sorted_values: array<u32>;

// The position of the next key of each digit.
var<workgroup> next: array<u32, 256>;
// Bit sets of the 256 threads that hold each digit: eight words per digit.
var<workgroup> holders: array<atomic<u32>, 2048>;

@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let length = counters[constants.x];
    let block = group_index(group);
    let blocks = divide_up(length, SORT_BLOCK);
    if block >= blocks {
        return;
    }
    next[thread] = digits[thread * blocks + block];
    for (var k = 0u; k < 8u; k += 1u) {
        atomicStore(&holders[thread * 8u + k], 0u);
    }
    workgroupBarrier();
    let end = min(length, (block + 1u) * SORT_BLOCK);
    for (var first = block * SORT_BLOCK; first < end; first += 256u) {
        let i = first + thread;
        let held = i < length;
        var key = 0u;
        var digit = 0u;
        if held {
            key = keys[i];
            digit = (key >> constants.y) & 255u;
            atomicOr(&holders[digit * 8u + thread / 32u], 1u << (thread % 32u));
        }
        workgroupBarrier();
        if held {
            // Number of earlier threads with the same digit.
            var rank = countOneBits(atomicLoad(&holders[digit * 8u + thread / 32u]) & ((1u << (thread % 32u)) - 1u));
            for (var k = 0u; k < thread / 32u; k += 1u) {
                rank += countOneBits(atomicLoad(&holders[digit * 8u + k]));
            }
            let at = next[digit] + rank;
            sorted_keys[at] = key;
            sorted_values[at] = values[i];
        }
        workgroupBarrier();
        // Each thread updates one digit: it advances the position and clears the bit set for the next round.
        var count = 0u;
        for (var k = 0u; k < 8u; k += 1u) {
            count += countOneBits(atomicExchange(&holders[thread * 8u + k], 0u));
        }
        next[thread] += count;
        workgroupBarrier();
    }
}
