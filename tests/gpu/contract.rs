//! What Rust knows of kernels, structs and constants is what the WGSL says. Needs no GPU.

use crate::gpu::Plain;
use bevy_faceoff::gpu::buffers::{Buffers, Capacity};
use bevy_faceoff::gpu::kernel::{Access, Binding, Kernel, bindings, own_name, type_name};
use bevy_faceoff::gpu::layout::{self, Struct};
use bevy_faceoff::gpu::program::{CONSTANTS, Call, Calls, Groups};
use bevy_faceoff::gpu::scan;
use bevy_faceoff::gpu::shader::{self, Shaders, Value};
use bevy_faceoff::manifolds::gpu::{ContactBuffers, ContactCapacity, ContactScratch};
use bevy_faceoff::plugin::Poses;
use bevy_faceoff::solver::gpu::{self as solver, SolverBuffers};
use bevy_faceoff::step::gpu::buffers::{StepBuffers, StepCapacity};
use bevy_faceoff::step::gpu::record::{ALL_SHADERS, Recorder, all_kernels, all_modules};
use bevy_faceoff::step::order::SubstepPosition;
use bevy_faceoff::types::settings::Response;
use bevy_faceoff::types::stage::Stage;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};
use wgpu::naga::valid::{Capabilities, ValidationFlags, Validator};
use wgpu::naga::{self, AddressSpace, Expression, Literal, ShaderStage, TypeInner, front};

pub const TESTS: &[Plain] = &[
    ("every_kernel_runs_on_any_device", every_kernel_runs_on_any_device),
    ("names_of_kernels_are_their_own", names_of_kernels_are_their_own),
    (
        "shaders_import_from_stages_before_theirs",
        shaders_import_from_stages_before_theirs,
    ),
    (
        "every_struct_is_laid_out_as_in_wgsl",
        every_struct_is_laid_out_as_in_wgsl,
    ),
    (
        "drawn_poses_are_elements_of_the_buffers",
        drawn_poses_are_elements_of_the_buffers,
    ),
    (
        "elements_of_buffers_have_no_gaps_between_them",
        elements_of_buffers_have_no_gaps_between_them,
    ),
    ("every_call_finds_its_buffers", every_call_finds_its_buffers),
    ("every_kernel_is_called", every_kernel_is_called),
    ("names_of_buffers_are_their_own", names_of_buffers_are_their_own),
    ("a_wrong_call_is_reported", a_wrong_call_is_reported),
    ("a_wrong_kernel_is_reported", a_wrong_kernel_is_reported),
    ("shared_constants_arrive_to_the_bit", shared_constants_arrive_to_the_bit),
    (
        "no_constant_stands_in_both_languages",
        no_constant_stands_in_both_languages,
    ),
];

/// Storage buffers that every device lets a kernel have.
const MAX_STORAGE: usize = 8;

/// Bytes of workgroup memory that every device has.
const MAX_WORKGROUP: u32 = 16 << 10;

/// Threads of a workgroup that every device has.
const MAX_THREADS: u32 = 256;

/// Every struct that passes between host and kernels.
fn structs() -> impl Iterator<Item = &'static Struct> {
    layout::STRUCTS.iter().chain(solver::layout::STRUCTS)
}

pub fn compose(kernel: &Kernel) -> Result<naga::Module, String> {
    let mut composer = shader::composer(all_modules()).map_err(|error| error.to_string())?;
    kernel
        .compose(&mut composer)
        .map_err(|error| error.emit_to_string(&composer))
}

