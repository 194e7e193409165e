//! A contact point of an island, and the laws between its impulses and velocities.
//!
//! Impulse and slack of a normal are positive, and their product is the *barrier*, a number that falls to zero.
//! Friction is `-limit v / sqrt(v^2 + least^2)` for the sliding velocity `v`; `least` falls with the barrier. Its
//! linearisation treats friction as an unknown of its own (Chan, Golub and Mulet, "A nonlinear primal-dual method for
//! total variation-based image restoration", 1999), so that it converges from afar.

use super::super::batch::{Batch, PointLanes, RowLanes};
use super::blocks::{N, Vector};
use crate::geometry::lanes::Stored;
use crate::simd::lanes::lane_of;

/// A rigid constraint with friction gives way by this part of the velocity that its impulse changes. So points that
/// hold the same load have unique impulses, and unique limits of friction.
const GIVE: f64 = 1.0e-4;
/// It gives way by at most this, m/s, whatever its load.
const MOST_GIVE: f64 = 4.0e-3;
/// Friction that holds slides by this part of the velocity that its limit would change.
const CREEP: f64 = 1.0e-3;

/// Along the normal and two tangents.
pub(super) type Triple = [f64; 3];

/// The two sides of a row of the Jacobian.
pub(super) type Row = [Vector; 2];

/// The bodies of a pair.
pub(super) struct PairSides {
    pub velocities: [Vector; 2],
    /// 1 for each unknown that impulses change, 0 for others.
    pub free: [Vector; 2],
}

/// An active point. Impulses are times the inverse effective mass of the normal, so they are velocities too, m/s.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    /// Only unknowns that impulses change have coefficients.
    pub rows: [Row; 3],
    /// How far the velocities along the rows are from what the pass aims at: before the solve, and now.
    pub initial_errors: Triple,
    pub errors: Triple,
    /// Velocity error per impulse that the contact spring allows; 0 if it is rigid.
    pub compliance: f64,
    /// An impulse of 1 in newton seconds.
    pub unit: f64,
    pub friction: f64,
    /// Whether the normal and the friction are solved.
    pub is_solved: bool,
    pub rubs: bool,
    /// Impulses before the solve, and now.
    pub start: Triple,
    pub impulses: Triple,
    /// The largest friction impulse.
    pub limit: f64,
    /// How far the normal velocity is above the least that is allowed; positive.
    pub slack: f64,
    /// Changes of impulses and slack.
    pub change: Triple,
    pub slack_change: f64,
}

impl Point {
    /// The point in a lane.
    pub fn new(batch: &Batch, point: &PointLanes, lane: usize, sides: &PairSides) -> Self {
        let of = |stored: &Stored| f64::from(stored.0[lane]);
        let aim = &point.aim;
        let targets = [&aim.bias, &aim.surface_speed[0], &aim.surface_speed[1]].map(of);
        let inverse_mass = of(&point.inverse_effective_mass[0]);
        let response = of(&aim.normal_response);
        let is_solved = response > 0.0 && inverse_mass > 0.0;
        let unit = if is_solved { 1.0 / inverse_mass } else { 1.0 };
        let start = [
            &point.normal_impulse,
            &point.friction_impulse[0],
            &point.friction_impulse[1],
        ]
        .map(of);
        let start = start.map(|impulse| impulse / unit);
        let mut rows = point.rows.each_ref().map(|row| whole_row(row, lane));
        let errors = std::array::from_fn(|i| along(&rows[i], &sides.velocities) + targets[i]);
        for row in &mut rows {
            for (side, free) in row.iter_mut().zip(&sides.free) {
                for (coefficient, free) in side.iter_mut().zip(free) {
                    *coefficient *= free;
                }
            }
        }
        let friction = of(&batch.friction);
        let least_compliance = if friction > 0.0 {
            GIVE.min(MOST_GIVE / start[0].max(f64::MIN_POSITIVE))
        } else {
            0.0
        };
        Self {
            rows,
            initial_errors: errors,
            errors,
            compliance: if is_solved {
                (of(&aim.impulse_scale) / response * unit).max(least_compliance)
            } else {
                0.0
            },
            unit,
            friction,
            is_solved,
            rubs: is_solved && friction > 0.0 && of(&aim.friction_response) > 0.0,
            start,
            impulses: start,
            limit: friction * start[0],
            slack: 0.0,
            change: [0.0; 3],
            slack_change: 0.0,
        }
    }

