//! The broad phase against a brute-force test of all pairs of spheres.

use bevy_faceoff::state::Bodies;
use bevy_faceoff::step::StepState;
use bevy_faceoff::types::body::{CollisionLayers, RigidBody};
use bevy_faceoff::types::stage::Stage;
use fastrand::Rng;
use glam::Vec3;

/// Brute force over all pairs.
fn all_pairs(bodies: &Bodies) -> Vec<[u32; 2]> {
    let n = bodies.center.len();
    let mut pairs = Vec::new();
    for a in 0..n {
        for b in a + 1..n {
            let reach = bodies.radius[a] + bodies.radius[b];
            let distance = bodies.center[a].distance_squared(bodies.center[b]);
            let kinds = [bodies.kind[a], bodies.kind[b]];
            let sensor = bodies.sensor[a] || bodies.sensor[b];
            let moved = kinds.contains(&RigidBody::Dynamic) || (sensor && kinds.contains(&RigidBody::Kinematic));
            if distance <= reach * reach * (1.0 + 1.0e-6) && moved && bodies.layers[a].interacts_with(bodies.layers[b])
            {
                pairs.push([a as u32, b as u32]);
            }
        }
    }
    pairs
}

fn push(state: &mut StepState, center: Vec3, radius: f32) {
    let bodies = &mut state.input.bodies;
    bodies.center.push(center);
    bodies.radius.push(radius);
    bodies.kind.push(RigidBody::Dynamic);
    bodies.layers.push(CollisionLayers::default());
    bodies.sensor.push(false);
}

fn somewhere(random: &mut Rng, side: f32) -> Vec3 {
    Vec3::from_array([0; 3].map(|_| side * (random.f32() - 0.5)))
}

/// Bodies of every kind in several collision layers.
fn mix(state: &mut StepState, random: &mut Rng) {
    let bodies = &mut state.input.bodies;
    for i in 0..bodies.center.len() {
        bodies.kind[i] = [RigidBody::Static, RigidBody::Kinematic, RigidBody::Dynamic][random.usize(..3)];
        bodies.sensor[i] = random.u8(..4) == 0;
        bodies.layers[i] = CollisionLayers {
            memberships: 1 << random.u32(..3),
            filters: random.u32(..8),
        };
    }
}

/// Moves all moving bodies, and each time changes one property of one static body, or nothing.
fn change_one_static(state: &mut StepState, random: &mut Rng, compare: impl Fn(&mut StepState) -> usize) {
    let all = 0..state.input.bodies.center.len();
    let (still, moving): (Vec<usize>, Vec<usize>) = all.partition(|&i| state.input.bodies.kind[i] == RigidBody::Static);
    let (Some(&one), Some(&other)) = (still.last(), moving.first()) else {
        return;
    };
    for change in 0..6 {
        let bodies = &mut state.input.bodies;
        for &i in &moving {
            let step = 0.5 * bodies.radius[i];
            bodies.center[i] += somewhere(random, step);
        }
        match change {
            0 => {}
            1 => bodies.radius[one] *= 1.5,
            2 => bodies.center[one].z += bodies.radius[one],
            // As many static bodies as before, but different ones.
            3 => bodies.kind.swap(one, other),
            4 => bodies.layers[one] = CollisionLayers::default(),
            _ => {
                bodies.center.swap_remove(one);
                bodies.radius.swap_remove(one);
                bodies.kind.swap_remove(one);
                bodies.layers.swap_remove(one);
                bodies.sensor.swap_remove(one);
            }
        }
        compare(state);
    }
}

/// Compares the scene with all bodies dynamic and with mixed kinds, then again after some have moved. Returns the
/// number of pairs of the first.
fn check(state: &mut StepState, random: &mut Rng, what: &str) -> usize {
    let compare = |state: &mut StepState| {
        bevy_faceoff::step::cpu::run(Stage::BroadPhase, state);
        let expected = all_pairs(&state.input.bodies);
        let missing = expected
            .iter()
            .find(|p| state.results.sphere_pairs.binary_search(p).is_err());
        assert!(missing.is_none(), "{what}: {missing:?} is missing");
        assert!(
            state.results.sphere_pairs == expected,
            "{what}: too many, or out of order"
        );
        expected.len()
    };
    let pairs = compare(state);
    mix(state, random);
    compare(state);
    for i in 0..state.input.bodies.center.len() {
        if state.input.bodies.kind[i] != RigidBody::Static || random.u8(..50) == 0 {
            let step = 0.5 * state.input.bodies.radius[i];
            state.input.bodies.center[i] += somewhere(random, step);
        }
    }
    compare(state);
    compare(state);
    change_one_static(state, random, compare);
    pairs
}

#[test]
fn random_scenes_of_all_sizes() {
    let mut random = Rng::with_seed(1);
    for spread in [1.0f32, 1.5, 100.0, 1.0e6] {
        for (n, side) in [(2, 1.0), (30, 3.0), (700, 8.0), (3000, 30.0)] {
            let mut state = StepState::default();
            for _ in 0..n {
                let radius = spread.powf(-random.f32());
                push(&mut state, somewhere(&mut random, side), radius);
            }
            let pairs = check(&mut state, &mut random, &format!("{n} bodies, sizes 1:{spread}"));
            assert!(n < 100 || pairs > 0, "nothing tested");
        }
    }
}

