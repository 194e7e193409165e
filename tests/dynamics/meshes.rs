//! Different meshes poured into a bin.

use crate::world::World;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::types::body::RigidBody;
use glam::{Quat, Vec3};

#[test]
fn bodies_poured_into_a_bin_come_to_rest() {
    for (name, mesh, count, seconds) in [
        ("tori", shapes::torus_240(), 40, 6),
        ("knots", shapes::knot_1120(), 12, 6),
    ] {
        let mut world = World::new();
        let cube = world.mesh(&shapes::cube(1.0));
        let poured = world.mesh(&mesh);
        world.floor(cube);
        for (scale, at) in [
            (Vec3::new(1.0, 30.0, 6.0), Vec3::new(-2.0, 15.0, 0.0)),
            (Vec3::new(1.0, 30.0, 6.0), Vec3::new(2.0, 15.0, 0.0)),
            (Vec3::new(6.0, 30.0, 1.0), Vec3::new(0.0, 15.0, -2.0)),
            (Vec3::new(6.0, 30.0, 1.0), Vec3::new(0.0, 15.0, 2.0)),
        ] {
            world.add(RigidBody::Static, cube, scale, at, Quat::IDENTITY);
        }
        let mut random = fastrand::Rng::with_seed(3);
        for i in 0..count {
            let side = if i % 2 == 0 { 0.54 } else { -0.54 };
            let at = Vec3::new(1.6 * (random.f32() - 0.5), 0.8 + 0.9 * (i / 2) as f32, side);
            let turn = Quat::from_scaled_axis(Vec3::new(random.f32(), random.f32(), random.f32()) * 3.0);
            world.add(RigidBody::Dynamic, poured, Vec3::splat(0.8), at, turn);
        }
        let mut deepest = 0.0f32;
        for _ in 0..64 * seconds {
            world.step();
            deepest = deepest.max(world.deepest());
        }
        let (still_deep, fastest) = (world.deepest(), world.fastest());
        println!("{name}: deepest before {deepest:.4} m, then {still_deep:.4} m, fastest {fastest:.4} m/s");
        for i in 5..5 + count {
            let c = world.center(i);
            assert!(c.x.abs() < 1.5 && c.z.abs() < 1.5 && c.y > 0.0, "{name} {i} is at {c}");
        }
        // The last ones land at 18 m/s.
        assert!(still_deep < 0.01 && deepest < 0.2, "{name}: {still_deep}, {deepest}");
        assert!(fastest < 0.1, "{name}: {fastest}");
    }
}
