//! The plugin on a GPU: what it says it takes, what it finds, and what happens when the device is lost.

use crate::app::{DEVICE, Sim, ball_like, sorted};
use crate::gpu::Test;
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::gpu::device::{Gpu, NoGpu};
use bevy_faceoff::prelude::*;
use wgpu::DeviceType;

pub const TESTS: &[Test] = &[
    ("auto_takes_no_adapter_that_computes_on_the_cpu", auto),
    ("an_app_on_the_gpu_finds_what_one_on_the_cpu_does", same_collisions),
    ("a_body_bounces_off_a_plane_as_on_the_cpu", bounce),
    ("a_lost_device_is_opened_anew_and_the_step_is_not_lost", lost_once),
    ("apps_share_a_device_until_it_is_lost", share),
    ("the_cpu_takes_over_from_a_device_that_is_always_lost", lost_for_good),
    ("bodies_come_and_go_while_the_gpu_steps", churn),
];

fn app(backend: Backend) -> Sim {
    let mut sim = Sim::with_step(StepPlugin {
        backend,
        threads: 1,
        readback: Readback::Lockstep,
        ..default()
    });
    sim.world().insert_resource(Response::Impulse);
    sim
}

fn active(sim: &Sim) -> ActiveBackend {
    sim.app.world().resource::<ActiveBackend>().clone()
}

fn auto(gpu: &Gpu) {
    let taken = active(&app(Backend::Auto));
    match (gpu.info.device_type, &taken) {
        // Nobody looks for adapters where there is no GPU.
        (DeviceType::Cpu, ActiveBackend::Cpu { reason, .. }) => {
            assert!(
                reason.contains(&gpu.info.name) || *reason == NoGpu::NoCard.to_string(),
                "{reason}"
            )
        }
        (DeviceType::Cpu, _) => panic!("took {taken:?}"),
        _ => assert_eq!(taken.name(), "gpu"),
    }
    assert_eq!(active(&app(Backend::Cpu)).name(), "cpu");
    assert_eq!(active(&app(Backend::Gpu)).name(), "gpu");
}

/// Tori that fly into each other, and one that contains a ball.
fn crowd(sim: &mut Sim) -> Vec<Entity> {
    let torus = sim.mesh(&shapes::torus_240());
    let ball = sim.mesh(&shapes::ball(0.4, 2));
    let mut random = fastrand::Rng::with_seed(5);
    let mut point = move |size: f32| size * (Vec3::from_array([0; 3].map(|_| random.f32())) - 0.5);
    (0..40)
        .map(|i| {
            let mesh = if i % 4 == 0 { &ball } else { &torus };
            let body = sim.spawn(ball_like(mesh, point(4.0), point(2.0)));
            let spin = AngularVelocity(point(3.0));
            sim.set(body, spin);
            body
        })
        .collect()
}

fn same_collisions(_: &Gpu) {
    let [mut cpu, mut gpu] = [app(Backend::Cpu), app(Backend::Gpu)];
    let [on_cpu, on_gpu] = [&mut cpu, &mut gpu].map(crowd);
    assert_eq!(on_cpu, on_gpu, "both apps name their bodies alike");
    for step in 0..10 {
        cpu.step(1);
        gpu.step(1);
        assert!(!cpu.touching().is_empty());
        assert_eq!(cpu.touching(), gpu.touching(), "step {step}");
        assert_eq!(cpu.report().sphere_pairs, gpu.report().sphere_pairs);
    }
    assert_eq!(cpu.started, gpu.started);
    assert_eq!(cpu.ended, gpu.ended);
    for (one, other) in cpu.collisions().iter().zip(gpu.collisions().iter()) {
        let distance = one.contact.point.distance(other.contact.point);
        assert!(distance < 1.0e-2, "{} touches {}", one.collider1, one.collider2);
    }
    for body in on_cpu {
        let distance = cpu.position(body).distance(gpu.position(body));
        assert!(distance < 1.0e-3, "{body} is {distance} m off");
    }
}

