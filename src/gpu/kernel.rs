//! Declaration and compilation of kernels. Bindings and workgroup sizes are reflected from the WGSL.

use super::device::Gpu;
use super::readback::{DeviceError, scoped};
use super::shader::{Module, composer};
use naga_oil::compose::{Composer, ComposerError, NagaModuleDescriptor, ShaderDefValue, ShaderType};
use std::borrow::Cow;
use std::collections::HashMap;
use std::panic::resume_unwind;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use wgpu::naga::{self, AddressSpace, Handle, ScalarKind, StorageAccess, Type, TypeInner, VectorSize};
use wgpu::*;

/// A compute shader with one entry point, `main`.
#[derive(Debug)]
pub struct Kernel {
    /// Label: the path of its file below `shaders/`, without the extension.
    pub name: &'static str,
    /// The WGSL source.
    pub source: &'static str,
    /// What is defined for the preprocessor. Lists of unknown length are counted by a kernel, and written by the same
    /// kernel with `EMIT`. With `LARGE` it has large workgroups, and with `PIECES` one for each piece of a pair of
    /// large meshes. Several names are separated by spaces.
    pub define: Option<&'static str>,
}

/// The kernel in a file below `shaders/`, without the extension; optionally with a definition.
macro_rules! kernel {
    ($path:literal) => {
        $crate::gpu::kernel::Kernel {
            name: $path,
            source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/", $path, ".wgsl")),
            define: None,
        }
    };
    ($path:literal, $define:literal) => {
        $crate::gpu::kernel::Kernel {
            name: concat!($path, " ", $define),
            define: Some($define),
            ..$crate::gpu::kernel::kernel!($path)
        }
    };
}

pub(crate) use kernel;

/// A buffer binding of a kernel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Binding {
    /// `@group` in WGSL.
    pub group: u32,
    /// `@binding` in WGSL.
    pub slot: u32,
    /// The variable's name in WGSL.
    pub name: String,
    /// How the kernel accesses it.
    pub access: Access,
    /// The WGSL type; for arrays, the type of the elements.
    pub element: String,
}

/// How a kernel accesses a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// Reads a struct.
    Uniform,
    /// Reads an array.
    Read,
    /// Reads and writes an array.
    Write,
}

impl Kernel {
    /// The naga module of the kernel, with its imports.
    ///
    /// # Errors
    /// If the WGSL is invalid.
    pub fn compose(&self, composer: &mut Composer) -> Result<naga::Module, Box<ComposerError>> {
        let define = |name: &str| (name.to_string(), ShaderDefValue::Bool(true));
        let names = self.define.into_iter().flat_map(str::split_whitespace);
        let shader_defs = names.map(define).collect();
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

    fn compile(&self, gpu: &Gpu, module: naga::Module) -> Compiled {
        let bindings = bindings(&module);
        let module = gpu.device.create_shader_module(ShaderModuleDescriptor {
            label: Some(self.name),
            source: ShaderSource::Naga(Cow::Owned(module)),
        });
        let entries: Vec<_> = bindings.iter().map(Binding::layout).collect();
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
                // Every kernel initialises what it reads.
                zero_initialize_workgroup_memory: false,
                ..Default::default()
            },
            cache: gpu.stored.as_ref().map(|stored| &stored.cache),
        });
        Compiled {
            bindings: bindings.into(),
            layout,
            pipeline,
        }
    }
}

