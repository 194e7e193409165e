//! Programs: lists of kernel calls, first by the names of buffers, then bound to buffers.
//!
//! A call binds each variable of its kernel to the buffer of the same name. Only kernels that run on different buffers,
//! such as the sort's, are given the names. So calls can be listed and checked without a device.

use super::commands::{Commands, Pass};
use super::device::Gpu;
use super::kernel::{Compiled, Kernel};
use crate::types::stage::Stage;
use std::collections::HashMap;
use wgpu::*;

/// Number of workgroups of a call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Groups {
    /// This number.
    Exactly(u32),
    /// One per this many bodies.
    PerBodies(u32),
    /// One per this many compounds.
    PerCompounds(u32),
    /// Indirect: the buffer of this name, and the slot in it.
    Indirect(&'static str, u32),
}

impl Groups {
    /// One workgroup of 64 threads per 64 elements, of which the device counts no more than `at_most`. Short lists get
    /// the largest possible number, because superfluous workgroups return at once and cost less than what wgpu does for
    /// an indirect dispatch.
    pub fn per_64(at_most: u32, counted: Self) -> Self {
        if at_most <= SHORT {
            Self::Exactly(at_most.div_ceil(64))
        } else {
            counted
        }
    }
}

/// The longest list that counts as short.
const SHORT: u32 = 4096;

/// The name of the variable that holds a call's constants.
pub const CONSTANTS: &str = "constants";

/// A call of a kernel.
#[derive(Clone, Debug)]
pub struct Call {
    /// The kernel.
    pub kernel: &'static Kernel,
    /// The stage to which it belongs.
    pub stage: Stage,
    /// Number of workgroups.
    pub groups: Groups,
    constants: Option<[u32; 4]>,
    bound: Vec<Bound>,
    steps: Steps,
}

/// The steps in which a call takes part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Steps {
    All,
    WithCompounds,
    WithPlanes,
    WithLargeMeshes,
    WithRoundedMeshes,
}

/// The numbers on which calls and their workgroups depend.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Population {
    /// Number of bodies.
    pub bodies: u32,
    /// Number of compounds.
    pub compounds: u32,
    /// Number of planes.
    pub planes: u32,
    /// Whether some mesh is so large that its pairs may be split.
    pub large_meshes: bool,
    /// Whether some body is rounded.
    pub rounded_meshes: bool,
}

impl From<u32> for Population {
    fn from(bodies: u32) -> Self {
        Self {
            bodies,
            ..Self::default()
        }
    }
}

/// A variable that is bound to a buffer of another name.
#[derive(Clone, Copy, Debug)]
struct Bound {
    variable: &'static str,
    buffer: &'static str,
    /// The element type of the buffer is ignored.
    words: bool,
}

impl Call {
    /// Sets the uniform [`CONSTANTS`].
    pub fn constants(&mut self, constants: [u32; 4]) -> &mut Self {
        self.constants = Some(constants);
        self
    }

    /// Binds a variable to a buffer of another name.
    pub fn bind(&mut self, variable: &'static str, buffer: &'static str) -> &mut Self {
        self.bound.push(Bound {
            variable,
            buffer,
            words: false,
        });
        self
    }

    /// Binds a variable to a buffer of any element type, for kernels that copy words.
    pub fn bind_words(&mut self, variable: &'static str, buffer: &'static str) -> &mut Self {
        self.bound.push(Bound {
            variable,
            buffer,
            words: true,
        });
        self
    }

    /// Leaves it out of steps without compounds.
    pub fn for_compounds(&mut self) -> &mut Self {
        self.steps = Steps::WithCompounds;
        self
    }

    /// Leaves it out of steps without planes.
    pub fn for_planes(&mut self) -> &mut Self {
        self.steps = Steps::WithPlanes;
        self
    }

    /// Leaves it out of steps without large meshes.
    pub fn for_large_meshes(&mut self) -> &mut Self {
        self.steps = Steps::WithLargeMeshes;
        self
    }

    /// Leaves it out of steps without rounded meshes.
    pub fn for_rounded_meshes(&mut self) -> &mut Self {
        self.steps = Steps::WithRoundedMeshes;
        self
    }

    /// The buffer to which a variable is bound, and whether its element type is ignored.
    pub fn buffer_of<'v>(&self, variable: &'v str) -> (&'v str, bool) {
        match self.bound.iter().find(|bound| bound.variable == variable) {
            Some(bound) => (bound.buffer, bound.words),
            None => (variable, false),
        }
    }

    /// The variables that are bound to buffers of other names.
    pub fn rebound(&self) -> impl Iterator<Item = &'static str> {
        self.bound.iter().map(|bound| bound.variable)
    }

    /// Whether it sets [`CONSTANTS`].
    pub fn has_constants(&self) -> bool {
        self.constants.is_some()
    }
}

/// A list of calls that are not yet bound to buffers.
#[derive(Clone, Debug)]
pub struct Calls {
    stage: Stage,
    calls: Vec<Call>,
}

impl Calls {
    /// An empty list. Calls are added to this stage first.
    pub fn new(stage: Stage) -> Self {
        Self {
            stage,
            calls: Vec::new(),
        }
    }