#[test]
fn one_huge_body() {
    let mut random = Rng::with_seed(2);
    for factor in [1.0e3, 1.0e8] {
        for huge in [0, 500] {
            let mut state = StepState::default();
            for i in 0..1000 {
                if i == huge {
                    push(&mut state, Vec3::Y * -factor, factor);
                } else {
                    push(&mut state, somewhere(&mut random, 20.0), 0.7);
                }
            }
            assert!(check(&mut state, &mut random, "one huge body") > 300);
        }
    }
}

#[test]
fn few_moving_giants_among_small_static_bodies() {
    let mut random = Rng::with_seed(3);
    let mut state = StepState::default();
    for i in 0..2500 {
        let radius = if i % 500 == 0 { 9.0 } else { 0.3 };
        push(&mut state, somewhere(&mut random, 30.0), radius);
        state.input.bodies.kind[i] = if i % 500 == 0 {
            RigidBody::Dynamic
        } else {
            RigidBody::Static
        };
    }
    check(&mut state, &mut random, "giants");
}

#[test]
fn coincident_bodies() {
    let mut random = Rng::with_seed(4);
    for center in [
        Vec3::ZERO,
        Vec3::new(-0.0, 0.0, -0.0),
        Vec3::splat(-1.0e9),
        Vec3::new(3.0, -7.0, 1.0e5),
    ] {
        let mut state = StepState::default();
        for i in 0..300 {
            push(&mut state, center, if i % 3 == 0 { 1.0e-9 } else { 0.5 });
        }
        assert_eq!(check(&mut state, &mut random, "coincident"), 300 * 299 / 2);
    }
}

#[test]
fn far_from_the_origin() {
    let mut random = Rng::with_seed(5);
    for far in [1.0e4, 1.0e6, 1.0e9] {
        for radius in [1.0e-9, 1.0e-3, 1.0, 1.0e3, 1.0e9] {
            let mut state = StepState::default();
            for i in 0..600 {
                let at = [Vec3::splat(far), Vec3::new(-far, far, 0.0), Vec3::new(0.0, 0.0, -far)][i % 3];
                push(&mut state, at + somewhere(&mut random, 8.0 * radius), radius);
            }
            check(&mut state, &mut random, &format!("{far} m away, radius {radius}"));
        }
    }
}

#[test]
fn on_the_borders_of_cells() {
    let mut random = Rng::with_seed(6);
    // A lattice: neighbours touch exactly or miss by the last bit.
    for radius in [0.5, 0.5f32.next_up(), 0.5f32.next_down(), 0.49, 1.0, 1.0 / 3.0] {
        let mut state = StepState::default();
        for x in -5..5 {
            for y in -5..5 {
                for z in -5..5 {
                    push(&mut state, Vec3::new(x as f32, y as f32, z as f32), radius);
                }
            }
        }
        check(&mut state, &mut random, &format!("lattice, radius {radius}"));
    }
}

#[test]
fn bodies_on_a_line() {
    let mut random = Rng::with_seed(7);
    for axis in Vec3::AXES {
        let mut state = StepState::default();
        for _ in 0..3000 {
            let radius = if random.u8(..100) == 0 { 20.0 } else { 0.2 };
            push(&mut state, axis * 1000.0 * random.f32(), radius);
        }
        check(&mut state, &mut random, &format!("along {axis}"));
    }
}

#[test]
fn bodies_come_and_go() {
    let mut random = Rng::with_seed(8);
    let mut state = StepState::default();
    for n in [0, 500, 3, 0, 2500, 1] {
        state.input.bodies = Bodies::default();
        for _ in 0..n {
            push(&mut state, somewhere(&mut random, 8.0), 0.5);
        }
        check(&mut state, &mut random, &format!("{n} bodies"));
    }
}

#[test]
fn bodies_spread_out_and_come_together() {
    let mut random = Rng::with_seed(9);
    let mut state = StepState::default();
    for i in 0..2000 {
        let radius = if i % 10 == 0 { 3.0 } else { 0.5 };
        push(&mut state, Vec3::ZERO, radius);
        state.input.bodies.kind[i] = if i % 3 == 0 {
            RigidBody::Static
        } else {
            RigidBody::Dynamic
        };
    }
    let mut pairs = Vec::new();
    for side in [4000.0, 20.0, 4000.0, 200.0, 60.0] {
        // Cells grow or shrink from step to step.
        for _ in 0..12 {
            for center in &mut state.input.bodies.center {
                *center = somewhere(&mut random, side);
            }
            bevy_faceoff::step::cpu::run(Stage::BroadPhase, &mut state);
            assert!(state.results.sphere_pairs == all_pairs(&state.input.bodies), "{side} m");
            pairs.push(state.results.sphere_pairs.len());
        }
    }
    let (fewest, most) = (pairs.iter().min(), pairs.iter().max());
    assert!(fewest < Some(&5) && most > Some(&5_000), "{fewest:?} to {most:?}");
}