impl Binding {
    fn layout(&self) -> BindGroupLayoutEntry {
        BindGroupLayoutEntry {
            binding: self.slot,
            visibility: ShaderStages::COMPUTE,
            ty: BindingType::Buffer {
                ty: match self.access {
                    Access::Uniform => BufferBindingType::Uniform,
                    Access::Read => BufferBindingType::Storage { read_only: true },
                    Access::Write => BufferBindingType::Storage { read_only: false },
                },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        }
    }
}

/// The bindings of a kernel, sorted by slot.
pub fn bindings(module: &naga::Module) -> Vec<Binding> {
    let variables = module.global_variables.iter().map(|(_, variable)| variable);
    let mut bindings: Vec<_> = variables
        .filter_map(|variable| {
            let at = variable.binding.as_ref()?;
            let access = match variable.space {
                AddressSpace::Uniform => Access::Uniform,
                AddressSpace::Storage { access } if !access.contains(StorageAccess::STORE) => Access::Read,
                _ => Access::Write,
            };
            let element = match module.types[variable.ty].inner {
                TypeInner::Array { base, .. } => base,
                _ => variable.ty,
            };
            Some(Binding {
                group: at.group,
                slot: at.binding,
                name: own_name(&variable.name).to_owned(),
                access,
                element: type_name(module, element),
            })
        })
        .collect();
    bindings.sort_by_key(|binding| (binding.group, binding.slot));
    bindings
}

/// The name of an item in its own file, without what naga_oil appends where it is imported.
pub fn own_name(name: &Option<String>) -> &str {
    let name = name.as_deref().unwrap_or_default();
    name.split_once("X_naga_oil_mod_X").map_or(name, |(own, _)| own)
}

/// The name of a type in WGSL. An atomic counts as its integer type.
pub fn type_name(module: &naga::Module, ty: Handle<Type>) -> String {
    let scalar = |scalar: naga::Scalar| match (scalar.kind, scalar.width) {
        (ScalarKind::Uint, 4) => "u32",
        (ScalarKind::Sint, 4) => "i32",
        (ScalarKind::Float, 4) => "f32",
        _ => "some other scalar",
    };
    match &module.types[ty].inner {
        TypeInner::Scalar(s) | TypeInner::Atomic(s) => scalar(*s).to_owned(),
        TypeInner::Vector { size, scalar: s } => {
            let size = match size {
                VectorSize::Bi => 2,
                VectorSize::Tri => 3,
                VectorSize::Quad => 4,
            };
            format!("vec{size}<{}>", scalar(*s))
        }
        TypeInner::Struct { .. } => own_name(&module.types[ty].name).to_owned(),
        other => format!("{other:?}"),
    }
}

/// A compiled kernel.
#[derive(Clone, Debug)]
pub(super) struct Compiled {
    pub bindings: Arc<[Binding]>,
    pub layout: BindGroupLayout,
    pub pipeline: ComputePipeline,
}

/// The compiled kernels of a device, by name. Clones refer to the same kernels.
#[derive(Clone, Debug, Default)]
pub(super) struct Kernels(Arc<Mutex<HashMap<&'static str, Compiled>>>);

impl Kernels {
    fn lock(&self) -> MutexGuard<'_, HashMap<&'static str, Compiled>> {
        // A panic does no harm: kernels are added only after all of them are compiled.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// # Panics
    /// If the kernel was not compiled.
    pub fn get(&self, kernel: &Kernel) -> Compiled {
        self.lock()[kernel.name].clone()
    }
}

impl Gpu {
    /// Compiles kernels that import from these modules on all cores, except kernels that the device has already. A
    /// kernel is known by its name. If one fails, the device keeps none.
    ///
    /// # Errors
    /// The message of the compiler or of the device.
    pub fn compile<'s>(
        &self,
        modules: impl IntoIterator<Item = &'s Module>,
        kernels: impl IntoIterator<Item = &'s Kernel>,
    ) -> Result<(), DeviceError> {
        let mut compiled = self.kernels.lock();
        let mut missing: Vec<_> = kernels.into_iter().filter(|k| !compiled.contains_key(k.name)).collect();
        missing.sort_by_key(|kernel| kernel.name);
        missing.dedup_by_key(|kernel| kernel.name);
        if missing.is_empty() {
            return Ok(());
        }
        let mut composer = composer(modules).map_err(DeviceError::failed)?;
        let mut composed = Vec::with_capacity(missing.len());
        for kernel in missing {
            let module = kernel.compose(&mut composer);
            composed.push((
                kernel,
                module.map_err(|error| DeviceError::Failed(error.emit_to_string(&composer)))?,
            ));
        }
        compiled.extend(self.compile_side_by_side(composed)?);
        if let Some(stored) = &self.stored {
            stored.store(self);
        }
        Ok(())
    }

    fn compile_side_by_side(
        &self,
        composed: Vec<(&Kernel, naga::Module)>,
    ) -> Result<Vec<(&'static str, Compiled)>, DeviceError> {
        let threads = std::thread::available_parallelism()
            .map_or(1, usize::from)
            .min(composed.len());
        let left = Mutex::new(composed);
        let work = || {
            let mut done = Vec::new();
            loop {
                let next = left.lock().unwrap_or_else(PoisonError::into_inner).pop();
                let Some((kernel, module)) = next else {
                    return Ok(done);
                };
                // Error scopes belong to threads.
                done.push((kernel.name, scoped(self, || kernel.compile(self, module))?));
            }
        };
        std::thread::scope(|scope| {
            let others: Vec<_> = (1..threads).map(|_| scope.spawn(work)).collect();
            let mut all = work();
            for other in others {
                let done = other.join().unwrap_or_else(|panic| resume_unwind(panic));
                all = all.and_then(|mut all| {
                    all.extend(done?);
                    Ok(all)
                });
            }
            all
        })
    }
}
