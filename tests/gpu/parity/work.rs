//! What a step asks of the device: counts of commands, bytes and lists.

use super::inputs::heap;
use super::same_bits::TINY;
use super::scene::Scene;
use super::scenes::half_spaces;
use crate::oracle::rng::Rng;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::gpu::layout;
use bevy_faceoff::step::StepState;
use bevy_faceoff::step::gpu::GpuStep;
use bevy_faceoff::step::gpu::results::Detail;
use bevy_faceoff::types::gpu_work::{GpuList, GpuWork};
use bevy_faceoff::types::settings::Response;
use glam::Vec3;

fn crowd(response: Response) -> Scene {
    let mut scene = heap(&shapes::torus_240(), 40, 2.6);
    scene.config.response = response;
    scene
}

fn work(state: &StepState) -> GpuWork {
    state.results.gpu.expect("the step ran on the device")
}

/// Lists that need not grow: the second step of the same scene.
fn settled(step: &mut GpuStep, scene: &Scene) -> StepState {
    let mut state = scene.state();
    for _ in 0..2 {
        step.forget();
        scene.fill(&mut state);
        step.run(&mut state).unwrap();
    }
    state
}

/// Below 4,096 bodies, with one collision substep: these many are the aim, because each dispatch costs a GPU some
/// microseconds.
pub fn small_worlds_take_few_dispatches(gpu: &Gpu) {
    let mut step = GpuStep::new(gpu.clone()).unwrap();
    for (response, most) in [(Response::Impulse, 20), (Response::None, 45), (Response::Contacts, 70)] {
        let mut scene = crowd(response);
        for body in &mut scene.bodies {
            body.linear_velocity *= 0.01;
            body.angular_velocity *= 0.01;
        }
        let state = settled(&mut step, &scene);
        assert_eq!(state.results.collision_substeps, 1);
        assert!(!state.results.contacts.pairs.is_empty());
        let GpuWork {
            dispatches,
            indirect,
            validations,
            passes,
            submissions,
            lists,
            ..
        } = work(&state);
        assert_eq!(lists.sphere_pairs.length as usize, state.results.sphere_pairs.len());
        println!("\n{response:?}: {dispatches} dispatches, {indirect} of them indirect");
        assert!(dispatches <= most, "{dispatches}");
        assert!(indirect < dispatches && (validations == 0 || validations == indirect));
        assert_eq!((passes, submissions), (6, 1));
    }
}

/// Half-spaces have kernels of their own, which worlds without them leave out.
pub fn half_spaces_alone_have_dispatches_for_them(gpu: &Gpu) {
    let mut step = GpuStep::new(gpu.clone()).unwrap();
    for (response, more) in [(Response::Impulse, 1), (Response::None, 2)] {
        let without = crowd(response);
        let mut with = without.clone();
        with.planes = half_spaces(&mut Rng::new(9, 9), 0.4);
        let [without, with] = [without, with].map(|scene| work(&settled(&mut step, &scene)).dispatches);
        assert_eq!(with, without + more, "{response:?}");
    }
}

pub fn bytes_and_lists_are_counted(gpu: &Gpu) {
    let mut step = GpuStep::new(gpu.clone()).unwrap();
    for response in [Response::Impulse, Response::None, Response::Contacts] {
        let mut scene = crowd(response);
        scene.planes = half_spaces(&mut Rng::new(9, 9), 0.4);
        let state = settled(&mut step, &scene);
        let GpuWork {
            uploaded_bytes,
            read_back_bytes,
            memory_bytes,
            lists,
            ..
        } = work(&state);
        assert_eq!(memory_bytes, step.bytes());
        let body = size_of::<layout::Body>() as u64;
        let bodies = scene.bodies.len() as u64 * body;
        // The second step of the same scene has nothing new.
        assert!(uploaded_bytes < 1000, "{uploaded_bytes}");
        let mut moved = scene.clone();
        for body in &mut moved.bodies {
            body.position += 0.001;
        }
        let mut state_of_moved = scene.state();
        step.run(&mut state_of_moved).unwrap();
        moved.fill(&mut state_of_moved);
        step.run(&mut state_of_moved).unwrap();
        // All bodies, up to the last one's position, but no meshes again, which are 20 KB.
        let up_to_last_position = bodies - body + size_of::<Vec3>() as u64;
        let uploaded = work(&state_of_moved).uploaded_bytes;
        assert!(
            (up_to_last_position..4 * bodies + 2000).contains(&uploaded),
            "{uploaded}"
        );
        assert!(read_back_bytes > (scene.bodies.len() * size_of::<layout::Moved>()) as u64);
        let results = &state.results;
        // With contacts the list also holds, at first, the pairs that can meet within the step.
        let listed = lists.sphere_pairs.length as usize;
        assert!(listed >= results.sphere_pairs.len());
        assert!(listed == results.sphere_pairs.len() || response == Response::Contacts);
        assert_eq!(lists.face_pairs.length as usize, results.contacts.faces.len());
        if state.results.collision_substeps == 1 {
            assert_eq!(lists.manifolds.length as usize, results.manifolds.pairs.len());
            assert_eq!(lists.contact_points.length as usize, results.manifolds.points.len());
        }
        assert!(lists.face_pairs.length > 0 && lists.plane_contacts.length > 0);
        for (name, GpuList { length, capacity }) in lists.iter() {
            assert!(length <= capacity, "{name}: {length} of {capacity}");
        }
        // Counts alone are a few hundred bytes; time stamps are 96 a collision substep.
        // The bodies have moved, so lists may grow in the first of two.
        let [_, output] = [(); 2].map(|()| {
            step.submit(&state.input, &[], Detail::Counts).unwrap();
            step.take().unwrap().unwrap()
        });
        let counts = output.work.read_back_bytes;
        assert!(counts < 600 + 96 * u64::from(output.collision_substeps), "{counts}");
    }
}

/// A step that is repeated counts all its attempts, and the meshes that it brought.
pub fn repetitions_count(gpu: &Gpu) {
    let mut step = GpuStep::with_capacity(gpu.clone(), TINY).unwrap();
    let scene = crowd(Response::Impulse);
    let first = work(&scene.on_gpu(&mut step));
    let second = work(&scene.on_gpu(&mut step));
    let third = work(&scene.on_gpu(&mut step));
    assert!(first.submissions > second.submissions, "{first:?}");
    assert!(first.dispatches >= 2 * second.dispatches);
    assert!(first.uploaded_bytes > second.uploaded_bytes + 10_000);
    assert_eq!(second.submissions, 1);
    // Meshes of another state are other meshes, and are written.
    assert_eq!(second.dispatches, third.dispatches);
}

/// What ran on the CPU asked nothing of a device, whatever ran before.
pub fn the_cpu_asks_for_nothing(gpu: &Gpu) {
    let mut step = GpuStep::new(gpu.clone()).unwrap();
    let mut state = crowd(Response::Impulse).on_gpu(&mut step);
    assert!(state.results.gpu.is_some());
    super::scene::step_on_cpu(&mut state);
    assert_eq!(state.results.gpu, None);
}
