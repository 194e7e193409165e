//! More workgroups than one dimension holds: every one runs, once, whoever counted them.

use bevy_faceoff::broad_phase::gpu::{ARGUMENTS, COUNT};
use bevy_faceoff::gpu::SHADERS;
use bevy_faceoff::gpu::commands::Commands;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::gpu::kernel::Kernel;
use bevy_faceoff::gpu::layout::{
    Body, COUNTERS, DYNAMIC, ENTRIES, GROUPS_PER_64_PAIRS, GROUPS_PER_DIGIT_BLOCK, GROUPS_PER_PAIR,
    GROUPS_PER_SORT_BLOCK, GridEntry, LEVELS, OVERFLOW, PAIRS, SKIPPED, SPHERE_PAIRS, Step,
};
use bevy_faceoff::gpu::program::{BufferSet, Calls, Groups, MAX_ROW, Program, rows};
use bevy_faceoff::gpu::radix_sort;
use bevy_faceoff::gpu::readback::{read_words, scoped};
use bevy_faceoff::gpu::scan;
use bevy_faceoff::step::gpu::record::all_modules;
use bevy_faceoff::types::stage::Stage;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{Buffer, BufferUsages};

/// Around a row, the round figures of real steps, and far beyond.
const COUNTS: [u32; 8] = [0, 1, MAX_ROW - 1, MAX_ROW, MAX_ROW + 1, 70_000, 2 * MAX_ROW, 5_000_000];

/// Counts how often each group runs, and those that are none of the wanted.
const MARK: Kernel = Kernel {
    name: "test/mark",
    source: "
        #import faceoff::dispatch::group_index
        @group(0) @binding(0) var<storage, read> wanted: array<u32>;
        @group(0) @binding(1) var<storage, read_write> marks: array<atomic<u32>>;
        @compute @workgroup_size(1)
        fn main(@builtin(workgroup_id) group: vec3<u32>) {
            let i = group_index(group);
            atomicAdd(&marks[min(i, wanted[0])], 1u);
        }
    ",
    define: None,
};

/// The device's own `rows`, into the first slot.
const ROWS: Kernel = Kernel {
    name: "test/rows",
    source: "
        #import faceoff::dispatch::rows
        @group(0) @binding(0) var<storage, read> wanted: array<u32>;
        @group(0) @binding(1) var<storage, read_write> arguments: array<u32>;
        @compute @workgroup_size(1)
        fn main() {
            let r = rows(wanted[0]);
            arguments[0] = r.x;
            arguments[1] = r.y;
            arguments[2] = r.z;
        }
    ",
    define: None,
};

fn buffer(gpu: &Gpu, words: &[u32], usage: BufferUsages) -> Buffer {
    gpu.device.create_buffer_init(&BufferInitDescriptor {
        label: Some("test"),
        contents: bytemuck::cast_slice(words),
        usage: usage | BufferUsages::STORAGE | BufferUsages::COPY_SRC,
    })
}

/// Runs what `add` adds; indirect dispatches take their groups from `arguments`.
fn run(gpu: &Gpu, buffers: &dyn BufferSet, kernel: &'static Kernel, groups: Groups) {
    const STAGE: Stage = Stage::BroadPhase;
    scoped(gpu, || {
        let mut calls = Calls::new(STAGE);
        calls.call(kernel, groups);
        let mut commands = Commands::new(gpu, "test");
        let program = Program::new(gpu, &calls, &[buffers]);
        program.record(STAGE, &mut commands, 0.into(), None);
        commands.submit();
    })
    .unwrap();
}

/// Every group below `wanted` ran once; of those beyond, which `rows` allows, there are fewer than a row.
fn check_marks(gpu: &Gpu, marks: &Buffer, wanted: u32) {
    let marks = read_words(gpu, marks, wanted as usize + 1).unwrap();
    let wrong = marks[..wanted as usize].iter().position(|&mark| mark != 1);
    assert_eq!(wrong, None, "of {wanted} groups");
    let [x, y, z] = rows(wanted);
    assert_eq!(marks[wanted as usize], x * y * z - wanted);
}

pub fn direct(gpu: &Gpu) {
    gpu.compile(SHADERS.modules, [&MARK]).unwrap();
    for wanted in COUNTS {
        let count = buffer(gpu, &[wanted], BufferUsages::empty());
        let marks = buffer(gpu, &vec![0; wanted as usize + 1], BufferUsages::empty());
        let buffers = [("wanted", &count), ("marks", &marks)];
        run(gpu, &buffers, &MARK, Groups::Exactly(wanted));
        check_marks(gpu, &marks, wanted);
    }
}

pub fn indirect(gpu: &Gpu) {
    gpu.compile(SHADERS.modules, [&MARK, &ROWS]).unwrap();
    for wanted in COUNTS {
        let arguments = buffer(gpu, &[0; 4], BufferUsages::INDIRECT);
        let count = buffer(gpu, &[wanted], BufferUsages::empty());
        let marks = buffer(gpu, &vec![0; wanted as usize + 1], BufferUsages::empty());
        let buffers = [("wanted", &count), ("arguments", &arguments), ("marks", &marks)];
        run(gpu, &buffers, &ROWS, Groups::Exactly(1));
        run(gpu, &buffers, &MARK, Groups::Indirect("arguments", 0));
        assert_eq!(read_words(gpu, &arguments, 3).unwrap(), rows(wanted));
        check_marks(gpu, &marks, wanted);
    }
}

