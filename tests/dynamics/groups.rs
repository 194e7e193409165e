//! Bodies that cannot meet pass through a step in collision substeps of their own.

use crate::world::World;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::state::Body;
use bevy_faceoff::types::body::RigidBody;
use glam::{Quat, Vec3};

/// A pile of so many tori on a floor. With `distant`, balls at 60 m/s hit a thin plate 200 m away, one every half
/// second.
fn pile(tori: usize, distant: bool) -> World {
    let mut world = World::new();
    let (torus, cube) = (world.mesh(&shapes::torus_240()), world.mesh(&shapes::cube(1.0)));
    world.floor(cube);
    for i in 0..tori {
        let turn = Quat::from_rotation_x(0.3 * i as f32);
        let at = Vec3::new(0.2 * (i % 3) as f32, 1.2 + 1.3 * i as f32, 0.0);
        world.add(RigidBody::Dynamic, torus, Vec3::ONE, at, turn);
    }
    if distant {
        let ball = world.mesh(&shapes::ball(0.05, 2));
        let at = Vec3::X * 200.0;
        world.put(&Body {
            gravity_scale: 0.0,
            ..Body::at_rest(cube, at, Quat::IDENTITY, Vec3::new(0.02, 2.0, 2.0))
        });
        for i in 1..=4 {
            world.put(&Body {
                linear_velocity: Vec3::NEG_X * 60.0,
                gravity_scale: 0.0,
                ..Body::at_rest(ball, at + Vec3::X * 30.0 * i as f32, Quat::IDENTITY, Vec3::ONE)
            });
        }
    }
    world
}

#[test]
fn an_impact_far_away_changes_nothing() {
    far_impact(12, 160);
}

/// A pile of so many tori, with and without an impact far away, for so many steps.
pub fn far_impact(tori: usize, steps: usize) {
    let (mut alone, mut beside) = (pile(tori, false), pile(tori, true));
    let mut had_own_pace = false;
    for step in 0..steps {
        alone.step();
        beside.step();
        for i in 0..=tori {
            assert_eq!(alone.center(i), beside.center(i), "step {step}, body {i}");
            assert_eq!(alone.velocity(i), beside.velocity(i), "step {step}, body {i}");
        }
        let [own, all] = [&alone, &beside].map(|world| world.state.results.collision_substeps);
        had_own_pace |= own < all && beside.state.results.mean_collision_substeps < all as f32;
    }
    assert!(had_own_pace, "the impacts need more collision substeps than the pile");
    let plate = beside.velocity(tori + 1);
    assert!(plate.x < -0.1, "the plate was hit: {plate}");
}

#[test]
fn billiard_balls_pass_on_their_momentum() {
    billiards();
}

/// A ball hits a rack. The balls that leave it hit others that were out of reach at the start of the step.
pub fn billiards() {
    let mut world = World::weightless();
    let radius = 0.03f32;
    let ball = world.mesh(&shapes::ball(radius.into(), 3));
    let mut put = |at: Vec3, velocity: Vec3| {
        world.put(&Body {
            linear_velocity: velocity,
            restitution: 1.0,
            ..Body::at_rest(ball, at, Quat::IDENTITY, Vec3::ONE)
        })
    };
    let gap = 2.01 * radius;
    put(Vec3::X * -0.5, Vec3::X * 5.0);
    for row in 0..4 {
        for i in 0..=row {
            let across = i as f32 - 0.5 * row as f32;
            put(Vec3::new(0.87 * gap * row as f32, gap * across, 0.0), Vec3::ZERO);
        }
    }
    let others = 60;
    for i in 0..others {
        let angle = i as f32 / others as f32 * std::f32::consts::TAU;
        let at = Vec3::new(angle.cos(), angle.sin(), 0.0) * (0.45 + 0.1 * (i % 3) as f32);
        if at.x > -0.3 {
            put(at, Vec3::ZERO);
        }
    }
    let count = world.state.input.bodies.len();
    let mut deepest = 0.0f32;
    for _ in 0..64 {
        world.step();
        deepest = deepest.max(world.deepest());
        let sum: Vec3 = (0..count).map(|i| world.velocity(i)).sum();
        assert!((sum - Vec3::X * 5.0).length() < 1.0e-3, "{sum}");
    }
    let energy: f32 = (0..count).map(|i| world.velocity(i).length_squared()).sum();
    assert!(energy < 25.1, "{energy}");
    let moving = (12..count).filter(|&i| world.velocity(i).length() > 0.1).count();
    println!(
        "deepest {deepest} m, energy {energy} of 25, {moving} of {} others move",
        count - 11
    );
    assert!(moving > 3, "{moving}");
    assert!(deepest < 0.5 * radius, "{deepest}");
}

#[test]
fn a_formation_with_a_fast_spinner_stays_together() {
    spinner();
}

/// A thin plate that turns fast beside a ball needs more collision substeps than the rest of a formation in flight. All
/// keep their places.
pub fn spinner() {
    let mut world = World::weightless();
    let (ball, cube) = (world.mesh(&shapes::ball(0.25, 3)), world.mesh(&shapes::cube(1.0)));
    let velocity = Vec3::X * 100.0;
    let mut places = Vec::new();
    for i in 0..20 {
        let at = Vec3::X * 0.8 * i as f32;
        places.push(at);
        world.put(&Body {
            linear_velocity: velocity,
            ..Body::at_rest(ball, at, Quat::IDENTITY, Vec3::ONE)
        });
    }
    let at = Vec3::new(4.0, 0.6, 0.0);
    places.push(at);
    world.put(&Body {
        linear_velocity: velocity,
        angular_velocity: Vec3::Y * 40.0,
        ..Body::at_rest(cube, at, Quat::IDENTITY, Vec3::new(0.6, 0.02, 0.6))
    });
    for step in 1..=64 {
        world.step();
        assert!(world.state.results.manifolds.points.is_empty() || world.deepest() < 0.0);
        for (i, at) in places.iter().enumerate() {
            let moved = world.center(i).as_vec3() - *at - velocity * (step as f32 / 64.0);
            assert!(moved.length() < 1.0e-3, "step {step}, body {i}: {moved}");
        }
    }
}

#[test]
fn a_wheel_on_its_axle_needs_few_collision_substeps() {
    wheel();
}

/// The rim of a wheel is fast, but the axle is far from it. A post beside the rim is not.
pub fn wheel() {
    const SPEED: f32 = 12.0;
    let substeps = |post: Option<Vec3>| {
        let mut world = World::weightless();
        let ring = world.mesh(&shapes::torus(24, 8, 0.88, 0.12));
        let cube = world.mesh(&shapes::cube(1.0));
        let wheel = world.put(&Body {
            angular_velocity: Vec3::Z * SPEED,
            ..Body::at_rest(ring, Vec3::ZERO, Quat::IDENTITY, Vec3::ONE)
        });
        for at in [Vec3::ZERO].into_iter().chain(post) {
            world.add(
                RigidBody::Static,
                cube,
                Vec3::new(0.1, 0.1, 3.0),
                at,
                Quat::from_rotation_z(0.3),
            );
        }
        let mut most = 0;
        for step in 0..32 {
            world.step();
            most = most.max(world.state.results.collision_substeps);
            assert!(
                world.center(wheel).length() < 1.0e-5 && world.state.results.manifolds.points.is_empty(),
                "step {step}: it touches nothing"
            );
        }
        most
    };
    let [alone, beside] = [None, Some(Vec3::X * 1.2)].map(substeps);
    println!("{alone} with an axle, {beside} with a post");
    assert_eq!([alone, beside], [1, 8]);
}
