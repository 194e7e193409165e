//! Lists that overflow: the step is done again with longer ones, or is an error that changes nothing.

use super::inputs::{agree, heap, strip};
use super::same_bits::{AMPLE, Bits, TINY, falling};
use super::scenes::{BALL, CUBE, Kit, TORUS, half_spaces};
use crate::oracle::rng::Rng;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::gpu::buffers::Capacity;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::state::{PairContact, Plane};
use bevy_faceoff::step::gpu::{GpuStep, StepError};
use bevy_faceoff::types::settings::Response;
use glam::Vec3;

/// A crowd that falls together, so that lists grow from step to step.
pub fn growing_lists_change_nothing(gpu: &Gpu) {
    let kit = Kit::new();
    let mut scene = falling(&kit, &[CUBE, BALL, TORUS], 80, 8.0);
    for body in &mut scene.bodies {
        body.linear_velocity = -10.0 * body.position;
    }
    let mut tiny = GpuStep::with_capacity(gpu.clone(), TINY).unwrap();
    let mut ample = GpuStep::with_capacity(gpu.clone(), AMPLE).unwrap();
    let mut growths = 0;
    for number in 0..8 {
        let before = tiny.capacity();
        let (one, other) = (scene.on_gpu(&mut tiny), scene.on_gpu(&mut ample));
        Bits::of(&one).require(&Bits::of(&other), &format!("step {number}"));
        growths += usize::from(tiny.capacity() != before);
        scene.take(&one);
    }
    assert!(growths >= 3, "lists grew {growths} times only");
    assert_eq!(ample.capacity(), AMPLE, "what is ample need not grow");
}

/// Lists that were long for one step become shorter after some hundred steps, and nothing changes but their length.
pub fn lists_become_shorter(gpu: &Gpu) {
    let mut step = GpuStep::new(gpu.clone()).unwrap();
    let crowd = heap(&shapes::torus_240(), 300, 4.0);
    crowd.on_gpu(&mut step);
    let (long, most) = (step.capacity(), step.bytes());
    let mut few = heap(&shapes::torus_240(), 3, 0.5);
    few.config.gravity = Vec3::ZERO;
    let mut state = few.state();
    let before = few.on_gpu(&mut step);
    for _ in 0..520 {
        few.fill(&mut state);
        step.run(&mut state).unwrap();
        assert_eq!(state.results.contacts.faces.len(), before.results.contacts.faces.len());
    }
    let short = step.capacity();
    assert!(
        short.hits < long.hits && short.pairs <= long.pairs,
        "{short:?}, {long:?}"
    );
    assert!(short.bodies < long.bodies, "{short:?}, {long:?}");
    assert!(step.bytes() < most);
    Bits::of(&few.on_gpu(&mut step)).require(&Bits::of(&before), "with shorter lists");
    let mut new = GpuStep::new(gpu.clone()).unwrap();
    Bits::of(&crowd.on_gpu(&mut step)).require(&Bits::of(&crowd.on_gpu(&mut new)), "the crowd again");
}

/// A small world reads little although its buffers are large. A crowd that comes all at once is read as a whole, by a
/// step that is repeated.
pub fn room_to_read_follows_use(gpu: &Gpu) {
    let mut step = GpuStep::with_capacity(gpu.clone(), AMPLE).unwrap();
    for response in [Response::Impulse, Response::Contacts] {
        let mut few = heap(&shapes::cube(1.0), 6, 2.0);
        few.config.response = response;
        few.config.gravity = Vec3::ZERO;
        let mut state = few.state();
        let mut read = Vec::new();
        for _ in 0..40 {
            step.forget();
            few.fill(&mut state);
            step.run(&mut state).unwrap();
            read.push(state.results.gpu.unwrap().read_back_bytes);
        }
        assert!(read[39] * 10 < read[0] && read[39] < 60_000, "{response:?}: {read:?}");
        let mut crowd = heap(&shapes::cube(1.0), 120, 6.0);
        crowd.config.response = response;
        step.forget();
        let (found, capacity) = (crowd.on_gpu(&mut step), step.capacity());
        let work = found.results.gpu.unwrap();
        assert!(work.submissions > 1, "{response:?}: {work:?}");
        assert_eq!(capacity.pairs, AMPLE.pairs, "there was room in the buffer");
        let mut new = GpuStep::with_capacity(gpu.clone(), AMPLE).unwrap();
        Bits::of(&found).require(&Bits::of(&crowd.on_gpu(&mut new)), &format!("{response:?}"));
        // The crowd fits when it comes again.
        step.forget();
        let again = crowd.on_gpu(&mut step).results.gpu.unwrap();
        assert_eq!(again.submissions, 1);
        assert!(again.read_back_bytes < work.read_back_bytes);
    }
}

