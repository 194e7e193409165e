//! How fast bodies move against each other: what decides into how many collision substeps a step is cut.

use super::bodies::SolverBodies;
use crate::types::solver_settings::{MAX_COLLISION_SUBSTEPS, SolverSettings};
use glam::{BVec3, Vec3};

/// Bounds on the velocities of some bodies. Only differences between velocities count, so that bodies which all move alike are
/// as good as at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Speeds {
    /// The least and the largest velocity along each axis, m/s.
    low: Vec3,
    high: Vec3,
    /// The largest speed of any surface about its body's centre of mass, m/s.
    spin: f32,
    /// Something is at rest that never moves.
    ground: bool,
}

impl Default for Speeds {
    fn default() -> Self {
        Self::NONE
    }
}

impl Speeds {
    /// Of no bodies.
    pub const NONE: Self = Self {
        low: Vec3::INFINITY,
        high: Vec3::NEG_INFINITY,
        spin: 0.0,
        ground: false,
    };

    /// Of bodies whose velocities lie between `low` and `high`, and whose surfaces turn no faster than `spin`, m/s. If some
    /// `low` exceeds its `high` there are none.
    pub fn between(low: Vec3, high: Vec3, spin: f32) -> Self {
        Self {
            low,
            high,
            spin,
            ground: false,
        }
    }

    /// Of all solid bodies and half-spaces but those that `skip` names. Bodies that are stopped where they first meet others
    /// are left out: they do not need a step to be cut up.
    pub fn of(bodies: &SolverBodies, skip: impl Fn(usize) -> bool) -> Self {
        let mut speeds = Self::NONE;
        for (i, ((body, motion), sleep)) in bodies.bodies.iter().zip(&bodies.motions).zip(&bodies.sleep).enumerate() {
            // Sensors that stand still are ground too: what flies past them is seen from there.
            speeds.ground |= !body.moves();
            if !body.solid || (body.continuous && body.moves()) || skip(i) {
                continue;
            }
            if !body.moves() || sleep.asleep {
                speeds.add(Vec3::ZERO, 0.0);
            } else {
                speeds.add(motion.linear_velocity, motion.angular_velocity.length() * body.radius);
            }
        }
        speeds
    }

    /// Takes in a body.
    pub fn add(&mut self, velocity: Vec3, spin: f32) {
        self.low = self.low.min(velocity);
        self.high = self.high.max(velocity);
        self.spin_up(spin);
    }

    /// Takes in a body of which only velocities along these axes are known.
    pub fn add_along(&mut self, axes: BVec3, velocity: Vec3) {
        self.low = Vec3::select(axes, self.low.min(velocity), self.low);
        self.high = Vec3::select(axes, self.high.max(velocity), self.high);
    }

    /// Takes in a surface that turns about its body's centre of mass, m/s.
    pub fn spin_up(&mut self, spin: f32) {
        self.spin = self.spin.max(spin);
    }

    /// Of these bodies and others.
    pub fn and(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            spin: self.spin.max(other.spin),
            ground: self.ground | other.ground,
        }
    }

    /// The same bodies, of which any may have been pushed by this much, m/s at any point of it, and may have been sped up by
    /// `fall`, m/s.
    pub fn after(self, push: f32, fall: Vec3) -> Self {
        Self {
            low: self.low.min(self.low + fall) - push,
            high: self.high.max(self.high + fall) + push,
            spin: self.spin + push,
            ground: self.ground,
        }
    }

    /// How fast two surfaces can move against each other at most, m/s.
    pub fn relative(&self) -> f32 {
        if self.low.cmple(self.high).all() {
            (self.high - self.low).length() + self.spin
        } else {
            self.spin
        }
    }

    /// The velocity against which bodies are slowest, m/s: none where there is ground, else that in the middle.
    pub fn drift(&self) -> Vec3 {
        let middle = 0.5 * (self.low + self.high);
        if !self.ground && middle.is_finite() {
            middle
        } else {
            Vec3::ZERO
        }
    }

    /// Into how many collision substeps a step of `dt` seconds must be cut so that no two surfaces of bodies with these speeds
    /// move further against each other in one than [`SolverSettings::collision_substep_travel`] of the thinnest body; 1 to
    /// [`SolverSettings::max_collision_substeps`].
    pub fn collision_substeps(&self, settings: &SolverSettings, bodies: &SolverBodies, dt: f32) -> u32 {
        let solid = bodies.bodies.iter().filter(|body| body.solid);
        let thinnest = solid.map(|body| body.thickness).fold(f32::INFINITY, f32::min);
        let wanted = (self.relative() * dt / (settings.collision_substep_travel * thinnest)).ceil();
        // A float becomes the nearest integer, and NaN zero.
        (wanted as u32).clamp(1, settings.max_collision_substeps.clamp(1, MAX_COLLISION_SUBSTEPS))
    }
}
