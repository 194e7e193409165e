// Exclusive scan, third of three kernels: replaces each value by the sum of all before it.
#import faceoff::constants::shared::SCAN_BLOCK
#import faceoff::dispatch::group_index
#import faceoff::scan::{inclusive_sum, scan_length}

@group(0) @binding(0) var<uniform> constants: vec4<u32>;
@group(0) @binding(1) var<storage, read> counters: array<u32>;
@group(0) @binding(2) var<storage, read> sums: array<u32>;
@group(0) @binding(3) var<storage, read_write> values: array<u32>;

@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let length = scan_length(constants, counters[constants.x]);
    let block = group_index(group);
    if block * SCAN_BLOCK >= length {
        return;
    }
    let first = block * SCAN_BLOCK + thread * 4u;
    var own = vec4(0u);
    for (var k = 0u; k < 4u; k += 1u) {
        if first + k < length {
            own[k] = values[first + k];
        }
    }
    let sum = own.x + own.y + own.z + own.w;
    let inclusive = inclusive_sum(thread, sum);
    var before = sums[block] + inclusive - sum;
    for (var k = 0u; k < 4u; k += 1u) {
        if first + k < length {
            values[first + k] = before;
            before += own[k];
        }
    }
}
