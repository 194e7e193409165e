//! Scenes from games: bodies in flight together, overlapping bodies, and landings. The work per step is counted.

use crate::world::{World, any_turn};
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::state::Body;
use bevy_faceoff::types::body::RigidBody;
use glam::{Quat, Vec3};

/// Work of one step: sphere pairs, near pairs, contact points, collision substeps.
type Work = [usize; 4];

fn work(world: &World) -> Work {
    let state = &world.state;
    [
        state.results.sphere_pairs.len(),
        state.results.near_pairs.len(),
        state.results.manifolds.points.len(),
        state.results.collision_substeps as usize,
    ]
}

/// A block of `side` cubed bodies, `gap` apart.
fn block(world: &mut World, mesh: &TriMesh, side: usize, gap: f32, lowest: f32, velocity: Vec3) {
    let mesh = world.mesh(mesh);
    for i in 0..side.pow(3) {
        let at = [i % side, i / side % side, i / side / side].map(|k| k as f32);
        world.put(&Body {
            linear_velocity: velocity,
            ..Body::at_rest(mesh, Vec3::from(at) * gap + Vec3::Y * lowest, Quat::IDENTITY, Vec3::ONE)
        });
    }
}

#[test]
fn a_common_velocity_costs_nothing_and_changes_nothing() {
    for (mesh, gap) in [
        (shapes::ball(0.25, 3), 0.6),
        (shapes::ball(0.25, 3), 0.501),
        (shapes::torus_240(), 2.2),
    ] {
        formation(&mesh, 3, gap, 32);
    }
}

/// A formation at rest, and the same in flight at several speeds.
pub fn formation(mesh: &TriMesh, side: usize, gap: f32, steps: usize) {
    let fly = |velocity: Vec3| -> (Vec<Work>, Vec<Vec3>) {
        let mut world = World::weightless();
        block(&mut world, mesh, side, gap, 0.0, velocity);
        let works = (0..steps).map(|_| {
            world.step();
            work(&world)
        });
        let works = works.collect();
        let time = steps as f32 * world.state.input.config.dt;
        let places = (0..world.state.input.bodies.len()).map(|i| world.center(i).as_vec3() - velocity * time);
        (works, places.collect())
    };
    let (works, places) = fly(Vec3::ZERO);
    for speed in [3.0, 10.0, 100.0] {
        let velocity = Vec3::new(0.6, 0.0, 0.8) * speed;
        let (moving, moved) = fly(velocity);
        assert_eq!(works, moving, "at {speed} m/s");
        // Rounding error of single precision so far from the origin.
        let tolerance = 1.0e-5 + 4.0 * f32::EPSILON * speed * steps as f32;
        for (p, q) in places.iter().zip(&moved) {
            assert!(p.distance(*q) < tolerance, "at {speed} m/s {p} is {q}");
        }
    }
}

#[test]
fn a_landing_swarm_has_small_margins() {
    swarm(3, 26.0);
}

/// A block of finely tessellated balls that falls from `height`. Its layers land one after the other, and no ball may
/// get lost.
pub fn swarm(side: usize, height: f32) {
    let mut world = World::new();
    let ball = shapes::ball(0.25, 3);
    block(
        &mut world,
        &ball,
        side,
        0.6,
        0.3,
        Vec3::NEG_Y * (2.0 * 9.81 * height).sqrt(),
    );
    let cube = world.mesh(&shapes::cube(1.0));
    world.floor(cube);
    let count = side.pow(3);
    for _ in 0..64 * 2 {
        world.step();
        let state = &world.state;
        for pair in &state.results.near_pairs {
            // A quarter of a ball, with the safety factor, and the contact margin.
            let most = if state.results.collision_substeps < 8 {
                0.5 * 0.25 * 1.5 + 0.006
            } else {
                0.5
            };
            assert!(
                pair.margin <= most,
                "{} in {} collision substeps",
                pair.margin,
                state.results.collision_substeps
            );
        }
    }
    for i in 0..count {
        let center = world.center(i);
        // At most as high as a column of them.
        assert!((0.2..0.5 * side as f64).contains(&center.y), "{i} is at {center}");
    }
    assert!(world.deepest() < 0.005, "{} m deep", world.deepest());
}

