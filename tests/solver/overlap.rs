//! Deep penetration: bodies that overlap at their first contact.

use super::shapes::Shape;
use super::world::{World, check_below};
use bevy_faceoff::manifolds::ManifoldPoint;
use bevy_faceoff::solver::CollisionSubstep;
use glam::{DQuat, DVec3, Vec3};

const BALL: Shape = Shape::Sphere(0.5);

pub fn overlapping_balls_separate_slowly() {
    for apart in [0.0, 0.1, 0.5, 0.9, 0.97] {
        let mut world = World::new();
        let a = world.dynamic(BALL, 1.0, DVec3::ZERO);
        let b = world.dynamic(BALL, 1.0, DVec3::new(apart, 1.0e-9, 0.0));
        let mut fastest = 0.0f32;
        for _ in 0..64 * 3 {
            world.step(1);
            fastest = fastest.max(world.velocity(a).length()).max(world.velocity(b).length());
        }
        let gap = world.center(a).distance(world.center(b)) - 1.0;
        assert!(gap > 0.0, "{apart}: still {gap} deep");
        check_below(&format!("{apart} apart: fastest, m/s"), fastest as f64, 1.1);
        check_below("gap", gap, 0.3);
    }
}

pub fn a_heap_spawned_in_one_place_comes_apart() {
    let mut world = World::heavy();
    world.floor(0.0);
    let mut random = fastrand::Rng::with_seed(2);
    for _ in 0..40 {
        let at = DVec3::new(random.f64(), 1.0 + random.f64(), random.f64());
        world.dynamic(BALL, 1.0, at);
    }
    let mut fastest = 0.0f32;
    for _ in 0..64 * 6 {
        world.step(1);
        for i in 1..41 {
            fastest = fastest.max(world.velocity(i).length());
        }
    }
    // At most as fast as a fall from the top of the heap.
    check_below("fastest, m/s", fastest as f64, 9.0);
    check_below("deepest, metres", world.deepest() as f64, 0.01);
}

pub fn a_box_sunk_into_the_floor_comes_up() {
    for depth in [0.02, 0.1, 0.4] {
        let mut world = World::heavy();
        world.floor(0.0);
        let cube = world.dynamic(Shape::Box(DVec3::splat(0.5)), 1.0, DVec3::Y * (0.5 - depth));
        world.motion(cube).rotation = DQuat::from_rotation_y(0.3);
        let (mut fastest, mut highest) = (0.0f32, 0.0f64);
        for _ in 0..64 * 3 {
            world.step(1);
            fastest = fastest.max(world.velocity(cube).length());
            highest = highest.max(world.center(cube).y);
        }
        check_below(&format!("{depth} deep: fastest, m/s"), fastest as f64, 1.1);
        check_below("hops, metres", highest - 0.5, 0.08);
        check_below("deep in the end, metres", world.deepest() as f64, 1.0e-3);
    }
}

pub fn two_boxes_in_one_place_separate() {
    let mut world = World::new();
    let cube = Shape::Box(DVec3::splat(0.5));
    let a = world.dynamic(cube, 1.0, DVec3::ZERO);
    let b = world.dynamic(cube, 2.0, DVec3::new(0.3, 0.2, 0.1));
    world.motion(b).rotation = DQuat::from_rotation_x(0.7);
    let mut fastest = 0.0f32;
    for _ in 0..64 * 3 {
        world.step(1);
        fastest = fastest.max(world.velocity(a).length()).max(world.velocity(b).length());
    }
    check_below("fastest, m/s", fastest as f64, 1.1);
    check_below("deepest, metres", world.deepest() as f64, 1.0e-3);
}

/// Two balls that overlap and have points with opposed normals, as thin parts of meshes do. With `approach` they touch
/// before they overlap.
fn disputed(approach: bool) -> (World, f64) {
    let mut world = World::new();
    world.dynamic(BALL, 1.0, DVec3::ZERO);
    world.dynamic(BALL, 1.0, DVec3::new(1.005, 0.0, 0.0));
    if approach {
        world.step(1);
        assert_ne!(world.solver.saved_pairs(), Some(0));
    }
    world.motion(0).center = DVec3::ZERO;
    world.motion(1).center = DVec3::X * 0.97;
    let collision_substep = CollisionSubstep {
        dt: world.dt,
        substeps: 8,
        gravity: Vec3::ZERO,
    };
    for _ in 0..64 {
        world.detect(world.dt);
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
        world.solve(&collision_substep);
    }
    let apart = world.center(1).x - world.center(0).x;
    (world, apart)
}

pub fn points_whose_normals_conflict_with_the_last_contact_are_ignored() {
    let (_, apart) = disputed(true);
    assert!(apart > 1.0, "pushed back to the side they came from: {apart}");
}

pub fn a_new_pair_with_opposed_normals_is_in_deep_penetration() {
    let (world, apart) = disputed(false);
    assert!(apart > 1.0, "{apart}");
    check_below("fastest, m/s", world.velocity(0).length() as f64, 1.1);
}
