//! Determinism: the same input gives the same bits, with any number of threads.

use super::shapes::Shape;
use super::world::World;
use bevy_faceoff::solver::SolverBodies;
use glam::DVec3;

pub fn heap() -> World {
    let mut world = World::heavy();
    world.settings.sleeping = true;
    world.floor(0.0);
    let mut random = fastrand::Rng::with_seed(4);
    for i in 0..300 {
        let at = DVec3::new((i % 6) as f64, 1.0 + (i / 36) as f64, (i / 6 % 6) as f64) * 1.05;
        let at = at + DVec3::new(random.f64(), random.f64(), random.f64()) * 0.1;
        let shape = if i % 3 == 0 {
            Shape::Box(DVec3::splat(0.4))
        } else {
            Shape::Sphere(0.5)
        };
        let body = world.dynamic(shape, 1.0, at);
        world.bodies.bodies[body].restitution = 0.3;
    }
    world
}

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
