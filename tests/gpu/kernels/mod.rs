//! What graphics APIs other than the one at hand ask of kernels. Needs no GPU.

#[cfg(feature = "cli")]
mod languages;
mod uniformity;

use crate::contract::compose;
use crate::gpu::Plain;
use bevy_faceoff::gpu::buffers::Capacity;
use bevy_faceoff::gpu::kernel::Kernel;
use bevy_faceoff::manifolds::gpu::ContactCapacity;
use bevy_faceoff::step::gpu::buffers::StepCapacity;
use bevy_faceoff::step::gpu::record::{Recorder, all_kernels, impulse_calls, impulse_kernels, report_kernels};
use bevy_faceoff::step::order::SubstepPosition;
use bevy_faceoff::types::settings::Response;
use bevy_faceoff::types::stage::Stage;
use std::collections::BTreeSet;
use wgpu::naga::front::wgsl;

pub const TESTS: &[Plain] = &[
    (
        "all_threads_of_a_workgroup_reach_its_barriers",
        all_threads_of_a_workgroup_reach_its_barriers,
    ),
    #[cfg(feature = "cli")]
    (
        "every_kernel_is_written_in_hlsl",
        languages::every_kernel_is_written_in_hlsl,
    ),
    #[cfg(feature = "cli")]
    (
        "every_kernel_is_written_in_msl",
        languages::every_kernel_is_written_in_msl,
    ),
    #[cfg(feature = "cli")]
    (
        "every_kernel_is_written_in_spir_v",
        languages::every_kernel_is_written_in_spir_v,
    ),
    (
        "only_what_a_response_calls_is_compiled",
        only_what_a_response_calls_is_compiled,
    ),
    (
        "barriers_that_some_threads_miss_are_found",
        barriers_that_some_threads_miss_are_found,
    ),
    (
        "barriers_that_all_threads_reach_are_not",
        barriers_that_all_threads_reach_are_not,
    ),
];

fn only_what_a_response_calls_is_compiled() {
    let names = |kernels: &mut dyn Iterator<Item = &'static Kernel>| -> BTreeSet<&str> {
        kernels.map(|kernel| kernel.name).collect()
    };
    let impulse = names(&mut impulse_kernels());
    let report = names(&mut report_kernels());
    let all = names(&mut all_kernels());
    assert!(impulse.len() < report.len() && report.len() < all.len());
    assert!(!report.iter().any(|name| name.starts_with("solver/")), "{report:?}");
    for length in [1, 100, 4096, 4097, 20_000, 1 << 20] {
        let capacity = Capacity {
            bodies: length,
            planes: 4,
            pairs: 4 * length,
            ..Capacity::default()
        };
        let contact_capacity = StepCapacity {
            contacts: ContactCapacity {
                pairs: length,
                points: 4 * length,
                ..ContactCapacity::default()
            },
            bodies: length,
            touches: 0,
            solves: false,
            has_fast_bodies: false,
        };
        let recorder = Recorder {
            response: Response::None,
            capacity: &capacity,
            contact_capacity: Some(&contact_capacity),
            may_sleep: false,
            is_begun: false,
        };
        let called = names(
            &mut recorder
                .calls(&Stage::ALL, SubstepPosition::of(0, 1))
                .iter()
                .map(|call| call.kernel),
        );
        assert!(called.is_subset(&report), "{length}: {called:?}");
        let called = names(&mut impulse_calls(&capacity).iter().map(|call| call.kernel));
        assert!(called.is_subset(&impulse), "{length}: {called:?}");
    }
}

