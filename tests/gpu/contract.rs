//! What Rust declares of every kernel, struct and constant is what the WGSL says. Needs no graphics card.

use crate::gpu::Plain;
use bevy_faceoff::gpu::kernel::{Access, Binding, Kernel, MAX_ROW, MODULES, composer, read, uniform, write};
use bevy_faceoff::gpu::layout::{self, Struct};
use bevy_faceoff::gpu::{mesh_features, radix_sort, scan};
use bevy_faceoff::manifolds;
use bevy_faceoff::solver::gpu as solver;
use bevy_faceoff::step::gpu::kernels;
use std::collections::{BTreeMap, BTreeSet, HashSet};
use wgpu::naga::valid::{Capabilities, ValidationFlags, Validator};
use wgpu::naga::{
    AddressSpace, Expression, Handle, Literal, Module, ScalarKind, ShaderStage, StorageAccess, Type, TypeInner,
    VectorSize, front,
};

pub const TESTS: &[Plain] = &[
    (
        "every_kernel_is_what_it_is_declared_to_be",
        every_kernel_is_what_it_is_declared_to_be,
    ),
    ("names_of_kernels_are_their_own", names_of_kernels_are_their_own),
    (
        "every_struct_is_laid_out_as_in_wgsl",
        every_struct_is_laid_out_as_in_wgsl,
    ),
    (
        "elements_of_buffers_have_no_gaps_between_them",
        elements_of_buffers_have_no_gaps_between_them,
    ),
    ("every_constant_is_the_same_in_wgsl", every_constant_is_the_same_in_wgsl),
    (
        "sizes_of_blocks_are_the_same_in_wgsl",
        sizes_of_blocks_are_the_same_in_wgsl,
    ),
    (
        "contact_generation_counts_as_in_wgsl",
        contact_generation_counts_as_in_wgsl,
    ),
    ("a_wrong_declaration_is_reported", a_wrong_declaration_is_reported),
    ("a_wrong_kernel_is_reported", a_wrong_kernel_is_reported),
];

/// Storage buffers that every device lets a kernel have.
const MAX_STORAGE: usize = 8;

/// Bytes of workgroup memory that every device has.
const MAX_WORKGROUP: u32 = 16 << 10;

/// Every struct that passes between host and kernels.
fn structs() -> impl Iterator<Item = &'static Struct> {
    layout::STRUCTS.iter().chain(solver::layout::STRUCTS)
}

/// The name in the source of what naga_oil renamed when it was imported.
fn plain(name: &Option<String>) -> &str {
    let name = name.as_deref().unwrap_or_default();
    name.split_once("X_naga_oil_mod_X").map_or(name, |(plain, _)| plain)
}

/// A type as Rust declares it; an atomic counts as what it holds.
fn spelled(module: &Module, ty: Handle<Type>) -> String {
    let scalar = |scalar: wgpu::naga::Scalar| match (scalar.kind, scalar.width) {
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
        TypeInner::Struct { .. } => plain(&module.types[ty].name).to_owned(),
        other => format!("{other:?}"),
    }
}

/// What a kernel binds, as its WGSL says.
fn bound(module: &Module) -> Vec<(u32, String, String)> {
    let mut found = Vec::new();
    for (_, variable) in module.global_variables.iter() {
        let Some(binding) = &variable.binding else { continue };
        let access = match variable.space {
            AddressSpace::Uniform => "uniform",
            AddressSpace::Storage { access } if access == StorageAccess::LOAD => "read",
            AddressSpace::Storage { access } if access == StorageAccess::LOAD | StorageAccess::STORE => "write",
            _ => "some other space",
        };
        let element = match module.types[variable.ty].inner {
            TypeInner::Array { base, .. } if access != "uniform" => base,
            _ => variable.ty,
        };
        let name = plain(&variable.name);
        let text = format!("{access} {name}: {}", spelled(module, element));
        found.push((binding.binding, text, format!("group {}", binding.group)));
    }
    found.sort();
    found
}

/// The same, as Rust says.
fn declared(bindings: &[Binding]) -> Vec<(u32, String, String)> {
    let mut all: Vec<_> = bindings
        .iter()
        .map(|b| {
            let access = match b.access {
                Access::Uniform => "uniform",
                Access::Read => "read",
                Access::Write => "write",
            };
            let text = format!("{access} {}: {}", b.name, b.element);
            (b.slot, text, "group 0".to_owned())
        })
        .collect();
    all.sort();
    all
}

