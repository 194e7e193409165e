// Exclusive scan, first of three kernels: the sum of each block of 1024 values.
#import faceoff::constants::shared::SCAN_BLOCK
#import faceoff::dispatch::group_index
#import faceoff::scan::scan_length

@group(0) @binding(0) var<uniform> constants: vec4<u32>;
@group(0) @binding(1) var<storage, read> counters: array<u32>;
@group(0) @binding(2) var<storage, read> values: array<u32>;
@group(0) @binding(3) var<storage, read_write> sums: array<u32>;

var<workgroup> partial: array<u32, 256>;

@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let length = scan_length(constants, counters[constants.x]);
    let block = group_index(group);
    if block * SCAN_BLOCK >= length {
        return;
    }
    var sum = 0u;
    for (var k = 0u; k < 4u; k += 1u) {
        let i = block * SCAN_BLOCK + thread * 4u + k;
        if i < length {
            sum += values[i];
        }
    }
    partial[thread] = sum;
    workgroupBarrier();
    for (var half = 128u; half > 0u; half /= 2u) {
        if thread < half {
            partial[thread] += partial[thread + half];
        }
        workgroupBarrier();
    }
    if thread == 0u {
        sums[block] = partial[0];
    }
}