fn all_threads_of_a_workgroup_reach_its_barriers() {
    let wrong: Vec<String> = all_kernels()
        .flat_map(|kernel| {
            let found = uniformity::complaints(&compose(kernel).unwrap()).into_iter();
            found.map(|what| format!("{}: {what}", kernel.name))
        })
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// What the analysis says of a kernel with this body.
fn said(body: &str) -> BTreeSet<String> {
    let source = format!(
        "@group(0) @binding(0) var<storage, read_write> list: array<u32>;
         @group(0) @binding(2) var<storage, read> input: array<u32>;
         @group(0) @binding(1) var<uniform> constants: vec4<u32>;
         var<workgroup> shared_count: u32;
         var<private> mine: u32;
         fn some_wait(thread: u32) {{ if thread > 3u {{ workgroupBarrier(); }} }}
         fn all_wait() {{ workgroupBarrier(); }}
         fn put(p: ptr<function, u32>, x: u32) {{ *p = x; }}
         fn early(x: u32) -> u32 {{ if x == 1u {{ return 1u; }} return 2u; }}
         @compute @workgroup_size(64)
         fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {{ {body} }}"
    );
    uniformity::complaints(
        &wgsl::parse_str(&source).unwrap_or_else(|error| panic!("{}", error.emit_to_string(&source))),
    )
}

fn barriers_that_some_threads_miss_are_found() {
    let bad = [
        "if thread == 0u { workgroupBarrier(); }",
        "if list[0] == 1u { workgroupBarrier(); }",
        "if input[thread] == 1u { workgroupBarrier(); }",
        "if shared_count == 1u { workgroupBarrier(); }",
        "if thread == 0u { return; } workgroupBarrier();",
        "if thread < 8u { if group.x == 0u { return; } } workgroupBarrier();",
        "loop { if list[thread] == 0u { break; } workgroupBarrier(); }",
        "loop { workgroupBarrier(); if list[thread] == 0u { break; } }",
        "loop { workgroupBarrier(); if list[thread] == 0u { continue; } if constants.x == 0u { break; } }",
        "for (var i = 0u; i < list[0]; i++) { workgroupBarrier(); }",
        "var x = 0u; if thread == 0u { x = 1u; } if x == 1u { workgroupBarrier(); }",
        "var x = 0u; loop { x += 1u; if x > thread { break; } } if x == 1u { workgroupBarrier(); }",
        // What varies from the second round on.
        "var x = 0u; var y = 0u; for (var i = 0u; i < 3u; i++) { if x == 1u { workgroupBarrier(); } x = y; y = thread; }",
        "var x: u32; put(&x, thread); if x == 1u { workgroupBarrier(); }",
        "mine = thread; if mine == 1u { workgroupBarrier(); }",
        "var many: array<u32, 4>; many[thread] = 1u; if many[0] == 1u { workgroupBarrier(); }",
        "var many = array<u32, 4>(1, 2, 3, 4); if many[thread] == 1u { workgroupBarrier(); }",
        "some_wait(thread);",
        "if thread == 0u { all_wait(); }",
        "if early(thread) == 1u { workgroupBarrier(); }",
        "if thread == 0u { shared_count = workgroupUniformLoad(&shared_count); }",
        "switch thread { case 0u: { workgroupBarrier(); } default: {} }",
        "if group.x == 0u && thread == 0u { storageBarrier(); }",
    ];
    for body in bad {
        assert!(!said(body).is_empty(), "{body}");
    }
}

fn barriers_that_all_threads_reach_are_not() {
    let good = [
        "workgroupBarrier(); if thread == 0u { list[0] = 1u; } workgroupBarrier();",
        "if group.x == 7u || constants.y == 1u { return; } workgroupBarrier();",
        "if thread == 0u { shared_count = list[0]; } let n = workgroupUniformLoad(&shared_count);
         for (var i = 0u; i < n; i++) { workgroupBarrier(); }",
        "for (var i = 0u; i < arrayLength(&list); i += 64u) { if list[i + thread] == 0u { mine = 1u; } workgroupBarrier(); }",
        "loop { if thread < 8u { list[thread] = 0u; } workgroupBarrier(); if constants.x == 0u { break; } }",
        "var x = 0u; loop { x += 1u; if x > thread { break; } } workgroupBarrier();",
        "var x: u32; put(&x, group.x); if x == 1u { all_wait(); }",
        "var a: u32; var b: u32; put(&a, thread); put(&b, 1u); if b == 1u { all_wait(); }",
        "if early(group.x) == 1u { all_wait(); }",
        "some_wait(group.x);",
        "if input[group.x] == 1u { all_wait(); }",
        // Threads that return from a function meet again behind its call.
        "list[thread] = early(thread); workgroupBarrier();",
    ];
    for body in good {
        assert_eq!(said(body), BTreeSet::new(), "{body}");
    }
}
