//! Bodies that overlap when they first meet, or whose points disagree.

use super::shapes::Shape;
use super::twin::{Apart, Twin, all, both, solve_on_cpu};
use super::world::World;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::manifolds::ManifoldPoint;
use bevy_faceoff::solver::CollisionSubstep;
use glam::{DQuat, DVec3, Vec3};

const BALL: Shape = Shape::Sphere(0.5);

pub fn overlapping_balls_part(gpu: &Gpu) {
    for apart in [0.0, 0.5, 0.97] {
        let make = || {
            let mut world = World::new();
            world.dynamic(BALL, 1.0, DVec3::ZERO);
            world.dynamic(BALL, 2.0, DVec3::new(apart, 1.0e-9, 0.0));
            world
        };
        let (cpu, twin) = both(gpu, make, 1.5);
        Apart::of(&cpu, &twin.world).check(&format!("{apart} apart"), all(1.0e-4));
        let gap = twin.world.center(0).distance(twin.world.center(1)) - 1.0;
        assert!(gap > 0.0, "{apart}: still {gap} deep");
    }
}

pub fn a_box_sunk_into_the_floor_comes_up(gpu: &Gpu) {
    for depth in [0.02, 0.4] {
        let make = || {
            let mut world = World::heavy();
            world.floor(0.0);
            // Aside from where the half-space has its centre: that is not the way out.
            let at = DVec3::new(2.0, 0.5 - depth, 1.0);
            let cube = world.dynamic(Shape::Box(DVec3::splat(0.5)), 1.0, at);
            world.motion(cube).rotation = DQuat::from_rotation_y(0.3);
            world
        };
        let (cpu, twin) = both(gpu, make, 1.0);
        Apart::of(&cpu, &twin.world).check(&format!("{depth} deep"), all(1.0e-4));
    }
}

/// Two balls of which one is to be moved into the other.
fn two_balls() -> World {
    let mut world = World::new();
    world.dynamic(BALL, 1.0, DVec3::ZERO);
    world.dynamic(BALL, 1.0, DVec3::new(1.005, 0.0, 0.0));
    world
}

/// Adds a point that pushes the wrong way, as thin parts of meshes do.
fn contradict(world: &mut World) {
    let depth = world.center(0).distance(world.center(1)) as f32 - 1.0;
    if depth < 0.0 && !world.manifolds.points.is_empty() {
        let wrong = ManifoldPoint {
            normal: Vec3::NEG_X,
            separation: 1.5 * depth,
            ..world.manifolds.points[0]
        };
        world.manifolds.points.push(wrong);
        world.manifolds.pairs[0].point_count += 1;
    }
}

pub fn points_that_disagree(gpu: &Gpu) {
    for approach in [true, false] {
        let mut cpu = two_balls();
        let mut twin = Twin::new(gpu, two_balls());
        if approach {
            cpu.step(1);
            twin.step(1);
        }
        for world in [&mut cpu, &mut twin.world] {
            world.motion(0).center = DVec3::ZERO;
            world.motion(1).center = DVec3::X * 0.97;
        }
        twin.put();
        let collision_substep = CollisionSubstep {
            dt: cpu.dt,
            substeps: 8,
            gravity: Vec3::ZERO,
        };
        for _ in 0..64 {
            cpu.detect(collision_substep.dt);
            contradict(&mut cpu);
            solve_on_cpu(&mut cpu, &collision_substep);
            twin.world.detect(collision_substep.dt);
            contradict(&mut twin.world);
            twin.solve(&collision_substep);
        }
        Apart::of(&cpu, &twin.world).check(&format!("approached {approach}"), all(1.0e-4));
        let apart = twin.world.center(1).x - twin.world.center(0).x;
        assert!(apart > 1.0, "pushed out the way they came: {apart}");
    }
}