    /// Goes back to the errors and impulses before the solve, and changes slack and impulse so that their product is
    /// the barrier.
    pub fn begin(&mut self, barrier: f64) {
        self.errors = self.initial_errors;
        self.impulses = self.start;
        if !self.is_solved {
            return;
        }
        let root = barrier.sqrt();
        let velocity = self.errors[0] + self.compliance * self.impulses[0];
        if self.impulses[0] >= velocity {
            self.impulses[0] = self.impulses[0].max(root);
            self.slack = barrier / self.impulses[0];
        } else {
            self.slack = velocity.max(root);
            self.impulses[0] = barrier / self.slack;
        }
        self.limit = self.friction * self.impulses[0];
        self.limit_friction();
    }

    /// The change of the normal impulse is the second number, less the first one times the change of the velocity.
    #[inline(always)]
    pub fn normal_law(&self, barrier: f64) -> (f64, f64) {
        let (p, s) = (self.impulses[0], self.slack);
        let residual = self.errors[0] + self.compliance * p - s;
        let inverse = 1.0 / (s + p * self.compliance);
        (p * inverse, (barrier - p * s - p * residual) * inverse)
    }

    /// The change of friction is the second vector, less the first matrix (tt, tu, uu) times the change of the
    /// velocities.
    #[inline(always)]
    pub fn friction_law(&self, barrier: f64) -> ([f64; 3], [f64; 2]) {
        let [_, s, t] = self.errors;
        let [p, q, r] = self.impulses;
        let limit = self.limit;
        // The sliding speed below which friction is less than its limit.
        let least = (0.1 * barrier / (p + barrier.sqrt())).max(CREEP * limit);
        let n = (s * s + t * t + least * least).sqrt();
        let inverse = 1.0 / n;
        let (qs, qt) = (q * inverse, r * inverse);
        let matrix = [
            (limit + qs * s) * inverse,
            0.5 * (qs * t + qt * s) * inverse,
            (limit + qt * t) * inverse,
        ];
        (matrix, [-q - limit * s * inverse, -r - limit * t * inverse])
    }

    /// Shortens friction to its limit.
    #[inline(always)]
    pub fn limit_friction(&mut self) {
        let limit = self.limit;
        let [_, q, r] = self.impulses;
        let length = (q * q + r * r).sqrt();
        if !self.rubs {
            (self.impulses[1], self.impulses[2]) = (0.0, 0.0);
        } else if length > limit {
            self.impulses[1] *= limit / length;
            self.impulses[2] *= limit / length;
        }
    }

    /// The impulses of the solution, newton seconds. A point that separates has none.
    pub fn result(&self) -> [f32; 3] {
        let impulses = if !self.is_solved {
            self.start
        } else if self.impulses[0] > self.slack {
            self.impulses
        } else {
            [0.0; 3]
        };
        impulses.map(|impulse| (impulse * self.unit) as f32)
    }
}

/// A row with the coefficients of all unknowns.
fn whole_row(row: &RowLanes, lane: usize) -> Row {
    let direction = lane_of(&row.direction, lane).to_array().map(f64::from);
    [0, 1].map(|side| {
        let sign = [-1.0, 1.0][side];
        let moment = lane_of(&row.moments[side], lane).to_array().map(f64::from);
        std::array::from_fn(|i| sign * if i < 3 { direction[i] } else { moment[i - 3] })
    })
}

/// The relative velocity along a row.
#[inline(always)]
pub(super) fn along(row: &Row, velocities: &[Vector; 2]) -> f64 {
    dot(&row[0], &velocities[0]) + dot(&row[1], &velocities[1])
}

#[inline(always)]
pub(super) fn dot(a: &Vector, b: &Vector) -> f64 {
    (0..N).map(|i| a[i] * b[i]).sum()
}