fn bounce(_: &Gpu) {
    let run = |backend| {
        let mut sim = app(backend);
        sim.app.insert_resource(Gravity::default());
        sim.spawn((PlaneCollider::through(Vec3::ZERO, Vec3::Y), Restitution::new(1.0)));
        let cube = sim.mesh(&shapes::cube(1.0));
        let body = sim.spawn(ball_like(&cube, Vec3::Y * 1.2, Vec3::ZERO));
        let heights: Vec<f32> = (0..60)
            .map(|_| {
                sim.step(1);
                sim.position(body).y
            })
            .collect();
        (heights, sim.started.len())
    };
    let ((cpu, starts), (gpu, gpu_starts)) = (run(Backend::Cpu), run(Backend::Gpu));
    assert!(starts > 0 && starts == gpu_starts, "{starts} {gpu_starts}");
    for (step, (a, b)) in cpu.iter().zip(&gpu).enumerate() {
        assert!((a - b).abs() < 1.0e-3, "step {step}: {a} on the CPU, {b} on the GPU");
    }
}

fn lose(sim: &Sim) {
    let gpu = bevy_faceoff::plugin::gpu(sim.app.world()).expect("the stages run on a GPU");
    gpu.device.destroy();
}

fn failures(sim: &mut Sim) -> usize {
    sim.world().resource_mut::<Messages<BackendFailed>>().drain().count()
}

fn lost_once(_: &Gpu) {
    DEVICE.set(None);
    let mut sim = app(Backend::Gpu);
    let torus = sim.mesh(&shapes::torus_240());
    let body = sim.spawn(ball_like(&torus, Vec3::ZERO, Vec3::X));
    sim.step(3);
    assert_eq!(failures(&mut sim), 0);
    lose(&sim);
    sim.step(1);
    assert_eq!(failures(&mut sim), 1);
    sim.step(2);
    assert_eq!(failures(&mut sim), 0);
    assert_eq!(active(&sim).name(), "gpu");
    assert!(
        (sim.position(body).x - 6.0 / 64.0).abs() < 1.0e-6,
        "six steps: {}",
        sim.position(body)
    );
}

fn share(_: &Gpu) {
    DEVICE.set(None);
    let mut first = app(Backend::Gpu);
    DEVICE.set(bevy_faceoff::plugin::gpu(first.app.world()).cloned());
    let mut second = app(Backend::Gpu);
    let is_shared = |sim: &Sim| matches!(active(sim), ActiveBackend::Gpu { shared: true, .. });
    assert!(!is_shared(&first) && is_shared(&second));
    let bodies = [&mut first, &mut second].map(|sim| {
        let torus = sim.mesh(&shapes::torus_240());
        sim.spawn(ball_like(&torus, Vec3::ZERO, Vec3::X))
    });
    first.step(1);
    second.step(1);
    lose(&first);
    // Each opens a device of its own.
    for (sim, body) in [(&mut first, bodies[0]), (&mut second, bodies[1])] {
        sim.step(1);
        assert_eq!((failures(sim), active(sim).name()), (1, "gpu"));
        assert!(!is_shared(sim));
        assert!((sim.position(body).x - 2.0 / 64.0).abs() < 1.0e-6);
    }
}

fn lost_for_good(_: &Gpu) {
    DEVICE.set(None);
    let mut sim = app(Backend::Gpu);
    let torus = sim.mesh(&shapes::torus_240());
    let body = sim.spawn(ball_like(&torus, Vec3::ZERO, Vec3::X));
    let mut steps = 0;
    while active(&sim).name() == "gpu" {
        assert!(steps < 20, "a device that is lost in every step is given up");
        lose(&sim);
        sim.step(1);
        steps += 1;
    }
    assert_eq!(steps, 4, "it is opened again three times");
    assert!(failures(&mut sim) > 0);
    sim.step(1);
    assert_eq!(active(&sim).name(), "cpu");
    assert!((sim.position(body).x - (steps + 1) as f32 / 64.0).abs() < 1.0e-6);
}

fn churn(_: &Gpu) {
    let mut sim = app(Backend::Gpu);
    let torus = sim.mesh(&shapes::torus_240());
    let cube = sim.mesh(&shapes::cube(1.0));
    let first = sim.spawn(ball_like(&torus, Vec3::ZERO, Vec3::ZERO));
    let second = sim.spawn(ball_like(&torus, Vec3::X * 0.3, Vec3::ZERO));
    sim.step(1);
    assert!(sim.touch(first, second));
    sim.world().despawn(first);
    let third = sim.spawn(ball_like(&cube, Vec3::X * 0.6, Vec3::ZERO));
    sim.step(1);
    assert_eq!(sim.touching(), [sorted(second, third)]);
    sim.world().despawn(second);
    sim.world().despawn(third);
    sim.step(1);
    assert!(sim.touching().is_empty());
    assert_eq!(sim.report().bodies, 0);
}
