//! Speculative margins: how far apart surfaces get contact points, because they may meet before the next detection.
//!
//! A pair's margin follows how its two bodies move against each other, so that bodies that fly alike have none. Beyond
//! twice the thickness of the thinner one it does not grow: fast bodies get more collision substeps instead. What happens
//! between two bodies because a third one stops or pushes one of them is seen in the next interval.

use crate::state::{Bodies, StepConfig};
use crate::types::body::RigidBody;
use glam::Vec3;

/// What bodies may move by, as a factor on what their velocities say: contacts turn and push them meanwhile.
pub(crate) const SAFETY: f32 = 1.5;

/// How far bodies look for each other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Margins {
    /// Not at all: only what touches is looked at.
    #[default]
    None,
    /// As far as the contact margin.
    AtRest,
    /// As far as the contact margin and what bodies may move.
    Moving {
        /// Until they are looked at again, seconds.
        interval: f32,
        /// The velocity that bodies have in common, m/s; see [`Speeds::drift`](crate::solver::speeds::Speeds::drift).
        drift: Vec3,
    },
}

/// A margin grows with motion by no more than this many times the thickness of the thinner body.
pub(crate) const BOUND: f32 = 2.0;

impl Margins {
    /// Sets how far all bodies look beyond their spheres. Those of two bodies together are no less than their pair's margin.
    pub fn set_reach(self, bodies: &mut Bodies, config: &StepConfig) {
        let mut reach = std::mem::take(&mut bodies.reach);
        reach.clear();
        // All that a body may meet on its way must be known to stop it there: what is stopped, and what comes towards it.
        let stops = bodies.params.iter().any(|params| params.continuous);
        reach.extend(bodies.radius.iter().enumerate().map(|(i, &radius)| {
            let travel = match self {
                Self::Moving { interval, drift } if bodies.kind[i] != RigidBody::Static => {
                    let speed = (bodies.linear_velocity[i] - drift).length() + sway(bodies, config, i, interval);
                    let travel = SAFETY * speed * interval;
                    if stops {
                        travel
                    } else {
                        travel.min(BOUND * bodies.thickness[i])
                    }
                }
                _ => 0.0,
            };
            radius + self.contact_margin(config) * radius + travel
        }));
        bodies.reach = reach;
    }

    /// How near the surfaces of two bodies must come for points to be found, metres.
    pub fn of_pair(self, bodies: &Bodies, config: &StepConfig, pair: [u32; 2]) -> f32 {
        let [a, b] = pair.map(|i| i as usize);
        let diameter = 2.0 * bodies.radius[a].min(bodies.radius[b]);
        let travel = match self {
            Self::Moving { interval, .. } => {
                let [v, w] = [a, b].map(|i| match bodies.kind[i] {
                    RigidBody::Static => Vec3::ZERO,
                    _ => bodies.linear_velocity[i],
                });
                let sway = [a, b].map(|i| sway(bodies, config, i, interval));
                let bound = BOUND * bodies.thickness[a].min(bodies.thickness[b]);
                (SAFETY * ((w - v).length() + sway[0] + sway[1]) * interval).min(bound)
            }
            _ => 0.0,
        };
        self.contact_margin(config) * diameter + travel
    }

    /// In diameters.
    fn contact_margin(self, config: &StepConfig) -> f32 {
        if self == Self::None {
            0.0
        } else {
            config.solver.margin()
        }
    }
}

/// How fast a body's surface may move within `interval` seconds beside the velocity of its centre, m/s.
fn sway(bodies: &Bodies, config: &StepConfig, i: usize, interval: f32) -> f32 {
    let spin = bodies.angular_velocity[i].length() * bodies.radius[i];
    match bodies.kind[i] {
        RigidBody::Static => 0.0,
        RigidBody::Kinematic => spin,
        RigidBody::Dynamic => spin + config.gravity.length() * bodies.gravity_scale[i].abs() * interval,
    }
}
