//! How contact constraints are made from manifolds and from the impulses of the last collision substep.

use super::bodies::SolverBodies;
use super::clearance;
use super::contact::{Pair, Point, frame};
use super::islands::Mobility;
use super::motion::unit;
use super::overlap::{self, Overlap};
use super::pace::Pace;
use super::patch;
use super::softness;
use super::warm_start::{PointMatcher, WarmStart};
use crate::parallel::loops;
use crate::state::{ManifoldPoint, Manifolds};
use crate::types::material::CombineRule;
use crate::types::solver_settings::SolverSettings;
use glam::{DVec3, Vec3, Vec3A};

/// Input for the constraints of a collision substep.
pub(super) struct Source<'a> {
    pub bodies: &'a SolverBodies,
    pub mobility: &'a [Mobility],
    pub paces: &'a [Pace],
    pub manifolds: &'a Manifolds,
    pub warm: &'a WarmStart,
    pub settings: &'a SolverSettings,
    pub gravity: Vec3,
}

/// Pairs that one task makes, at most.
const GRAIN: usize = 256;

impl Source<'_> {
    /// Makes the constraints of the pairs of an island with this pace. `points` are those of all pairs, in order.
    pub fn fill_all(&self, pairs: &mut [Pair], points: &mut [Point], pace: Pace) {
        if pairs.len() > GRAIN {
            let (pairs, more_pairs) = pairs.split_at_mut(pairs.len() / 2);
            let count = pairs.iter().map(|pair| pair.count as usize).sum();
            let (points, more_points) = points.split_at_mut(count);
            loops::join(
                || self.fill_all(pairs, points, pace),
                || self.fill_all(more_pairs, more_points, pace),
            );
            return;
        }
        let mut rest = points;
        for pair in pairs {
            let own;
            (own, rest) = rest.split_at_mut(pair.count as usize);
            self.fill(pair, own, pace);
        }
    }

    /// Makes the constraint of one pair of an island with this pace. Invalid points have no effect.
    fn fill(&self, pair: &mut Pair, points: &mut [Point], pace: Pace) {
        let [a, b] = pair.bodies.map(|i| i as usize);
        let settings = self.settings;
        let bodies = [&self.bodies.bodies[a], &self.bodies.bodies[b]];
        let colliders = pair.colliders.map(|i| &self.bodies.bodies[i as usize]);
        let offsets = pair.colliders.map(|i| self.bodies.offset(i));
        let motions = [&self.bodies.motions[a], &self.bodies.motions[b]];
        let has_mass = [a, b].map(|i| self.mobility[i].has_impulses());
        let diameter = diameter(colliders[0].radius, colliders[1].radius);
        pair.rest_offset = settings.rest_offset * diameter;
        pair.diameter = diameter;
        pair.softness = softness::beside_kinematic(bodies);
        // A light kinematic body needs the exactness of a light dynamic one: it carries its part beside such.
        pair.mass_ratio =
            mass_ratio(bodies.map(|body| body.inverse_mass), has_mass).max((pair.softness - 1.0) / softness::CORNER);
        pair.driven = [0, 1].iter().any(|&side| bodies[side].is_driven(motions[side]));
        pair.friction = CombineRule::combine(colliders.map(|e| e.friction_combine), colliders.map(|e| e.friction));
        let restitution = colliders.map(|e| e.restitution);
        pair.restitution = CombineRule::combine(colliders.map(|e| e.restitution_combine), restitution).min(1.0);
        pair.tangent_velocity = Vec3::ZERO;
        if let Some(surface) = self.manifolds.surface_of(pair.colliders) {
            (pair.friction, pair.restitution) = (surface.friction, surface.restitution);
            pair.tangent_velocity = surface.tangent_velocity;
        }

        let center_offset = motions[1].center - motions[0].center;
        let surface_speeds = [0, 1].map(|side| motions[side].angular_velocity.length() * bodies[side].extent);
        let first = pair.source as usize;
        let manifold = &self.manifolds.points[first..first + points.len()];
        let last = self.warm.find(pair.colliders.map(|i| self.bodies.keys[i as usize]));
        let motion = overlap::RelativeMotion {
            center_offset: center_offset.as_vec3() + (offsets[1] - offsets[0]),
            approach: (motions[0].linear_velocity - motions[1].linear_velocity) * pace.dt,
            angular_travel: (surface_speeds[0] + surface_speeds[1]) * pace.dt,
            has_mass,
        };
        let overlap = overlap::classify(manifold, last.as_ref(), diameter, &motion, settings);
        pair.substep = pace.h();
        pair.known = last.is_some();
        pair.depenetrating = false;
        pair.separating_direction = Vec3::ZERO;
        match overlap {
            Overlap::Deep(normal) => {
                pair.depenetrating = true;
                points.fill(Point::NONE);
                let deepest = manifold.iter().map(|p| p.separation).fold(0.0, f32::min);
                points[0] = depenetration_point(normal, deepest - pair.rest_offset);
                return;
            }
            Overlap::Conflicting(direction) => pair.separating_direction = direction,
            _ => {}
        }
        let mut matcher = PointMatcher::new(
            last.as_ref(),
            motions.map(|motion| unit(motion.rotation)),
            settings,
            diameter,
            pair.substep,
        );
        let may_be_tight = clearance::may_be_tight(manifold);
        for (point, own) in points.iter_mut().zip(manifold) {
            let conflicts = own.separation < 0.0 && own.normal.dot(pair.separating_direction) < 0.0;
            *point = if conflicts {
                Point::NONE
            } else {
                let rest_offset = if may_be_tight {
                    clearance::rest_offset(own, manifold, pair.rest_offset)
                } else {
                    pair.rest_offset
                };
                contact_point(own, center_offset, offsets, rest_offset)
            };
        }
        if pair.friction > 0.0 {
            patch::spread_friction(points, diameter);
        }
        for (point, manifold) in points.iter_mut().zip(manifold) {
            if point.valid
                && let Some((impulse, friction)) = matcher.find(manifold)
            {
                point.normal_impulse = impulse;
                point.touched = impulse > 0.0;
                // The saved impulse belongs to the last collision substep, so it does not count in this one's total.
                point.total_normal_impulse = -impulse;
                point.friction_impulse = [1, 2].map(|i| point.frame[i].dot(friction.into()));
            }
        }
    }
}