/// What the kernel writes that ends the broad phase: counters and arguments.
fn broad_phase_arguments(gpu: &Gpu, pairs: u32, capacity: u32) -> [Buffer; 2] {
    let step = Step {
        pair_capacity: capacity,
        ..Default::default()
    };
    let words: &[u32] = bytemuck::cast_slice(std::slice::from_ref(&step));
    let step = buffer(gpu, words, BufferUsages::UNIFORM);
    let status = buffer(gpu, &[0; 4], BufferUsages::empty());
    let mut start = [0; COUNTERS as usize];
    start[SPHERE_PAIRS as usize] = pairs;
    let counters = buffer(gpu, &start, BufferUsages::empty());
    // What an earlier step left there must not matter.
    let [arguments, piece_arguments] = [16, 4].map(|words| buffer(gpu, &vec![77; words], BufferUsages::INDIRECT));
    let buffers = [
        ("step", &step),
        ("status", &status),
        ("counters", &counters),
        ("arguments", &arguments),
        ("piece_arguments", &piece_arguments),
    ];
    run(gpu, &buffers, &ARGUMENTS, Groups::Exactly(1));
    // No pair is split yet.
    assert_eq!(read_words(gpu, &piece_arguments, 3).unwrap(), [0, 0, 1]);
    [counters, arguments]
}

/// The four indirect dispatches of a step.
fn slots(pairs: u32) -> [(u32, u32); 4] {
    let blocks = (2 * pairs).div_ceil(radix_sort::BLOCK);
    [
        (GROUPS_PER_64_PAIRS, pairs.div_ceil(64)),
        (GROUPS_PER_PAIR, pairs),
        (GROUPS_PER_SORT_BLOCK, blocks),
        (GROUPS_PER_DIGIT_BLOCK, (256 * blocks).div_ceil(scan::BLOCK)),
    ]
}

pub fn of_the_broad_phase(gpu: &Gpu) {
    gpu.compile(SHADERS.modules, [&MARK, &ARGUMENTS]).unwrap();
    for pairs in [0, 1, 64, 65, MAX_ROW + 1, 70_000, 5_000_000] {
        let [counters, arguments] = broad_phase_arguments(gpu, pairs, 5_000_000);
        let counters = read_words(gpu, &counters, COUNTERS as usize).unwrap();
        let noted = [PAIRS, ENTRIES, SKIPPED].map(|counter| counters[counter as usize]);
        assert_eq!(noted, [pairs, 2 * pairs, 0]);
        for (slot, wanted) in slots(pairs) {
            let count = buffer(gpu, &[wanted], BufferUsages::empty());
            let marks = buffer(gpu, &vec![0; wanted as usize + 1], BufferUsages::empty());
            let buffers = [("wanted", &count), ("marks", &marks), ("arguments", &arguments)];
            run(gpu, &buffers, &MARK, Groups::Indirect("arguments", slot));
            check_marks(gpu, &marks, wanted);
        }
    }
}

pub fn nothing_after_overflow(gpu: &Gpu) {
    gpu.compile(SHADERS.modules, [&ARGUMENTS]).unwrap();
    let [counters, arguments] = broad_phase_arguments(gpu, 1001, 1000);
    let counters = read_words(gpu, &counters, COUNTERS as usize).unwrap();
    let noted = [PAIRS, ENTRIES, SPHERE_PAIRS].map(|counter| counters[counter as usize]);
    assert_eq!(noted, [0, 0, 1001], "the host must learn how many there are");
    assert_ne!(counters[SKIPPED as usize], 0);
    let arguments = read_words(gpu, &arguments, 12).unwrap();
    for slot in arguments.chunks(3) {
        assert_eq!(slot.iter().product::<u32>(), 0, "{arguments:?}");
    }
}

/// A step in flight behind one that overflowed has no poses. Its bodies may all be at one place, and a search for pairs
/// would take time quadratic in their number.
pub fn no_pairs_after_overflow(gpu: &Gpu) {
    const LEVEL: u32 = 31;
    gpu.compile(all_modules(), [&COUNT]).unwrap();
    let body = |i: u32| Body {
        memberships: u32::MAX,
        filters: u32::MAX,
        body: i,
        ..Body::default()
    };
    let entry = |i: u32| GridEntry {
        center: [0.5; 3],
        radius: 1.0,
        body: i,
        level: LEVEL as i32,
        flags: DYNAMIC,
        padding: 0,
    };
    let step = Step {
        bodies: 3,
        bucket_mask: 0,
        ..Default::default()
    };
    let step = buffer(gpu, bytemuck::cast_slice(&[step]), BufferUsages::UNIFORM);
    let bodies = buffer(gpu, bytemuck::cast_slice(&[0, 1, 2].map(body)), BufferUsages::empty());
    let entries = buffer(gpu, bytemuck::cast_slice(&[0, 1, 2].map(entry)), BufferUsages::empty());
    let buckets = buffer(gpu, &[0, 3], BufferUsages::empty());
    let mut start = [0; COUNTERS as usize];
    start[LEVELS as usize] = 1 << LEVEL;
    let counters = buffer(gpu, &start, BufferUsages::empty());
    for (overflowed, expected) in [(0, [2, 1, 0]), (1, [0; 3])] {
        let mut flags = [0; 4];
        flags[OVERFLOW as usize] = overflowed;
        let status = buffer(gpu, &flags, BufferUsages::empty());
        let pair_counts = buffer(gpu, &[77; 3], BufferUsages::empty());
        let buffers = [
            ("step", &step),
            ("status", &status),
            ("counters", &counters),
            ("bodies", &bodies),
            ("entries", &entries),
            ("buckets", &buckets),
            ("pair_counts", &pair_counts),
        ];
        run(gpu, &buffers, &COUNT, Groups::Exactly(1));
        assert_eq!(read_words(gpu, &pair_counts, 3).unwrap(), expected, "{overflowed}");
    }
}
