//! Poses that shaders blend between two steps, while bodies stay on the GPU.

use super::readback::app;
use crate::app::{Sim, ball_like};
use crate::gpu::Test;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::gpu::readback::read_words;
use bevy_faceoff::plugin::Poses;
use bevy_faceoff::prelude::*;
use std::time::Duration;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{BindGroupDescriptor, BindGroupEntry, BufferUsages, ComputePipelineDescriptor, ShaderModuleDescriptor};

pub const TESTS: &[Test] = &[
    ("a_straight_flight_is_drawn_evenly_from_the_gpu", flight),
    ("bodies_are_drawn_in_one_place_while_the_clock_is_paused", paused),
    ("a_body_that_is_placed_is_drawn_there_at_once", placed),
];

/// Frames a second; there are 64 steps.
const FRAMES: f64 = 240.0;

/// What a shader of a user does: the place of a point of each mesh, blended.
const DRAW: &str = "
@group(0) @binding(0) var<storage, read> before: array<FaceoffBefore>;
@group(0) @binding(1) var<storage, read> after: array<FaceoffAfter>;
@group(0) @binding(2) var<storage, read> part: f32;
@group(0) @binding(3) var<storage, read_write> drawn: array<vec4<f32>>;

@compute @workgroup_size(1)
fn draw(@builtin(global_invocation_id) id: vec3<u32>) {
    let pose = faceoff_pose(before[id.x], after[id.x], part);
    drawn[2u * id.x] = vec4(pose.position, 0.0);
    drawn[2u * id.x + 1u] = vec4(faceoff_point(pose, vec3(0.5, 0.0, 0.0)), 0.0);
}";

/// Position of the first body, and of a point of its mesh, as drawn in this frame.
fn drawn(sim: &Sim) -> [Vec3; 2] {
    let world = sim.app.world();
    let part = bevy_faceoff::plugin::drawn_part(world);
    let gpu = bevy_faceoff::plugin::gpu(world).unwrap();
    let (poses, entities) = bevy_faceoff::plugin::poses(world).unwrap();
    assert_eq!(entities.count(), poses.bodies as usize);
    let device = &gpu.device;
    let shader = device.create_shader_module(ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(format!("{}{DRAW}", Poses::WGSL).into()),
    });
    let pipeline = device.create_compute_pipeline(&ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &shader,
        entry_point: None,
        compilation_options: Default::default(),
        cache: None,
    });
    let buffer = |contents: &[f32], usage| {
        device.create_buffer_init(&BufferInitDescriptor {
            label: None,
            contents: bytemuck::cast_slice(contents),
            usage,
        })
    };
    let part = buffer(&[part], BufferUsages::STORAGE);
    let points = buffer(
        &vec![0.0; 8 * poses.bodies as usize],
        BufferUsages::STORAGE | BufferUsages::COPY_SRC,
    );
    let buffers = [poses.previous, poses.current, &part, &points];
    let entries: Vec<_> = (0..)
        .zip(buffers)
        .map(|(binding, buffer)| BindGroupEntry {
            binding,
            resource: buffer.as_entire_binding(),
        })
        .collect();
    let group = device.create_bind_group(&BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &entries,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.dispatch_workgroups(poses.bodies, 1, 1);
    drop(pass);
    gpu.queue.submit([encoder.finish()]);
    let words = read_words(gpu, &points, 8).unwrap();
    [0, 4].map(|first| Vec3::from_array([0, 1, 2].map(|k| f32::from_bits(words[first + k]))))
}

/// A body that flies along x and turns about z, in an app that draws 240 times a second.
fn flyer() -> (Sim, Entity) {
    let mut sim = app(Backend::Gpu, Readback::Resident);
    let torus = sim.mesh(&shapes::torus_240());
    let body = sim.spawn(ball_like(&torus, Vec3::ZERO, Vec3::X * 64.0));
    sim.set(body, AngularVelocity(Vec3::Z * 6.0));
    let frame = Duration::from_secs_f64(1.0 / FRAMES);
    sim.app.insert_resource(TimeUpdateStrategy::ManualDuration(frame));
    for _ in 0..12 {
        sim.app.update();
    }
    (sim, body)
}

fn flight(_: &Gpu) {
    let (mut sim, _) = flyer();
    let [mut before, _] = drawn(&sim);
    let angle = |[center, point]: [Vec3; 2]| (point - center).xy().to_angle();
    let mut angle_before = angle(drawn(&sim));
    for frame in 0..60 {
        sim.app.update();
        let now = drawn(&sim);
        let way = now[0].x - before.x;
        let even = 64.0 / FRAMES as f32;
        assert!((way - even).abs() < 0.01 * even, "frame {frame}: {way} m, not {even}");
        let turn = (angle(now) - angle_before).rem_euclid(std::f32::consts::TAU);
        let even = 6.0 / FRAMES as f32;
        assert!(
            (turn - even).abs() < 0.01 * even,
            "frame {frame}: {turn} rad, not {even}"
        );
        assert!(((now[1] - now[0]).length() - 0.5).abs() < 1e-4);
        before = now[0];
        angle_before = angle(now);
    }
}

fn paused(_: &Gpu) {
    let (mut sim, _) = flyer();
    let mut before = drawn(&sim)[0].x;
    sim.world().resource_mut::<Time<Physics>>().pause();
    for frame in 0..12 {
        sim.app.update();
        let now = drawn(&sim)[0].x;
        // In the first frames the tick before is drawn to its end.
        assert!(
            now >= before && (frame < 5 || now == before),
            "frame {frame}: {before} to {now}"
        );
        before = now;
    }
    sim.world().resource_mut::<Time<Physics>>().unpause();
    for _ in 0..12 {
        sim.app.update();
        let now = drawn(&sim)[0].x;
        assert!(now >= before, "{before} to {now}");
        before = now;
    }
}

fn placed(_: &Gpu) {
    let (mut sim, body) = flyer();
    sim.set(body, Transform::from_xyz(0.0, 50.0, 0.0));
    sim.set(body, Teleport);
    let mut arrived = false;
    for _ in 0..12 {
        sim.app.update();
        let height = drawn(&sim)[0].y;
        let is_there = (height - 50.0).abs() < 1e-4;
        assert!(is_there || height.abs() < 1e-4, "{height}");
        arrived |= is_there;
    }
    assert!(arrived);
}
