//! Chains of rings.

use crate::world::{Contacts, HZ, World};
use avian_faceoff::prelude::*;
use avian3d::prelude::*;
use bevy_faceoff::testing::scenes::chain::{chain, linking_number};

/// Number of links that have opened after 20 s.
fn opened(world: &mut World) -> usize {
    world.steps(20 * HZ);
    let rings: Vec<_> = world
        .bodies
        .iter()
        .map(|&ring| (world.position(ring).as_dvec3(), world.rotation(ring).as_dquat()))
        .collect();
    rings
        .windows(2)
        .filter(|pair| linking_number(pair[0], pair[1]) == 0)
        .count()
}

#[test]
fn a_chain_of_20_rings_hangs() {
    let mut world = World::of(Contacts::Exact, &chain(20, 0.74));
    assert_eq!(opened(&mut world), 0);
    println!("deepest {:.2} % of the diameter", 100.0 * world.deepest());
}

#[test]
fn a_chain_of_50_rings_hangs_with_two_steps() {
    let mut world = World::new(Contacts::Exact);
    world
        .app
        .add_plugins(PhysicsStepsPlugin::new(2))
        .insert_resource(SubstepCount(3));
    world.fill(&chain(50, 0.74));
    world.begin();
    assert_eq!(opened(&mut world), 0);
    println!("deepest {:.2} % of the diameter", 100.0 * world.deepest());
}
