// Radix sort, second of two kernels per digit: moves each key to its place. Keys with the same digit keep their order.
#import faceoff::constants::shared::SORT_BLOCK
#import faceoff::dispatch::{divide_up, group_index}
#import faceoff::sort::{begin, place}

// x: the counter that holds the number of keys. y: the shift of the digit.
@group(0) @binding(0) var<uniform> constants: vec4<u32>;
@group(0) @binding(1) var<storage, read> counters: array<u32>;
@group(0) @binding(2) var<storage, read> digits: array<u32>;
@group(0) @binding(3) var<storage, read> keys: array<u32>;
@group(0) @binding(4) var<storage, read> values: array<u32>;
@group(0) @binding(5) var<storage, read_write> sorted_keys: array<u32>;
@group(0) @binding(6) var<storage, read_write> sorted_values: array<u32>;

var<workgroup> key_count: u32;

@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    if thread == 0u {
        key_count = counters[constants.x];
    }
    let length = workgroupUniformLoad(&key_count);
    let block = group_index(group);
    let blocks = divide_up(length, SORT_BLOCK);
    if block >= blocks {
        return;
    }
    begin(thread, digits[thread * blocks + block]);
    let end = min(length, (block + 1u) * SORT_BLOCK);
    for (var first = block * SORT_BLOCK; first < end; first += 256u) {
        let i = first + thread;
        let held = i < length;
        var key = 0u;
        if held {
            key = keys[i];
        }
        let at = place(thread, held, (key >> constants.y) & 255u);
        if held {
            sorted_keys[at] = key;
            sorted_values[at] = values[i];
        }
    }
}
