//! Pairs of large meshes, which are split into pieces.

use super::same_bits::{AMPLE, Bits, TINY};
use super::scene::{Scene, Shape};
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::manifolds::Manifolds;
use bevy_faceoff::state::{Body, StepConfig};
use bevy_faceoff::step::StepState;
use bevy_faceoff::step::gpu::GpuStep;
use bevy_faceoff::types::gpu_work::GpuLists;
use bevy_faceoff::types::settings::Response;
use glam::{Quat, Vec3};
use std::collections::BTreeSet;

/// Triangles of a node at the level of pieces.
const PIECE: u64 = 64;

fn two(mesh: &TriMesh, offset: Vec3, response: Response) -> Scene {
    let turn = Quat::from_rotation_x(0.3) * Quat::from_rotation_z(0.2);
    Scene {
        shapes: vec![Shape::new("large", mesh, None)],
        bodies: [(Vec3::ZERO, Quat::IDENTITY), (offset, turn)]
            .map(|(position, rotation)| Body::at_rest(0, position, rotation, Vec3::ONE))
            .into(),
        config: StepConfig {
            response,
            ..StepConfig::default()
        },
        ..Scene::default()
    }
}

fn lists(state: &StepState) -> GpuLists {
    state.results.gpu.expect("the step ran on the device").lists
}

/// Requires the same faces, but for a `share` that touches within what single precision resolves, and the same contact.
fn require_same(cpu: &StepState, gpu: &StepState, share: f64) {
    let [of_cpu, of_gpu] = [cpu, gpu].map(|state| {
        let faces = state.results.contacts.faces.iter();
        faces.map(|pair| [pair.a, pair.b]).collect::<BTreeSet<_>>()
    });
    let added = of_gpu.difference(&of_cpu).count();
    println!("\n{} pairs of faces, {added} more on the device", of_cpu.len());
    assert_eq!(of_cpu.difference(&of_gpu).count(), 0, "missed");
    assert!(
        added as f64 <= share * of_cpu.len() as f64,
        "{added} of {}",
        of_cpu.len()
    );
    assert_eq!(of_gpu.len(), gpu.results.contacts.faces.len(), "a pair of faces twice");
    let [of_cpu, of_gpu] = [cpu, gpu].map(|state| &state.results.contacts.pairs);
    assert_eq!((of_cpu.len(), of_gpu.len()), (1, 1));
    let (p, q) = (of_cpu[0].contact, of_gpu[0].contact);
    assert!(p.point.distance(q.point) < 1e-4, "{p:?}, {q:?}");
    assert!(p.normal.distance(q.normal) < 1e-2, "{p:?}, {q:?}");
}

fn deepest(manifolds: &Manifolds) -> f32 {
    let points = manifolds.points.iter();
    points.map(|point| point.separation).fold(f32::INFINITY, f32::min)
}

/// 327,680 triangles each, whose pieces are larger than those of other meshes.
pub fn hundreds_of_thousands_of_triangles(gpu: &Gpu) {
    let mesh = shapes::ball(0.5, 7);
    for response in [Response::Impulse, Response::None] {
        let scene = two(&mesh, Vec3::new(0.95, 0.1, 0.05), response);
        let mut step = GpuStep::with_capacity(gpu.clone(), TINY).unwrap();
        let (cpu, gpu) = (scene.on_cpu(), scene.on_gpu(&mut step));
        require_same(&cpu, &gpu, 0.03);
        let pieces = lists(&gpu).pair_pieces.length;
        assert!(pieces > 16, "{pieces}");
        if response == Response::None {
            let [of_cpu, of_gpu] = [&cpu, &gpu].map(|state| deepest(&state.results.manifolds));
            assert!((of_cpu - of_gpu).abs() < 1e-4, "{of_cpu}, {of_gpu}");
            assert!(lists(&gpu).near_pieces.length > 16);
        }
    }
}

/// Surfaces that are close to each other all over, like those of a nut and a bolt: a hundred thousand tests of triangles in
/// one pair, and no workgroup has more than those of a piece.
pub fn one_pair_is_shared_by_many_workgroups(gpu: &Gpu) {
    let scene = two(&shapes::ball(0.5, 5), Vec3::ZERO, Response::Impulse);
    let mut step = GpuStep::with_capacity(gpu.clone(), TINY).unwrap();
    let state = scene.on_gpu(&mut step);
    // Most faces are nearly coplanar with others.
    require_same(&scene.on_cpu(), &state, 0.08);
    let pieces = u64::from(lists(&state).pair_pieces.length);
    let tests = state.results.contacts.triangle_tests;
    println!("\n{tests} tests in {pieces} pieces");
    assert!(tests > 100_000 && pieces > 1000, "{tests} tests in {pieces} pieces");
    assert!(tests <= pieces * PIECE * PIECE);
    let mut ample = GpuStep::with_capacity(gpu.clone(), AMPLE).unwrap();
    let again = Bits::of(&scene.on_gpu(&mut ample));
    Bits::of(&state).require(&again, "with ample lists");
}

/// A small body on a large mesh, and one inside of it.
pub fn large_and_small(gpu: &Gpu) {
    let mut step = GpuStep::new(gpu.clone()).unwrap();
    let mut scene = two(&shapes::ball(0.5, 5), Vec3::Y * 0.52, Response::Impulse);
    scene.bodies[1].scale = Vec3::splat(0.1);
    require_same(&scene.on_cpu(), &scene.on_gpu(&mut step), 0.03);
    for height in [0.0, 0.3, 0.6] {
        scene.bodies[1].position = Vec3::Y * height;
        let (cpu, gpu) = (scene.on_cpu(), scene.on_gpu(&mut step));
        let [of_cpu, of_gpu] = [&cpu, &gpu].map(|state| {
            let pairs = state.results.contacts.pairs.iter();
            pairs.map(|pair| pair.contained).collect::<Vec<_>>()
        });
        assert_eq!(of_cpu, of_gpu, "{height}");
        assert_eq!(of_cpu.len(), usize::from(height < 0.5), "{height}");
    }
}

/// Where the pieces of some pairs no longer fit, the lists of what pieces find grow by what is needed, not by what an earlier
/// step left in them.
pub fn pieces_that_do_not_fit_ask_for_nothing(gpu: &Gpu) {
    let mut scene = two(&shapes::ball(0.5, 5), Vec3::new(0.9, 0.1, 0.05), Response::None);
    // Other pairs, which barely touch at first.
    for z in [2.0, 4.0, 6.0] {
        for mut body in [scene.bodies[0], scene.bodies[1]] {
            body.position.x *= 1.1;
            body.position.z += z;
            scene.bodies.push(body);
        }
    }
    let mut step = GpuStep::with_capacity(gpu.clone(), TINY).unwrap();
    scene.on_gpu(&mut step);
    let few = lists(&scene.on_gpu(&mut step));
    for body in &mut scene.bodies[3..] {
        body.position.x *= 0.9;
    }
    // The first pair's pieces fit, those of the others do not.
    let many = lists(&scene.on_gpu(&mut step));
    assert!(many.near_pieces.length > few.near_pieces.capacity, "{few:?}, {many:?}");
    for (name, before, after) in [
        ("features", few.features, many.features),
        ("segments", few.segments, many.segments),
    ] {
        let most = before.capacity.max(2 * after.length);
        assert!(after.capacity <= most, "{name}: {before:?}, {after:?}");
    }
}
