//! Warm starting: the impulses of one step are the first guess for the next, matched by the keys of bodies.

use super::cloud::heap;
use super::shapes::Shape;
use super::world::{World, check_below};
use bevy_faceoff::manifolds::Manifolds;
use bevy_faceoff::solver::SolverBodies;
use glam::DVec3;

/// Reverses the numbers of the bodies.
fn renumber(world: &mut World) {
    let count = world.shapes.len();
    world.shapes.reverse();
    let SolverBodies {
        keys,
        bodies,
        motions,
        forces,
        sleep,
        ..
    } = &mut world.bodies;
    keys.reverse();
    bodies.reverse();
    motions.reverse();
    forces.reverse();
    sleep.reverse();
    assert_eq!(count, world.bodies.len());
}

pub fn impulses_survive_a_renumbering() {
    // A tall stack with warm starting stands still. Without saved impulses it sinks at first. A single tower would be
    // solved directly, so planks lie on cubes, three below each.
    let stack = |gap: f64| {
        let mut world = World::heavy();
        world.floor(0.0);
        for i in 0..10 {
            let height = DVec3::Y * (0.5 + gap + (1.0 + gap) * i as f64);
            if i % 2 == 1 {
                world.dynamic(Shape::Box(DVec3::new(1.8, 0.5, 0.5)), 3.0, height);
                continue;
            }
            for x in [-1.25, 0.0, 1.25] {
                world.dynamic(Shape::Box(DVec3::splat(0.5)), 1.0, height + DVec3::X * x);
            }
        }
        world.seconds(5.0);
        world
    };
    let highest = |world: &World| world.bodies.motions.iter().map(|m| m.center.y).fold(0.0, f64::max);
    let sinks_from = |gap: f64, change: &dyn Fn(&mut World)| {
        let mut world = stack(gap);
        // With more passes the impulses converge from nothing too.
        world.settings.max_iterations = 2;
        let top = highest(&world);
        change(&mut world);
        let mut sunk = 0.0f64;
        for _ in 0..20 {
            world.step(1);
            sunk = sunk.max(top - highest(&world));
        }
        sunk
    };
    // One stack in thirty still sways a little: the median of three hardly does.
    let sinks = |change: &dyn Fn(&mut World)| {
        let mut sunk = [0.0, 1.0, 2.0].map(|more| sinks_from(0.00087 + 1.0e-6 * more, change));
        sunk.sort_unstable_by(f64::total_cmp);
        sunk[1]
    };
    let mut worst = 0.0f64;
    let mut check = |what: &str, sunk: f64, limit: f64| {
        check_below(&format!("{what}: sinks, metres"), sunk, limit);
        worst = worst.max(sunk);
    };
    check("unchanged", sinks(&|_| {}), 1.0e-5);
    check("renumbered", sinks(&renumber), 1.0e-4);
    let twice = |world: &mut World| {
        renumber(world);
        world.step(1);
        renumber(world);
    };
    check("renumbered twice", sinks(&twice), 1.0e-4);
    let cold = sinks(&|world| world.solver.forget());
    println!("without saved impulses: sinks {cold} m");
    assert!(
        cold > 3.0 * worst,
        "warm starting makes no difference: {cold} and {worst}"
    );
}

pub fn bodies_come_and_go() {
    let mut world = heap();
    world.step(40);
    // The first hundred bodies leave.
    for _ in 0..100 {
        world.shapes.remove(1);
        let SolverBodies {
            keys,
            bodies,
            motions,
            forces,
            sleep,
            ..
        } = &mut world.bodies;
        keys.remove(1);
        bodies.remove(1);
        motions.remove(1);
        forces.remove(1);
        sleep.remove(1);
    }
    world.step(80);
    check_below("deepest, metres", world.deepest() as f64, 0.02);
    world.manifolds = Manifolds::default();
    world.bodies.clear();
    world.shapes.clear();
    world.step(1);
    assert!(world.solver.saved_pairs().is_none_or(|pairs| pairs == 0));
}
