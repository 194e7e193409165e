//! The kernels in SPIR-V, as wgpu writes them for a device of our own.

use bevy_faceoff::gpu::kernel::{Access, Binding, Kernel, bindings};
use bevy_faceoff::gpu::shader;
use bevy_faceoff::step::gpu::record::{all_kernels, all_modules};
use naga::back::spv::{Options, PipelineOptions, ZeroInitializeWorkgroupMemoryMode, write_vec};
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use std::error::Error;

/// A kernel that a driver can compile.
pub struct Spirv {
    /// The name of its file below `shaders/`, without the ending, and its definition.
    pub name: &'static str,
    /// The module.
    pub words: Vec<u32>,
    /// The slots of its buffers, and whether each is a uniform.
    pub buffers: Vec<(u32, bool)>,
}

/// All kernels whose names contain `part`.
///
/// # Errors
/// If one cannot be written.
pub fn all(part: &str) -> Result<Vec<Spirv>, Box<dyn Error>> {
    all_kernels()
        .filter(|kernel| kernel.name.contains(part))
        .map(write)
        .collect()
}

fn write(kernel: &'static Kernel) -> Result<Spirv, Box<dyn Error>> {
    let mut composer = shader::composer(all_modules())?;
    let module = match kernel.compose(&mut composer) {
        Ok(module) => module,
        Err(error) => return Err(error.emit_to_string(&composer).into()),
    };
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module)?;
    let options = Options {
        lang_version: (1, 3),
        // As a device of our own, which runs without checks of buffers.
        bounds_check_policies: BoundsCheckPolicies {
            index: BoundsCheckPolicy::Restrict,
            buffer: BoundsCheckPolicy::Unchecked,
            image_load: BoundsCheckPolicy::Restrict,
            binding_array: BoundsCheckPolicy::Restrict,
        },
        zero_initialize_workgroup_memory: ZeroInitializeWorkgroupMemoryMode::None,
        ..Options::default()
    };
    let entry = PipelineOptions {
        shader_stage: naga::ShaderStage::Compute,
        entry_point: "main".to_owned(),
    };
    let buffer = |binding: &Binding| (binding.slot, binding.access == Access::Uniform);
    Ok(Spirv {
        name: kernel.name,
        words: write_vec(&module, &info, &options, Some(&entry))?,
        buffers: bindings(&module).iter().map(buffer).collect(),
    })
}
