// Radix sort of a list that one workgroup sorts alone, by all digits. Keys and values move between two pairs of arrays;
// after an odd number of digits the result is in the second one.
#import faceoff::scan::inclusive_sum
#import faceoff::sort::{begin, place}

// x: the counter that holds the number of keys. y: the number of bits of a key.
@group(0) @binding(0) var<uniform> constants: vec4<u32>;
@group(0) @binding(1) var<storage, read> counters: array<u32>;
@group(0) @binding(2) var<storage, read_write> keys: array<u32>;
@group(0) @binding(3) var<storage, read_write> values: array<u32>;
@group(0) @binding(4) var<storage, read_write> other_keys: array<u32>;
@group(0) @binding(5) var<storage, read_write> other_values: array<u32>;

var<workgroup> key_count: u32;
// Number of keys with each digit.
var<workgroup> found: array<atomic<u32>, 256>;

@compute @workgroup_size(256)
fn main(@builtin(local_invocation_index) thread: u32) {
    if thread == 0u {
        key_count = counters[constants.x];
    }
    let length = workgroupUniformLoad(&key_count);
    var from_other = false;
    for (var shift = 0u; shift < constants.y; shift += 8u) {
        begin(thread, keys_before(thread, length, shift, from_other));
        for (var first = 0u; first < length; first += 256u) {
            let i = first + thread;
            let held = i < length;
            var key = 0u;
            var value = 0u;
            if held && from_other {
                key = other_keys[i];
                value = other_values[i];
            } else if held {
                key = keys[i];
                value = values[i];
            }
            let at = place(thread, held, (key >> shift) & 255u);
            if held && from_other {
                keys[at] = key;
                values[at] = value;
            } else if held {
                other_keys[at] = key;
                other_values[at] = value;
            }
        }
        from_other = !from_other;
        storageBarrier();
    }
}

// Number of keys whose digit is lower than the number of the thread.
fn keys_before(thread: u32, length: u32, shift: u32, from_other: bool) -> u32 {
    atomicStore(&found[thread], 0u);
    workgroupBarrier();
    for (var i = thread; i < length; i += 256u) {
        var key = 0u;
        if from_other {
            key = other_keys[i];
        } else {
            key = keys[i];
        }
        atomicAdd(&found[(key >> shift) & 255u], 1u);
    }
    workgroupBarrier();
    let own = atomicLoad(&found[thread]);
    return inclusive_sum(thread, own) - own;
}