/// Everything that is wrong with a kernel's declaration.
fn complaints(kernel: &Kernel) -> Vec<String> {
    let mut composer = composer().expect("the imports are valid");
    let module = match kernel.compose(&mut composer) {
        Ok(module) => module,
        Err(error) => return vec![error.emit_to_string(&composer)],
    };
    let mut wrong = Vec::new();
    // No capabilities: the kernels ask for no feature of a device.
    let validated = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module);
    if let Err(error) = validated {
        wrong.push(format!("not valid: {error:?}"));
    }
    let entries: Vec<_> = (module.entry_points.iter())
        .map(|entry| (entry.name.as_str(), entry.stage, entry.workgroup_size))
        .collect();
    let wanted = [("main", ShaderStage::Compute, [kernel.workgroup, 1, 1])];
    if entries != wanted {
        wrong.push(format!("entry points are {entries:?}, declared {wanted:?}"));
    }
    let (in_source, in_rust) = (bound(&module), declared(kernel.bindings));
    if in_source != in_rust {
        wrong.push(format!("binds {in_source:?}, declared {in_rust:?}"));
    }
    let storage = kernel.bindings.iter().filter(|b| b.access != Access::Uniform).count();
    if storage > MAX_STORAGE {
        wrong.push(format!("{storage} storage buffers"));
    }
    let shared: u32 = (module.global_variables.iter())
        .filter(|(_, variable)| variable.space == AddressSpace::WorkGroup)
        .map(|(_, variable)| module.types[variable.ty].inner.size(module.to_ctx()))
        .sum();
    if shared > MAX_WORKGROUP {
        wrong.push(format!("{shared} bytes of workgroup memory"));
    }
    wrong.extend(structs_of(&module).filter_map(|(name, found)| {
        let expected = structs().find(|s| s.name == name)?;
        (found != laid_out(expected)).then(|| format!("{name} is {found:?}"))
    }));
    wrong
}

/// Size, and offset by member.
type Layout = (usize, Vec<(String, usize)>);

fn laid_out(expected: &Struct) -> Layout {
    let fields = expected.fields.iter().map(|&(name, offset)| (name.to_owned(), offset));
    (expected.size, fields.collect())
}

fn structs_of(module: &Module) -> impl Iterator<Item = (&str, Layout)> {
    module.types.iter().filter_map(|(_, ty)| match &ty.inner {
        TypeInner::Struct { members, span } => {
            let fields = members.iter().map(|m| (plain(&m.name).to_owned(), m.offset as usize));
            Some((plain(&ty.name), (*span as usize, fields.collect())))
        }
        _ => None,
    })
}

/// The constants of one of the imported files.
fn constants(file: &str) -> BTreeMap<String, u32> {
    let (_, source) = MODULES.iter().find(|(name, _)| *name == file).expect("it is imported");
    // What is not constant may use imports: only the lines of constants are read.
    let lines: Vec<&str> = source.lines().filter(|line| line.starts_with("const ")).collect();
    let module = front::wgsl::parse_str(&lines.join("\n")).expect("constants alone are valid");
    let value = |init| match module.global_expressions[init] {
        Expression::Literal(Literal::U32(value)) => Some(value),
        _ => None,
    };
    (module.constants.iter())
        .filter_map(|(_, constant)| Some((constant.name.clone()?, value(constant.init)?)))
        .collect()
}

fn every_kernel_is_what_it_is_declared_to_be() {
    let all: Vec<String> = kernels()
        .flat_map(|kernel| {
            complaints(kernel)
                .into_iter()
                .map(|what| format!("{}: {what}", kernel.name))
        })
        .collect();
    assert!(all.is_empty(), "{}", all.join("\n"));
    assert!(kernels().count() >= 18);
}

fn names_of_kernels_are_their_own() {
    // Compiled kernels are found by name.
    let mut names = HashSet::new();
    for kernel in kernels() {
        assert!(names.insert(kernel.name), "{} twice", kernel.name);
    }
}

fn every_struct_is_laid_out_as_in_wgsl() {
    let mut seen = BTreeSet::new();
    let mut composer = composer().unwrap();
    for kernel in kernels() {
        let module = kernel
            .compose(&mut composer)
            .map_err(|e| e.emit_to_string(&composer))
            .unwrap();
        for (name, found) in structs_of(&module) {
            if let Some(expected) = structs().find(|s| s.name == name) {
                assert_eq!(found, laid_out(expected), "{name} in {}", kernel.name);
                seen.insert(expected.name);
            }
        }
        // A struct in a buffer that the host knows nothing of could not be compared.
        for binding in kernel.bindings {
            let known = ["u32", "vec2<u32>", "vec4<u32>"].contains(&binding.element);
            assert!(
                known || structs().any(|s| s.name == binding.element),
                "{} in {}",
                binding.element,
                kernel.name
            );
        }
    }
    let all: BTreeSet<&str> = structs().map(|s| s.name).collect();
    assert_eq!(seen, all, "structs that no kernel uses");
}

fn elements_of_buffers_have_no_gaps_between_them() {
    // Rust's arrays have none; WGSL's are padded to the alignment of the element.
    let mut composer = composer().unwrap();
    for kernel in kernels() {
        let module = kernel
            .compose(&mut composer)
            .map_err(|e| e.emit_to_string(&composer))
            .unwrap();
        for (_, variable) in module.global_variables.iter().filter(|(_, v)| v.binding.is_some()) {
            if let TypeInner::Array { base, stride, .. } = module.types[variable.ty].inner {
                let size = module.types[base].inner.size(module.to_ctx());
                assert_eq!(stride, size, "{} in {}", spelled(&module, base), kernel.name);
            }
        }
    }
}

