//! Determinism: the same input gives the same bits, with any number of threads, and whatever other islands there are.

use super::cloud::heap;
use super::shapes::Shape;
use super::world::World;
use bevy_faceoff::solver::SolverBodies;
use glam::{DVec3, Vec3};

fn bits(bodies: &SolverBodies) -> String {
    format!("{:?} {:?}", bodies.motions, bodies.sleep)
}

#[test]
fn threads_and_runs_give_the_same_bits() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut world = heap();
        pool.install(|| world.step(150));
        assert!(world.manifolds.pairs.len() > 300, "{}", world.manifolds.pairs.len());
        bits(&world.bodies)
    };
    let first = run(1);
    for threads in [1, 2, 7] {
        assert!(run(threads) == first, "{threads} threads");
    }
}

/// Adds a few bodies near a place: one of eight kinds of small scenes, each time another one of its kind.
fn small_scene(world: &mut World, number: usize) {
    let mut random = fastrand::Rng::with_seed(number as u64);
    let mut some = move |size: f64| size * (1.0 + 0.1 * (random.f64() - 0.5));
    let at = DVec3::X * 20.0 * number as f64;
    let cube = Shape::Box(DVec3::splat(0.5));
    let first = world.bodies.len();
    match number % 8 {
        0 => {
            let ball = world.dynamic(Shape::Sphere(0.5), 1.0, at + DVec3::Y * 0.5);
            world.motion(ball).angular_velocity = Vec3::Z * some(6.0) as f32;
        }
        1 => {
            let ball = world.dynamic(Shape::Sphere(0.5), 1.0, at + DVec3::Y * some(0.8));
            world.bodies.bodies[ball].restitution = 0.8;
        }
        2 => {
            for level in 0..4 {
                let aside = DVec3::X * some(0.1) * f64::from(level % 2);
                world.dynamic(cube, some(1.0) as f32, at + aside + DVec3::Y * (0.5 + f64::from(level)));
            }
        }
        // The light cube needs more substeps.
        3 => {
            world.dynamic(cube, 1.0, at + DVec3::Y * 0.5);
            world.dynamic(cube, some(60.0) as f32, at + DVec3::Y * 1.5);
        }
        // Deep in each other.
        4 => {
            world.dynamic(cube, 1.0, at + DVec3::Y * 3.0);
            world.dynamic(cube, 1.0, at + DVec3::new(some(0.3), 3.2, 0.1));
        }
        5 => {
            for i in 0..3 {
                let ball = world.dynamic(
                    Shape::Sphere(0.5),
                    some(1.0) as f32,
                    at + DVec3::new(some(1.1) * i as f64, 4.0, 0.0),
                );
                world.motion(ball).linear_velocity = Vec3::X * some(3.0) as f32 * (1.0 - i as f32);
                world.bodies.bodies[ball].restitution = 1.0;
            }
        }
        6 => {
            let slider = world.dynamic(cube, 1.0, at + DVec3::Y * 0.5);
            world.motion(slider).linear_velocity = Vec3::new(some(2.0) as f32, 0.0, 0.7);
        }
        _ => {
            for [x, y] in [[-0.6, 0.5], [0.6, 0.5], [0.0, 1.5]] {
                world.dynamic(cube, some(1.0) as f32, at + DVec3::new(x, y, 0.0));
            }
        }
    }
    for body in first..world.bodies.len() {
        world.bodies.bodies[body].friction = 0.4;
    }
}

fn on_a_floor(scenes: impl Iterator<Item = usize>) -> World {
    let mut world = World::heavy();
    // Their number is otherwise that of the fastest of all bodies.
    world.collision_substeps = Some(2);
    world.floor(0.0);
    scenes.for_each(|number| small_scene(&mut world, number));
    world
}

#[test]
fn an_island_moves_with_the_same_bits_whatever_others_there_are() {
    const SCENES: usize = 64;
    let mut all = on_a_floor(0..SCENES);
    let mut alone: Vec<World> = (0..SCENES).map(|number| on_a_floor(number..number + 1)).collect();
    for step in 0..120 {
        all.step(1);
        let mut next = 1;
        for (number, world) in alone.iter_mut().enumerate() {
            world.step(1);
            let own = &world.bodies.motions[1..];
            let same = &all.bodies.motions[next..next + own.len()];
            assert_eq!(format!("{own:?}"), format!("{same:?}"), "scene {number}, step {step}");
            next += own.len();
        }
    }
    let is_low = |world: &World| world.bodies.motions[1..].iter().all(|motion| motion.center.y < 4.5);
    assert!(alone.iter().all(is_low));
}