    /// Adds the following calls to this stage.
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
            steps: if matches!(groups, Groups::PerCompounds(_)) {
                Steps::WithCompounds
            } else {
                Steps::All
            },
        });
        let last = self.calls.len() - 1;
        &mut self.calls[last]
    }

    /// All calls, in order.
    pub fn iter(&self) -> impl Iterator<Item = &Call> {
        self.calls.iter()
    }
}

/// Buffers by name.
pub trait BufferSet {
    /// The buffer of this name.
    fn find(&self, name: &str) -> Option<&Buffer>;
}

impl<const N: usize> BufferSet for [(&str, &Buffer); N] {
    fn find(&self, name: &str) -> Option<&Buffer> {
        self.iter().find(|(own, _)| *own == name).map(|(_, buffer)| *buffer)
    }
}

/// A call with its bindings.
#[derive(Clone, Debug)]
struct BoundCall {
    kernel: &'static str,
    pipeline: ComputePipeline,
    bind_group: BindGroup,
    groups: Groups,
    steps: Steps,
    /// The buffer of an indirect dispatch.
    arguments: Option<Buffer>,
}

/// Calls with their bindings, by stage. They are recorded in every step, and made again when a buffer is replaced.
#[derive(Clone, Debug, Default)]
pub struct Program {
    stages: [Vec<BoundCall>; Stage::COUNT],
}

impl Program {
    /// Binds calls to the buffers of `sets`, whose names must be unique.
    ///
    /// # Panics
    /// If a kernel is not compiled, or a buffer is missing.
    pub fn new(gpu: &Gpu, calls: &Calls, sets: &[&dyn BufferSet]) -> Self {
        let mut binder = Binder {
            gpu,
            sets,
            constants: HashMap::new(),
        };
        let mut program = Self::default();
        for call in calls.iter() {
            program.stages[call.stage as usize].push(binder.bind(call));
        }
        program
    }

    /// Records the calls of a stage as one compute pass.
    pub fn record(
        &self,
        stage: Stage,
        commands: &mut Commands,
        population: Population,
        timestamps: Option<ComputePassTimestampWrites>,
    ) {
        let mut pass = commands.pass(stage.name(), timestamps);
        let calls = self.stages[stage as usize].iter();
        let Population {
            bodies,
            compounds,
            planes,
            large_meshes,
            rounded_meshes,
        } = population;
        let takes_part = |call: &&BoundCall| match call.steps {
            Steps::All => true,
            Steps::WithCompounds => compounds > 0,
            Steps::WithPlanes => planes > 0,
            Steps::WithLargeMeshes => large_meshes,
            Steps::WithRoundedMeshes => rounded_meshes,
        };
        for call in calls.filter(takes_part) {
            pass.pass.set_pipeline(&call.pipeline);
            pass.pass.set_bind_group(0, &call.bind_group, &[]);
            pass.time(Some(call.kernel));
            match (call.groups, &call.arguments) {
                (Groups::Exactly(n), _) => dispatch(&mut pass, n),
                (Groups::PerBodies(per), _) => dispatch(&mut pass, bodies.div_ceil(per)),
                (Groups::PerCompounds(per), _) => dispatch(&mut pass, compounds.div_ceil(per)),
                (Groups::Indirect(_, slot), Some(arguments)) => {
                    pass.dispatch_indirect(arguments, 3 * slot);
                }
                (Groups::Indirect(..), None) => {}
            }
        }
        pass.time(None);
    }
}

/// Resolves the buffers of calls.
struct Binder<'a> {
    gpu: &'a Gpu,
    sets: &'a [&'a dyn BufferSet],
    /// Uniforms that never change, by content.
    constants: HashMap<[u32; 4], Buffer>,
}

impl Binder<'_> {
    fn bind(&mut self, call: &Call) -> BoundCall {
        let Compiled {
            bindings,
            layout,
            pipeline,
        } = self.gpu.kernels.get(call.kernel);
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
            layout: &layout,
            entries: &entries,
        });
        BoundCall {
            kernel: call.kernel.name,
            pipeline,
            bind_group,
            groups: call.groups,
            steps: call.steps,
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
    // Not with its contents at once: that maps the buffer, and wgpu panics if the device has just been lost.
    let buffer = gpu.device.create_buffer(&BufferDescriptor {
        label: Some(CONSTANTS),
        size: size_of_val(&values) as u64,
        usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    gpu.queue.write_buffer(&buffer, 0, bytemuck::bytes_of(&values));
    buffer
}

/// One dimension of a dispatch has at most 65,535 workgroups, so they are laid out in rows. `dispatch.wgsl` numbers
/// them on the device.
fn dispatch(pass: &mut Pass, groups: u32) {
    pass.dispatch(rows(groups));
}

/// The dispatch size for a number of workgroups. The last row may have too many.
pub fn rows(groups: u32) -> [u32; 3] {
    [groups.min(MAX_ROW), groups.div_ceil(MAX_ROW), 1]
}

/// Workgroups per dimension that every device supports.
pub const MAX_ROW: u32 = 65_535;
