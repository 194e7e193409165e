// Exclusive scan of a list that one workgroup scans alone: replaces each value by the sum of all before it, and writes
// the total. A total that overflows is written as 0xffffffff, which no list can hold.
#import faceoff::agree::agree
#import faceoff::constants::shared::{NO_TOTAL, SCAN_BLOCK}
#import faceoff::scan::{checked_total, inclusive_sum, of_last, scan_length}

@group(0) @binding(0) var<uniform> constants: vec4<u32>;
@group(0) @binding(1) var<storage, read_write> counters: array<u32>;
@group(0) @binding(2) var<storage, read_write> values: array<u32>;

@compute @workgroup_size(256)
fn main(@builtin(local_invocation_index) thread: u32) {
    let length = agree(thread, scan_length(constants, counters[constants.x]));
    // The sum of all earlier blocks.
    var before = 0u;
    // The sum over this thread's values as a float, to detect overflow.
    var roughly = 0.0;
    for (var block = 0u; block < length; block += SCAN_BLOCK) {
        let first = block + thread * 4u;
        var own = vec4(0u);
        for (var k = 0u; k < 4u; k += 1u) {
            if first + k < length {
                own[k] = values[first + k];
            }
        }
        let all = vec4<f32>(own);
        roughly += all.x + all.y + all.z + all.w;
        let sum = own.x + own.y + own.z + own.w;
        let inclusive = inclusive_sum(thread, sum);
        var place = before + inclusive - sum;
        for (var k = 0u; k < 4u; k += 1u) {
            if first + k < length {
                values[first + k] = place;
                place += own[k];
            }
        }
        before += of_last(thread, inclusive);
    }
    let total = checked_total(thread, before, roughly);
    if thread == 0u && constants.z != NO_TOTAL {
        counters[constants.z] = total;
    }
}
