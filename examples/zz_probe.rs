use bevy::prelude::*;
use bevy_faceoff::prelude::*;
use std::time::Instant;
fn main() {
    let capsules = std::env::args().any(|a| a == "capsules");
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, FaceoffHeadlessPlugins::default().set(StepPlugin { backend: Backend::Cpu, ..default() })))
        .insert_resource(SolverSettings { sleeping: false, ..default() });
    app.finish(); app.cleanup();
    let world = app.world_mut();
    let half = 4.0f32; let height = 12.0;
    for (x, z) in [(1.0f32, 0.0f32), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
        world.spawn((CuboidCollider { size: Vec3::new(1.0 + 9.0 * z.abs(), height, 1.0 + 9.0 * x.abs()), rounding: 0.0 }, Transform::from_xyz(x * (half + 0.5), 6.0, z * (half + 0.5))));
    }
    world.spawn((CuboidCollider::new(16.0, 1.0, 16.0), Transform::from_xyz(0.0, -0.5, 0.0)));
    let n = if capsules { 1000 } else { 2000 };
    for i in 0..n {
        let (x, z, y) = (i % 8, i / 8 % 8, i / 64);
        let aside = 0.05 * (y % 5) as f32;
        let at = Vec3::new(x as f32 - 3.5, y as f32, z as f32 - 3.5) * 0.9 + Vec3::new(aside, 1.0, 0.5 * aside);
        let t = Transform::from_translation(at).with_rotation(Quat::from_rotation_z(0.3 * (i % 7) as f32));
        if capsules { world.spawn((RigidBody::Dynamic, CapsuleCollider::new(0.2, 0.5), t)); } else { world.spawn((RigidBody::Dynamic, BallCollider::new(0.25), t)); }
    }
    let mut sum = 0.0;
    for step in 0..512 {
        let s = Instant::now();
        app.world_mut().run_schedule(FaceoffStep);
        let ms = s.elapsed().as_secs_f64() * 1e3;
        if step >= 384 { sum += ms }
        if step % 128 == 127 { println!("{step}: {ms:.2} ms {:#?}", app.world().resource::<StepReport>()); }
    }
    println!("rest {:.2} ms", sum / 128.0);
}
