//! The results do not depend on the instruction set that is chosen at run time: those of the triangle test, of contact
//! generation and of continuous collision detection are the same, to the bit.

use crate::world::{World, any_turn};
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::state::{Body, BodyParams};
use bevy_faceoff::step::cpu::touching;
use bevy_faceoff::testing::use_baseline_only;
use bevy_faceoff::types::body::RigidBody;
use bevy_faceoff::types::settings::{Culling, Response};
use glam::{Quat, Vec3};
use std::sync::{Mutex, PoisonError};

/// Everything that a step computed, as text: floats are printed with all their digits.
fn results(world: &World) -> String {
    let state = &world.state;
    let bodies = &state.input.bodies;
    format!(
        "{:?} {:?} {:?} {:?} {:?} {:?} {:?}",
        state.results.contacts,
        state.results.manifolds,
        bodies.position,
        bodies.rotation,
        bodies.linear_velocity,
        bodies.angular_velocity,
        bodies.frame,
    )
}

/// The instruction set is chosen for the whole process, so one test at a time may do it.
static CHOICE: Mutex<()> = Mutex::new(());

/// The results of `run` with the baseline and with the widest instruction set of this machine.
fn both(run: impl Fn() -> Vec<String>) -> [Vec<String>; 2] {
    let _choice = CHOICE.lock().unwrap_or_else(PoisonError::into_inner);
    [true, false].map(|only| {
        use_baseline_only(only);
        let results = run();
        use_baseline_only(false);
        results
    })
}

fn require_same(run: impl Fn() -> Vec<String>) {
    let [narrow, wide] = both(run);
    assert_eq!(narrow.len(), wide.len());
    for (step, (narrow, wide)) in narrow.iter().zip(&wide).enumerate() {
        assert!(narrow == wide, "step {step} differs");
    }
}

/// Bodies of various shapes and scales, close together, that fly about. Half of them stop at their first impact.
fn crowd(meshes: &[TriMesh], count: usize, spread: f32) -> World {
    let mut world = World::new();
    let slots: Vec<u32> = meshes.iter().map(|mesh| world.mesh(mesh)).collect();
    let mut random = fastrand::Rng::with_seed(99);
    for i in 0..count {
        let mut vector = |size: f32| Vec3::from_array([(); 3].map(|()| size * (2.0 * random.f32() - 1.0)));
        let (at, velocity, spin) = (vector(spread), vector(5.0), vector(8.0));
        let scale = match i % 4 {
            0 => Vec3::new(1.0, 0.6, 1.3),
            1 => Vec3::new(-0.8, 0.8, 0.8),
            2 => Vec3::splat(0.1),
            _ => Vec3::ONE,
        };
        // Faces of unrotated bodies are parallel, so that single precision leaves many decisions to double precision.
        let turn = if i % 3 == 0 {
            Quat::IDENTITY
        } else {
            any_turn(&mut random)
        };
        world.put(&Body {
            kind: if i % 7 == 0 {
                RigidBody::Static
            } else {
                RigidBody::Dynamic
            },
            linear_velocity: velocity,
            angular_velocity: spin,
            culling: [Culling::Exact, Culling::FrontFacing][usize::from(i % 5 == 0)],
            params: BodyParams {
                continuous: i % 2 == 0,
                ..BodyParams::default()
            },
            ..Body::at_rest(slots[i % slots.len()], at, turn, scale)
        });
    }
    world
}

/// Steps of a crowd with each response, and which bodies touch by the search for the first hit.
fn steps(meshes: &[TriMesh], count: usize, spread: f32, steps: usize) -> Vec<String> {
    let mut all = vec![];
    let mut touches = 0;
    for response in [Response::None, Response::Contacts] {
        let mut world = crowd(meshes, count, spread);
        world.state.input.config.response = response;
        for _ in 0..steps {
            world.step();
            touches += world.state.results.contacts.pairs.len();
            all.push(results(&world));
            all.push(format!("{:?}", touching(&mut world.state)));
        }
    }
    assert!(touches > 100, "{touches} touches are no crowd");
    all
}

#[test]
fn small_meshes_move_by_the_same_bits() {
    let meshes = [
        shapes::torus_240(),
        shapes::cube(0.8),
        shapes::ball(0.5, 2),
        shapes::knot_1120(),
    ];
    require_same(|| steps(&meshes, 60, 2.5, 12));
}

#[test]
fn large_meshes_move_by_the_same_bits() {
    let meshes = [shapes::ball(0.5, 5), shapes::torus(96, 60, 0.7, 0.3), shapes::cube(0.8)];
    require_same(|| steps(&meshes, 24, 1.5, 3));
}
