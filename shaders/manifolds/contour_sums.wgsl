#define_import_path faceoff::contour_sums

// Sums and maxima over the 64 threads of a workgroup.

#import faceoff::types as t

var<workgroup> sums: array<vec4<f32>, 64>;
var<workgroup> numbers: array<u32, 64>;

fn total(own: vec4<f32>, thread: u32) -> vec4<f32> {
    sums[thread] = own;
    workgroupBarrier();
    for (var half = 32u; half > 0u; half /= 2u) {
        if thread < half {
            sums[thread] += sums[thread + half];
        }
        workgroupBarrier();
    }
    let result = sums[0];
    workgroupBarrier();
    return result;
}

fn maximum(own: f32, thread: u32) -> f32 {
    sums[thread].x = own;
    workgroupBarrier();
    for (var half = 32u; half > 0u; half /= 2u) {
        if thread < half {
            sums[thread].x = max(sums[thread].x, sums[thread + half].x);
        }
        workgroupBarrier();
    }
    let result = sums[0].x;
    workgroupBarrier();
    return result;
}

fn minimum_number(own: u32, thread: u32) -> u32 {
    numbers[thread] = own;
    workgroupBarrier();
    for (var half = 32u; half > 0u; half /= 2u) {
        if thread < half {
            numbers[thread] = min(numbers[thread], numbers[thread + half]);
        }
        workgroupBarrier();
    }
    let result = numbers[0];
    workgroupBarrier();
    return result;
}
