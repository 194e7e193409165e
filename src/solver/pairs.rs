//! What a pair does in a pass: from the velocities of its bodies, an impulse for each.

use super::constraints::{Impulse, Pair, Point, Row};
use super::motion::{Mass, Movers, Velocity, change};
use super::softness::Softness;
use crate::types::solver_settings::SolverSettings;
use glam::Vec3A;

/// Gauss-Seidel sweeps over the points of a pair that bounces: it happens once per interval, and has to be right.
pub(super) const BOUNCE_SWEEPS: u32 = 6;
/// Points push if they come nearer than this part of the rest offset within the substep.
pub(super) const REST_PART: f32 = 0.5;

/// What holds for all pairs in a pass.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pass {
    /// Length of the substep.
    h: f32,
    softness: Softness,
    /// Part of a correction applied at once.
    relaxation: f32,
    sweeps: u32,
    max_depenetration_speed: f32,
    deep_depenetration_speed: f32,
    /// Pushes overlapping bodies apart.
    biased: bool,
}

impl Pass {
    pub fn new(settings: &SolverSettings, h: f32) -> Self {
        Self {
            h,
            softness: Softness::new(settings, h),
            relaxation: settings.relaxation,
            sweeps: settings.sweeps,
            max_depenetration_speed: settings.max_depenetration_speed,
            deep_depenetration_speed: settings.deep_depenetration_speed,
            biased: true,
        }
    }

    pub fn relaxing(self) -> Self {
        Self { biased: false, ..self }
    }

    /// The speed that a point asks for beyond none at all, and its softness.
    fn bias(&self, pair: &Pair, separation: f32) -> (f32, f32, f32) {
        if separation > 0.0 {
            // They may meet by the end of the substep, and no sooner.
            (separation / self.h, 1.0, 0.0)
        } else if !self.biased {
            (0.0, 1.0, 0.0)
        } else if pair.depenetrating {
            // Slower towards the end, where the spring of other pairs is as fast.
            let speed = (self.softness.bias_rate * separation).max(-self.deep_depenetration_speed);
            (speed, 1.0, 0.0)
        } else {
            let speed = (self.softness.bias_rate * separation).max(-self.max_depenetration_speed);
            (speed, self.softness.mass_scale, self.softness.impulse_scale)
        }
    }
}

/// Where a pair's points are now, and how their bodies give way there.
pub(super) fn measure(pair: &Pair, points: &mut [Point], movers: &Movers) {
    if pair.frozen {
        return;
    }
    let [a, b] = pair.bodies.map(|i| movers.shifts[i as usize]);
    let masses = pair.bodies.map(|i| movers.masses[i as usize]);
    let moved = b.moved - a.moved;
    for point in points.iter_mut().filter(|p| p.usable) {
        let mut levers = [Vec3A::ZERO; 2];
        if pair.depenetrating {
            point.separation = point.first_separation + point.normal().dot(moved);
        } else {
            let turns = [change(a.turned, point.rounds[0]), change(b.turned, point.rounds[1])];
            let offset = moved + turns[1] - turns[0];
            point.turn_with(offset);
            point.separation = point.separation_after(offset);
            // One place for both, or the two impulses would turn the pair.
            let offset = point.offset + offset;
            levers = [
                point.anchors[0] + turns[0] + point.along * offset,
                point.anchors[1] + turns[1] - (1.0 - point.along) * offset,
            ];
        }
        let mut gives = [[0.0; 3]; 2];
        for (i, row) in point.rows.iter_mut().enumerate() {
            let d = row.direction;
            row.moments = levers.map(|lever| lever.cross(d));
            row.turns = [0, 1].map(|end| masses[end].inverse_inertia * row.moments[end]);
            for (end, give) in gives.iter_mut().enumerate() {
                give[i] = (masses[end].inverse_mass * d).dot(d) + row.moments[end].dot(row.turns[end]);
            }
        }
        // One number for both tangents: with two, friction would not point against the sliding.
        point.give = gives.map(|[normal, one, other]| [normal, one.max(other)]);
    }
}

/// Measures the points, finds out which of them push, and gives the impulses of the last substep again.
pub(super) fn begin_substep(pair: &mut Pair, points: &mut [Point], movers: &Movers, pass: &Pass) -> [Impulse; 2] {
    pair.active = false;
    if pair.frozen {
        return [Impulse::default(); 2];
    }
    measure(pair, points, movers);
    let mut local = Local::new(pair, movers);
    for point in points.iter_mut().filter(|p| p.usable) {
        // As fast as before anything was pushed: what is pushed here shows in the next pass.
        let parting = local.parting(&point.rows[0]);
        point.total += point.impulse;
        if point.largest == 0.0 {
            point.impact = parting;
        }
        point.active = point.impulse > 0.0 || point.separation + parting * pass.h < REST_PART * pair.rest_offset;
        if !point.active {
            point.impulse = 0.0;
            point.friction = [0.0; 2];
            continue;
        }
        pair.active = true;
        local.note(&point.rows[0], point.impulse);
        local.note(&point.rows[1], point.friction[0]);
        local.note(&point.rows[2], point.friction[1]);
    }
    local.out()
}

/// A pair by itself: its bodies, each with this pair's share of its mass.
struct Local {
    velocities: [Velocity; 2],
    /// With the share.
    inverse_masses: [Vec3A; 2],
    shares: [f32; 2],
    /// The impulse on the second body; the first has its opposite.
    linear: Vec3A,
    angular: [Vec3A; 2],
}

