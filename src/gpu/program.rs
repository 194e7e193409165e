//! What a step does on the device: calls of kernels in order, first by the names of buffers, then with the buffers.
//!
//! A call binds each variable of its kernel to the buffer of the same name. Only what runs on different buffers from call
//! to call, such as the sort, is told their names. So calls can be listed, and checked, without a device.

use super::device::Gpu;
use super::kernel::{Compiled, Kernel, Kernels};
use crate::types::stage::Stage;
use std::collections::HashMap;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::*;

/// How many workgroups run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Groups {
    /// As many as there are.
    Exactly(u32),
    /// One for so many bodies.
    PerBodies(u32),
    /// What the kernels before wrote into the slot of this number in the buffer of this name.
    Indirect(&'static str, u32),
}

/// The variable that holds what a call says beside buffers.
pub const CONSTANTS: &str = "constants";

/// A call of a kernel.
#[derive(Clone, Debug)]
pub struct Call {
    /// Which.
    pub kernel: &'static Kernel,
    /// Part of which stage.
    pub stage: Stage,
    /// How many workgroups it has.
    pub groups: Groups,
    constants: Option<[u32; 4]>,
    bound: Vec<Bound>,
}

/// A variable whose buffer has another name.
#[derive(Clone, Copy, Debug)]
struct Bound {
    variable: &'static str,
    buffer: &'static str,
    /// The buffer's elements are taken for words.
    words: bool,
}

impl Call {
    /// Sets the uniform [`CONSTANTS`].
    pub fn constants(&mut self, constants: [u32; 4]) -> &mut Self {
        self.constants = Some(constants);
        self
    }

    /// Binds a variable to the buffer of another name.
    pub fn bind(&mut self, variable: &'static str, buffer: &'static str) -> &mut Self {
        self.bound.push(Bound {
            variable,
            buffer,
            words: false,
        });
        self
    }

    /// Binds a variable to a buffer whatever its elements are: the kernel moves words.
    pub fn bind_words(&mut self, variable: &'static str, buffer: &'static str) -> &mut Self {
        self.bound.push(Bound {
            variable,
            buffer,
            words: true,
        });
        self
    }

    /// The buffer to which a variable is bound, and whether its elements are taken for words.
    pub fn buffer_of<'v>(&self, variable: &'v str) -> (&'v str, bool) {
        match self.bound.iter().find(|bound| bound.variable == variable) {
            Some(bound) => (bound.buffer, bound.words),
            None => (variable, false),
        }
    }

    /// Variables that are bound to buffers of other names.
    pub fn rebound(&self) -> impl Iterator<Item = &'static str> {
        self.bound.iter().map(|bound| bound.variable)
    }

    /// Whether it sets [`CONSTANTS`].
    pub fn has_constants(&self) -> bool {
        self.constants.is_some()
    }
}

/// Calls in order, not yet bound to buffers.
#[derive(Clone, Debug)]
pub struct Calls {
    stage: Stage,
    calls: Vec<Call>,
}

impl Calls {
    /// None yet; the next ones belong to this stage.
    pub fn new(stage: Stage) -> Self {
        Self {
            stage,
            calls: Vec::new(),
        }
    }

    /// What follows belongs to this stage.
    pub fn stage(&mut self, stage: Stage) {
        self.stage = stage;
    }

