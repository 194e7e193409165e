//! Many bodies in one place, and limits that they exceed.

use crate::world::World;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::plugin::settings::StepLimits;
use bevy_faceoff::prelude::*;
use bevy_faceoff::types::stage::Stage;
use glam::{Quat, Vec3};

/// Fifteen bodies to the side of the crowd: a floor and two columns of boxes that rest on it and touch each other.
const ASIDE: usize = 15;

/// `crowd` tori at nearly the same place above a floor, and a few boxes that stand aside.
fn crowded(crowd: usize, response: Response, limits: StepLimits) -> World {
    let mut world = World::new();
    world.state.input.config.response = response;
    world.state.input.config.limits = limits;
    let cube = world.mesh(&shapes::cube(1.0));
    let torus = world.mesh(&shapes::torus_240());
    let wide = Vec3::new(100.0, 1.0, 100.0);
    world.add(RigidBody::Static, cube, wide, Vec3::new(0.0, -0.5, 0.0), Quat::IDENTITY);
    for i in 1..ASIDE {
        let (column, height) = (i % 2, (i - 1) / 2);
        let position = Vec3::new(20.0 + 5.0 * column as f32, 0.499 + 0.998 * height as f32, 0.0);
        world.add(RigidBody::Dynamic, cube, Vec3::ONE, position, Quat::IDENTITY);
    }
    for i in 0..crowd {
        let position = Vec3::new(0.01 * (i % 10) as f32, 0.45, 0.01 * (i / 10) as f32);
        world.add(RigidBody::Dynamic, torus, Vec3::ONE, position, Quat::IDENTITY);
    }
    world
}

/// Pairs of bodies that touch, of which none is in the crowd.
fn aside(world: &World) -> Vec<[u32; 2]> {
    let pairs = world.state.results.contacts.pairs.iter().map(|pair| pair.bodies);
    pairs
        .filter(|pair| pair.iter().all(|&i| (i as usize) < ASIDE))
        .collect()
}

const FEW_BODIES: StepLimits = StepLimits {
    body_pairs: 2000,
    face_pairs: usize::MAX,
};
const FEW_FACES: StepLimits = StepLimits {
    body_pairs: usize::MAX,
    face_pairs: 100_000,
};

#[test]
fn a_crowd_loses_pairs_and_the_others_lose_none() {
    for response in [Response::None, Response::Impulse, Response::Contacts] {
        for limits in [FEW_BODIES, FEW_FACES] {
            let mut free = crowded(0, response, StepLimits::default());
            let mut world = crowded(200, response, limits);
            free.step();
            world.step();
            let results = &world.state.results;
            assert!(
                results.crowd.bodies > 100 && results.crowd.bodies <= 200,
                "{response:?}, {limits:?}: {:?}",
                results.crowd
            );
            assert!(results.crowd.example as usize >= ASIDE);
            assert_eq!(free.state.results.crowd.bodies, 0);
            assert_eq!(aside(&world), aside(&free), "{response:?}, {limits:?}");
            // The crowd still stands on the floor, and some of its pairs are left.
            let pairs = &results.contacts.pairs;
            let on_floor = pairs
                .iter()
                .filter(|pair| pair.bodies[0] == 0 && pair.bodies[1] as usize >= ASIDE);
            assert_eq!(on_floor.count(), 200, "{response:?}, {limits:?}");
            let within = pairs.iter().filter(|pair| pair.bodies[0] as usize >= ASIDE).count();
            assert!(
                within > 0 && within < 200 * 199 / 2,
                "{response:?}, {limits:?}: {within}"
            );
            assert!(results.sphere_pairs.len() <= limits.body_pairs.saturating_mul(2));
            assert!(results.contacts.faces.len() <= limits.face_pairs);
        }
    }
}

/// More bodies on the floor than are tested before the first look at the limit.
#[test]
fn nobody_of_a_large_crowd_loses_the_floor() {
    let limits = StepLimits {
        body_pairs: usize::MAX,
        face_pairs: 50_000,
    };
    let mut free = crowded(0, Response::Contacts, StepLimits::default());
    let mut world = crowded(300, Response::Contacts, limits);
    free.step();
    world.step();
    let pairs = &world.state.results.contacts.pairs;
    let on_floor = pairs
        .iter()
        .filter(|pair| pair.bodies[0] == 0 && pair.bodies[1] as usize >= ASIDE);
    assert_eq!(on_floor.count(), 300);
    assert_eq!(aside(&world), aside(&free));
    assert!(world.state.results.crowd.bodies > 0);
}

/// A dense floor of boxes has eight partners each. Its share of the limit would be less than two.
#[test]
fn a_small_crowd_takes_nothing_from_many_others() {
    let lattice = |crowd: usize, body_pairs: usize| {
        let mut world = World::weightless();
        world.state.input.config.response = Response::None;
        world.state.input.config.limits.body_pairs = body_pairs;
        let cube = world.mesh(&shapes::cube(1.0));
        for i in 0..900 {
            let position = Vec3::new((i % 30) as f32, 0.0, (i / 30) as f32);
            world.add(RigidBody::Dynamic, cube, Vec3::ONE, position, Quat::IDENTITY);
        }
        for _ in 0..crowd {
            world.add(
                RigidBody::Dynamic,
                cube,
                Vec3::ONE,
                Vec3::new(0.0, 50.0, 0.0),
                Quat::IDENTITY,
            );
        }
        world.step();
        world.state.results
    };
    let (free, results) = (lattice(0, usize::MAX), lattice(300, 8000));
    let aside: Vec<_> = results
        .sphere_pairs
        .iter()
        .filter(|pair| pair[1] < 900)
        .copied()
        .collect();
    assert!(aside.len() > 900 * 3);
    assert_eq!(aside, free.sphere_pairs);
    assert!(
        results.crowd.bodies > 100 && results.crowd.example >= 900,
        "{:?}",
        results.crowd
    );
    let within = results.sphere_pairs.len() - aside.len();
    assert!(within >= 300, "{within}");
    assert!(results.sphere_pairs.len() <= 8000);
}

