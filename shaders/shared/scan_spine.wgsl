// Exclusive scan, second of three kernels: one workgroup scans the sums of all blocks and writes the total. A total
// that overflows is written as 0xffffffff, which no list can hold.
#import faceoff::agree::agree
#import faceoff::constants::shared::{NO_TOTAL, SCAN_BLOCK}
#import faceoff::dispatch::divide_up
#import faceoff::scan::{checked_total, inclusive_sum, of_last, scan_length}

@group(0) @binding(0) var<uniform> constants: vec4<u32>;
@group(0) @binding(1) var<storage, read_write> counters: array<u32>;
@group(0) @binding(2) var<storage, read_write> sums: array<u32>;

@compute @workgroup_size(256)
fn main(@builtin(local_invocation_index) thread: u32) {
    let length = agree(thread, scan_length(constants, counters[constants.x]));
    let blocks = divide_up(length, SCAN_BLOCK);
    // The sum of all earlier blocks.
    var before = 0u;
    // The sum over this thread's blocks as a float, to detect overflow.
    var roughly = 0.0;
    for (var first = 0u; first < blocks; first += 256u) {
        let i = first + thread;
        var value = 0u;
        if i < blocks {
            value = sums[i];
        }
        roughly += f32(value);
        let inclusive = inclusive_sum(thread, value);
        if i < blocks {
            sums[i] = before + inclusive - value;
        }
        before += of_last(thread, inclusive);
    }
    let total = checked_total(thread, before, roughly);
    if thread == 0u && constants.z != NO_TOTAL {
        counters[constants.z] = total;
    }
}
