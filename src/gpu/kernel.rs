//! How a kernel is declared, and what follows from the declaration: layout, pipeline, bind group, dispatch, label, and
//! the test that compares it with its WGSL.

use super::device::Gpu;
use crate::types::stage::Stage;
use naga_oil::compose::{
    ComposableModuleDescriptor, Composer, ComposerError, NagaModuleDescriptor, ShaderDefValue, ShaderLanguage,
    ShaderType,
};
use std::borrow::Cow;
use std::collections::HashMap;
use wgpu::util::DeviceExt;
use wgpu::*;

/// A compute shader with one entry point, `main`.
#[derive(Debug)]
pub struct Kernel {
    /// Its label, `stage/what it does`.
    pub name: &'static str,
    /// WGSL.
    pub source: &'static str,
    /// Whether `EMIT` is defined: lists of unknown length are counted by a kernel and emitted by the same one again.
    pub emit: bool,
    /// Threads in a workgroup, along x.
    pub workgroup: u32,
    /// Group 0, in the order in which a call names the buffers.
    pub bindings: &'static [Binding],
}

/// A buffer that a kernel sees.
#[derive(Clone, Copy, Debug)]
pub struct Binding {
    /// `@binding` in WGSL.
    pub slot: u32,
    /// The variable's name in WGSL.
    pub name: &'static str,
    /// What the kernel does with it.
    pub access: Access,
    /// The WGSL type; of an array, that of its elements.
    pub element: &'static str,
}

/// What a kernel does with a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// Reads one struct.
    Uniform,
    /// Reads an array.
    Read,
    /// Reads and writes an array.
    Write,
}

/// A uniform.
pub const fn uniform(slot: u32, name: &'static str, element: &'static str) -> Binding {
    Binding {
        slot,
        name,
        access: Access::Uniform,
        element,
    }
}

/// An array that is read.
pub const fn read(slot: u32, name: &'static str, element: &'static str) -> Binding {
    Binding {
        slot,
        name,
        access: Access::Read,
        element,
    }
}

/// An array that is written.
pub const fn write(slot: u32, name: &'static str, element: &'static str) -> Binding {
    Binding {
        slot,
        name,
        access: Access::Write,
        element,
    }
}

/// What kernels import.
pub const MODULES: &[(&str, &str)] = &[
    (
        "types.wgsl",
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/shared/types.wgsl")),
    ),
    (
        "math.wgsl",
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/shared/math.wgsl")),
    ),
    (
        "dispatch.wgsl",
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/shared/dispatch.wgsl")),
    ),
    (
        "scan.wgsl",
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/shared/scan.wgsl")),
    ),
    (
        "grid.wgsl",
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/broad_phase/grid.wgsl")),
    ),
    (
        "arena.wgsl",
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/shared/arena.wgsl")),
    ),
    (
        "margins.wgsl",
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/shared/margins.wgsl")),
    ),
    (
        "tree.wgsl",
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/shared/tree.wgsl")),
    ),
    (
        "containment.wgsl",
        include_str!(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/shaders/triangle_test/containment.wgsl"
        )),
    ),
    (
        "triangles.wgsl",
        include_str!(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/shaders/triangle_test/triangles.wgsl"
        )),
    ),
    (
        "response.wgsl",
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/force_scan/response.wgsl")),
    ),
    (
        "sides.wgsl",
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/manifolds/sides.wgsl")),
    ),
    (
        "features.wgsl",
        include_str!(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/shaders/manifolds/feature_pairs.wgsl"
        )),
    ),
    (
        "smooth.wgsl",
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/manifolds/smooth.wgsl")),
    ),
    (
        "contact_slots.wgsl",
        include_str!(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/shaders/manifolds/contact_slots.wgsl"
        )),
    ),
    (
        "solver_types.wgsl",
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/solver/types.wgsl")),
    ),
    (
        "solver_math.wgsl",
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/solver/math.wgsl")),
    ),
    (
        "tensor.wgsl",
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/shared/tensor.wgsl")),
    ),
    (
        "solver_mover.wgsl",
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/solver/mover.wgsl")),
    ),
    (
        "solver_overlap.wgsl",
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/solver/overlap.wgsl")),
    ),
    (
        "solver_contact.wgsl",
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/solver/contact.wgsl")),
    ),
    (
        "carried.wgsl",
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/step/carried.wgsl")),
    ),
    (
        "placed.wgsl",
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/manifolds/placed.wgsl")),
    ),
    (
        "solver_islands.wgsl",
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/sleep/islands.wgsl")),
    ),
];

