//! The scene of Aly & Elawady 2010: bodies in a box, random poses, sizes and velocities.

use crate::asset::CollisionMesh;
use glam::{Quat, Vec3};
use std::f32::consts::TAU;

/// Parameters of a scene.
#[derive(Clone, Copy, Debug)]
pub struct Paper {
    /// Number of bodies.
    pub bodies: usize,
    /// Side of the box, metres.
    pub side: f32,
    /// Largest speed, m/s.
    pub speed: f32,
    /// Seed of the random numbers.
    pub seed: u64,
}

/// A body of the scene. Its restitution is 1.
#[derive(Clone, Copy, Debug)]
pub struct Flyer {
    /// Position of the mesh's origin, metres.
    pub position: Vec3,
    /// A unit quaternion.
    pub rotation: Quat,
    /// Uniform scale.
    pub scale: f32,
    /// Velocity of the centre of mass, m/s.
    pub velocity: Vec3,
}

/// Smallest and largest diameter of the bodies, metres.
const DIAMETERS: (f32, f32) = (0.25, 2.0);

/// The side at which `bodies` bodies have about 0.7 overlapping sphere pairs each, as in the paper's table 1.
pub fn default_side(bodies: usize) -> f32 {
    22.5 * (bodies as f32 / 2200.0).cbrt()
}

impl Paper {
    /// The walls, each as a point and its inward normal. Their restitution is 1.
    pub fn walls(&self) -> [(Vec3, Vec3); 6] {
        let normals = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
        normals.map(|normal| (-0.5 * self.side * normal, normal))
    }

    /// The bodies, which share one mesh. `random` returns numbers from 0 to 1.
    pub fn flyers(&self, mesh: &CollisionMesh, mut random: impl FnMut() -> f32) -> impl Iterator<Item = Flyer> {
        let half = 0.5 * self.side;
        let (radius, mass_center, speed) = (mesh.radius, mesh.mass.center, self.speed);
        let mut between = move |low: f32, high: f32| low + (high - low) * random();
        (0..self.bodies).map(move |_| {
            let scale = between(DIAMETERS.0, DIAMETERS.1) / (2.0 * radius);
            let rotation = {
                // Uniform over rotations (Shoemake 1992).
                let (u, v, w) = (between(0.0, 1.0), between(0.0, TAU), between(0.0, TAU));
                let (a, b) = ((1.0 - u).sqrt(), u.sqrt());
                Quat::from_xyzw(a * v.sin(), a * v.cos(), b * w.sin(), b * w.cos())
            };
            let center = Vec3::from_array([0; 3].map(|_| between(-half, half)));
            let velocity = Vec3::from_array([0; 3].map(|_| between(-1.0, 1.0))).clamp_length_max(1.0) * speed;
            Flyer {
                position: center - rotation * (scale * mass_center),
                rotation,
                scale,
                velocity,
            }
        })
    }
}
