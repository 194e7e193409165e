//! A device of the driver that the environment names, and its compiler's figures.
//!
//! wgpu cannot open a card that is not there, because it submits work when it starts. This speaks Vulkan itself.

#![allow(unsafe_code, reason = "every call of Vulkan is unsafe")]

use crate::spirv::Spirv;
use crate::table::Compiled;
use ash::vk;
use std::error::Error;
use std::time::Instant;

/// Compiles all kernels.
///
/// # Errors
/// If the driver has no device, or refuses a kernel.
pub fn compile(kernels: &[Spirv]) -> Result<Vec<Compiled>, Box<dyn Error>> {
    // SAFETY: all that is created here is used in this function only, and outlives what is made of it: nothing is
    // destroyed before the process ends. Structures are those that the calls ask for.
    unsafe {
        let entry = ash::Entry::load()?;
        let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_3);
        let instance =
            entry.create_instance(&vk::InstanceCreateInfo::default().application_info(&application), None)?;
        let card = *instance
            .enumerate_physical_devices()?
            .first()
            .ok_or("the driver has no device")?;
        let name = instance.get_physical_device_properties(card);
        eprintln!("{}", name.device_name_as_c_str()?.to_string_lossy());
        let queue = [vk::DeviceQueueCreateInfo::default().queue_priorities(&[1.0])];
        let extensions = [ash::khr::pipeline_executable_properties::NAME.as_ptr()];
        let mut statistics =
            vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR::default().pipeline_executable_info(true);
        let info = vk::DeviceCreateInfo::default()
            .queue_create_infos(&queue)
            .enabled_extension_names(&extensions)
            .push_next(&mut statistics);
        let device = instance.create_device(card, &info, None)?;
        let figures = ash::khr::pipeline_executable_properties::Device::new(&instance, &device);
        kernels.iter().map(|kernel| one(&device, &figures, kernel)).collect()
    }
}

/// Compiles one kernel.
///
/// # Safety
/// `figures` belongs to `device`.
unsafe fn one(
    device: &ash::Device,
    figures: &ash::khr::pipeline_executable_properties::Device,
    kernel: &Spirv,
) -> Result<Compiled, Box<dyn Error>> {
    let buffer = |&(slot, uniform): &(u32, bool)| {
        let kind = match uniform {
            true => vk::DescriptorType::UNIFORM_BUFFER,
            false => vk::DescriptorType::STORAGE_BUFFER,
        };
        vk::DescriptorSetLayoutBinding::default()
            .binding(slot)
            .descriptor_type(kind)
            .descriptor_count(1)
            .stage_flags(vk::ShaderStageFlags::COMPUTE)
    };
    let buffers: Vec<_> = kernel.buffers.iter().map(buffer).collect();
    // SAFETY: as in `compile`.
    unsafe {
        let set = [device
            .create_descriptor_set_layout(&vk::DescriptorSetLayoutCreateInfo::default().bindings(&buffers), None)?];
        let layout = device.create_pipeline_layout(&vk::PipelineLayoutCreateInfo::default().set_layouts(&set), None)?;
        let module = device.create_shader_module(&vk::ShaderModuleCreateInfo::default().code(&kernel.words), None)?;
        let stage = vk::PipelineShaderStageCreateInfo::default()
            .stage(vk::ShaderStageFlags::COMPUTE)
            .module(module)
            .name(c"main");
        let info = vk::ComputePipelineCreateInfo::default()
            .flags(vk::PipelineCreateFlags::CAPTURE_STATISTICS_KHR)
            .stage(stage)
            .layout(layout);
        let start = Instant::now();
        let pipelines = device
            .create_compute_pipelines(vk::PipelineCache::null(), &[info], None)
            .map_err(|(_, error)| format!("{}: {error}", kernel.name))?;
        let milliseconds = 1e3 * start.elapsed().as_secs_f64();
        let info = vk::PipelineExecutableInfoKHR::default().pipeline(pipelines[0]);
        let mut compiled = Compiled::new(kernel.name, milliseconds);
        for figure in figures.get_pipeline_executable_statistics(&info)? {
            let value = match figure.format {
                vk::PipelineExecutableStatisticFormatKHR::UINT64 => figure.value.u64 as f64,
                vk::PipelineExecutableStatisticFormatKHR::INT64 => figure.value.i64 as f64,
                vk::PipelineExecutableStatisticFormatKHR::FLOAT64 => figure.value.f64,
                _ => continue,
            };
            compiled.note(&figure.name_as_c_str()?.to_string_lossy(), value);
        }
        Ok(compiled)
    }
}