#[test]
fn a_body_does_not_sleep_before_it_is_pushed_out() {
    for (shape, depth) in [
        (shapes::ball(0.5, 3), 0.6),
        (shapes::ball(0.5, 3), 0.3),
        (shapes::cube(1.0), 0.7),
        (shapes::cube(1.0), 0.03),
    ] {
        pushed_out(&shape, depth);
    }
}

/// What is not deep is pushed out at no more than `SolverSettings::max_depenetration_speed`, which only large bodies
/// reach.
#[test]
fn a_large_body_is_pushed_out_at_three_metres_per_second() {
    let mut world = World::new();
    let [large, block] = [10.0, 40.0].map(|size| world.mesh(&shapes::cube(size)));
    world.add(RigidBody::Dynamic, large, Vec3::ONE, Vec3::Y * 4.7, Quat::IDENTITY);
    world.add(RigidBody::Static, block, Vec3::ONE, Vec3::NEG_Y * 20.0, Quat::IDENTITY);
    let mut fastest = 0.0f64;
    for _ in 0..64 {
        let before = world.center(0).y;
        world.step();
        fastest = fastest.max(64.0 * (world.center(0).y - before));
    }
    assert!((2.5..3.1).contains(&fastest), "{fastest} m/s");
    assert!((world.center(0).y - 5.0).abs() < 0.02, "{}", world.center(0));
}

/// A body with a radius of half a metre that starts `depth` metres deep in the top of a block.
pub fn pushed_out(shape: &TriMesh, depth: f32) {
    let mut world = World::new();
    world.state.input.config.solver.sleeping = true;
    let (mesh, cube) = (world.mesh(shape), world.mesh(&shapes::cube(4.0)));
    world.add(
        RigidBody::Dynamic,
        mesh,
        Vec3::ONE,
        Vec3::Y * (0.5 - depth),
        Quat::IDENTITY,
    );
    world.add(RigidBody::Static, cube, Vec3::ONE, Vec3::NEG_Y * 2.0, Quat::IDENTITY);
    let mut speeds = Vec::new();
    for _ in 0..64 * 3 {
        let before = world.center(0).y;
        world.step();
        let height = world.center(0).y;
        speeds.push(64.0 * (height - before));
        assert!(!world.state.results.asleep[0] || height > 0.495, "asleep at {height}");
    }
    assert!(world.state.results.asleep[0], "it is out, and at rest");
    assert!((world.center(0).y - 0.5).abs() < 0.01, "{}", world.center(0));
    // The depenetration speed decreases with the depth, as that of a damped spring, by less than half per step.
    for (k, pair) in speeds.windows(2).enumerate() {
        let falls = pair[1] <= pair[0] + 0.1 && pair[1] >= 0.5 * pair[0] - 0.05;
        assert!(falls, "from {} to {} m/s at step {k}", pair[0], pair[1]);
    }
}

#[test]
fn two_overlapping_bodies_separate_before_they_sleep() {
    for shape in [
        shapes::cube(1.0),
        shapes::torus_240(),
        shapes::knot_1120(),
        shapes::ball(0.5, 3),
    ] {
        overlapping(&shape, 2, Vec3::X * 0.3);
    }
}

#[test]
fn bodies_in_the_same_place_separate() {
    for shape in [shapes::cube(1.0), shapes::torus_240(), shapes::ball(0.5, 2)] {
        for count in [2, 5, 20] {
            overlapping(&shape, count, Vec3::ZERO);
        }
    }
    // Positions that differ by rounding errors only count as the same place too.
    overlapping(&shapes::ball(0.5, 2), 2, Vec3::X * 1.0e-6);
    // Not turned, their planes are the same to the bit.
    for shape in [
        shapes::cube(1.0),
        shapes::torus_240(),
        shapes::knot_1120(),
        shapes::ball(0.5, 2),
    ] {
        turned_overlapping(&shape, 2, Vec3::ZERO, Quat::IDENTITY);
    }
}

