//! The distance from a segment to one placed mesh, and how to move the segment out of it.

use super::placed::Placed;
use super::point::{FARTHEST, beside_segment};
use super::ray::Ray;
use crate::geometry::distance::{closest, nearest};
use glam::{DVec3, Vec3};

/// How a segment lies beside the nearest surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SegmentHit {
    /// How far the segment is from the surface, metres. Negative if it is inside or passes through: how far it has to
    /// move along `normal` to come out.
    pub distance: f64,
    /// A point of the surface, in the world.
    pub point: DVec3,
    /// Unit vector from the surface to the segment, or out of the mesh.
    pub normal: Vec3,
    /// The face, an index of the source mesh.
    pub face: u32,
}

impl Placed<'_> {
    /// The point of the surface that is nearest to a segment with these ends, if it is no farther than `max_distance`
    /// metres. A capsule is a segment with a radius: it overlaps the mesh by its radius minus the distance.
    ///
    /// * If the middle of the segment or both ends are inside a closed mesh, it comes out where the middle is nearest
    ///   to the surface. If one end is inside, it comes out where that end is nearest to the surface; else where the
    ///   middle of the longest part inside is. That may not be far enough for all of it: ask again from there.
    /// * If the segment passes through the surface of an open mesh, it comes out on the side of its middle.
    /// * There is none if a number is NaN, the distance negative, or an end not finite or farther than 10^18 m away.
    pub fn closest_to_segment(&self, ends: [DVec3; 2], max_distance: f64) -> Option<SegmentHit> {
        let [p, q] = ends.map(|end| self.in_axes(end));
        let is_valid = [p, q].iter().all(|end| end.is_finite() && end.length() < FARTHEST) && max_distance >= 0.0;
        if !is_valid {
            return None;
        }
        let middle = (p + q) * 0.5;
        let inside = [p, q].map(|end| self.contains(end));
        let deepest = if inside == [true; 2] || self.contains(middle) {
            Some(middle)
        } else {
            let end = [p, q].into_iter().zip(inside).find(|(_, inside)| *inside);
            end.map(|(end, _)| end).or_else(|| self.longest_part_inside(ends))
        };
        let rounding = self.rounding();
        if let Some(deepest) = deepest {
            let hit = self.point_hit(deepest, &self.nearest(deepest, f64::INFINITY)?, true);
            let depth = hit.point.distance(self.in_world(deepest));
            return Some(SegmentHit {
                distance: -depth - rounding,
                point: hit.point + hit.normal.as_dvec3() * rounding,
                normal: hit.normal,
                face: hit.face,
            });
        }
        let mut most = max_distance + rounding;
        let mut found = None;
        self.visit_near(middle, (p - q).abs() * 0.5, most, &mut |triangle| {
            let corners = self.corners(triangle);
            let (point, distance, away) = if p == q {
                let point = closest(p, &corners);
                (point, point.distance(p), (p - point).normalize_or_zero())
            } else {
                let near = nearest(&corners, &[p, q, q]);
                (near.from, near.distance, near.direction)
            };
            if distance < most || (distance == most && found.is_none()) {
                most = distance;
                found = Some((triangle, point, away));
            }
            most
        });
        let (triangle, point, away) = found?;
        let (distance, away) = if most > 1.0e-14 * (p.length() + q.length()) {
            (most, away)
        } else {
            let [a, b, c] = self.corners(triangle);
            let normal = (b - a).cross(c - a).normalize_or(beside_segment([a, c])) * self.mirror();
            let above = if normal.dot(middle - point) < 0.0 {
                -normal
            } else {
                normal
            };
            let heights = [p, q].map(|end| above.dot(end - point));
            (heights[0].min(heights[1]).min(0.0), above)
        };
        let normal = self.turn_to_world(away);
        Some(SegmentHit {
            distance: distance - rounding,
            point: self.in_world(point) + normal * rounding,
            normal: normal.as_vec3(),
            face: self.mesh().mesh.face_ids()[triangle],
        })
    }

    /// The middle of the longest part inside a closed mesh, of a segment whose ends are outside, in
    /// [`Placed::in_axes`].
    fn longest_part_inside(&self, ends: [DVec3; 2]) -> Option<DVec3> {
        if !self.mesh().mesh.is_solid() {
            return None;
        }
        let hits = self.core_hits(&Ray::between(ends[0], ends[1]));
        let parts = hits.windows(2).filter_map(|pair| {
            let middle = self.in_axes((pair[0].point + pair[1].point) * 0.5);
            let length = pair[1].distance - pair[0].distance;
            (length > 0.0 && self.contains(middle)).then_some((length, middle))
        });
        let longest = parts.max_by(|one, other| one.0.total_cmp(&other.0));
        longest.map(|(_, middle)| middle)
    }
}
