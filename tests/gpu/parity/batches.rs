//! Steps whose pairs are worked off in several batches: the same bits as in one, and less memory.

use super::inputs::heap;
use super::overflow::with_binding_size;
use super::same_bits::{AMPLE, Bits};
use super::scene::Scene;
use super::scenes::half_spaces;
use crate::oracle::rng::Rng;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::manifolds::gpu::BatchSize;
use bevy_faceoff::state::Body;
use bevy_faceoff::step::StepState;
use bevy_faceoff::step::gpu::GpuStep;
use bevy_faceoff::types::gpu_work::GpuWork;
use bevy_faceoff::types::settings::Response;
use glam::Vec3;

/// Dispatches of a batch without large meshes.
const OF_A_BATCH: u32 = 15;

/// A device's steps, with batches of so many bytes.
fn in_batches_of(gpu: &Gpu, bytes: u64) -> GpuStep {
    let batch_size = BatchSize {
        bytes,
        ..BatchSize::of(gpu)
    };
    let step = GpuStep::with_capacity(gpu.clone(), AMPLE).unwrap();
    step.with_batch_size(batch_size)
}

/// Tori deep in each other, on half-spaces.
fn pile(response: Response) -> Scene {
    pile_of(40, response)
}

fn pile_of(tori: usize, response: Response) -> Scene {
    let mut scene = heap(&shapes::torus_240(), tori, 2.4);
    for body in &mut scene.bodies {
        body.linear_velocity *= 0.01;
        body.angular_velocity *= 0.01;
    }
    scene.planes = half_spaces(&mut Rng::new(9, 9), 0.4);
    scene.config.response = response;
    scene
}

fn work(state: &StepState) -> GpuWork {
    state.results.gpu.expect("the step ran on the device")
}

/// Requires the same bits of some steps, at first with lists that are too short. Returns the work of the last steps.
fn require_same_bits(scene: &Scene, steps: usize, small: &mut GpuStep, large: &mut GpuStep) -> [GpuWork; 2] {
    let mut states = [scene.state(), scene.state()];
    for number in 0..steps {
        for (state, step) in states.iter_mut().zip([&mut *small, &mut *large]) {
            step.run(state).unwrap();
        }
        let what = format!("{:?}, step {number}", scene.config.response);
        require_same([&states[0], &states[1]], &what);
    }
    states.each_ref().map(work)
}

fn require_same(states: [&StepState; 2], what: &str) {
    let [one, other] = states.map(Bits::of);
    one.require(&other, what);
    let [points, others] = states.map(|state| format!("{:?}", state.results.manifolds));
    assert!(points == others, "{what}: contact points differ");
}

/// Two tori far from a pile fly at each other, so the pile completes its step before them.
pub fn groups_in_batches(gpu: &Gpu) {
    let mut scene = pile(Response::Contacts);
    scene.planes.clear();
    for side in [-1.0, 1.0] {
        scene.bodies.push(Body {
            position: Vec3::new(50.0 + side, 0.0, 0.0),
            linear_velocity: Vec3::X * (-60.0 * side),
            ..scene.bodies[0]
        });
    }
    let mut states = [scene.state(), scene.state()];
    for (state, bytes) in states.iter_mut().zip([256 << 10, 256 << 20]) {
        in_batches_of(gpu, bytes).run(state).unwrap();
    }
    require_same(states.each_ref(), "with groups");
    let results = &states[0].results;
    println!(
        "{} batches; {} collision substeps, {} in the mean",
        work(&states[0]).batches,
        results.collision_substeps,
        results.mean_collision_substeps
    );
    assert!(work(&states[0]).batches > 4);
    assert!(results.collision_substeps > 2 && results.mean_collision_substeps < 2.0);
}

pub fn a_pile_in_batches(gpu: &Gpu) {
    // In the second step overlaps are pushed out, in many collision substeps.
    for (response, steps) in [(Response::None, 3), (Response::Contacts, 1)] {
        let [mut small, mut large] = [256 << 10, 256 << 20].map(|bytes| in_batches_of(gpu, bytes));
        let [of_small, of_large] = require_same_bits(&pile(response), steps, &mut small, &mut large);
        println!("\n{response:?}: {} batches", of_small.batches);
        assert_eq!(of_large.batches, 1);
        assert!(of_small.batches > 4, "{of_small:?}");
        let [short, long] = [of_small, of_large].map(|work| work.lists.near_triangles.length);
        assert!(3 * short < long, "{short}, {long}");
        if response == Response::None {
            let more = OF_A_BATCH * (of_small.batches - 1);
            assert_eq!(of_small.dispatches, of_large.dispatches + more);
        }
    }
}

/// Pairs of large meshes, each of which takes more than a batch should.
pub fn large_meshes_in_batches(gpu: &Gpu) {
    for response in [Response::None, Response::Contacts] {
        let mut scene = heap(&shapes::ball(0.5, 4), 4, 0.35);
        scene.config.response = response;
        scene.bodies.iter_mut().for_each(|body| body.scale = Vec3::ONE);
        let [mut small, mut large] = [64 << 10, 256 << 20].map(|bytes| in_batches_of(gpu, bytes));
        let [of_small, of_large] = require_same_bits(&scene, 2, &mut small, &mut large);
        assert_eq!(of_large.batches, 1);
        assert!(
            of_small.batches > 1 && of_small.lists.near_pieces.length > 16,
            "{of_small:?}"
        );
    }
}

/// Batches become fewer when hundreds of steps needed fewer.
pub fn batches_become_fewer(gpu: &Gpu) {
    let mut step = in_batches_of(gpu, 256 << 10);
    let crowd = pile(Response::None);
    let before = crowd.on_gpu(&mut step);
    assert!(work(&before).batches > 4);
    let mut few = heap(&shapes::cube(1.0), 2, 0.5);
    few.config.response = Response::None;
    let mut state = few.state();
    let mut batches = Vec::new();
    for _ in 0..520 {
        few.fill(&mut state);
        step.run(&mut state).unwrap();
        batches.push(work(&state).batches);
    }
    batches.dedup();
    assert_eq!(batches, [work(&before).batches, 1]);
    require_same([&crowd.on_gpu(&mut step), &before], "the crowd again");
}

/// A device that binds little memory makes contact points of many pairs all the same.
pub fn little_memory_suffices_for_many_pairs(gpu: &Gpu) {
    let limit = 1 << 20;
    let mut scene = pile_of(70, Response::None);
    // Lists of faces would not fit either.
    scene.config.face_lists = false;
    let mut step = GpuStep::new(with_binding_size(gpu, limit)).unwrap();
    let found = scene.on_gpu(&mut step);
    let mut ample = GpuStep::new(gpu.clone()).unwrap();
    let at_once = scene.on_gpu(&mut ample);
    require_same([&found, &at_once], "with little memory");
    assert!(16 * u64::from(work(&at_once).lists.near_triangles.length) > limit);
    assert!(work(&found).batches > 1);
}
