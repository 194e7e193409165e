//! WGSL modules that kernels import, and the constants that they share with the host.
//!
//! A constant that both need is defined in Rust, next to the CPU code that uses it, and listed in its stage's `gpu.rs`.
//! Its WGSL is generated when a [composer] is made, so no constant is defined in both languages.

use super::kernel::Kernel;
use naga_oil::compose::{ComposableModuleDescriptor, Composer, ComposerError, ShaderLanguage};
use std::fmt::Write;

/// The shaders of a stage.
#[derive(Debug)]
pub struct Shaders {
    /// Modules that this stage's and later stages' kernels import. A module may import modules before it.
    pub modules: &'static [Module],
    /// The stage's kernels.
    pub kernels: &'static [&'static Kernel],
}

/// A module: what kernels import under one path.
#[derive(Clone, Copy, Debug)]
pub struct Module {
    /// File name, for messages.
    pub name: &'static str,
    /// The WGSL source, which begins with `#define_import_path`.
    pub source: &'static str,
    /// Constants that are defined in Rust.
    pub constants: &'static [(&'static str, Value)],
}

/// The value of a shared constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// An unsigned integer.
    U32(u32),
    /// A number. WGSL gets the nearest one of single precision.
    F32(f64),
    /// Two numbers.
    Vec2([f64; 2]),
    /// Three numbers.
    Vec3([f64; 3]),
}

/// The module in a file below `shaders/`, without the extension; optionally with constants from Rust.
macro_rules! module {
    ($path:literal) => {
        $crate::gpu::shader::module!($path, &[])
    };
    ($path:literal, $constants:expr) => {
        $crate::gpu::shader::Module {
            name: concat!($path, ".wgsl"),
            source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/", $path, ".wgsl")),
            constants: $constants,
        }
    };
}

/// A module of constants alone, each with its type and name in WGSL and its value.
macro_rules! shared_constants {
    ($path:literal, { $($type:ident $name:ident = $value:expr;)* }) => {
        $crate::gpu::shader::Module {
            name: $path,
            source: concat!("#define_import_path ", $path, "\n"),
            constants: &[$((stringify!($name), $crate::gpu::shader::shared_value!($type $value))),*],
        }
    };
}

macro_rules! shared_value {
    (u32 $value:expr) => {
        $crate::gpu::shader::Value::U32($value as u32)
    };
    (f32 $value:expr) => {
        $crate::gpu::shader::Value::F32($value as f64)
    };
    (vec2 $value:expr) => {
        $crate::gpu::shader::Value::Vec2([$value[0] as f64, $value[1] as f64])
    };
    (vec3 $value:expr) => {
        $crate::gpu::shader::Value::Vec3([$value.x as f64, $value.y as f64, $value.z as f64])
    };
}

pub(crate) use {module, shared_constants, shared_value};

impl Module {
    /// The WGSL source with the constants.
    pub fn wgsl(&self) -> String {
        let mut wgsl = self.source.to_owned();
        for (name, value) in self.constants {
            let (ty, text) = value.wgsl();
            // Writing to a string cannot fail.
            let _ = writeln!(wgsl, "const {name}: {ty} = {text};");
        }
        wgsl
    }
}

impl Value {
    /// The type and value in WGSL. Single-precision numbers are written in double precision, where they are exact.
    fn wgsl(self) -> (&'static str, String) {
        let numbers = |all: &[f64]| all.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(", ");
        match self {
            Self::U32(value) => ("u32", format!("{value}u")),
            Self::F32(value) => ("f32", format!("{value:?}")),
            Self::Vec2(value) => ("vec2<f32>", format!("vec2({})", numbers(&value))),
            Self::Vec3(value) => ("vec3<f32>", format!("vec3({})", numbers(&value))),
        }
    }
}

/// A composer with these modules. Each may import those before it.
///
/// # Errors
/// If one of them is invalid WGSL.
pub fn composer<'m>(modules: impl IntoIterator<Item = &'m Module>) -> Result<Composer, Box<ComposerError>> {
    let mut composer = Composer::default();
    add(&mut composer, modules)?;
    Ok(composer)
}

/// Adds modules to a composer.
///
/// # Errors
/// If one is invalid WGSL, or imports an unknown module.
pub fn add<'m>(
    composer: &mut Composer,
    modules: impl IntoIterator<Item = &'m Module>,
) -> Result<(), Box<ComposerError>> {
    for module in modules {
        composer
            .add_composable_module(ComposableModuleDescriptor {
                source: &module.wgsl(),
                file_path: module.name,
                language: ShaderLanguage::Wgsl,
                ..Default::default()
            })
            .map_err(Box::new)?;
    }
    Ok(())
}
