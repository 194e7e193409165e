//! Which speculative points count: those that still lie over their face, or on their edges, when the surfaces meet
//! there.
//!
//! A point ahead of a body lies on the plane through the other body's face, and the solver lets nothing cross that
//! plane. A body that flies past a convex edge crosses it beyond the edge, where there is no surface. So a point counts
//! if the surfaces do not arrive within the collision substep, or if they arrive on the surface. The others are
//! dropped, and [`first_contact`](crate::ccd::first_contact) finds where such a pair meets, if it does.

use super::feature::{Feature, Origin};
use super::inside::is_near;
use super::pair::Pair;
use super::side::Side;
use super::smooth;
use glam::DVec3;

/// Largest distance from a surface at which a point arrives on it, in units of the rest offset. The gap between bodies
/// at rest must not hide a surface, and a body may fly past at that distance.
pub(crate) const TOLERANCE: f64 = 0.25;
/// Searches for the nearest surface, for a pair. Points beyond that are dropped.
const MAX_SEARCHES: u32 = 32;

/// How the colliders of a pair move as far as the solver looks ahead, in world axes; see
/// [`Travel`](crate::state::travel::Travel).
#[derive(Clone, Copy, Debug, Default)]
pub struct PairMotion {
    /// Displacement of the second centre of mass relative to the first, metres.
    pub travel: DVec3,
    /// What gravity and external forces add to it, unless something supports the bodies.
    pub fall: DVec3,
    /// Rotation vectors of both, radians.
    pub turns: [DVec3; 2],
    /// The gap that contacts keep, metres.
    pub rest_offset: f64,
}

/// The motion of a pair in the axes of its first body, as the features of the pair are.
pub struct Arrival<'a> {
    pair: &'a Pair<'a>,
    motion: PairMotion,
    searches: u32,
}

/// Where a feature meets the other surface.
fn place(feature: &Feature) -> DVec3 {
    match feature.origin {
        Origin::Vertex { side, .. } | Origin::VertexEdge { side, .. } => feature.points[usize::from(side)],
        _ => feature.middle(),
    }
}

impl<'a> Arrival<'a> {
    pub fn new(pair: &'a Pair<'a>, motion: &PairMotion) -> Self {
        let motion = PairMotion {
            travel: pair.to_first_axes(motion.travel),
            fall: pair.to_first_axes(motion.fall),
            turns: motion.turns.map(|turn| pair.to_first_axes(turn)),
            ..*motion
        };
        Self {
            pair,
            motion,
            searches: MAX_SEARCHES,
        }
    }

    /// Whether the solver may act on a feature.
    pub fn counts(&mut self, feature: &Feature) -> bool {
        if self.is_certain(feature) {
            return true;
        }
        let (at, fall) = (place(feature), self.motion.fall);
        let way = self.way(at);
        self.arrives(feature, at, way) && (fall == DVec3::ZERO || self.arrives(feature, at, way + fall))
    }

    /// Whether a feature counts without a search for the surface on which it arrives.
    pub fn is_certain(&self, feature: &Feature) -> bool {
        let PairMotion { fall, rest_offset, .. } = self.motion;
        if feature.separation <= rest_offset || self.is_round(feature) {
            return true;
        }
        // What carries a body is not known here. The point must arrive on the surface with and without `fall`.
        let [closing, falling] = [self.way(place(feature)), fall].map(|way| -feature.normal.dot(way));
        closing + falling.max(0.0) <= feature.separation - rest_offset
    }

    /// Whether both surfaces are smooth and convex at the feature. The solver rotates the normal of their contact as
    /// they pass each other.
    fn is_round(&self, feature: &Feature) -> bool {
        (0..2).all(|i| smooth::curvature(&self.pair.sides, feature, i) > 0.0)
    }

    /// Whether a feature at a point arrives on the surface, or not at all.
    fn arrives(&mut self, feature: &Feature, at: DVec3, way: DVec3) -> bool {
        let (gap, closing) = (feature.separation, -feature.normal.dot(way));
        if closing <= gap - self.motion.rest_offset {
            return true;
        }
        // Both times are fractions of the motion.
        let time = (gap / closing).min(1.0);
        let left = (gap - time * closing).max(0.0);
        let way = time * way;
        let error = time * time * self.curvature(at);
        match feature.origin {
            Origin::Vertex { side, .. } => self.vertex_arrives(feature, usize::from(side), way, left, error),
            Origin::Edges(edges) => self.edges_cross(feature, edges, way, left, error),
            Origin::VertexEdge { side, .. } => {
                let side = usize::from(side);
                self.touches(1 - side, feature.points[side] + relative(side, way), left, error)
            }
            Origin::Vertices(_) => self.touches(0, feature.points[1] + way, left, error),
            Origin::Patch { .. } | Origin::Inside => true,
        }
    }