impl Local {
    fn new(pair: &Pair, movers: &Movers) -> Self {
        let masses: [&Mass; 2] = pair.bodies.map(|i| &movers.masses[i as usize]);
        Self {
            velocities: pair.bodies.map(|i| movers.velocities[i as usize]),
            inverse_masses: masses.map(|m| m.share * m.inverse_mass),
            shares: masses.map(|m| m.share),
            linear: Vec3A::ZERO,
            angular: [Vec3A::ZERO; 2],
        }
    }

    /// Change of speed per impulse along the normal and across; `None` if nothing gives way along the normal.
    fn give(&self, point: &Point) -> Option<[f32; 2]> {
        let [a, b] = self.shares;
        let give = [0, 1].map(|d| a * point.give[0][d] + b * point.give[1][d]);
        (give[0] > 0.0).then_some(give)
    }

    /// How fast the bodies part along a row.
    fn parting(&self, row: &Row) -> f32 {
        let [a, b] = &self.velocities;
        let sum = row.direction * (b.linear - a.linear) + row.moments[1] * b.angular - row.moments[0] * a.angular;
        sum.element_sum()
    }

    /// Adds an impulse on the second body, and its opposite on the first, to what the pair hands out.
    fn note(&mut self, row: &Row, impulse: f32) {
        self.linear += row.direction * impulse;
        self.angular[0] -= row.moments[0] * impulse;
        self.angular[1] += row.moments[1] * impulse;
    }

    /// The same, and changes the velocities.
    fn push(&mut self, row: &Row, impulse: f32) {
        self.note(row, impulse);
        let linear = row.direction * impulse;
        let [a, b] = &mut self.velocities;
        a.linear -= self.inverse_masses[0] * linear;
        a.angular -= row.turns[0] * (self.shares[0] * impulse);
        b.linear += self.inverse_masses[1] * linear;
        b.angular += row.turns[1] * (self.shares[1] * impulse);
    }

    fn out(&self) -> [Impulse; 2] {
        let [first, second] = self.angular;
        [
            Impulse {
                linear: -self.linear,
                angular: first,
            },
            Impulse {
                linear: self.linear,
                angular: second,
            },
        ]
    }
}

/// One pass over a pair's points.
pub(super) fn solve(pair: &Pair, points: &mut [Point], movers: &Movers, pass: &Pass) -> [Impulse; 2] {
    if !pair.active {
        return [Impulse::default(); 2];
    }
    let mut local = Local::new(pair, movers);
    for _ in 0..pass.sweeps {
        for point in points.iter_mut().filter(|p| p.active) {
            let Some(give) = local.give(point) else {
                continue;
            };
            let (bias, mass_scale, impulse_scale) = pass.bias(pair, point.separation);
            let wanted = local.parting(&point.rows[0]) + bias;
            let change = -pass.relaxation * mass_scale * wanted / give[0] - impulse_scale * point.impulse;
            let impulse = (point.impulse + change).max(0.0);
            local.push(&point.rows[0], impulse - point.impulse);
            point.impulse = impulse;
            point.largest = point.largest.max(impulse);

            let limit = if pair.depenetrating {
                0.0
            } else {
                pair.friction * impulse
            };
            let friction = slide(&local, point, give[1], point.friction, pass.relaxation, limit);
            local.push(&point.rows[1], friction[0] - point.friction[0]);
            local.push(&point.rows[2], friction[1] - point.friction[1]);
            point.friction = friction;
        }
    }
    local.out()
}

/// The friction impulse that stops the points from sliding, shortened to `limit`.
fn slide(local: &Local, point: &Point, give: f32, so_far: [f32; 2], part: f32, limit: f32) -> [f32; 2] {
    if give <= 0.0 {
        return so_far;
    }
    let wanted = [0, 1].map(|d| so_far[d] - part * local.parting(&point.rows[d + 1]) / give);
    let square = wanted[0] * wanted[0] + wanted[1] * wanted[1];
    if square > limit * limit {
        wanted.map(|w| w * (limit / square.sqrt()))
    } else {
        wanted
    }
}

/// Makes a pair active if some of its points met fast enough to bounce.
pub(super) fn begin_bounce(pair: &mut Pair, points: &mut [Point], threshold: f32) {
    pair.active = false;
    if pair.frozen || pair.depenetrating || pair.restitution <= 0.0 {
        return;
    }
    for point in points {
        point.active = point.usable && point.impact < -threshold && point.largest > 0.0;
        pair.active |= point.active;
    }
}

/// One pass that turns round the speed at which a pair's points met (Newton's law of impact), with the friction that goes
/// with it.
pub(super) fn bounce(pair: &Pair, points: &mut [Point], movers: &Movers) -> [Impulse; 2] {
    if !pair.active {
        return [Impulse::default(); 2];
    }
    let mut local = Local::new(pair, movers);
    for _ in 0..BOUNCE_SWEEPS {
        for point in points.iter_mut().filter(|p| p.active) {
            let Some(give) = local.give(point) else {
                continue;
            };
            let wanted = local.parting(&point.rows[0]) + pair.restitution * point.impact;
            let impulse = (point.bounce - wanted / give[0]).max(0.0);
            local.push(&point.rows[0], impulse - point.bounce);
            point.bounce = impulse;

            let friction = slide(
                &local,
                point,
                give[1],
                point.bounce_friction,
                1.0,
                pair.friction * impulse,
            );
            local.push(&point.rows[1], friction[0] - point.bounce_friction[0]);
            local.push(&point.rows[2], friction[1] - point.bounce_friction[1]);
            point.bounce_friction = friction;
        }
    }
    local.out()
}