/// The constraint point of a manifold's point; [`Point::NONE`] if its numbers are invalid.
fn contact_point(manifold: &ManifoldPoint, center_offset: DVec3, offsets: [Vec3; 2], rest_offset: f32) -> Point {
    let valid = manifold.normal.is_normalized()
        && manifold.gap().is_finite()
        && manifold.normal_rotation.is_finite()
        && manifold.anchors.iter().all(|anchor| anchor.is_finite());
    if !valid {
        return Point::NONE;
    }
    let [a, b] = manifold.anchors;
    Point {
        anchors: manifold.anchors.map(Vec3A::from),
        curvature_centers: manifold.curvature_centers(offsets).map(Vec3A::from),
        contact_fraction: contact_fraction(manifold.curvature_radii),
        anchor_offset: (center_offset + b.as_dvec3() - a.as_dvec3()).as_vec3a(),
        normal_rotation: manifold.normal_rotation,
        frame: frame(manifold.normal),
        initial_separation: manifold.gap() - rest_offset,
        valid: true,
        ..Point::NONE
    }
}

/// The only active point of a pair in deep penetration. Its impulses act at the centres of mass.
fn depenetration_point(normal: Vec3, separation: f32) -> Point {
    Point {
        frame: frame(normal),
        initial_separation: separation,
        valid: true,
        ..Point::NONE
    }
}

/// Where impulses act between the two anchors, by the radii of curvature: on the sharper body, which is 0 for the first
/// and 1 for the second.
fn contact_fraction([a, b]: [f32; 2]) -> f32 {
    let fraction = a / (a + b);
    if fraction.is_finite() {
        fraction
    } else if a.is_infinite() && !b.is_infinite() {
        1.0
    } else if b.is_infinite() && !a.is_infinite() {
        0.0
    } else {
        0.5
    }
}

/// The mass of the heavier body over that of the lighter one.
fn mass_ratio([a, b]: [f32; 2], has_mass: [bool; 2]) -> f32 {
    let ratio = (a / b).max(b / a);
    if has_mass == [true; 2] && ratio.is_finite() {
        ratio
    } else {
        1.0
    }
}

/// The smaller bounding diameter; 0 if neither is a positive, finite number.
fn diameter(a: f32, b: f32) -> f32 {
    let smaller = 2.0 * a.min(b);
    if smaller > 0.0 && smaller.is_finite() {
        smaller
    } else {
        0.0
    }
}