#[test]
fn what_is_left_out_does_not_depend_on_threads() {
    let run = |threads: usize, limits| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut world = crowded(150, Response::Contacts, limits);
        pool.install(|| (0..3).for_each(|_| world.step()));
        let results = &world.state.results;
        let poses: Vec<_> = world.state.input.bodies.position.iter().map(|p| p.to_array()).collect();
        (
            results.sphere_pairs.clone(),
            results.contacts.faces.clone(),
            results.crowd,
            poses,
        )
    };
    for limits in [FEW_BODIES, FEW_FACES] {
        assert_eq!(run(1, limits), run(4, limits));
    }
}

/// So many bodies that threads share the work of sorting them. Which pairs are kept follows from where the bodies are
/// now, not from threads, nor from where they were before.
#[test]
fn what_a_large_crowd_loses_follows_from_the_bodies_alone() {
    let run = |threads: usize, before: &[f32]| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut world = World::weightless();
        world.state.input.config.response = Response::None;
        world.state.input.config.limits.body_pairs = 10_000;
        let cube = world.mesh(&shapes::cube(1.0));
        let mut random = fastrand::Rng::with_seed(3);
        let places: Vec<Vec3> = (0..40_000)
            .map(|_| 60.0 * Vec3::from_array([0; 3].map(|_| random.f32())))
            .collect();
        for (i, &place) in places.iter().enumerate() {
            let kind = if i % 5 == 0 {
                RigidBody::Static
            } else {
                RigidBody::Dynamic
            };
            world.add(kind, cube, Vec3::ONE, place, Quat::IDENTITY);
        }
        pool.install(|| {
            for spread in before.iter().chain(&[1.0]) {
                for (center, place) in world.state.input.bodies.center.iter_mut().zip(&places) {
                    *center = place * spread;
                }
                bevy_faceoff::step::cpu::run(Stage::BroadPhase, &mut world.state);
            }
        });
        assert!(world.state.results.crowd.bodies > 1000);
        (world.state.results.sphere_pairs, world.state.results.crowd)
    };
    let alone = run(1, &[]);
    for threads in [2, 4] {
        assert_eq!(run(threads, &[]), alone, "{threads} threads");
    }
    // Bodies far apart have larger cells, and bodies that gather keep these for some time.
    for before in [&[2.0; 3][..], &[1.0; 3], &[40.0, 3.0, 1.0]] {
        assert_eq!(run(1, before), alone, "after {before:?}");
    }
}

#[test]
fn a_crowd_pushes_itself_apart() {
    let mut world = crowded(60, Response::Contacts, FEW_FACES);
    let spread = |world: &World| {
        let crowd = &world.state.input.bodies.position[ASIDE..];
        let middle = crowd.iter().sum::<Vec3>() / crowd.len() as f32;
        crowd.iter().map(|p| p.distance(middle)).fold(0.0, f32::max)
    };
    let before = spread(&world);
    (0..60).for_each(|_| world.step());
    assert!(spread(&world) > 2.0 * before, "{before} to {}", spread(&world));
    let below = world.state.input.bodies.position[1..]
        .iter()
        .filter(|p| p.y < 0.1)
        .count();
    assert_eq!(below, 0, "bodies fell through the floor");
}

#[test]
fn one_pair_may_have_more_faces_than_the_limit() {
    let mut world = crowded(
        2,
        Response::None,
        StepLimits {
            face_pairs: 1,
            ..StepLimits::default()
        },
    );
    world.step();
    assert!(!world.state.results.contacts.pairs.is_empty());
    assert!(world.state.results.contacts.faces.len() > 1);
}

#[test]
fn without_a_crowd_the_limits_change_nothing() {
    let run = |limits| {
        let mut world = crowded(30, Response::Contacts, limits);
        (0..5).for_each(|_| world.step());
        assert_eq!(world.state.results.crowd.bodies, 0);
        world.state.input.bodies.position.clone()
    };
    assert_eq!(run(StepLimits::default()), run(StepLimits::NONE));
}

#[test]
#[ignore = "takes minutes"]
fn a_million_bodies_in_one_place() {
    for response in [Response::Impulse, Response::Contacts] {
        let mut world = World::weightless();
        world.state.input.config.response = response;
        let torus = world.mesh(&shapes::torus_240());
        for _ in 0..1_000_000 {
            world.add(RigidBody::Dynamic, torus, Vec3::ONE, Vec3::ZERO, Quat::IDENTITY);
        }
        for _ in 0..2 {
            let start = std::time::Instant::now();
            world.step();
            let results = &world.state.results;
            println!(
                "{response:?}: {:.1} s, {} sphere pairs, {} faces, {:?}",
                start.elapsed().as_secs_f32(),
                results.sphere_pairs.len(),
                results.contacts.faces.len(),
                results.crowd,
            );
            assert!(results.crowd.bodies > 0);
            assert!(world.state.input.bodies.position.iter().all(|p| p.is_finite()));
        }
    }
}