/// Faces that nobody asked for need no room: the step is not repeated, and bodies move as if they were listed.
pub fn faces_that_are_only_counted_need_no_room(gpu: &Gpu) {
    let mut listed = heap(&shapes::torus_240(), 12, 1.2);
    let mut counted = listed.clone();
    counted.config.face_lists = false;
    for response in [Response::Impulse, Response::None] {
        let steps = [&mut listed, &mut counted].map(|scene| {
            scene.config.response = response;
            let capacity = Capacity { hits: 1, ..AMPLE };
            let mut step = GpuStep::with_capacity(gpu.clone(), capacity).unwrap();
            let state = scene.on_gpu(&mut step);
            (state, step.capacity().hits)
        });
        let [(with, room), (without, no_room)] = &steps;
        assert!(*room > 1 && *no_room == 1, "{room}, {no_room}");
        let (one, other) = (&with.results.contacts, &without.results.contacts);
        assert!(one.faces.len() > 1 && other.faces.is_empty());
        let key = |pair: &PairContact| (pair.bodies, pair.contained, pair.contact);
        assert!(one.pairs.iter().map(key).eq(other.pairs.iter().map(key)));
        for i in 0..with.input.bodies.len() {
            let motions = [with, without].map(|state| state.input.bodies.motion(i));
            assert_eq!(motions[0], motions[1], "{response:?}, body {i}");
        }
    }
}

/// Two meshes that touch in 100,000 places are a long loop. Mesa's llvmpipe leaves loops early; that must not go
/// unnoticed.
pub fn too_many_places_are_found_or_an_error(gpu: &Gpu) {
    let mut step = GpuStep::new(gpu.clone()).unwrap();
    let mut scene = heap(&strip(4096, f32::MAX), 2, 0.1);
    scene.bodies[1].scale = scene.bodies[0].scale;
    let mut state = scene.state();
    match step.run(&mut state) {
        Ok(()) => {
            let cpu = scene.on_cpu();
            let count = cpu.results.contacts.faces.len();
            assert!(count > 100_000, "{count}");
            assert!(state.results.contacts.faces.len().abs_diff(count) < count / 200);
        }
        Err(error) => {
            println!("\n{error}");
            assert_eq!(error, StepError::CutShort);
        }
    }
    // Nothing of it is left.
    agree(&heap(&strip(64, 60.0), 80, 4.0), &mut step, "64 triangles").require_no_failures();
}

/// A crowd with more intersecting faces than a device holds is refused with the need, and the next step is as ever. A
/// real device would take minutes to be filled, so this one may bind little memory only.
pub fn a_crowd_is_refused_and_leaves_no_trace(gpu: &Gpu) {
    let mut step = GpuStep::new(with_binding_size(gpu, 8 << 20)).unwrap();
    let crowd = heap(&shapes::torus_240(), 80, 0.1);
    let mut state = crowd.state();
    let positions = state.input.bodies.position.clone();
    let error = step.run(&mut state).unwrap_err();
    let StepError::TooLarge(need) = error else {
        panic!("{error}")
    };
    assert_eq!(need.limit, 8 << 20);
    assert!(need.bytes > need.limit, "{need}");
    assert_eq!(state.input.bodies.position, positions);
    let tally = agree(&heap(&shapes::torus_240(), 40, 2.0), &mut step, "after a crowd");
    tally.require_no_failures();
    assert!(tally.touching > 20);
}

/// The device of this adapter, opened again, with buffer bindings of so many bytes at most.
pub fn with_binding_size(gpu: &Gpu, bytes: u64) -> Gpu {
    let descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
    let flags = descriptor.flags;
    let (device, queue) = pollster::block_on(async {
        let instance = wgpu::Instance::new(descriptor);
        let mut adapters = instance.enumerate_adapters(wgpu::Backends::all()).await;
        adapters.retain(|adapter| adapter.get_info() == gpu.info);
        let required_limits = wgpu::Limits {
            max_storage_buffer_binding_size: bytes,
            ..adapters[0].limits()
        };
        let descriptor = wgpu::DeviceDescriptor {
            required_limits,
            ..Default::default()
        };
        adapters[0].request_device(&descriptor).await.unwrap()
    });
    Gpu::new(device, queue, gpu.info.clone(), flags)
}

/// What the device cannot hold is an error, and the next step is as if it had never been tried.
pub fn too_much_is_an_error_that_leaves_no_trace(gpu: &Gpu) {
    let limits = gpu.device.limits();
    let limit = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    // A half-space takes 32 bytes on the device.
    let planes = limit / 32 + 1;
    if planes > 1 << 25 {
        println!("\nthe device holds {limit} bytes, which would take too long to fill");
        return;
    }
    let mut step = GpuStep::new(gpu.clone()).unwrap();
    let mut scene = heap(&shapes::torus_240(), 40, 2.0);
    let mut state = scene.state();
    let plane = Plane {
        normal: Vec3::Y,
        distance: -100.0,
        restitution: 0.0,
        ..Plane::default()
    };
    state.input.planes = vec![plane; planes as usize];
    let positions = state.input.bodies.position.clone();
    let error = step.run(&mut state).unwrap_err();
    assert!(matches!(error, StepError::TooLarge(_)), "{error}");
    assert_eq!(state.input.bodies.position, positions);
    scene.planes = half_spaces(&mut Rng::new(9, 9), 0.4);
    let tally = agree(&scene, &mut step, "after an error");
    tally.require_no_failures();
    assert!(tally.touching > 20);
    // This very state with its meshes, not only an equal one.
    state.input.planes.clear();
    step.run(&mut state).unwrap();
    assert!(state.results.contacts.pairs.len() > 20);
}
