//! Stable sort of words with a value each, eight bits at a time: count digits per block, scan the counts, move. Five
//! dispatches a digit.

use super::device::Gpu;
use super::kernel::{Builder, Groups, Kernel, read, uniform, write};
use super::run_once::RunOnce;
use super::scan::{self, Length, Scan};
use wgpu::Buffer;

/// Keys that one workgroup moves, as in `scan.wgsl`.
pub const BLOCK: u32 = 2048;

/// Bits sorted by at a time.
pub const DIGIT: u32 = 8;

/// Counts digits.
pub const COUNT: Kernel = Kernel {
    name: "sort/count",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/shared/sort_count.wgsl")),
    emit: false,
    workgroup: 256,
    bindings: &[
        uniform(0, "constants", "vec4<u32>"),
        read(1, "counters", "u32"),
        read(2, "keys", "u32"),
        write(3, "digits", "u32"),
    ],
};

/// Moves keys and values.
pub const MOVE: Kernel = Kernel {
    name: "sort/move",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/shared/sort_move.wgsl")),
    emit: false,
    workgroup: 256,
    bindings: &[
        uniform(0, "constants", "vec4<u32>"),
        read(1, "counters", "u32"),
        read(2, "digits", "u32"),
        read(3, "keys", "u32"),
        read(4, "values", "u32"),
        write(5, "sorted_keys", "u32"),
        write(6, "sorted_values", "u32"),
    ],
};

/// Both.
pub const KERNELS: [&Kernel; 2] = [&COUNT, &MOVE];

/// The arrays of a sort, each with room for all keys.
#[derive(Clone, Copy, Debug)]
pub struct Sort<'b> {
    /// Holds the number of keys.
    pub counters: &'b Buffer,
    /// Keys and values; read, and overwritten by every second digit.
    pub input: [&'b Buffer; 2],
    /// Scratch of the same size.
    pub scratch: [&'b Buffer; 2],
    /// 256 words for every [`BLOCK`] keys.
    pub digits: &'b Buffer,
    /// Scratch of the scan over `digits`.
    pub sums: &'b Buffer,
}

impl<'b> Sort<'b> {
    /// Adds the calls for keys of `bits` bits, and tells which buffers hold the result. `groups` are those for one
    /// workgroup per [`BLOCK`] keys, and for the scan of the digits.
    pub fn record(&self, builder: &mut Builder, counter: u32, bits: u32, groups: [Groups; 2]) -> [&'b Buffer; 2] {
        let (mut from, mut to) = (self.input, self.scratch);
        for shift in (0..bits).step_by(DIGIT as usize) {
            let constants = builder.constants([counter, shift, 0, 0]);
            builder.call(&COUNT, &[&constants, self.counters, from[0], self.digits], groups[0]);
            let scan = Scan {
                counters: self.counters,
                values: self.digits,
                sums: self.sums,
            };
            scan.record(builder, counter, Length::Digits, None, groups[1]);
            let buffers = [&constants, self.counters, self.digits, from[0], from[1], to[0], to[1]];
            builder.call(&MOVE, &buffers, groups[0]);
            std::mem::swap(&mut from, &mut to);
        }
        from
    }
}

/// Workgroups for the scan of the digits of so many keys.
pub fn digit_groups(keys: u32) -> u32 {
    (256 * keys.div_ceil(BLOCK)).div_ceil(scan::BLOCK)
}

/// Sorts `keys` of `bits` bits on its own; tells the sorted keys, and where each was.
///
/// # Errors
/// What the device says.
pub fn sort(gpu: &Gpu, keys: &[u32], bits: u32) -> Result<(Vec<u32>, Vec<u32>), String> {
    let run = RunOnce::new(gpu, scan::KERNELS.iter().chain(&KERNELS))?;
    let length = keys.len() as u32;
    let blocks = length.div_ceil(BLOCK);
    let counters = run.buffer(&[length]);
    let values: Vec<u32> = (0..length).collect();
    let input = [run.buffer(keys), run.buffer(&values)];
    let scratch = [run.buffer(&vec![0; keys.len()]), run.buffer(&vec![0; keys.len()])];
    let digits = run.buffer(&vec![0; 256 * blocks as usize + 1]);
    let sums = run.buffer(&vec![0; digit_groups(length) as usize + 1]);
    let mut odd = false;
    run.program(|builder| {
        let sort = Sort {
            counters: &counters,
            input: input.each_ref(),
            scratch: scratch.each_ref(),
            digits: &digits,
            sums: &sums,
        };
        let groups = [Groups::Exactly(blocks), Groups::Exactly(digit_groups(length))];
        let result = sort.record(builder, 0, bits, groups);
        odd = std::ptr::eq(result[0], &scratch[0]);
    })?;
    let [keys_out, values_out] = if odd { &scratch } else { &input };
    Ok((run.read(keys_out, keys.len())?, run.read(values_out, keys.len())?))
}
