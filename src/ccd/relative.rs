//! Relative pose and motion of two bodies at one time.

use super::Sweep;
use crate::simd::rounding::PAD;
use glam::{DMat3, DVec3, Mat3, Vec3};

/// Rounding error of a speed in single precision, as a fraction of the largest speed.
const SPEED_ERROR: f32 = 2.0e-6;

/// Two bodies at one time, relative to the first one's centre of mass and along its axes. Lengths are in metres,
/// velocities in metres per collision substep.
#[derive(Clone, Copy)]
pub struct Relative {
    /// The time, 0 to 1.
    pub time: f64,
    /// From the second body's axes to the first's.
    pub rotation: DMat3,
    /// From the first body's centre of mass to the second's.
    pub translation: DVec3,
    /// Velocity of the first body's centre of mass relative to the second's.
    pub velocity: DVec3,
    /// Angular velocities, radians per collision substep.
    pub turns: [DVec3; 2],
}

impl Relative {
    /// At time `t`.
    pub fn at(sweeps: [&Sweep; 2], t: f64) -> Self {
        let [a, b] = sweeps;
        let axes = sweeps.map(|sweep| sweep.axes(t));
        let to_a = axes[0].transpose();
        // Subtraction comes first, because the bodies may be far from the origin.
        let apart = (b.before.center - a.before.center) + (b.travel - a.travel) * t;
        Self {
            time: t,
            rotation: to_a * axes[1],
            translation: to_a * apart,
            velocity: to_a * (a.travel - b.travel),
            turns: [to_a * a.turn, to_a * b.turn],
        }
    }

    /// This pose and motion in single precision, with lengths multiplied by `unit`. `size` is the sum of the bounding
    /// radii and `target_distance` the distance at which bodies are stopped, both in metres.
    pub fn rounded(&self, unit: f32, size: f64, target_distance: f64) -> Rounded {
        let scaled = |v: DVec3| (v * f64::from(unit)).as_vec3();
        let rotation = self.rotation.as_mat3();
        let turns = self.turns.map(|turn| turn.as_vec3());
        let axes = |to_frame: DMat3| Frame {
            translation: scaled(to_frame * self.translation),
            velocity: scaled(to_frame * self.velocity),
            turns: self.turns.map(|turn| (to_frame * turn).as_vec3()),
        };
        let rounding = f64::from(PAD) * (size + self.translation.length());
        Rounded {
            rotation,
            back: rotation.transpose(),
            frames: [axes(DMat3::IDENTITY), axes(self.rotation.transpose())],
            turns,
            pad: ((target_distance + rounding) * f64::from(unit)) as f32,
            speed_pad: SPEED_ERROR * (self.velocity.length() * f64::from(unit)) as f32,
        }
    }
}

/// [`Relative`] in single precision, in the pair's own unit of length.
pub struct Rounded {
    pub rotation: Mat3,
    pub back: Mat3,
    /// In the first body's axes and in the second's.
    pub frames: [Frame; 2],
    /// In the first body's axes.
    pub turns: [Vec3; 2],
    /// Gaps are reduced by this: the target distance and the rounding error.
    pub pad: f32,
    /// Closing speeds are increased by this: the rounding error.
    pub speed_pad: f32,
}

/// The vectors of [`Relative`] along one body's axes.
#[derive(Clone, Copy)]
pub struct Frame {
    pub translation: Vec3,
    pub velocity: Vec3,
    pub turns: [Vec3; 2],
}

impl Frame {
    /// For each body and each axis `e`, the largest speed along `e` of a point at unit distance from the axis of
    /// rotation: `|e x w|`.
    pub fn spins(&self) -> [Vec3; 2] {
        self.turns.map(|w| {
            let [x, y, z] = (w * w).to_array();
            let spin = Vec3::new((y + z).sqrt(), (z + x).sqrt(), (x + y).sqrt());
            spin * (1.0 + SPEED_ERROR)
        })
    }
}
