//! Speculative margins: surfaces closer than their margin get contact points, because they may meet before the next
//! collision substep.
//!
//! A pair's margin follows the relative velocity of its bodies, so bodies that move together have none from motion. It
//! is capped at twice the thickness of the thinner body; fast bodies get more collision substeps instead. If a third
//! body changes the motion of one of the two, the next collision substep accounts for it.

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
        let has_continuous = bodies.params.iter().any(|params| params.continuous);
        self.set_radii(bodies, config, |travel, thickness| {
            if has_continuous {
                travel
            } else {
                travel.min(BOUND * thickness)
            }
        });
    }

    /// The same without a cap on the travel: spheres of bodies that cannot meet before the next collision
    /// substep do not overlap.
    pub fn set_reach(self, bodies: &mut Bodies, config: &StepConfig) {
        self.set_radii(bodies, config, |travel, _| travel);
    }

    fn set_radii(self, bodies: &mut Bodies, config: &StepConfig, cap: impl Fn(f32, f32) -> f32) {
        let mut radii = std::mem::take(&mut bodies.speculative_radius);
        radii.clear();
        radii.extend(bodies.radius.iter().enumerate().map(|(i, &radius)| {
            let travel = match self {
                Self::Moving { drift } if bodies.kind[i] != RigidBody::Static => {
                    let dt = bodies.travel_time[i];
                    let speed = (bodies.linear_velocity[i] - drift).length() + sway(bodies, config, i, dt);
                    cap(SAFETY * speed * dt, bodies.thickness[i])
                }
                _ => 0.0,
            };
            radius + self.contact_margin(config) * radius + travel
        }));
        bodies.speculative_radius = radii;
    }

    /// The speculative margin of a pair, metres.
    pub fn of_pair(self, bodies: &Bodies, config: &StepConfig, pair: [u32; 2]) -> f32 {
        let [a, b] = pair.map(|i| i as usize);
        let diameter = 2.0 * bodies.radius[a].min(bodies.radius[b]);
        let travel = match self {
            Self::Moving { .. } => {
                let dt = bodies.travel_time[a].max(bodies.travel_time[b]);
                let [v, w] = [a, b].map(|i| match bodies.kind[i] {
                    RigidBody::Static => Vec3::ZERO,
                    _ => bodies.linear_velocity[i],
                });
                let sway = [a, b].map(|i| sway(bodies, config, i, dt));
                let bound = BOUND * bodies.thickness[a].min(bodies.thickness[b]);
                (SAFETY * ((w - v).length() + sway[0] + sway[1]) * dt).min(bound)
            }
            _ => 0.0,
        };
        self.contact_margin(config) * diameter + travel
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

/// Upper bound of the speed that rotation, gravity and external forces add to a body's surface within `dt` seconds, m/s.
pub(crate) fn sway(bodies: &Bodies, config: &StepConfig, i: usize, dt: f32) -> f32 {
    let turn = bodies.angular_velocity[i].length();
    let mut spin = turn * bodies.radius[i];
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
