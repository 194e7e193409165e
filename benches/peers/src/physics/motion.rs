//! What closed systems keep, from masses, poses and velocities.

use super::mass::Mass;
use super::world::State;
use bevy::math::{DMat3, DVec3};
use bevy_faceoff::testing::scenes::Scene;

/// Sums over all dynamic bodies.
#[derive(Clone, Copy, Debug, Default)]
pub struct Motion {
    /// kg m/s.
    pub linear: DVec3,
    /// About the origin, kg m^2/s.
    pub angular: DVec3,
    /// The part of it that is about the bodies' own centres.
    pub own: DVec3,
    /// Linear and angular, joules.
    pub kinetic: f64,
    /// The sum of |m v|.
    pub linear_size: f64,
    /// The sum of |r x m v|.
    pub angular_size: f64,
}

impl Motion {
    /// Sums over a scene's bodies, given their masses.
    pub fn of(scene: &Scene, masses: &[Mass], states: &[State]) -> Self {
        let mut sum = Self::default();
        for ((_, mass), state) in scene
            .bodies
            .iter()
            .zip(masses)
            .zip(states)
            .filter(|((b, _), _)| !b.fixed)
        {
            let momentum = state.velocity * mass.mass;
            let axes = DMat3::from_quat(state.rotation);
            let turning = axes * (mass.inertia * (axes.transpose() * state.spin));
            let moment = state.center.cross(momentum);
            sum.linear += momentum;
            sum.own += turning;
            sum.angular += moment + turning;
            sum.kinetic += 0.5 * (momentum.dot(state.velocity) + turning.dot(state.spin));
            sum.linear_size += momentum.length();
            sum.angular_size += moment.length();
        }
        sum
    }
}
