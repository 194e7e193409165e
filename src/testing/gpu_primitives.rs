//! Scan and sort on the GPU by themselves.

use crate::gpu::SHADERS;
use crate::gpu::commands::Commands;
use crate::gpu::device::Gpu;
use crate::gpu::kernel::Kernel;
use crate::gpu::program::{BufferSet, Calls, Groups, Program};
use crate::gpu::radix_sort::{self, Sort};
use crate::gpu::readback::{DeviceError, read_words, scoped};
use crate::gpu::scan::{self, Length, Scan};
use crate::types::stage::Stage;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{Buffer, BufferUsages};

/// The sums before each value, and the total. `at_most` is the length of the longest list that there may be.
///
/// # Errors
/// The device's message.
pub fn exclusive_scan(gpu: &Gpu, values: &[u32], at_most: u32) -> Result<(Vec<u32>, u32), DeviceError> {
    let run = RunOnce::new(gpu, [&scan::SCAN_WHOLE, &scan::SUMS, &scan::SPINE, &scan::APPLY])?;
    let length = values.len() as u32;
    let counters = run.buffer(&[length, 0]);
    let array = run.buffer(values);
    let sums = run.buffer(&vec![0; length.div_ceil(scan::BLOCK) as usize + 1]);
    let sets = [("counters", &counters), ("values", &array), ("sums", &sums)];
    run.program(&sets, |calls| {
        let scan = Scan {
            counters: "counters",
            values: "values",
            sums: "sums",
        };
        let groups = Groups::Exactly(length.div_ceil(scan::BLOCK));
        scan.record(calls, 0, Length::Counter, Some(1), at_most, groups);
    })?;
    let total = run.read(&counters, 2)?[1];
    Ok((run.read(&array, values.len())?, total))
}

/// Sorts `keys` of `bits` bits. Returns the sorted keys, and the index that each had. `at_most` is the length of the
/// longest list that there may be.
///
/// # Errors
/// The device's message.
pub fn sort(gpu: &Gpu, keys: &[u32], bits: u32, at_most: u32) -> Result<(Vec<u32>, Vec<u32>), DeviceError> {
    let run = RunOnce::new(
        gpu,
        [
            &scan::SCAN_WHOLE,
            &scan::SUMS,
            &scan::SPINE,
            &scan::APPLY,
            &radix_sort::SORT_WHOLE,
            &radix_sort::COUNT,
            &radix_sort::MOVE,
        ],
    )?;
    let length = keys.len() as u32;
    let blocks = length.div_ceil(radix_sort::BLOCK);
    let counters = run.buffer(&[length]);
    let values: Vec<u32> = (0..length).collect();
    let input = [run.buffer(keys), run.buffer(&values)];
    let scratch = [run.buffer(&vec![0; keys.len()]), run.buffer(&vec![0; keys.len()])];
    let digits = run.buffer(&vec![0; (radix_sort::DIGITS * blocks) as usize + 1]);
    let sums = run.buffer(&vec![0; radix_sort::digit_groups(length) as usize + 1]);
    let sort = Sort {
        counters: "counters",
        input: ["keys", "values"],
        scratch: ["other_keys", "other_values"],
        digits: "digits",
        sums: "sums",
    };
    let sets = [
        ("counters", &counters),
        ("keys", &input[0]),
        ("values", &input[1]),
        ("other_keys", &scratch[0]),
        ("other_values", &scratch[1]),
        ("digits", &digits),
        ("sums", &sums),
    ];
    let mut result = sort.input;
    run.program(&sets, |calls| {
        let groups = [
            Groups::Exactly(blocks),
            Groups::Exactly(radix_sort::digit_groups(length)),
        ];
        result = sort.record(calls, 0, bits, at_most, groups);
    })?;
    let [keys_out, values_out] = if result == sort.input { &input } else { &scratch };
    Ok((run.read(keys_out, keys.len())?, run.read(values_out, keys.len())?))
}

/// A device with some kernels.
struct RunOnce<'g> {
    gpu: &'g Gpu,
}

impl<'g> RunOnce<'g> {
    /// Compiles kernels that import no stage.
    ///
    /// # Errors
    /// The compiler's message.
    fn new<'k>(gpu: &'g Gpu, kernels: impl IntoIterator<Item = &'k Kernel>) -> Result<Self, DeviceError> {
        gpu.compile(SHADERS.modules, kernels)?;
        Ok(Self { gpu })
    }

    /// An array with these words, or with one zero.
    fn buffer(&self, words: &[u32]) -> Buffer {
        let words = if words.is_empty() { &[0] } else { words };
        self.gpu.device.create_buffer_init(&BufferInitDescriptor {
            label: None,
            contents: bytemuck::cast_slice(words),
            usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
        })
    }

    /// Runs calls on these buffers.
    ///
    /// # Errors
    /// The device's message.
    fn program(&self, buffers: &dyn BufferSet, add: impl FnOnce(&mut Calls)) -> Result<(), DeviceError> {
        const STAGE: Stage = Stage::BroadPhase;
        scoped(self.gpu, || {
            let mut calls = Calls::new(STAGE);
            add(&mut calls);
            let program = Program::new(self.gpu, &calls, &[buffers]);
            let mut commands = Commands::new(self.gpu, "test");
            program.record(STAGE, &mut commands, 0.into(), None);
            commands.submit();
        })
    }

    /// Reads the first words of an array.
    ///
    /// # Errors
    /// The device's message.
    fn read(&self, buffer: &Buffer, words: usize) -> Result<Vec<u32>, DeviceError> {
        read_words(self.gpu, buffer, words)
    }
}
