//! Bodies on half-spaces.

use super::approach::scene;
use super::compare::{on_cpu, on_gpu, require};
use super::scene::{body, oracle_mesh, state};
use crate::oracle::body::Body;
use crate::oracle::product::Product;
use crate::oracle::rng::Rng;
use crate::oracle::shapes::Shapes;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::state::Plane;
use bevy_faceoff::step::StepState;
use bevy_faceoff::types::body::RigidBody;
use glam::{DVec3, Quat, Vec3};

fn plane(normal: Vec3, distance: f32) -> Plane {
    Plane {
        normal: normal.normalize(),
        distance,
        restitution: 0.0,
        ..Plane::default()
    }
}

fn bodies_on_planes(rng: &mut Rng, count: usize) -> StepState {
    let (product, shapes) = (Product::default(), Shapes::new());
    let solids = shapes.solids();
    let bodies: Vec<_> = (0..count)
        .map(|i| {
            let mut at = rng.in_ball(5.0);
            at.z = rng.range(-0.2, 0.55);
            let rotation = if i % 3 == 0 { Quat::IDENTITY } else { rng.rotation() };
            body(solids[i % solids.len()], at, rotation)
        })
        .collect();
    let mut state = state(&product, &bodies.iter().collect::<Vec<_>>());
    for i in 0..count {
        state.input.bodies.linear_velocity[i] = rng.in_ball(3.0).as_vec3();
        state.input.bodies.angular_velocity[i] = rng.in_ball(3.0).as_vec3();
        if i % 11 == 5 {
            state.input.bodies.kind[i] = RigidBody::Static;
        }
        state.input.bodies.sensor[i] = i % 13 == 7;
    }
    state.input.planes = vec![
        plane(Vec3::Z, 0.0),
        plane(Vec3::new(0.3, 0.2, 1.0), -1.0),
        plane(-Vec3::X, -4.8),
    ];
    state
}

pub fn half_spaces(gpu: &Gpu) {
    let state = bodies_on_planes(&mut Rng::new(30, 0), 200);
    require("half-spaces", gpu, &state, &[], 0, 0.01);
}

/// Finely cut surfaces, scaled alike and not, touch where the smooth ones would.
pub fn round_ones(gpu: &Gpu) {
    let meshes = [
        ("ball", shapes::ball(0.5, 4)),
        ("coarse ball", shapes::ball(0.5, 2)),
        ("torus", shapes::torus(96, 48, 0.35, 0.15)),
    ];
    let meshes = meshes.map(|(name, mesh)| oracle_mesh(name, &mesh));
    let mut rng = Rng::new(32, 0);
    let bodies: Vec<_> = (0..60)
        .map(|i| {
            let mut at = rng.in_ball(5.0);
            at.z = rng.range(0.4, 0.5);
            Body {
                scale: [Vec3::ONE, Vec3::new(1.0, -1.2, 0.9)][i % 2],
                ..body(&meshes[i % 3], at, rng.rotation())
            }
        })
        .collect();
    let mut state = state(&Product::default(), &bodies.iter().collect::<Vec<_>>());
    for velocity in &mut state.input.bodies.linear_velocity {
        *velocity = rng.in_ball(3.0).as_vec3();
    }
    state.input.planes = vec![plane(Vec3::Z, 0.0), plane(Vec3::new(0.1, 0.2, 1.0), 0.0)];
    require("round ones", gpu, &state, &[], 0, 0.01);
    let found = on_cpu(&state, &[]);
    assert!(found.points.iter().any(|p| p.curvature_radii[0] > 0.0));
}

/// Pairs of bodies and bodies on half-spaces are one ascending list.
pub fn among_pairs(gpu: &Gpu) {
    let shapes = Shapes::new();
    let mut rng = Rng::new(31, 0);
    let cases: Vec<_> = (0..20)
        .map(|i| {
            let at = DVec3::new(3.0 * f64::from(i), 0.0, 0.45);
            let a = body(&shapes.torus, at, rng.rotation());
            ([a, body(&shapes.cube, at + DVec3::X * 0.8, rng.rotation())], 0.1)
        })
        .collect();
    let (mut state, pairs) = scene(&Product::default(), &cases);
    state.input.planes = vec![plane(Vec3::Z, 0.0), plane(Vec3::Y, -0.4)];
    require("among pairs", gpu, &state, &pairs, 0, 0.01);
    let [wanted, found] = [on_cpu(&state, &pairs), on_gpu(gpu, &state, &pairs)];
    let bodies =
        |list: &bevy_faceoff::manifolds::Manifolds| list.pairs.iter().map(|pair| pair.bodies).collect::<Vec<_>>();
    assert_eq!(bodies(&wanted), bodies(&found));
    assert!(found.pairs.iter().any(|pair| pair.bodies[1] >= 40));
}