/// A composer that knows [`MODULES`].
///
/// # Errors
/// If one of them is not valid WGSL.
pub fn composer() -> Result<Composer, Box<ComposerError>> {
    let mut composer = Composer::default();
    for (path, source) in MODULES {
        composer
            .add_composable_module(ComposableModuleDescriptor {
                source,
                file_path: path,
                language: ShaderLanguage::Wgsl,
                ..Default::default()
            })
            .map_err(Box::new)?;
    }
    Ok(composer)
}

impl Kernel {
    /// The kernel with its imports.
    ///
    /// # Errors
    /// If it is not valid WGSL.
    pub fn compose(&self, composer: &mut Composer) -> Result<wgpu::naga::Module, Box<ComposerError>> {
        let mut shader_defs = HashMap::new();
        if self.emit {
            shader_defs.insert("EMIT".to_string(), ShaderDefValue::Bool(true));
        }
        composer
            .make_naga_module(NagaModuleDescriptor {
                source: self.source,
                file_path: self.name,
                shader_type: ShaderType::Wgsl,
                shader_defs,
                ..Default::default()
            })
            .map_err(Box::new)
    }

    fn compile(&self, gpu: &Gpu, composer: &mut Composer) -> Result<Compiled, String> {
        let module = self.compose(composer).map_err(|e| e.emit_to_string(composer))?;
        let module = gpu.device.create_shader_module(ShaderModuleDescriptor {
            label: Some(self.name),
            source: ShaderSource::Naga(Cow::Owned(module)),
        });
        let entries: Vec<_> = self
            .bindings
            .iter()
            .map(|b| BindGroupLayoutEntry {
                binding: b.slot,
                visibility: ShaderStages::COMPUTE,
                ty: BindingType::Buffer {
                    ty: match b.access {
                        Access::Uniform => BufferBindingType::Uniform,
                        Access::Read => BufferBindingType::Storage { read_only: true },
                        Access::Write => BufferBindingType::Storage { read_only: false },
                    },
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            })
            .collect();
        let layout = gpu.device.create_bind_group_layout(&BindGroupLayoutDescriptor {
            label: Some(self.name),
            entries: &entries,
        });
        let pipeline_layout = gpu.device.create_pipeline_layout(&PipelineLayoutDescriptor {
            label: Some(self.name),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = gpu.device.create_compute_pipeline(&ComputePipelineDescriptor {
            label: Some(self.name),
            layout: Some(&pipeline_layout),
            module: &module,
            entry_point: Some("main"),
            compilation_options: PipelineCompilationOptions {
                // Every kernel clears what it reads.
                zero_initialize_workgroup_memory: false,
                ..Default::default()
            },
            cache: None,
        });
        Ok(Compiled { layout, pipeline })
    }
}

/// A kernel on a device.
#[derive(Clone, Debug)]
struct Compiled {
    layout: BindGroupLayout,
    pipeline: ComputePipeline,
}

/// All kernels on a device.
#[derive(Debug)]
pub struct Kernels {
    compiled: HashMap<&'static str, Compiled>,
}

impl Kernels {
    /// Compiles some kernels.
    ///
    /// # Errors
    /// The compiler's message.
    pub fn new<'k>(gpu: &Gpu, kernels: impl IntoIterator<Item = &'k Kernel>) -> Result<Self, String> {
        let mut compiled = Self {
            compiled: HashMap::new(),
        };
        compiled.add(gpu, kernels)?;
        Ok(compiled)
    }

    /// Compiles some more.
    ///
    /// # Errors
    /// The compiler's message.
    pub fn add<'k>(&mut self, gpu: &Gpu, kernels: impl IntoIterator<Item = &'k Kernel>) -> Result<(), String> {
        let mut composer = composer().map_err(|e| e.to_string())?;
        for kernel in kernels {
            self.compiled.insert(kernel.name, kernel.compile(gpu, &mut composer)?);
        }
        Ok(())
    }
}

/// How many workgroups run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Groups {
    /// As many as there are.
    Exactly(u32),
    /// One for so many bodies.
    PerBodies(u32),
    /// What the kernels before wrote into the arguments' slot of this number.
    Indirect(u32),
}

