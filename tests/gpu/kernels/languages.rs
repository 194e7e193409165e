//! Every kernel, written as wgpu writes it for the graphics APIs of other systems.
//!
//! This shows that naga can write it, not that the driver's compiler takes it.

use crate::contract::compose;
use bevy_faceoff::step::gpu::record::all_kernels;
use wgpu::naga::back::{hlsl, msl, spv};
use wgpu::naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use wgpu::naga::{Module, ShaderStage};

/// Kernels of which `write` says that they cannot be written.
fn refused(write: impl Fn(&Module, &ModuleInfo) -> Result<(), String>) -> Vec<String> {
    all_kernels()
        .filter_map(|kernel| {
            let module = compose(kernel).unwrap();
            let info = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module);
            let written = write(&module, &info.unwrap());
            written.err().map(|error| format!("{}: {error}", kernel.name))
        })
        .collect()
}

fn expect_all(refused: Vec<String>) {
    assert!(refused.is_empty(), "{}", refused.join("\n"));
}

/// For Direct3D 12, in the version that FXC compiles.
pub fn every_kernel_is_written_in_hlsl() {
    let options = hlsl::Options {
        shader_model: hlsl::ShaderModel::V5_1,
        // wgpu chooses the registers.
        fake_missing_bindings: true,
        ..hlsl::Options::default()
    };
    let pipeline = hlsl::PipelineOptions::default();
    expect_all(refused(|module, info| {
        let mut text = String::new();
        let mut writer = hlsl::Writer::new(&mut text, &options, &pipeline);
        let reflection = writer.write(module, info, None).map_err(|error| error.to_string())?;
        for name in reflection.entry_point_names {
            name.map_err(|error| error.to_string())?;
        }
        if !text.contains("numthreads") {
            return Err("there is no entry point".into());
        }
        Ok(())
    }));
}

/// For Metal.
pub fn every_kernel_is_written_in_msl() {
    let options = msl::Options {
        lang_version: (2, 0),
        fake_missing_bindings: true,
        zero_initialize_workgroup_memory: true,
        force_loop_bounding: true,
        ..msl::Options::default()
    };
    let pipeline = msl::PipelineOptions::default();
    expect_all(refused(|module, info| {
        let (text, translation) =
            msl::write_string(module, info, &options, &pipeline).map_err(|error| error.to_string())?;
        for name in translation.entry_point_names {
            name.map_err(|error| error.to_string())?;
        }
        if !text.contains("kernel void") {
            return Err("there is no entry point".into());
        }
        Ok(())
    }));
}

/// For Vulkan, in the oldest version that wgpu writes.
pub fn every_kernel_is_written_in_spir_v() {
    let options = spv::Options {
        lang_version: (1, 0),
        ..spv::Options::default()
    };
    let entry = spv::PipelineOptions {
        shader_stage: ShaderStage::Compute,
        entry_point: "main".to_owned(),
    };
    expect_all(refused(|module, info| {
        let words = spv::write_vec(module, info, &options, Some(&entry)).map_err(|error| error.to_string())?;
        // The magic number of SPIR-V.
        if words.first() != Some(&0x0723_0203) {
            return Err("this is not SPIR-V".into());
        }
        Ok(())
    }));
}
