//! Mechanical quantities of a scene: energy, momentum, penetration.

use bevy::prelude::*;
use bevy_faceoff::prelude::*;
use glam::{DMat3, DVec3};
use serde::Serialize;

/// Mechanical quantities of all dynamic bodies and of all touching pairs.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Mechanics {
    /// Linear and angular kinetic energy, joules.
    kinetic_energy: f64,
    /// Linear momentum, kg m/s.
    momentum: [f64; 3],
    /// The largest penetration of any pair, metres; `null` if no contact points are computed.
    deepest_penetration: Option<f64>,
    /// The mean penetration of the pairs with contact points, metres. Pairs that do not overlap count as 0.
    mean_penetration: Option<f64>,
}

impl Mechanics {
    /// The quantities of a world after a step.
    pub fn of(world: &mut World) -> Self {
        let mut bodies = world.query::<(&RigidBody, &MeshCollider, &Transform, &LinearVelocity, &AngularVelocity)>();
        let meshes = world.resource::<Assets<CollisionMesh>>();
        let (mut energy, mut momentum) = (0.0, DVec3::ZERO);
        for (_, collider, pose, v, w) in bodies.iter(world).filter(|(kind, ..)| **kind == RigidBody::Dynamic) {
            let Some(mesh) = meshes.get(&collider.0) else { continue };
            let scale = pose.scale.as_dvec3();
            let mass = f64::from(mesh.mass.volume) * scale.element_product().abs();
            let inertia = mesh.mass.inertia(scale, mass);
            let axes = DMat3::from_quat(pose.rotation.as_dquat());
            let (v, w) = (v.as_dvec3(), axes.transpose() * w.as_dvec3());
            energy += 0.5 * (mass * v.length_squared() + w.dot(inertia * w));
            momentum += mass * v;
        }
        let depths = penetrations(world);
        Self {
            kinetic_energy: energy,
            momentum: momentum.to_array(),
            deepest_penetration: depths.as_ref().map(|d| d.iter().copied().fold(0.0, f64::max)),
            mean_penetration: depths.map(|d| d.iter().sum::<f64>() / d.len().max(1) as f64),
        }
    }
}

/// The penetration of each pair with contact points, metres; `None` if no contact points are computed.
fn penetrations(world: &World) -> Option<Vec<f64>> {
    if *world.resource::<Response>() == Response::Impulse {
        return None;
    }
    let manifolds = world.resource::<Collisions>().manifolds();
    let depth = |points: &[_]| points.iter().map(separation).fold(0.0, |depth, s| f64::max(depth, -s));
    Some(manifolds.map(|(.., points)| depth(points)).collect())
}

fn separation(point: &bevy_faceoff::manifolds::ManifoldPoint) -> f64 {
    f64::from(point.separation)
}
