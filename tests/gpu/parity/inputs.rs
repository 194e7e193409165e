//! Scenes at the edges of what there can be: nothing, one of something, meshes around the sizes at which trees grow.

use super::band::Oracle;
use super::compare::{Tally, compare};
use super::contacts::differences;
use super::scene::{Scene, Shape};
use super::scenes::half_spaces;
use crate::oracle::rng::Rng;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::state::{Body, Plane, StepConfig};
use bevy_faceoff::step::gpu::GpuStep;
use glam::{Quat, Vec3};

/// An open strip of so many triangles, wound about the z axis, at most `turns` radians.
pub fn strip(triangles: u32, turns: f32) -> TriMesh {
    let vertex = |i: u32| {
        let turn = i as f32 * (turns / triangles as f32).min(0.45);
        let radius = if i.is_multiple_of(2) { 0.5 } else { 0.2 };
        let height = 0.8 * (i as f32 / (triangles + 2) as f32 - 0.5);
        Vec3::new(radius * turn.cos(), radius * turn.sin(), height)
    };
    let vertices = (0..triangles + 2).map(vertex).collect();
    TriMesh::new(vertices, (0..triangles).map(|i| [i, i + 1, i + 2]).collect()).unwrap()
}

/// So many bodies of one mesh, heaped about the origin, falling.
pub fn heap(mesh: &TriMesh, count: usize, side: f64) -> Scene {
    let mut rng = Rng::new(1, count as u64);
    let body = |_| Body {
        linear_velocity: rng.in_cube(1.0).as_vec3(),
        angular_velocity: rng.in_cube(1.0).as_vec3(),
        ..Body::at_rest(
            0,
            rng.in_cube(0.5 * side).as_vec3(),
            rng.rotation(),
            Vec3::splat(rng.range(0.3, 2.0) as f32),
        )
    };
    Scene {
        shapes: vec![Shape::new("mesh", mesh, None)],
        bodies: (0..count).map(body).collect(),
        config: StepConfig {
            gravity: Vec3::NEG_Y * 9.81,
            ..Default::default()
        },
        ..Default::default()
    }
}

/// Compares one step, faces, contacts and motion.
pub fn agree(scene: &Scene, step: &mut GpuStep, what: &str) -> Tally {
    let (cpu, gpu) = (scene.on_cpu(), scene.on_gpu(step));
    let (mut tally, agreed) = compare(scene, &cpu, &gpu, &Oracle::new(scene, &cpu));
    let differ = differences(scene, &cpu, &gpu, &agreed);
    tally.failures.extend(differ.failures);
    if differ.bodies_off + differ.contacts_off > 1 {
        tally.failures.push(format!(
            "{} bodies, {} contacts off",
            differ.bodies_off, differ.contacts_off
        ));
    }
    println!("{}", tally.row(what));
    let named = |text: &String| format!("{what}: {text}");
    tally.failures = tally.failures.iter().map(named).collect();
    tally
}

pub fn meshes_of_any_size(gpu: &Gpu) {
    let mut step = GpuStep::new(gpu.clone()).unwrap();
    let mut all = Tally::default();
    println!("\n{}", Tally::head());
    // One triangle, one cluster, one group of clusters, one of those, and one more each.
    for (triangles, count, side) in [
        (1, 300, 3.5),
        (2, 200, 3.5),
        (7, 150, 4.0),
        (8, 150, 4.0),
        (9, 150, 4.0),
        (63, 80, 4.0),
        (64, 80, 4.0),
        (65, 80, 4.0),
        (511, 20, 3.0),
        (512, 20, 3.0),
        (513, 20, 3.0),
        (4096, 6, 1.5),
        (4097, 6, 1.5),
    ] {
        let tally = agree(
            &heap(&strip(triangles, 60.0), count, side),
            &mut step,
            &format!("{triangles} triangles"),
        );
        assert!(tally.touching > 5, "{triangles} triangles: {} touch", tally.touching);
        all.add(tally);
    }
    all.require_no_failures();
    // Many of the triangles are slivers.
    all.require_few_excused(300);
}

pub fn none_and_one_of_everything(gpu: &Gpu) {
    let mut step = GpuStep::new(gpu.clone()).unwrap();
    let torus = shapes::torus_240();
    let mut all = Tally::default();
    println!("\n{}", Tally::head());
    let nothing = Scene::default();
    all.add(agree(&nothing, &mut step, "nothing at all"));
    for bodies in [0, 1, 2, 64, 65] {
        for planes in [0, 1, 5] {
            let mut scene = heap(&torus, bodies, 0.5 + 0.03 * bodies as f64);
            scene.planes = half_spaces(&mut Rng::new(9, 9), 0.4);
            scene.planes.truncate(planes);
            all.add(agree(
                &scene,
                &mut step,
                &format!("{bodies} bodies, {planes} half-spaces"),
            ));
        }
    }
    // More half-spaces than anything else.
    let mut scene = heap(&torus, 3, 0.5);
    scene.planes = (0..40).flat_map(|i| half_spaces(&mut Rng::new(9, i), 0.4)).collect();
    all.add(agree(&scene, &mut step, "200 half-spaces"));
    // Nothing is left of it.
    all.add(agree(&nothing, &mut step, "nothing again"));
    all.require_no_failures();
    all.require_few_excused(1000);
}

/// A huge body that rotates fast and touches a plane gets an impulse that is no number.
pub fn an_impulse_that_is_no_number_has_no_effect(gpu: &Gpu) {
    let spin = Vec3::Z * 1.0e8;
    let mut scene = Scene {
        shapes: vec![Shape::new("cube", &shapes::cube(1.0), None)],
        bodies: vec![Body {
            angular_velocity: spin,
            ..Body::at_rest(0, Vec3::ZERO, Quat::from_rotation_z(0.3), Vec3::splat(1.0e8))
        }],
        ..Default::default()
    };
    scene.planes.push(Plane {
        normal: Vec3::Y,
        distance: -0.5e8,
        ..Plane::default()
    });
    let mut step = GpuStep::new(gpu.clone()).unwrap();
    for state in [scene.on_cpu(), scene.on_gpu(&mut step)] {
        assert_eq!(state.results.contacts.planes.len(), 1);
        let bodies = &state.input.bodies;
        assert_eq!(bodies.linear_velocity[0], Vec3::ZERO);
        assert_eq!(bodies.angular_velocity[0], spin);
    }
}
