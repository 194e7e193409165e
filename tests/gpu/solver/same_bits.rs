//! Equal inputs give the same bits, whatever the capacity of the lists.

use super::many::cloud;
use super::shapes::Shape;
use super::twin::Twin;
use super::world::World;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::solver::gpu::SolverCapacity;
use glam::DVec3;

pub fn heap() -> World {
    let mut world = World::heavy();
    world.settings.sleeping = true;
    world.floor(0.0);
    let mut random = fastrand::Rng::with_seed(7);
    for i in 0..24 {
        let at = DVec3::new(random.f64(), 0.6 + 0.7 * i as f64, random.f64());
        if i % 2 == 0 {
            world.dynamic(Shape::Sphere(0.4), 1.0, at);
        } else {
            world.dynamic(Shape::Box(DVec3::new(0.3, 0.4, 0.5)), 1.0, at);
        }
    }
    world
}

fn bits(twin: &Twin) -> String {
    // Debug formatting gives the shortest text that gives a float back.
    format!("{:?}", twin.world.bodies.motions)
}

pub fn the_same_bits_again(gpu: &Gpu) {
    for make in [heap, || cloud(64, 0.5)] {
        let run = || {
            let mut twin = Twin::new(gpu, make());
            twin.step(64);
            bits(&twin)
        };
        let first = run();
        assert!(first == run(), "not the same bits");
    }
}

pub fn bits_do_not_depend_on_room(gpu: &Gpu) {
    let run = |capacity| {
        let mut twin = Twin::with_capacity(gpu, capacity, heap());
        twin.step(40);
        (bits(&twin), twin.solver.capacity())
    };
    // Every list has to grow, some of them with saved impulses.
    let tiny = SolverCapacity {
        bodies: 1,
        pairs: 1,
        points: 1,
    };
    let large = SolverCapacity {
        bodies: 70_000,
        pairs: 5000,
        points: 9000,
    };
    let (few, many) = (run(tiny), run(large));
    assert!(few.0 == many.0, "not the same bits");
    assert!(few.1.bodies >= 25 && few.1.points > 1, "{:?}", few.1);
    assert_eq!(many.1, large);
}