/// Everything for which a device may refuse a kernel, or would read or write something else than the host.
fn complaints(kernel: &Kernel) -> Vec<String> {
    let module = match compose(kernel) {
        Ok(module) => module,
        Err(error) => return vec![error],
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
    if !matches!(entries[..], [("main", ShaderStage::Compute, [1..=MAX_THREADS, 1, 1])]) {
        wrong.push(format!("entry points are {entries:?}"));
    }
    let bindings = bindings(&module);
    if bindings.iter().any(|binding| binding.group != 0) {
        wrong.push("binds another group than 0".to_owned());
    }
    let storage = bindings.iter().filter(|b| b.access != Access::Uniform).count();
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

fn structs_of(module: &naga::Module) -> impl Iterator<Item = (&str, Layout)> {
    module.types.iter().filter_map(|(_, ty)| match &ty.inner {
        TypeInner::Struct { members, span } => {
            let fields = members
                .iter()
                .map(|m| (own_name(&m.name).to_owned(), m.offset as usize));
            Some((own_name(&ty.name), (*span as usize, fields.collect())))
        }
        _ => None,
    })
}

fn every_kernel_runs_on_any_device() {
    let wrong: Vec<String> = all_kernels()
        .flat_map(|kernel| {
            let wrong = complaints(kernel).into_iter();
            wrong.map(|what| format!("{}: {what}", kernel.name))
        })
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

fn names_of_kernels_are_their_own() {
    // Compiled kernels are found by name.
    let mut names = HashSet::new();
    for kernel in all_kernels() {
        assert!(names.insert(kernel.name), "{} twice", kernel.name);
    }
    assert!(names.len() >= 50);
}

fn shaders_import_from_stages_before_theirs() {
    let mut composer = shader::composer([]).unwrap();
    for Shaders { modules, kernels } in ALL_SHADERS {
        if let Err(error) = shader::add(&mut composer, *modules) {
            panic!("{}", error.emit_to_string(&composer));
        }
        for kernel in *kernels {
            if let Err(error) = kernel.compose(&mut composer) {
                panic!("{}: {}", kernel.name, error.emit_to_string(&composer));
            }
        }
    }
}

fn every_struct_is_laid_out_as_in_wgsl() {
    let mut seen = BTreeSet::new();
    for kernel in all_kernels() {
        let module = compose(kernel).unwrap();
        for (name, found) in structs_of(&module) {
            if let Some(expected) = structs().find(|s| s.name == name) {
                assert_eq!(found, laid_out(expected), "{name} in {}", kernel.name);
                seen.insert(expected.name);
            }
        }
        // A struct in a buffer that the host knows nothing of could not be compared.
        for Binding { element, .. } in bindings(&module) {
            let known = ["u32", "vec2<u32>", "vec4<u32>"].contains(&element.as_str());
            assert!(
                known || structs().any(|s| s.name == element),
                "{element} in {}",
                kernel.name
            );
        }
    }
    let all: BTreeSet<&str> = structs().map(|s| s.name).collect();
    assert_eq!(seen, all, "structs that no kernel uses");
}

fn drawn_poses_are_elements_of_the_buffers() {
    let module = front::wgsl::parse_str(Poses::WGSL).unwrap();
    let drawn: HashMap<&str, Layout> = structs_of(&module).collect();
    for (name, element) in [("FaceoffBefore", "Body"), ("FaceoffAfter", "Moved")] {
        let (size, fields) = &drawn[name];
        let element = structs().find(|s| s.name == element).unwrap();
        assert_eq!(*size, element.size, "{name}");
        // All but the last, which stands for the fields that are not drawn.
        let named = fields.split_last().unwrap().1.iter();
        for (field, offset) in named {
            let wanted = element.fields.iter().find(|(name, _)| name == field);
            assert_eq!(wanted.map(|&(_, offset)| offset), Some(*offset), "{name}.{field}");
        }
    }
}

fn elements_of_buffers_have_no_gaps_between_them() {
    // Rust's arrays have none; WGSL's are padded to the alignment of the element.
    for kernel in all_kernels() {
        let module = compose(kernel).unwrap();
        for (_, variable) in module.global_variables.iter().filter(|(_, v)| v.binding.is_some()) {
            if let TypeInner::Array { base, stride, .. } = module.types[variable.ty].inner {
                let size = module.types[base].inner.size(module.to_ctx());
                assert_eq!(stride, size, "{} in {}", type_name(&module, base), kernel.name);
            }
        }
    }
}

/// A set's buffers: names, and what their elements are called in WGSL.
type Elements = &'static [(&'static str, &'static str)];

const IMPULSE_SETS: [Elements; 1] = [Buffers::ELEMENTS];
const CONTACT_SETS: [Elements; 5] = [
    Buffers::ELEMENTS,
    ContactBuffers::ELEMENTS,
    ContactScratch::ELEMENTS,
    SolverBuffers::ELEMENTS,
    StepBuffers::ELEMENTS,
];

/// Every call of every program of a step, with lists of some length, with the buffers that the program has.
fn all_calls() -> Vec<(Call, &'static [Elements])> {
    let mut all: Vec<(Call, &'static [Elements])> = Vec::new();
    let mut add = |calls: Calls, sets: &'static [Elements]| all.extend(calls.iter().map(|call| (call.clone(), sets)));
    // Sorts end in either of their buffers, by the number of bits.
    for bodies in [100, 1000, 100_000] {
        let capacity = Capacity {
            bodies,
            planes: 4,
            pairs: 4 * bodies,
            ..Capacity::default()
        };
        let contact_capacity = StepCapacity {
            contacts: ContactCapacity {
                pairs: bodies,
                points: 4 * bodies,
                ..ContactCapacity::default()
            },
            bodies,
            touches: bodies,
            solves: true,
            has_fast_bodies: false,
        };
        let recorder = |response, may_sleep| Recorder {
            response,
            capacity: &capacity,
            contact_capacity: (response != Response::Impulse).then_some(&contact_capacity),
            may_sleep,
            is_begun: false,
        };
        let alone = SubstepPosition::of(0, 1);
        add(
            recorder(Response::Impulse, false).calls(&Stage::ALL, alone),
            &IMPULSE_SETS,
        );
        add(recorder(Response::None, false).calls(&Stage::ALL, alone), &CONTACT_SETS);
        add(recorder(Response::Contacts, true).reach(), &CONTACT_SETS);
        for may_sleep in [true, false] {
            for position in [
                alone,
                SubstepPosition::of(0, 3),
                SubstepPosition::of(1, 3),
                SubstepPosition::of(2, 3),
            ] {
                let calls = recorder(Response::Contacts, may_sleep).calls(&Stage::ALL, position);
                add(calls, &CONTACT_SETS);
            }
        }
    }
    all
}

/// What is wrong with a call of a kernel that binds this, by the names and elements of these sets.
fn wrong_of_call(call: &Call, bindings: &[Binding], sets: &[Elements]) -> Vec<String> {
    let mut wrong = Vec::new();
    let element_of = |name: &str| {
        let found = sets.iter().find_map(|set| set.iter().find(|(own, _)| *own == name));
        found.map(|(_, element)| *element)
    };
    let mut seen: HashMap<&str, Access> = HashMap::new();
    let mut arguments = None;
    if let Groups::Indirect(buffer, _) = call.groups {
        arguments = Some(buffer);
        if element_of(buffer) != Some("u32") {
            wrong.push(format!("there are no arguments {buffer}"));
        }
    }
    for binding in bindings.iter().filter(|binding| binding.name != CONSTANTS) {
        let (name, words) = call.buffer_of(&binding.name);
        match element_of(name) {
            None => wrong.push(format!("there is no buffer {name}")),
            Some(element) if !words && element != binding.element => {
                wrong.push(format!("{name} holds {element} and not {}", binding.element));
            }
            Some(_) => {}
        }
        let other = seen.insert(name, binding.access);
        let writes = |access| access == Some(Access::Write);
        if other.is_some() && (writes(other) || writes(Some(binding.access))) {
            wrong.push(format!("{name} is written under another name"));
        }
        if arguments == Some(name) && binding.access == Access::Write {
            wrong.push(format!("{name} is written by what it dispatches"));
        }
    }
    if bindings.iter().any(|binding| binding.name == CONSTANTS) != call.has_constants() {
        wrong.push("has constants that nobody reads, or none that somebody reads".to_owned());
    }
    for variable in call.rebound() {
        if !bindings.iter().any(|binding| binding.name == variable) {
            wrong.push(format!("there is no variable {variable}"));
        }
    }
    wrong
}

fn every_call_finds_its_buffers() {
    let mut bound: HashMap<&str, Vec<Binding>> = HashMap::new();
    let mut all = BTreeSet::new();
    for (call, sets) in all_calls() {
        let kernel = call.kernel;
        let bindings = bound
            .entry(kernel.name)
            .or_insert_with(|| bindings(&compose(kernel).unwrap()));
        let wrong = wrong_of_call(&call, bindings, sets).into_iter();
        all.extend(wrong.map(|what| format!("{}: {what}", kernel.name)));
    }
    assert!(all.is_empty(), "{all:#?}");
}

fn every_kernel_is_called() {
    let called: BTreeSet<&str> = all_calls().iter().map(|(call, _)| call.kernel.name).collect();
    let declared: BTreeSet<&str> = all_kernels().map(|kernel| kernel.name).collect();
    assert_eq!(called, declared);
}

fn names_of_buffers_are_their_own() {
    // So it does not matter in which of a program's sets a name is looked up first.
    let mut names = HashSet::new();
    for (name, _) in CONTACT_SETS.into_iter().flatten() {
        assert!(names.insert(name), "{name} twice");
        assert_ne!(*name, CONSTANTS);
    }
}

fn a_wrong_call_is_reported() {
    let bindings = bindings(&compose(&scan::APPLY).unwrap());
    const SETS: [Elements; 1] = [&[
        ("counters", "u32"),
        ("sums", "u32"),
        ("values", "u32"),
        ("bodies", "Body"),
    ]];
    let said = |change: fn(&mut Call) -> &mut Call, what: &str| {
        let mut calls = Calls::new(Stage::BroadPhase);
        change(calls.call(&scan::APPLY, Groups::Exactly(1)).constants([0; 4]));
        let call = calls.iter().next().unwrap();
        assert_eq!(wrong_of_call(call, &bindings, &SETS).join(", "), what);
    };
    said(|call| call, "");
    said(|call| call.bind("values", "elsewhere"), "there is no buffer elsewhere");
    said(|call| call.bind("values", "bodies"), "bodies holds Body and not u32");
    said(|call| call.bind_words("values", "bodies"), "");
    said(|call| call.bind("values", "sums"), "sums is written under another name");
    said(|call| call.bind("value", "sums"), "there is no variable value");
    let mut calls = Calls::new(Stage::BroadPhase);
    calls.call(&scan::APPLY, Groups::Indirect("values", 0));
    let call = calls.iter().next().unwrap();
    assert_eq!(
        wrong_of_call(call, &bindings, &SETS).join(", "),
        "values is written by what it dispatches, has constants that nobody reads, or none that somebody reads"
    );
}

fn a_wrong_kernel_is_reported() {
    let said = |source, what: &str| {
        let wrong = complaints(&Kernel {
            name: "wrong",
            source,
            define: None,
        });
        assert!(wrong.iter().any(|text| text.contains(what)), "{what}: {wrong:?}");
    };
    said("@compute @workgroup_size(1) fn main() { let x: u32 = 1.5; }", "error");
    said("@compute @workgroup_size(1) fn other() {}", "entry points");
    said("@compute @workgroup_size(8, 8) fn main() {}", "entry points");
    said("@compute @workgroup_size(512) fn main() {}", "entry points");
    said(
        "var<workgroup> large: array<vec4<f32>, 1025>;
         @compute @workgroup_size(1) fn main() { large[0] = vec4(1.0); }",
        "16400 bytes of workgroup memory",
    );
    said(
        "@group(1) @binding(0) var<storage, read_write> list: array<u32>;
         @compute @workgroup_size(1) fn main() { list[0] = 1u; }",
        "binds another group than 0",
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
    let nine: String = (0..9)
        .map(|slot| format!("@group(0) @binding({slot}) var<storage, read_write> list_{slot}: array<u32>;"))
        .collect();
    let nine = format!("{nine} @compute @workgroup_size(1) fn main() {{ list_0[0] = 1u; }}");
    said(nine.leak(), "9 storage buffers");
}

fn shared_constants_arrive_to_the_bit() {
    let mut count = 0;
    for module in all_modules() {
        // What is not constant may use imports: only the lines of constants are read.
        let wgsl = module.wgsl();
        let lines: Vec<&str> = wgsl.lines().filter(|line| line.starts_with("const ")).collect();
        let parsed = front::wgsl::parse_str(&lines.join("\n")).expect("constants alone are valid");
        let literal = |handle| match parsed.global_expressions[handle] {
            Expression::Literal(Literal::U32(value)) => value,
            Expression::Literal(Literal::I32(value)) => value as u32,
            Expression::Literal(Literal::F32(value)) => value.to_bits(),
            ref other => panic!("{other:?} in {}", module.name),
        };
        let found: BTreeMap<&str, Vec<u32>> = (parsed.constants.iter())
            .map(|(_, constant)| {
                let bits = match &parsed.global_expressions[constant.init] {
                    Expression::Compose { components, .. } => components.iter().map(|&c| literal(c)).collect(),
                    _ => vec![literal(constant.init)],
                };
                (constant.name.as_deref().unwrap_or_default(), bits)
            })
            .collect();
        for (name, value) in module.constants {
            let bits = |all: &[f64]| all.iter().map(|&x| (x as f32).to_bits()).collect::<Vec<_>>();
            let expected = match value {
                Value::U32(value) => vec![*value],
                Value::F32(value) => bits(&[*value]),
                Value::Vec2(all) => bits(all),
                Value::Vec3(all) => bits(all),
            };
            assert_eq!(found.get(name), Some(&expected), "{name} in {}", module.name);
            count += 1;
        }
    }
    assert!(count >= 100, "{count}");
}

/// Files below a folder with an ending, and what they hold without comments.
fn sources(folder: &str, ending: &str) -> Vec<(PathBuf, String)> {
    fn walk(folder: &Path, ending: &str, found: &mut Vec<(PathBuf, String)>) {
        for entry in fs::read_dir(folder).unwrap().flatten() {
            let path = entry.path();
            if path.is_dir() {
                walk(&path, ending, found);
            } else if path.extension().is_some_and(|own| own == ending) {
                let text = fs::read_to_string(&path).unwrap();
                let code = |line: &str| line.split("//").next().unwrap_or_default().to_owned() + "\n";
                found.push((path, text.lines().map(code).collect()));
            }
        }
    }
    let mut found = Vec::new();
    walk(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder), ending, &mut found);
    assert!(!found.is_empty());
    found
}

/// The names after the word `const`.
fn constants_of(code: &str) -> impl Iterator<Item = &str> {
    code.split("const ").skip(1).filter_map(|rest| {
        let (name, value) = rest.split_once(':')?;
        // Shaders have no strings.
        if value.starts_with(" &str") {
            return None;
        }
        let is_name = |c: char| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_';
        (!name.is_empty() && name.chars().all(is_name)).then_some(name)
    })
}

/// Numbers with a decimal point in WGSL.
fn decimals_of(code: &str) -> impl Iterator<Item = f64> {
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '.' || c == '_';
    let words = code.split(move |c| !is_part(c)).filter(|word| word.contains('.'));
    words.filter_map(|word| word.parse().ok())
}

fn no_constant_stands_in_both_languages() {
    let rust = sources("src", "rs");
    let in_rust: HashMap<&str, &PathBuf> = (rust.iter())
        .flat_map(|(path, code)| constants_of(code).map(move |name| (name, path)))
        .collect();
    // A half, powers of ten and the like say nothing.
    let is_unusual = |x: f64| {
        let text = format!("{:e}", x as f32);
        let digits = text.split('e').next().unwrap_or_default();
        !["0", "1", "2", "2.5", "4", "5", "8"].contains(&digits)
    };
    let shared: Vec<(&str, f64)> = all_modules()
        .flat_map(|module| module.constants)
        .flat_map(|(name, value)| {
            let values = match value {
                Value::U32(_) => vec![],
                Value::F32(value) => vec![*value],
                Value::Vec2(all) => all.to_vec(),
                Value::Vec3(all) => all.to_vec(),
            };
            values.into_iter().map(move |value| (*name, value))
        })
        .filter(|(_, value)| is_unusual(*value))
        .collect();
    let mut twice = Vec::new();
    for (path, code) in sources("shaders", "wgsl") {
        let path = path.display();
        for name in constants_of(&code) {
            if let Some(other) = in_rust.get(name) {
                twice.push(format!("{name} stands in {path} and in {}", other.display()));
            }
        }
        for x in decimals_of(&code) {
            if let Some((name, _)) = shared.iter().find(|(_, value)| *value as f32 == x as f32) {
                twice.push(format!("{x} in {path} has the value of {name}"));
            }
        }
    }
    assert!(twice.is_empty(), "{twice:#?}");
}
