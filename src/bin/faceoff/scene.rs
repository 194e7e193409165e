//! The scene of Aly & Elawady 2010: bodies in a box, random poses, sizes and velocities. `benches/peers` includes this file, to
//! give other engines the same scene.

use bevy::prelude::*;
use bevy_faceoff::prelude::*;
use std::f32::consts::TAU;

/// What makes a scene.
#[derive(Clone, Copy, Debug)]
pub struct Scene {
    /// How many bodies.
    pub bodies: usize,
    /// Side of the box in metres.
    pub side: f32,
    /// Largest speed in m/s.
    pub speed: f32,
    /// Of the random numbers.
    pub seed: u64,
}

/// Diameters of the bodies in metres.
const DIAMETERS: (f32, f32) = (0.25, 2.0);

/// The side at which `bodies` bodies have about 0.7 overlapping sphere pairs each, as in the paper's table 1.
pub fn default_side(bodies: usize) -> f32 {
    22.5 * (bodies as f32 / 2200.0).cbrt()
}

/// Spawns the box and its bodies, all of one mesh.
pub fn spawn(world: &mut World, scene: &Scene, mesh: &CollisionMesh, handle: &Handle<CollisionMesh>) {
    let half = 0.5 * scene.side;
    for normal in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z] {
        world.spawn((PlaneCollider::through(-half * normal, normal), Restitution::new(1.0)));
    }
    let mut random = fastrand::Rng::with_seed(scene.seed);
    let mut between = move |low: f32, high: f32| low + (high - low) * random.f32();
    for _ in 0..scene.bodies {
        let scale = between(DIAMETERS.0, DIAMETERS.1) / (2.0 * mesh.radius);
        let rotation = {
            // Shoemake 1992: uniform over rotations.
            let (u, v, w) = (between(0.0, 1.0), between(0.0, TAU), between(0.0, TAU));
            let (a, b) = ((1.0 - u).sqrt(), u.sqrt());
            Quat::from_xyzw(a * v.sin(), a * v.cos(), b * w.sin(), b * w.cos())
        };
        let center = Vec3::from_array([0; 3].map(|_| between(-half, half)));
        let velocity = Vec3::from_array([0; 3].map(|_| between(-1.0, 1.0))).clamp_length_max(1.0) * scene.speed;
        world.spawn((
            RigidBody::Dynamic,
            MeshCollider(handle.clone()),
            Transform {
                translation: center - rotation * (scale * mesh.mass.center),
                rotation,
                scale: Vec3::splat(scale),
            },
            LinearVelocity(velocity),
            Restitution::new(1.0),
        ));
    }
}
