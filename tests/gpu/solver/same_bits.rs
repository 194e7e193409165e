//! The same input gives the same bits, whatever the capacity of the lists; and bodies may be renumbered.

use super::many::cloud;
use super::shapes::Shape;
use super::twin::{Apart, Twin, all};
use super::world::World;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::solver::gpu::SolverCapacity;
use glam::{DVec3, Vec3};

fn heap() -> World {
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
    // Of floats the shortest text that gives them back.
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

/// Gives every body the number that `new_numbers` says; keys stay.
fn renumber(world: &mut World, new_numbers: &[u32]) {
    let old = std::mem::take(&mut world.bodies);
    let shapes = world.shapes.clone();
    for new in 0..new_numbers.len() as u32 {
        let i = new_numbers.iter().position(|&n| n == new).unwrap();
        world.bodies.push(old.keys[i], old.bodies[i], old.motions[i]);
        world.shapes[new as usize] = shapes[i];
    }
}

pub fn new_numbers_keep_the_impulses(gpu: &Gpu) {
    // A stack that friction holds, with another order of bodies in every step, the floor among them. The CPU goes by their
    // keys.
    let make = || {
        let mut world = World::heavy();
        world.gravity += Vec3::new(1.5, 0.0, 0.7);
        world.floor(0.0);
        let gap = 0.005 * 3.0f64.sqrt();
        for i in 0..4 {
            let height = 0.5 + gap + i as f64 * (1.0 + gap);
            world.dynamic(Shape::Box(DVec3::splat(0.5)), 1.0, DVec3::Y * height);
        }
        world
    };
    let mut cpu = make();
    let mut twin = Twin::new(gpu, make());
    let mut random = fastrand::Rng::with_seed(4);
    for step in 0..64 {
        cpu.step(1);
        twin.step(1);
        let mut new_numbers: Vec<u32> = (0..5).collect();
        random.shuffle(&mut new_numbers);
        renumber(&mut cpu, &new_numbers);
        renumber(&mut twin.world, &new_numbers);
        twin.put();
        if step % 16 == 15 {
            // All are gone, and others have come.
            new_numbers.fill(u32::MAX);
            cpu.warm.clear();
        }
        twin.solver.renumber(&new_numbers).unwrap();
    }
    Apart::of(&cpu, &twin.world).check("stack", all(1.0e-5));
}
