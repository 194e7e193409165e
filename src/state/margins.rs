//! Speculative margins: surfaces closer than their margin get contact points, because they may meet before the next
//! collision substep.
//!
//! A pair's margin follows the relative velocity of its bodies, so bodies that move together have none from motion. The
//! speed of rotation counts where the other body may touch. The margin is capped at twice the thickness of the thinner
//! body; fast bodies get more collision substeps instead. If a third body changes the motion of one of the two, the
//! next collision substep accounts for it.

use super::arm::arm;
use super::mesh_arena::MeshArena;
use crate::state::{Bodies, StepConfig};
use crate::types::body::RigidBody;
use glam::Vec3;

/// Safety factor on the distance that bodies travel at their current velocities: contacts may change these velocities.
pub(crate) const SAFETY: f32 = 1.5;

/// The rule that determines speculative margins.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum SpeculativeMargins {
    /// No margin: only touching surfaces get contacts.
    #[default]
    None,
    /// The contact margin of the solver settings.
    AtRest,
    /// The contact margin plus the distance that bodies may travel in [`Bodies::travel_time`].
    Moving {
        /// Common velocity of the bodies, m/s; see [`Speeds::drift`](crate::solver::speeds::Speeds::drift).
        drift: Vec3,
    },
}

/// Cap of the part of the margin that grows with motion, in units of the thinner body's thickness.
pub(crate) const BOUND: f32 = 2.0;

impl SpeculativeMargins {
    /// Sets [`Bodies::speculative_radius`]. The parts beyond the bounding radii of two bodies add up to at least the
    /// margin of the pair.
    pub fn set_speculative_radii(self, bodies: &mut Bodies, config: &StepConfig) {
        // Continuous collision needs every pair that may meet within the step, so the travel is not capped.
        let has_continuous = bodies.flags().continuous;
        self.set_radii(bodies, config, |travel, thickness| {
            if has_continuous {
                travel
            } else {
                travel.min(BOUND * thickness)
            }
        });
    }

    /// Sets [`Bodies::speculative_radius`] without a cap on the travel: if two spheres do not overlap, the bodies
    /// cannot meet before the next collision substep.
    pub fn set_reach(self, bodies: &mut Bodies, config: &StepConfig) {
        self.set_radii(bodies, config, |travel, _| travel);
    }

    fn set_radii(self, bodies: &mut Bodies, config: &StepConfig, cap: impl Fn(f32, f32) -> f32) {
        let margin = self.contact_margin(config);
        bodies.speculative_radius.resize(bodies.radius.len(), 0.0);
        if bodies.static_margin != Some(margin) {
            for (i, radius) in bodies.speculative_radius.iter_mut().enumerate() {
                if bodies.kind[i] == RigidBody::Static {
                    *radius = bodies.radius[i] + margin * bodies.radius[i];
                }
            }
            bodies.static_margin = Some(margin);
        }
        bodies.for_each_mover(|bodies, i| {
            let radius = bodies.radius[i];
            let travel = match self {
                Self::Moving { drift } => {
                    let dt = bodies.travel_time[i];
                    let speed = (bodies.linear_velocity[i] - drift).length() + sway(bodies, config, i, dt);
                    cap(SAFETY * speed * dt, bodies.thickness[i])
                }
                _ => 0.0,
            };
            bodies.speculative_radius[i] = radius + margin * radius + travel;
        });
    }