    /// Adds a call.
    pub fn call(&mut self, kernel: &'static Kernel, groups: Groups) -> &mut Call {
        self.calls.push(Call {
            kernel,
            stage: self.stage,
            groups,
            constants: None,
            bound: Vec::new(),
        });
        let last = self.calls.len() - 1;
        &mut self.calls[last]
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = &Call> {
        self.calls.iter()
    }
}

/// Buffers that have names.
pub trait BufferSet {
    /// The buffer of this name.
    fn find(&self, name: &str) -> Option<&Buffer>;
}

impl<const N: usize> BufferSet for [(&str, &Buffer); N] {
    fn find(&self, name: &str) -> Option<&Buffer> {
        self.iter().find(|(own, _)| *own == name).map(|(_, buffer)| *buffer)
    }
}

/// A call with its buffers.
#[derive(Clone, Debug)]
struct BoundCall {
    pipeline: ComputePipeline,
    bind_group: BindGroup,
    groups: Groups,
    /// Of indirect dispatches.
    arguments: Option<Buffer>,
}

/// Calls with their buffers, by stage: recorded anew every step, made anew when a buffer is.
#[derive(Clone, Debug, Default)]
pub struct Program {
    stages: [Vec<BoundCall>; Stage::COUNT],
}

impl Program {
    /// Binds calls to buffers of `sets`, among which no two have the same name.
    ///
    /// # Panics
    /// If a kernel was not compiled, or there is no buffer of some name.
    pub fn new(gpu: &Gpu, kernels: &Kernels, calls: &Calls, sets: &[&dyn BufferSet]) -> Self {
        let mut binder = Binder {
            gpu,
            kernels,
            sets,
            constants: HashMap::new(),
        };
        let mut program = Self::default();
        for call in calls.iter() {
            program.stages[call.stage as usize].push(binder.bind(call));
        }
        program
    }

    /// Records the calls of one stage as one pass.
    pub fn record(
        &self,
        stage: Stage,
        encoder: &mut CommandEncoder,
        bodies: u32,
        timestamps: Option<ComputePassTimestampWrites>,
    ) {
        let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor {
            label: Some(stage.name()),
            timestamp_writes: timestamps,
        });
        for call in &self.stages[stage as usize] {
            pass.set_pipeline(&call.pipeline);
            pass.set_bind_group(0, &call.bind_group, &[]);
            match (call.groups, &call.arguments) {
                (Groups::Exactly(n), _) => dispatch(&mut pass, n),
                (Groups::PerBodies(per), _) => dispatch(&mut pass, bodies.div_ceil(per)),
                (Groups::Indirect(_, slot), Some(arguments)) => {
                    pass.dispatch_workgroups_indirect(arguments, u64::from(slot) * 12);
                }
                (Groups::Indirect(..), None) => {}
            }
        }
    }

    /// How many dispatches a stage takes.
    pub fn len(&self, stage: Stage) -> usize {
        self.stages[stage as usize].len()
    }
}

/// Finds the buffers of calls.
struct Binder<'a> {
    gpu: &'a Gpu,
    kernels: &'a Kernels,
    sets: &'a [&'a dyn BufferSet],
    /// Small uniforms that never change, by what they hold.
    constants: HashMap<[u32; 4], Buffer>,
}

impl Binder<'_> {
    fn bind(&mut self, call: &Call) -> BoundCall {
        let Compiled {
            bindings,
            layout,
            pipeline,
        } = self.kernels.get(call.kernel);
        if let Some(values) = call.constants {
            let Self { gpu, constants, .. } = self;
            constants.entry(values).or_insert_with(|| uniform(gpu, values));
        }
        let buffers = bindings.iter().map(|binding| match call.constants {
            Some(values) if binding.name == CONSTANTS => &self.constants[&values],
            _ => self.find(call, call.buffer_of(&binding.name).0),
        });
        let entries: Vec<_> = (bindings.iter().zip(buffers))
            .map(|(binding, buffer)| BindGroupEntry {
                binding: binding.slot,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        let bind_group = self.gpu.device.create_bind_group(&BindGroupDescriptor {
            label: Some(call.kernel.name),
            layout,
            entries: &entries,
        });
        BoundCall {
            pipeline: pipeline.clone(),
            bind_group,
            groups: call.groups,
            arguments: match call.groups {
                Groups::Indirect(arguments, _) => Some(self.find(call, arguments).clone()),
                _ => None,
            },
        }
    }

    fn find(&self, call: &Call, name: &str) -> &Buffer {
        let found = self.sets.iter().find_map(|set| set.find(name));
        found.unwrap_or_else(|| panic!("{}: there is no buffer {name}", call.kernel.name))
    }
}

fn uniform(gpu: &Gpu, values: [u32; 4]) -> Buffer {
    gpu.device.create_buffer_init(&BufferInitDescriptor {
        label: Some(CONSTANTS),
        contents: bytemuck::bytes_of(&values),
        usage: BufferUsages::UNIFORM,
    })
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
