//! What the GPU versions of all stages share.
//!
//! | file | contents |
//! |---|---|
//! | [`device`] | the device, and why there may be none |
//! | [`kernel`] | declaration and compilation of kernels |
//! | [`pipeline_cache`] | compiled kernels on disk |
//! | [`shader`] | WGSL modules and shared constants |
//! | [`program`] | lists of kernel calls |
//! | [`commands`] | recording and submission, counted |
//! | [`buffer_contents`] | what need not be written again |
//! | [`layout`] | structs and constants that kernels share with the host |
//! | [`buffers`] | the buffers of a step without contact points |
//! | [`arena`], [`mesh_features`] | the meshes, with their topology if needed |
//! | [`scan`], [`radix_sort`] | primitives |
//! | [`readback`] | reading of buffers |
//! | [`timer`] | the time that each stage takes |
//!
//! Each stage declares its kernels in its own folder, in `gpu.rs` or `gpu/`, with their WGSL in `shaders/`. `step::gpu`
//! runs them all. Lists whose number of elements is not known in advance have a capacity and a counter. If one
//! overflows, the bodies do not move, the list is made longer, and the step is repeated: no result is dropped.

pub mod arena;
pub mod buffer_contents;
pub mod buffers;
pub mod commands;
pub mod device;
pub mod kernel;
pub mod kernel_timer;
pub mod layout;
pub mod mesh_features;
pub mod pipeline_cache;
pub mod program;
pub mod radix_sort;
pub mod readback;
pub mod scan;
pub mod shader;
pub mod timer;

use crate::geometry::features::ANY_NORMAL;
use crate::projection::heights;
use crate::state::pairs::DEFAULT_DIRECTION;
use crate::state::{fault, margins};
use shader::{Module, Shaders, module, shared_constants};

/// Constants that kernels of several stages share with the host.
const CONSTANTS: Module = shared_constants!("faceoff::constants::shared", {
    u32 MAX_ROW = program::MAX_ROW;
    u32 SCAN_BLOCK = scan::BLOCK;
    u32 NO_TOTAL = scan::NO_TOTAL;
    u32 SORT_BLOCK = radix_sort::BLOCK;
    u32 DIGITS = radix_sort::DIGITS;
    u32 TREE_LEVELS = arena::TREE_LEVELS;
    u32 LARGE_PAIR = arena::LARGE_PAIR;
    u32 VAST_LEVELS = arena::VAST_LEVELS;
    u32 HEIGHT_STEPS = heights::STEPS;
    u32 MESH_HEADER = mesh_features::HEADER;
    u32 MESH_RECORD = mesh_features::RECORD;
    u32 MESH_ROUND = mesh_features::ROUNDNESS;
    f32 ANY_NORMAL = ANY_NORMAL;
    vec3 DEFAULT_DIRECTION = DEFAULT_DIRECTION;
    f32 MAX_SPEED = fault::MAX_SPEED;
    f32 SAFETY = margins::SAFETY;
    f32 BOUND = margins::BOUND;
});

/// Modules that all kernels may import, and the kernels of the primitives.
pub const SHADERS: Shaders = Shaders {
    modules: &[
        CONSTANTS,
        module!("shared/types", layout::CONSTANTS),
        module!("shared/math"),
        module!("shared/dispatch"),
        module!("shared/agree"),
        module!("shared/scan"),
        module!("shared/sort"),
        module!("shared/arena"),
        module!("shared/margins"),
        module!("shared/arm"),
        module!("shared/closest"),
        module!("shared/tree"),
        module!("shared/split"),
        module!("shared/tensor"),
        module!("shared/carried"),
        module!("shared/compound"),
    ],
    kernels: &[
        &scan::SCAN_WHOLE,
        &scan::SUMS,
        &scan::SPINE,
        &scan::APPLY,
        &radix_sort::SORT_WHOLE,
        &radix_sort::COUNT,
        &radix_sort::MOVE,
    ],
};