/// `count` bodies of one mesh without gravity, each `apart` from the one before.
pub fn overlapping(mesh: &TriMesh, count: usize, apart: Vec3) {
    turned_overlapping(mesh, count, apart, any_turn(&mut fastrand::Rng::with_seed(5)));
}

fn turned_overlapping(mesh: &TriMesh, count: usize, apart: Vec3, turn: Quat) {
    let mut world = World::weightless();
    world.state.input.config.solver.sleeping = true;
    let mesh = world.mesh(mesh);
    for i in 0..count {
        world.add(
            RigidBody::Dynamic,
            mesh,
            Vec3::ONE,
            apart * i as f32 + Vec3::splat(3.0),
            turn,
        );
    }
    for step in 0..64 * 4 {
        world.step();
        let state = &world.state;
        let gap = 2.0 * state.input.bodies.radius[0] * state.input.config.solver.rest_offset;
        let deepest = world.deepest();
        let all_sleep = state.results.asleep.iter().all(|asleep| *asleep);
        assert!(!all_sleep || deepest <= gap, "asleep {deepest} m deep at step {step}");
        if step == 0 {
            assert_eq!(state.results.contacts.pairs.len(), count * (count - 1) / 2);
        }
    }
    assert!(world.deepest() < 1.0e-3, "{} m deep in the end", world.deepest());
    for i in 0..count {
        for j in 0..i {
            let distance = world.center(i).distance(world.center(j));
            assert!(distance > 0.2, "{i} and {j} are {distance} m apart");
        }
    }
}

#[test]
fn few_bodies_are_little_work() {
    for count in [1, 10] {
        let mut world = World::new();
        world.state.input.planes.push(Default::default());
        let cube = world.mesh(&shapes::cube(1.0));
        for i in 0..count {
            world.add(
                RigidBody::Dynamic,
                cube,
                Vec3::ONE,
                Vec3::new(1.5 * i as f32, 0.6, 0.0),
                Quat::IDENTITY,
            );
        }
        for _ in 0..64 {
            world.step();
            let [spheres, near, points, collision_substeps] = work(&world);
            // The spheres of neighbours overlap. The cubes are half a metre apart, and each lower corner has a point
            // with the plane.
            assert!(
                spheres < count && near == 0 && points <= 4 * count && collision_substeps == 1,
                "{:?}",
                work(&world)
            );
        }
    }
}

#[test]
fn a_distant_fast_body_adds_no_pair_and_no_collision_substep() {
    let play = |with_bullet: bool| -> Vec<[usize; 2]> {
        let mut world = World::new();
        let ball = world.mesh(&shapes::ball(0.05, 2));
        let cube = world.mesh(&shapes::cube(1.0));
        world.floor(cube);
        for i in 0..6 {
            world.add(
                RigidBody::Dynamic,
                cube,
                Vec3::ONE,
                Vec3::Y * (0.51 + 1.01 * i as f32),
                Quat::IDENTITY,
            );
        }
        if with_bullet {
            world.put(&Body {
                linear_velocity: Vec3::X * 100.0,
                gravity_scale: 0.0,
                ..Body::at_rest(ball, Vec3::new(100.0, 500.0, 0.0), Quat::IDENTITY, Vec3::ONE)
            });
        }
        let works = (0..64).map(|_| {
            world.step();
            let [spheres, near, _, collision_substeps] = work(&world);
            assert_eq!(collision_substeps, 1);
            [spheres, near]
        });
        works.collect()
    };
    assert_eq!(play(false), play(true));
}
