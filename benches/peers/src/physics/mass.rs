//! What bodies weigh.

use bevy::math::{DMat3, DVec3};
use bevy_faceoff::testing::scenes::{Body, Scene};

/// How a body resists being moved. All engines are given the same.
#[derive(Clone, Copy, Debug)]
pub struct Mass {
    /// Kilograms.
    pub mass: f64,
    /// Centre of mass from the shape's origin, in the body's own axes.
    pub center: DVec3,
    /// About the centre, in the body's own axes, kg m^2.
    pub inertia: DMat3,
}

impl Mass {
    /// Mass, centre and inertia of a body.
    pub fn of(body: &Body) -> Self {
        let (baked, scale) = (&body.shape.mesh().mass, body.scale.as_dvec3());
        let mass = f64::from(body.density) * f64::from(baked.volume) * scale.element_product();
        Self {
            mass,
            center: scale * baked.center.as_dvec3(),
            inertia: baked.inertia(scale, mass),
        }
    }
}

/// Masses of all bodies of a scene.
pub fn masses(scene: &Scene) -> Vec<Mass> {
    scene.bodies.iter().map(Mass::of).collect()
}
