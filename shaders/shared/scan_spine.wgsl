// Exclusive scan, second of three kernels: one workgroup scans the sums of all blocks and writes the total. A total
// that overflows is written as 0xffffffff, which no list can hold.
#import faceoff::constants::shared::{NO_TOTAL, SCAN_BLOCK}
#import faceoff::dispatch::divide_up
#import faceoff::scan::scan_length

@group(0) @binding(0) var<uniform> constants: vec4<u32>;
@group(0) @binding(1) var<storage, read_write> counters: array<u32>;
@group(0) @binding(2) var<storage, read_write> sums: array<u32>;

var<workgroup> partial: array<u32, 256>;

@compute @workgroup_size(256)
fn main(@builtin(local_invocation_index) thread: u32) {
    let blocks = divide_up(scan_length(constants, counters[constants.x]), SCAN_BLOCK);
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
        var inclusive = value;
        for (var offset = 1u; offset < 256u; offset *= 2u) {
            partial[thread] = inclusive;
            workgroupBarrier();
            if thread >= offset {
                inclusive += partial[thread - offset];
            }
            workgroupBarrier();
        }
        if i < blocks {
            sums[i] = before + inclusive - value;
        }
        partial[thread] = inclusive;
        workgroupBarrier();
        before += partial[255];
        workgroupBarrier();
    }
    partial[thread] = bitcast<u32>(roughly);
    workgroupBarrier();
    for (var half = 128u; half > 0u; half /= 2u) {
        if thread < half {
            partial[thread] = bitcast<u32>(bitcast<f32>(partial[thread]) + bitcast<f32>(partial[thread + half]));
        }
        workgroupBarrier();
    }
    if thread == 0u && constants.z != NO_TOTAL {
        counters[constants.z] = select(before, 0xffffffffu, bitcast<f32>(partial[0]) > 4.29e9);
    }
}