/// A kernel with its buffers.
#[derive(Clone, Debug)]
struct Call {
    pipeline: ComputePipeline,
    bind_group: BindGroup,
    groups: Groups,
}

/// Calls in order, by stage: recorded anew every step, built anew when a buffer is.
#[derive(Clone, Debug, Default)]
pub struct Program {
    stages: [Vec<Call>; Stage::COUNT],
}

/// Adds calls to a [`Program`].
pub struct Builder<'a> {
    /// Where it will run.
    pub gpu: &'a Gpu,
    kernels: &'a Kernels,
    program: Program,
    stage: Stage,
}

impl<'a> Builder<'a> {
    /// Without any call yet.
    pub fn new(gpu: &'a Gpu, kernels: &'a Kernels) -> Self {
        Self {
            gpu,
            kernels,
            program: Program::default(),
            stage: Stage::BroadPhase,
        }
    }

    /// What follows belongs to this stage.
    pub fn stage(&mut self, stage: Stage) {
        self.stage = stage;
    }

    /// Adds a call. `buffers` are in the order of the kernel's bindings.
    ///
    /// # Panics
    /// If the kernel was not compiled, or has another number of bindings.
    pub fn call(&mut self, kernel: &Kernel, buffers: &[&Buffer], groups: Groups) {
        assert_eq!(buffers.len(), kernel.bindings.len(), "{}", kernel.name);
        let Compiled { layout, pipeline } = &self.kernels.compiled[kernel.name];
        let entries: Vec<_> = kernel
            .bindings
            .iter()
            .zip(buffers)
            .map(|(binding, buffer)| BindGroupEntry {
                binding: binding.slot,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        let bind_group = self.gpu.device.create_bind_group(&BindGroupDescriptor {
            label: Some(kernel.name),
            layout,
            entries: &entries,
        });
        self.program.stages[self.stage as usize].push(Call {
            pipeline: pipeline.clone(),
            bind_group,
            groups,
        });
    }

    /// A small uniform that never changes.
    pub fn constants(&self, values: [u32; 4]) -> Buffer {
        self.gpu.device.create_buffer_init(&util::BufferInitDescriptor {
            label: Some("constants"),
            contents: bytemuck::bytes_of(&values),
            usage: BufferUsages::UNIFORM,
        })
    }

    /// All calls.
    pub fn finish(self) -> Program {
        self.program
    }
}

impl Program {
    /// Records the calls of one stage as one pass.
    pub fn record(
        &self,
        stage: Stage,
        encoder: &mut CommandEncoder,
        bodies: u32,
        arguments: &Buffer,
        timestamps: Option<ComputePassTimestampWrites>,
    ) {
        let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor {
            label: Some(stage.name()),
            timestamp_writes: timestamps,
        });
        for call in &self.stages[stage as usize] {
            pass.set_pipeline(&call.pipeline);
            pass.set_bind_group(0, &call.bind_group, &[]);
            match call.groups {
                Groups::Exactly(n) => dispatch(&mut pass, n),
                Groups::PerBodies(per) => dispatch(&mut pass, bodies.div_ceil(per)),
                Groups::Indirect(slot) => pass.dispatch_workgroups_indirect(arguments, u64::from(slot) * 12),
            }
        }
    }

    /// How many dispatches a stage takes.
    pub fn len(&self, stage: Stage) -> usize {
        self.stages[stage as usize].len()
    }
}

/// One dimension holds 65,535 groups; more are laid out in rows. `dispatch.wgsl` does the same on the device, and
/// numbers the groups.
fn dispatch(pass: &mut ComputePass, groups: u32) {
    let [x, y, z] = rows(groups);
    pass.dispatch_workgroups(x, y, z);
}

/// Rows of workgroups; the last one may hold more than are wanted.
pub fn rows(groups: u32) -> [u32; 3] {
    [groups.min(MAX_ROW), groups.div_ceil(MAX_ROW), 1]
}

/// Groups along one dimension that every device allows.
pub const MAX_ROW: u32 = 65_535;
