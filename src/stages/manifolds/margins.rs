//! How far apart surfaces are looked at: as far as they may move before they are looked at again.

use crate::components::RigidBody;
use crate::stages::state::{Bodies, StepConfig};

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
    },
}

impl Margins {
    /// Sets how far all bodies look beyond their spheres. Those of two bodies together are no less than their pair's margin.
    pub fn set_reach(self, bodies: &mut Bodies, config: &StepConfig) {
        let mut reach = std::mem::take(&mut bodies.reach);
        reach.clear();
        reach.extend(bodies.radius.iter().enumerate().map(|(i, &radius)| {
            let travel = self.travel(bodies, config, i);
            // All that a fast body may meet on its way must be known to stop it there.
            let travel = if bodies.handling.get(i).is_some_and(|h| h.continuous) {
                travel
            } else {
                travel.min(2.0 * radius)
            };
            radius + self.contact_margin(config) * radius + travel
        }));
        bodies.reach = reach;
    }

    /// How near the surfaces of two bodies must come for points to be found, metres. What they may move counts no further
    /// than the diameter of the smaller one: points found from farther away say nothing about where they will meet.
    pub fn of_pair(self, bodies: &Bodies, config: &StepConfig, pair: [u32; 2]) -> f32 {
        let [a, b] = pair.map(|i| i as usize);
        let diameter = 2.0 * bodies.radius[a].min(bodies.radius[b]);
        // Not their relative velocity: of two bodies that move alike one may be stopped by a third.
        let travel = self.travel(bodies, config, a) + self.travel(bodies, config, b);
        self.contact_margin(config) * diameter + travel.min(diameter)
    }

    /// In diameters.
    fn contact_margin(self, config: &StepConfig) -> f32 {
        if self == Self::None {
            0.0
        } else {
            config.solver.margin()
        }
    }

    /// How far a point of the body may move until it is looked at again, metres.
    fn travel(self, bodies: &Bodies, config: &StepConfig, i: usize) -> f32 {
        let Self::Moving { interval } = self else { return 0.0 };
        let speed = bodies.linear_velocity[i].length() + bodies.angular_velocity[i].length() * bodies.radius[i];
        let speed = match bodies.kind[i] {
            RigidBody::Static => 0.0,
            RigidBody::Kinematic => speed,
            RigidBody::Dynamic => speed + config.gravity.length() * bodies.gravity_scale[i].abs() * interval,
        };
        SAFETY * speed * interval
    }
}
