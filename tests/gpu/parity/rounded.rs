//! Rounded bodies among others: which pairs touch, of which triangles, and where.

use super::scene::step_on_cpu;
use crate::support::Random;
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::state::{Body, PairContact, Plane};
use bevy_faceoff::step::StepState;
use bevy_faceoff::step::gpu::GpuStep;
use bevy_faceoff::types::settings::Response;
use glam::Vec3;
use std::collections::BTreeMap;

const COUNT: usize = 300;
/// The slot of the capsule.
const CAPSULE: u32 = 1;

fn scene(response: Response) -> StepState {
    let mut random = Random::new(17);
    let mut state = StepState::default();
    state.input.config.response = response;
    state.input.config.gravity = Vec3::ZERO;
    let meshes = [
        CollisionMesh::ball(0.3).unwrap(),
        CollisionMesh::capsule(0.15, 0.6).unwrap(),
        CollisionMesh::cuboid(Vec3::new(0.8, 0.4, 0.6), 0.1).unwrap(),
        CollisionMesh::new(&shapes::cube(0.7)),
        CollisionMesh::new(&shapes::torus_240()),
    ];
    let slots = meshes.map(|mesh| state.input.meshes.add(mesh));
    for i in 0..COUNT {
        let at = 2.8 * random.vector().as_vec3();
        let body = Body {
            sensor: i % 3 == 0,
            ..Body::at_rest(slots[i % slots.len()], at, random.rotation().as_quat(), Vec3::ONE)
        };
        state.input.bodies.push(&body, &state.input.meshes).unwrap();
    }
    state.input.planes.push(Plane {
        normal: Vec3::Y,
        distance: -2.0,
        ..Plane::default()
    });
    state
}

fn pairs(state: &StepState) -> BTreeMap<[u32; 2], &PairContact> {
    let pairs = state.results.contacts.pairs.iter();
    pairs.map(|pair| (pair.bodies, pair)).collect()
}

fn faces(state: &StepState, pair: &PairContact) -> Vec<[u32; 2]> {
    let faces = state.results.contacts.faces_of(pair).iter();
    let mut faces: Vec<_> = faces.map(|face| [face.a, face.b]).collect();
    faces.sort_unstable();
    faces
}

fn is_rounded(state: &StepState, pair: [u32; 2]) -> bool {
    pair.iter().any(|&i| state.input.bodies.rounding[i as usize] > 0.0)
}

/// Requires that nearly all pairs are the same, with the same triangles and nearly the same contacts.
fn compare(gpu: &Gpu, response: Response) {
    let [mut cpu, mut device] = [scene(response), scene(response)];
    step_on_cpu(&mut cpu);
    GpuStep::new(gpu.clone()).unwrap().run(&mut device).unwrap();
    let (of_cpu, of_gpu) = (pairs(&cpu), pairs(&device));
    let (mut rounded, mut alone, mut other_faces, mut off) = (0, 0, 0, 0);
    let mut listed = 0;
    for (pair, on_gpu) in &of_gpu {
        let Some(on_cpu) = of_cpu.get(pair) else {
            println!("{response:?}: {pair:?} on the device only");
            alone += 1;
            continue;
        };
        rounded += usize::from(is_rounded(&cpu, *pair));
        let lists = [faces(&cpu, on_cpu), faces(&device, on_gpu)];
        listed += lists[0].len();
        other_faces += usize::from(lists[0] != lists[1] || on_cpu.contained != on_gpu.contained);
        let [p, q] = [on_cpu.contact, on_gpu.contact];
        // A segment that pierces faces has no contour, whose middle would be the point.
        let has_segment = pair.iter().any(|&i| cpu.input.bodies.mesh[i as usize] == CAPSULE);
        let near = if has_segment { 0.3 } else { 1.0e-3 };
        let is_off = p.point.distance(q.point) > near || p.normal.distance(q.normal) > 1.0e-2;
        if is_off {
            println!("{response:?}: {pair:?}: {p:?} and {q:?}");
        }
        off += usize::from(is_off);
    }
    for pair in of_cpu.keys().filter(|pair| !of_gpu.contains_key(*pair)) {
        println!("{response:?}: {pair:?} on the CPU only");
        alone += 1;
    }
    println!(
        "{response:?}: {} pairs, {rounded} of them rounded, {alone} on one side only, {listed} pairs of triangles, \
         {other_faces} pairs with others, {off} contacts that differ",
        of_cpu.len()
    );
    assert!(rounded > 200, "{rounded}");
    assert!(alone <= 2 && other_faces <= 2 + rounded / 100 && off <= 2 + rounded / 100);
    let on_planes = [&cpu, &device].map(|state| &state.results.contacts.planes);
    assert_eq!(on_planes[0].len(), on_planes[1].len());
    for (p, q) in on_planes[0].iter().zip(on_planes[1]) {
        assert_eq!((p.body, p.plane), (q.body, q.plane));
        assert!(
            (p.depth - q.depth).abs() < 1.0e-4 && p.point.distance(q.point) < 1.0e-2,
            "{p:?} and {q:?}"
        );
    }
    assert!(on_planes[0].len() > 10);
}

pub fn same_pairs(gpu: &Gpu) {
    for response in [Response::Impulse, Response::None, Response::Contacts] {
        compare(gpu, response);
    }
}