    /// The speculative margin of a pair, metres.
    pub fn of_pair(self, bodies: &Bodies, meshes: &MeshArena, config: &StepConfig, pair: [u32; 2]) -> f32 {
        let at_rest = Self::of_resting_pair(bodies, config, pair);
        match self {
            Self::None => return 0.0,
            Self::AtRest => return at_rest,
            Self::Moving { .. } => {}
        }
        let [a, b] = pair;
        let [first, second] = pair.map(|i| i as usize);
        let dt = bodies.travel_time[first].max(bodies.travel_time[second]);
        let sway_near = |pair @ [i, _]: [u32; 2]| {
            let i = i as usize;
            let spin = bodies.angular_velocity[i].length() * bodies.radius[i];
            // Where rotation adds little, a smaller margin saves less than it costs to know.
            if bodies.kind[i] == RigidBody::Static || SAFETY * spin * dt <= at_rest {
                sway(bodies, config, i, dt)
            } else {
                sway_at(bodies, config, i, dt, arm_within(bodies, meshes, config, pair, dt))
            }
        };
        let speed = relative_speed(bodies, pair) + sway_near([a, b]) + sway_near([b, a]);
        let bound = BOUND * bodies.thickness[first].min(bodies.thickness[second]);
        at_rest + (SAFETY * speed * dt).min(bound)
    }

    /// The speculative margin of a pair without relative motion, metres.
    pub fn of_resting_pair(bodies: &Bodies, config: &StepConfig, pair: [u32; 2]) -> f32 {
        let [a, b] = pair.map(|i| bodies.radius[i as usize]);
        config.solver.margin() * 2.0 * a.min(b)
    }

    /// The contact margin in units of the smaller body's diameter.
    fn contact_margin(self, config: &StepConfig) -> f32 {
        if self == Self::None {
            0.0
        } else {
            config.solver.margin()
        }
    }
}

/// The [`arm`] of collider `i` near `j` within `dt` seconds, at velocities that forces may change, metres.
pub(crate) fn arm_within(bodies: &Bodies, meshes: &MeshArena, config: &StepConfig, pair: [u32; 2], dt: f32) -> f32 {
    let [own, other] = pair.map(|i| i as usize);
    let speed = relative_speed(bodies, pair) + sway(bodies, config, other, dt) + sway_at(bodies, config, own, dt, 0.0);
    arm(bodies, meshes, pair, SAFETY * speed * dt)
}

/// The speed of the colliders' centres relative to each other, m/s.
fn relative_speed(bodies: &Bodies, pair: [u32; 2]) -> f32 {
    let [v, w] = pair.map(|i| match bodies.kind[i as usize] {
        RigidBody::Static => Vec3::ZERO,
        _ => bodies.linear_velocity[i as usize],
    });
    (w - v).length()
}

/// Upper bound of the speed of the colliders' surfaces relative to each other, at their present velocities, m/s.
pub(crate) fn surface_speed(bodies: &Bodies, pair: [u32; 2]) -> f32 {
    let spin = |i: u32| match bodies.kind[i as usize] {
        RigidBody::Static => 0.0,
        _ => bodies.angular_velocity[i as usize].length() * bodies.radius[i as usize],
    };
    relative_speed(bodies, pair) + spin(pair[0]) + spin(pair[1])
}

/// Upper bound of the speed that rotation, gravity and external forces add to a body's surface within `dt` seconds,
/// m/s.
pub(crate) fn sway(bodies: &Bodies, config: &StepConfig, i: usize, dt: f32) -> f32 {
    sway_at(bodies, config, i, dt, bodies.radius[i])
}

/// [`sway`] of the surface within `arm` metres of the axis of rotation.
pub(crate) fn sway_at(bodies: &Bodies, config: &StepConfig, i: usize, dt: f32, arm: f32) -> f32 {
    let turn = bodies.angular_velocity[i].length();
    let mut spin = turn * arm;
    if let Some(part) = bodies.part(i as u32) {
        // The velocity of a collider that circles its body's centre of mass changes direction.
        spin += 0.5 * turn * turn * dt * part.offset.length() as f32;
    }
    match bodies.kind[i] {
        RigidBody::Static => 0.0,
        RigidBody::Kinematic => spin,
        RigidBody::Dynamic => {
            let fall = config.gravity.length() * bodies.gravity_scale[i].abs();
            let [force, torque] = bodies.surface_accelerations(i);
            spin + (fall + force + torque) * dt
        }
    }
}
