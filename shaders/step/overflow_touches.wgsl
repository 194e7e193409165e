// Integrate of a step with contacts, first: if the touch list overflowed, the step is discarded.
#import faceoff::types as t

@group(0) @binding(0) var<uniform> step: t::Step;
@group(0) @binding(1) var<storage, read> tally: array<u32>;
@group(0) @binding(2) var<storage, read_write> status: array<u32>;
@group(0) @binding(3) var<storage, read_write> counters: array<u32>;

@compute @workgroup_size(1)
fn main() {
    if tally[t::TOUCHES] > step.touch_capacity {
        status[t::OVERFLOW] = 1u;
        counters[t::SKIPPED] = 1u;
    }
}
