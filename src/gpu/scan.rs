//! Exclusive scan of words on the device: block sums, scan of the sums, apply. Three dispatches, no look-back, since WGSL
//! promises no progress between workgroups.

use super::device::Gpu;
use super::kernel::{Builder, Groups, Kernel, read, uniform, write};
use super::run_once::RunOnce;
use wgpu::Buffer;

/// Values that one workgroup scans, as in `scan.wgsl`.
pub const BLOCK: u32 = 1024;

/// Sums blocks.
pub const SUMS: Kernel = Kernel {
    name: "scan/sums",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/shared/scan_sums.wgsl")),
    emit: false,
    workgroup: 256,
    bindings: &[
        uniform(0, "constants", "vec4<u32>"),
        read(1, "counters", "u32"),
        read(2, "values", "u32"),
        write(3, "sums", "u32"),
    ],
};

/// Scans the sums.
pub const SPINE: Kernel = Kernel {
    name: "scan/spine",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/shared/scan_spine.wgsl")),
    emit: false,
    workgroup: 256,
    bindings: &[
        uniform(0, "constants", "vec4<u32>"),
        write(1, "counters", "u32"),
        write(2, "sums", "u32"),
    ],
};

/// Applies them.
pub const APPLY: Kernel = Kernel {
    name: "scan/apply",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/shared/scan_apply.wgsl")),
    emit: false,
    workgroup: 256,
    bindings: &[
        uniform(0, "constants", "vec4<u32>"),
        read(1, "counters", "u32"),
        read(2, "sums", "u32"),
        write(3, "values", "u32"),
    ],
};

/// All three.
pub const KERNELS: [&Kernel; 3] = [&SUMS, &SPINE, &APPLY];

/// What is scanned: how many values a counter stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Length {
    /// As many as the counter says.
    Counter,
    /// The digit counts of a sort of as many keys.
    Digits,
}

/// The arrays of a scan.
#[derive(Clone, Copy, Debug)]
pub struct Scan<'b> {
    /// Holds the length, and takes the total.
    pub counters: &'b Buffer,
    /// Replaced by the sum of all values before.
    pub values: &'b Buffer,
    /// Scratch, a word for every [`BLOCK`] values.
    pub sums: &'b Buffer,
}

impl Scan<'_> {
    /// Adds the calls. `length` is in counter `counter`; `total` is the counter that takes the sum of all; `groups` are
    /// those for one workgroup per block.
    pub fn record(&self, builder: &mut Builder, counter: u32, length: Length, total: Option<u32>, groups: Groups) {
        let constants = builder.constants([counter, length as u32, total.unwrap_or(u32::MAX), 0]);
        let Self { counters, values, sums } = *self;
        builder.call(&SUMS, &[&constants, counters, values, sums], groups);
        builder.call(&SPINE, &[&constants, counters, sums], Groups::Exactly(1));
        builder.call(&APPLY, &[&constants, counters, sums, values], groups);
    }
}

/// Scans `values` on its own: the sums before each value, and the total.
///
/// # Errors
/// What the device says.
pub fn exclusive(gpu: &Gpu, values: &[u32]) -> Result<(Vec<u32>, u32), String> {
    let run = RunOnce::new(gpu, &KERNELS)?;
    let length = values.len() as u32;
    let counters = run.buffer(&[length, 0]);
    let array = run.buffer(values);
    let sums = run.buffer(&vec![0; length.div_ceil(BLOCK) as usize + 1]);
    run.program(|builder| {
        let scan = Scan {
            counters: &counters,
            values: &array,
            sums: &sums,
        };
        scan.record(
            builder,
            0,
            Length::Counter,
            Some(1),
            Groups::Exactly(length.div_ceil(BLOCK)),
        );
    })?;
    let total = run.read(&counters, 2)?[1];
    Ok((run.read(&array, values.len())?, total))
}
