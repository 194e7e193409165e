//! The GPU's step against the CPU's, on the same scenes.
#![cfg(feature = "gpu")]

use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::gpu::{device, step::GpuStep};
use bevy_faceoff::stages::Stage;
use bevy_faceoff::stages::state::{Body, StepState};
use glam::{Quat, Vec3};
use std::time::Instant;

fn scene(mesh: &CollisionMesh, count: usize, side: f32, seed: u64) -> StepState {
    let mut state = StepState::default();
    let slot = state.meshes.add(mesh.clone());
    let mut random = fastrand::Rng::with_seed(seed);
    for _ in 0..count {
        let scale = (0.25 + 1.75 * random.f32()) / (2.0 * mesh.radius);
        let q = Quat::from_xyzw(
            random.f32() - 0.5,
            random.f32() - 0.5,
            random.f32() - 0.5,
            random.f32() - 0.5,
        );
        let p = Vec3::new(random.f32(), random.f32(), random.f32()) * side;
        let mut body = Body::at_rest(slot, p, q, Vec3::splat(scale));
        body.linear_velocity = Vec3::new(random.f32(), random.f32(), random.f32()) - 0.5;
        body.angular_velocity = Vec3::new(random.f32(), random.f32(), random.f32()) - 0.5;
        state.bodies.push(&body, &state.meshes).unwrap();
    }
    state
}

#[test]
fn smoke() {
    let gpu = device::open(true).unwrap();
    let t = Instant::now();
    let mut step = GpuStep::new(gpu).unwrap();
    println!("compile {:?}", t.elapsed());
    for (name, tri) in [("torus", shapes::torus_240()), ("knot", shapes::knot_1120())] {
        let mesh = CollisionMesh::new(&tri);
        for seed in 0..1 {
            let mut cpu = scene(&mesh, 500, 13.7, seed);
            let mut gpu = scene(&mesh, 500, 13.7, seed);
            for stage in Stage::ALL {
                stage.run_on_cpu(&mut cpu);
            }
            let t = Instant::now();
            step.run(&mut gpu).unwrap();
            println!("{name} gpu {:?} {:?}", t.elapsed(), gpu.times);
            println!("dispatches {:?} sizes {:?}", step.dispatches(), step.sizes());
            println!(
                "sphere {} {} touching {} {} faces {} {} tests {} {}",
                cpu.sphere_pairs.len(),
                gpu.sphere_pairs.len(),
                cpu.contacts.pairs.len(),
                gpu.contacts.pairs.len(),
                cpu.contacts.faces.len(),
                gpu.contacts.faces.len(),
                cpu.contacts.triangle_tests,
                gpu.contacts.triangle_tests
            );
            println!("sphere same {}", cpu.sphere_pairs == gpu.sphere_pairs);
            let key = |s: &StepState| {
                s.contacts
                    .pairs
                    .iter()
                    .map(|p| (p.bodies, p.contained, p.face_count))
                    .collect::<Vec<_>>()
            };
            println!("pairs same {}", key(&cpu) == key(&gpu));
            for (p, q) in cpu.contacts.pairs.iter().zip(&gpu.contacts.pairs) {
                let (dp, dn) = (
                    p.contact.point.distance(q.contact.point),
                    p.contact.normal.distance(q.contact.normal),
                );
                let mid = |s: &StepState, p: &bevy_faceoff::stages::state::TouchingPair| {
                    let mut sum = Vec3::ZERO;
                    let mut w = 0.0;
                    for f in s.contacts.faces_of(p) {
                        let l = f.start.distance(f.end);
                        w += l;
                        sum += (f.start + f.end) * 0.5 * l;
                    }
                    (sum / w, w)
                };
                if dp > 1e-4 && p.face_count < 9 {
                    println!(
                        "cpu {:?} {:?} gpu {:?} {:?}",
                        p.contact.point,
                        mid(&cpu, p),
                        q.contact.point,
                        mid(&gpu, q)
                    );
                    for f in cpu.contacts.faces_of(p) {
                        println!("   {f:?}");
                    }
                    for f in gpu.contacts.faces_of(q) {
                        println!(" g {f:?}");
                    }
                }
                if dp > 1e-4 || dn > 1e-3 {
                    println!(
                        "{:?} faces {} {} point {dp} normal {dn} contained {}",
                        p.bodies, p.face_count, q.face_count, p.contained
                    );
                }
            }
            let mut worst = [0f32; 4];
            for i in 0..cpu.bodies.len() {
                let (a, b) = (&cpu.bodies, &gpu.bodies);
                worst[0] = worst[0].max(a.position[i].distance(b.position[i]));
                worst[1] = worst[1].max((a.rotation[i] - b.rotation[i]).length());
                worst[2] = worst[2].max(a.linear_velocity[i].distance(b.linear_velocity[i]));
                worst[3] = worst[3].max(a.angular_velocity[i].distance(b.angular_velocity[i]));
            }
            println!("worst {worst:?}");
        }
    }
}
