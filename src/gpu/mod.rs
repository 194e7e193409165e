//! What the GPU versions of all stages share.
//!
//! [`device`] finds a device; [`kernel`] says how a kernel is declared, compiled and called; [`layout`] is what passes
//! between host and kernels, and [`buffers`] where it lies; [`arena`] holds the meshes, if wanted with what contact points are made of; [`scan`] and [`radix_sort`] are
//! the primitives; [`contacts`] joins contact generation and solver; [`upload`] is what a step is told and [`results`] what comes of it; [`step`] runs it all. Each stage's kernels are declared in its own folder, in `gpu.rs`, with their
//! WGSL in `shaders/`.
//!
//! A step is one submission, of a pass per stage and collision substep; several may be in flight. Lists of unknown length have a capacity and a counter; if one is too short, the
//! bodies stay where they are, the list is made longer, and the step runs again: nothing is dropped.

pub mod arena;
pub mod buffers;
pub mod device;
pub mod kernel;
pub mod layout;
pub mod mesh_features;
pub mod radix_sort;
pub mod readback;
pub mod run_once;
pub mod scan;
pub mod timer;
