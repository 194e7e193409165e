//! Bounds on the relative speeds of bodies. They determine the number of collision substeps.

use super::bodies::SolverBodies;
use crate::types::solver_settings::{MAX_COLLISION_SUBSTEPS, SolverSettings};
use glam::{BVec3, Vec3};

/// Bounds on the velocities of a set of bodies. Only differences between velocities count: bodies with the same
/// velocity need as few collision substeps as bodies at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Speeds {
    /// The smallest and the largest velocity along each axis, m/s.
    low: Vec3,
    high: Vec3,
    /// The largest speed of any surface relative to its body's centre of mass, m/s.
    spin: f32,
    /// There is a static body.
    has_static: bool,
}

impl Default for Speeds {
    fn default() -> Self {
        Self::NONE
    }
}

impl Speeds {
    /// Bounds for no bodies.
    pub const NONE: Self = Self {
        low: Vec3::INFINITY,
        high: Vec3::NEG_INFINITY,
        spin: 0.0,
        has_static: false,
    };

    /// Bounds for bodies whose velocities lie between `low` and `high`, and whose surfaces move no faster than `spin`
    /// relative to their centres of mass, m/s. There are no bodies if some `low` exceeds its `high`.
    pub fn between(low: Vec3, high: Vec3, spin: f32) -> Self {
        Self {
            low,
            high,
            spin,
            has_static: false,
        }
    }

    /// Bounds for all solid bodies and planes except those for which `skip` is true, within `dt` seconds. Bodies with
    /// continuous collision detection are left out, because they need no collision substeps.
    pub fn of(bodies: &SolverBodies, dt: f32, skip: impl Fn(usize) -> bool) -> Self {
        let mut speeds = Self::NONE;
        for i in bodies.movers().filter(|&i| !skip(i)) {
            speeds.include(bodies, i, dt);
        }
        if bodies.still().1 {
            speeds.add(Vec3::ZERO);
        }
        // A static sensor counts as well: speeds of bodies that pass it are relative to it.
        speeds.has_static = bodies.statics().any;
        speeds
    }

    /// Includes body `i`, if it is solid and needs collision substeps, with the speed that external forces give it
    /// within `dt` seconds.
    pub fn include(&mut self, bodies: &SolverBodies, i: usize, dt: f32) {
        if bodies.bodies[i].solid {
            self.include_velocity(bodies, i, dt);
            self.spin_up(Self::spin_of(bodies, i, dt));
        }
    }

    /// Includes body `i` without its rotation, solid or not.
    pub fn include_velocity(&mut self, bodies: &SolverBodies, i: usize, dt: f32) {
        let body = &bodies.bodies[i];
        if !body.moves() || !body.continuous && bodies.sleep[i].asleep {
            self.add(Vec3::ZERO);
        } else if !body.continuous {
            let velocity = bodies.motions[i].linear_velocity;
            let (push, _) = bodies.accelerations(i);
            self.add(velocity);
            self.add(velocity + push * dt);
        }
    }

    /// Upper bound of the speed of the surface of body `i` relative to its centre of mass within `dt` seconds, m/s; 0
    /// if it needs no collision substeps.
    pub fn spin_of(bodies: &SolverBodies, i: usize, dt: f32) -> f32 {
        let body = &bodies.bodies[i];
        if !body.moves() || body.continuous || bodies.sleep[i].asleep {
            return 0.0;
        }
        let (_, turn) = bodies.accelerations(i);
        (bodies.motions[i].angular_velocity.length() + turn * dt) * body.extent
    }

    /// Includes a body with this velocity.
    pub fn add(&mut self, velocity: Vec3) {
        self.low = self.low.min(velocity);
        self.high = self.high.max(velocity);
    }

    /// Includes a body whose velocity is known only along these axes.
    pub fn add_along(&mut self, axes: BVec3, velocity: Vec3) {
        self.low = Vec3::select(axes, self.low.min(velocity), self.low);
        self.high = Vec3::select(axes, self.high.max(velocity), self.high);
    }

    /// The largest speed of any surface relative to its body's centre of mass, m/s.
    pub fn spin(&self) -> f32 {
        self.spin
    }

    /// Includes a surface that moves with this speed relative to its body's centre of mass, m/s.
    pub fn spin_up(&mut self, spin: f32) {
        self.spin = self.spin.max(spin);
    }

    /// Bounds for the bodies of both.
    pub fn and(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            spin: self.spin.max(other.spin),
            has_static: self.has_static | other.has_static,
        }
    }

    /// Bounds for these bodies after impulses have changed the velocity of their points by up to `push`, and gravity
    /// their velocity by up to `fall`, m/s.
    pub fn after(self, push: f32, fall: Vec3) -> Self {
        Self {
            low: self.low.min(self.low + fall) - push,
            high: self.high.max(self.high + fall) + push,
            spin: self.spin + push,
            has_static: self.has_static,
        }
    }

    /// Upper bound for the relative speed of any two surfaces, m/s.
    pub fn relative(&self) -> f32 {
        if self.low.cmple(self.high).all() {
            (self.high - self.low).length() + self.spin
        } else {
            self.spin
        }
    }

    /// The common velocity of the bodies, m/s: zero if there is a static body, otherwise the middle of the bounds.
    pub fn drift(&self) -> Vec3 {
        let middle = 0.5 * (self.low + self.high);
        if !self.has_static && middle.is_finite() {
            middle
        } else {
            Vec3::ZERO
        }
    }

    /// The number of collision substeps that a step of `dt` seconds needs, 1 to
    /// [`SolverSettings::max_collision_substeps`]: enough that in each of them no two surfaces move farther relative to
    /// each other than [`SolverSettings::collision_substep_travel`] of the thinnest body.
    pub fn collision_substeps(&self, settings: &SolverSettings, bodies: &SolverBodies, dt: f32) -> u32 {
        let solid = bodies.movers().map(|i| &bodies.bodies[i]).filter(|body| body.solid);
        let thinnest = solid.map(|body| body.thickness).fold(bodies.still().0, f32::min);
        self.collision_substeps_for(settings, thinnest, dt)
    }

    /// [`Speeds::collision_substeps`] for bodies whose thinnest has the thickness `thinnest`, metres.
    pub fn collision_substeps_for(&self, settings: &SolverSettings, thinnest: f32, dt: f32) -> u32 {
        let wanted = (self.relative() * dt / (settings.collision_substep_travel * thinnest)).ceil();
        // The cast saturates and turns NaN into 0.
        (wanted as u32).clamp(1, settings.max_collision_substeps.clamp(1, MAX_COLLISION_SUBSTEPS))
    }
}
