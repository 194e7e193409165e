#define_import_path faceoff::scan

// Shared by the kernels of a scan. In `constants`, x is the counter that holds the number of elements, y selects
// what is scanned (see below), and z is the counter that receives the total.

#import faceoff::constants::shared::{DIGITS, SORT_BLOCK}
#import faceoff::dispatch::divide_up

var<workgroup> partial: array<u32, 256>;

// The sum of the values of this thread and of all before it. All 256 threads call it.
fn inclusive_sum(thread: u32, value: u32) -> u32 {
    var inclusive = value;
    for (var offset = 1u; offset < 256u; offset *= 2u) {
        partial[thread] = inclusive;
        workgroupBarrier();
        if thread >= offset {
            inclusive += partial[thread - offset];
        }
        workgroupBarrier();
    }
    return inclusive;
}

// The value of the last thread. All 256 threads call it.
fn of_last(thread: u32, value: u32) -> u32 {
    partial[thread] = value;
    workgroupBarrier();
    let last = partial[255];
    workgroupBarrier();
    return last;
}

// For the first thread: `total`, or 0xffffffff, which no list can hold, if the total has overflowed. `roughly` is the
// share of each thread as a float. All 256 threads call it.
fn checked_total(thread: u32, total: u32, roughly: f32) -> u32 {
    partial[thread] = bitcast<u32>(roughly);
    workgroupBarrier();
    for (var half = 128u; half > 0u; half /= 2u) {
        if thread < half {
            partial[thread] = bitcast<u32>(bitcast<f32>(partial[thread]) + bitcast<f32>(partial[thread + half]));
        }
        workgroupBarrier();
    }
    return select(total, 0xffffffffu, bitcast<f32>(partial[0]) > 4.29e9);
}

// Number of scanned values: one per element (y = 0), or the 256 digit counts of each block of a sort (y = 1).
fn scan_length(constants: vec4<u32>, things: u32) -> u32 {
    if constants.y == 0u {
        return things;
    }
    return DIGITS * divide_up(things, SORT_BLOCK);
}