fn every_constant_is_the_same_in_wgsl() {
    let files = [
        ("types.wgsl", layout::CONSTANTS),
        ("solver_types.wgsl", solver::layout::CONSTANTS),
    ];
    for (file, in_rust) in files {
        let in_source = constants(file);
        for &(name, value) in in_rust {
            assert_eq!(in_source.get(name), Some(&value), "{name} in {file}");
        }
    }
}

fn sizes_of_blocks_are_the_same_in_wgsl() {
    let scan_file = constants("scan.wgsl");
    assert_eq!(scan_file["BLOCK"], scan::BLOCK);
    assert_eq!(scan_file["SORT_BLOCK"], radix_sort::BLOCK);
    assert_eq!(constants("dispatch.wgsl")["MAX_ROW"], MAX_ROW);
}

fn contact_generation_counts_as_in_wgsl() {
    let types = constants("types.wgsl");
    assert_eq!(types["MOST_POINTS"] as usize, manifolds::MAX_POINTS);
    assert_eq!(types["MAX_PLANE_POINTS"] as usize, manifolds::cpu::planes::MAX_POINTS);
    assert_eq!(types["NOTHING"], manifolds::cpu::planes::NO_FACE);
    let sides = constants("sides.wgsl");
    assert_eq!(sides["HEADER"] as usize, mesh_features::HEADER);
    assert_eq!(sides["RECORD"] as usize, mesh_features::RECORD);
}

/// Wrong declarations of a right kernel, and what must be said of them.
fn a_wrong_declaration_is_reported() {
    let right = Kernel { ..scan::SUMS };
    assert_eq!(complaints(&right), [""; 0]);
    const CONSTANTS: Binding = uniform(0, "constants", "vec4<u32>");
    const COUNTERS: Binding = read(1, "counters", "u32");
    const VALUES: Binding = read(2, "values", "u32");
    const SUMS: Binding = write(3, "sums", "u32");
    const WRONG: [(&str, &[Binding]); 6] = [
        ("a slot", &[CONSTANTS, COUNTERS, VALUES, write(4, "sums", "u32")]),
        ("a name", &[CONSTANTS, COUNTERS, read(2, "value", "u32"), SUMS]),
        ("access", &[CONSTANTS, COUNTERS, VALUES, read(3, "sums", "u32")]),
        ("a type", &[CONSTANTS, read(1, "counters", "i32"), VALUES, SUMS]),
        ("one too few", &[CONSTANTS, COUNTERS, VALUES]),
        (
            "one too many",
            &[CONSTANTS, COUNTERS, VALUES, SUMS, read(4, "more", "u32")],
        ),
    ];
    for (what, bindings) in WRONG {
        let wrong = complaints(&Kernel { bindings, ..right });
        assert!(wrong.len() == 1 && wrong[0].starts_with("binds "), "{what}: {wrong:?}");
    }
    let wrong = complaints(&Kernel {
        workgroup: 128,
        ..right
    });
    assert!(wrong.len() == 1 && wrong[0].starts_with("entry points"), "{wrong:?}");
}

fn a_wrong_kernel_is_reported() {
    let kernel = |source| Kernel {
        name: "wrong",
        source,
        emit: false,
        workgroup: 1,
        bindings: &[],
    };
    let said = |source, what: &str| {
        let wrong = complaints(&kernel(source));
        assert!(wrong.iter().any(|text| text.contains(what)), "{what}: {wrong:?}");
    };
    said("@compute @workgroup_size(1) fn main() { let x: u32 = 1.5; }", "error");
    said("@compute @workgroup_size(1) fn other() {}", "entry points");
    said(
        "var<workgroup> large: array<vec4<f32>, 1025>;
         @compute @workgroup_size(1) fn main() { large[0] = vec4(1.0); }",
        "16400 bytes of workgroup memory",
    );
    // Two fields of `Plane` in the other order.
    said(
        "struct Plane {
            distance: f32, normal: vec3<f32>,
            restitution: f32, padding_a: f32, padding_b: f32, padding_c: f32,
         }
         var<private> p: Plane;
         @compute @workgroup_size(1) fn main() { p.distance = 1.0; }",
        "Plane is (",
    );
    const NINE: &[Binding] = &[
        write(0, "a", "u32"),
        write(1, "b", "u32"),
        write(2, "c", "u32"),
        write(3, "d", "u32"),
        write(4, "e", "u32"),
        write(5, "f", "u32"),
        write(6, "g", "u32"),
        write(7, "h", "u32"),
        write(8, "i", "u32"),
    ];
    let wrong = complaints(&Kernel {
        bindings: NINE,
        ..kernel("@compute @workgroup_size(1) fn main() {}")
    });
    assert!(wrong.contains(&"9 storage buffers".to_owned()), "{wrong:?}");
}
