//! Conserved quantities of closed systems: momentum and energy.

use crate::world::World;
use glam::{DMat3, DVec3};

/// Sums over all dynamic bodies of a world.
#[derive(Clone, Copy, Debug, Default)]
pub struct Motion {
    /// kg m/s.
    pub linear: DVec3,
    /// About the origin, kg m^2/s.
    pub angular: DVec3,
    /// Linear and angular, joules.
    pub kinetic: f64,
    /// The sum of |m v|.
    pub linear_size: f64,
    /// The sum of |r x m v|.
    pub angular_size: f64,
}

impl Motion {
    pub fn of(world: &World) -> Self {
        let bodies = &world.state.input.bodies;
        let mut sum = Self::default();
        for i in (0..bodies.len()).filter(|&i| bodies.inverse_mass[i] > 0.0) {
            let momentum = bodies.linear_velocity[i].as_dvec3() / f64::from(bodies.inverse_mass[i]);
            let spin = bodies.angular_velocity[i].as_dvec3();
            let turning = inertia(world, i) * spin;
            let moment = world.center(i).cross(momentum);
            sum.linear += momentum;
            sum.angular += moment + turning;
            sum.kinetic += 0.5 * (momentum.dot(bodies.linear_velocity[i].as_dvec3()) + turning.dot(spin));
            sum.linear_size += momentum.length();
            sum.angular_size += moment.length();
        }
        sum
    }
}

/// The inertia tensor of body `i` in world axes, kg m^2.
pub fn inertia(world: &World, i: usize) -> DMat3 {
    let axes = world.state.input.bodies.frame[i].rotation;
    axes * world.state.input.bodies.local_inverse_inertia[i].as_dmat3().inverse() * axes.transpose()
}
