//! Flat patches: where friction acts between two flat surfaces.
//!
//! Contact points stand at the corners of a patch, but its load is spread over its area. At the corners friction would
//! resist spin too much: between a disc and a plane half as much again. So it acts nearer to the middle of the patch,
//! at the mean distance of its area.

use super::contact::Point;
use glam::Vec2;

/// Normals of one patch have at least this cosine.
pub(super) const SAME_NORMAL: f32 = 0.9999;
/// Points of one patch lie in a plane, within this fraction of D.
pub(super) const FLATNESS: f32 = 1.0e-4;
/// A point is inside a patch if it is farther than this fraction of D from its outline.
pub(super) const INSIDE: f32 = 1.0e-3;
/// Only the first points of a pair are searched for patches.
pub(super) const MAX_POINTS: usize = 64;

/// The outline of a patch, counter-clockwise.
type Outline = arrayvec::ArrayVec<Vec2, MAX_POINTS>;

/// Spreads the friction of the flat patches of a pair over their areas. Removes the points inside a patch: the corners
/// hold the same load, and how the solver shares it out is arbitrary.
pub(super) fn spread_friction(points: &mut [Point], diameter: f32) {
    let count = points.len().min(MAX_POINTS);
    let mut done = 0u64;
    for first in 0..count {
        if done >> first & 1 == 1 || !points[first].is_flat() {
            continue;
        }
        let origin = points[first];
        let plane = |point: &Point| {
            let offset = point.anchors[0] - origin.anchors[0];
            Vec2::new(offset.dot(origin.frame[1]), offset.dot(origin.frame[2]))
        };
        let mut members = 0u64;
        let mut positions = Outline::new();
        for (i, point) in points.iter().enumerate().take(count).skip(first) {
            if point.is_flat() && in_plane(&origin, point, FLATNESS * diameter) {
                members |= 1 << i;
                positions.push(plane(point));
            }
        }
        done |= members;
        let outline = outline(positions);
        let Some((center, scale)) = friction_circle(&outline) else {
            continue;
        };
        let [t, u] = [origin.frame[1], origin.frame[2]];
        for (i, point) in points.iter_mut().enumerate().take(count).skip(first) {
            if members >> i & 1 == 1 {
                let position = plane(point);
                point.valid = !is_inside(&outline, position, INSIDE * diameter);
                let offset = (scale - 1.0) * (position - center);
                point.friction_offset = offset.x * t + offset.y * u;
            }
        }
    }
}

impl Point {
    /// Whether both surfaces are flat.
    fn is_flat(&self) -> bool {
        self.valid && self.normal_rotation == 0.0 && self.anchors == self.curvature_centers
    }
}

fn in_plane(a: &Point, b: &Point, tolerance: f32) -> bool {
    let height = |side: usize| (b.anchors[side] - a.anchors[side]).dot(a.normal());
    a.normal().dot(b.normal()) > SAME_NORMAL && height(0).abs() < tolerance && height(1).abs() < tolerance
}

/// The convex hull (Andrew's monotone chain).
fn outline(mut points: Outline) -> Outline {
    points.sort_unstable_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let mut hull = arrayvec::ArrayVec::<Vec2, { 2 * MAX_POINTS }>::new();
    let mut chain = |point: Vec2, first: usize| {
        while hull.len() >= first + 2
            && (hull[hull.len() - 1] - hull[hull.len() - 2]).perp_dot(point - hull[hull.len() - 1]) <= 0.0
        {
            hull.pop();
        }
        hull.push(point);
        hull.len()
    };
    let mut end = 0;
    for &point in &points {
        end = chain(point, 0);
    }
    for &point in points.iter().rev().skip(1) {
        chain(point, end - 1);
    }
    // The first point closes the hull.
    hull.pop();
    hull.into_iter().take(MAX_POINTS).collect()
}

/// The centre of an outline, and by which factor friction is nearer to it than the corners. `None` for less than two
/// corners.
fn friction_circle(outline: &[Vec2]) -> Option<(Vec2, f32)> {
    if outline.len() < 2 {
        return None;
    }
    let edges = || outline.iter().zip(outline.iter().cycle().skip(1));
    let mean = outline.iter().sum::<Vec2>() / outline.len() as f32;
    let (mut area, mut moment) = (0.0, Vec2::ZERO);
    for (&a, &b) in edges() {
        let double = (a - mean).perp_dot(b - mean);
        area += double;
        moment += double * (a + b + mean) / 3.0;
    }
    let center = if area > 0.0 { moment / area } else { mean };
    let corners = outline.iter().map(|corner| corner.distance(center)).sum::<f32>() / outline.len() as f32;
    if outline.len() == 2 || area <= 0.0 {
        // The load of a line: half of its points are nearer than a quarter of its length.
        return Some((center, 0.5));
    }
    // The mean distance from a corner within a triangle is two thirds of the mean distance to the opposite side, which
    // is found by Simpson's rule.
    let mut distance = 0.0;
    for (&a, &b) in edges() {
        let (a, b) = (a - center, b - center);
        let side = (a.length() + 4.0 * (0.5 * (a + b)).length() + b.length()) / 6.0;
        distance += a.perp_dot(b) * side * 2.0 / 3.0;
    }
    let scale = distance / (area * corners);
    scale.is_finite().then_some((center, scale.clamp(0.0, 1.0)))
}

fn is_inside(outline: &[Vec2], point: Vec2, distance: f32) -> bool {
    outline.len() > 2
        && outline.iter().zip(outline.iter().cycle().skip(1)).all(|(&a, &b)| {
            let side = b - a;
            side.perp_dot(point - a) > distance * side.length()
        })
}