    /// Displacement of the second body's material at a point relative to the first body's.
    fn way(&self, p: DVec3) -> DVec3 {
        let [a, b] = self.arms(p);
        let [turn_a, turn_b] = self.motion.turns;
        self.motion.travel + turn_b.cross(b) - turn_a.cross(a)
    }

    /// Bound of how far the path of a point leaves its straight way, in the axes of either body.
    fn curvature(&self, p: DVec3) -> f64 {
        let [a, b] = self.arms(p).map(DVec3::length);
        let [turn_a, turn_b] = self.motion.turns.map(DVec3::length);
        let straight = self.motion.travel.length();
        0.5 * (turn_a * turn_a * a + turn_b * turn_b * b) + turn_a.max(turn_b) * (straight + turn_b * b + turn_a * a)
    }

    fn arms(&self, p: DVec3) -> [DVec3; 2] {
        [0, 1].map(|i| p - self.pair.sides[i].center)
    }

    /// Whether a vertex of `side` arrives on the other side's surface.
    fn vertex_arrives(&mut self, feature: &Feature, side: usize, way: DVec3, left: f64, error: f64) -> bool {
        let other = 1 - side;
        let place = feature.points[side] + relative(side, way);
        let over = self.pair.sides[other].triangle(feature.triangles[other]);
        let foot = place - over.normal * over.normal.dot(place - over.corners[0]);
        let inside = (0..3).all(|i| {
            let edge = over.corners[(i + 1) % 3] - over.corners[i];
            let across = edge.cross(foot - over.corners[i]).dot(over.normal) * over.winding_sign;
            across >= error * edge.length()
        });
        inside || self.touches(other, place, left, error)
    }

    /// Whether two edges still cross when they arrive. Where one of them has ended, another may continue it.
    fn edges_cross(&mut self, feature: &Feature, edges: [u8; 2], way: DVec3, left: f64, error: f64) -> bool {
        let [(start_a, a), (start_b, b)] = [0, 1].map(|i| edge(&self.pair.sides[i], feature.triangles[i], edges[i]));
        let offset = start_b + way - start_a;
        let cross = a.cross(b);
        let square = cross.length_squared();
        let at = [b, a].map(|other| offset.cross(other).dot(cross) / square);
        let is_within = |at: f64, along: DVec3| {
            let margin = error / along.length();
            (margin..=1.0 - margin).contains(&at)
        };
        if is_within(at[0], a) && is_within(at[1], b) {
            return true;
        }
        let place = start_a + a * at[0];
        place.is_finite() && self.is_on(0, place, left, error) && self.is_on(1, place - way, left, error)
    }

    /// Whether a vertex of one side touches the other, or is no farther from it than is `left` of the gap.
    fn touches(&mut self, other: usize, p: DVec3, left: f64, error: f64) -> bool {
        let apart = self.pair.rounding() + left;
        self.is_on(other, p, apart, error)
    }

    /// Whether a point lies on a side's core, or no farther above it than is `left` of the gap.
    fn is_on(&mut self, side: usize, p: DVec3, left: f64, error: f64) -> bool {
        let tolerance = TOLERANCE * self.motion.rest_offset;
        if error > tolerance || self.searches == 0 {
            return false;
        }
        self.searches -= 1;
        is_near(&self.pair.sides[side], p, left + tolerance)
    }
}

/// How a body's point moves, in the axes of the other.
fn relative(side: usize, way: DVec3) -> DVec3 {
    if side == 1 { way } else { -way }
}

/// Where an edge of a triangle begins, and its direction.
fn edge(side: &Side, triangle: u32, k: u8) -> (DVec3, DVec3) {
    let corners = side.features.triangles[triangle as usize].map(|v| side.vertex(v));
    let k = usize::from(k);
    (corners[k], corners[(k + 1) % 3] - corners[k])
}
