//! Tight fits: surfaces on opposite sides of a body that leave less room than two rest offsets.
//!
//! A pin in its hole has points on both sides. If each kept the whole rest offset it would be pushed from both sides,
//! and friction would hold it although it is loose. So opposite points share what room there is. The smooth surfaces of
//! a pin and its hole bulge beyond their facets, and may leave less room than the meshes do. Then the meshes decide.

use crate::state::ManifoldPoint;

/// Normals are opposite if the cosine of the angle between them is below this.
pub(super) const OPPOSITE: f32 = -0.7;
/// No normals are opposite if the cosine of the angle between the first and each other one is above this: that angle is
/// half of the angle between opposite normals.
pub(super) const ALIKE: f32 = 0.4;
/// Only the first points of a pair are compared with each other.
pub(super) const MOST_COMPARED: usize = 64;

/// Whether points of a pair may be opposite. Of nearly all pairs none are, and this tells it soon.
pub(super) fn may_be_tight(points: &[ManifoldPoint]) -> bool {
    points
        .iter()
        .take(MOST_COMPARED)
        .any(|point| point.normal.dot(points[0].normal) < ALIKE)
}

/// The rest offset of a point of a pair with these points and this rest offset: half of the gap to each opposite point,
/// if that is less. It is negative by up to the bulge where only the meshes leave room.
pub(super) fn rest_offset(point: &ManifoldPoint, points: &[ManifoldPoint], rest_offset: f32) -> f32 {
    points
        .iter()
        .take(MOST_COMPARED)
        .filter(|other| other.normal.dot(point.normal) < OPPOSITE)
        .map(|other| 0.5 * (point.gap() + other.gap()))
        .fold(rest_offset, f32::min)
        .max(-point.bulge)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn point(normal: Vec3, separation: f32) -> ManifoldPoint {
        ManifoldPoint {
            anchors: [Vec3::ZERO; 2],
            normal,
            separation,
            bulge: 0.0,
            curvature_radii: [f32::INFINITY; 2],
            normal_rotation: 0.0,
            faces: [0; 2],
        }
    }

    #[test]
    fn opposite_points_share_the_room_between_them() {
        let pin = [point(Vec3::Y, 0.003), point(Vec3::NEG_Y, 0.001), point(Vec3::X, 0.0)];
        assert!(may_be_tight(&pin));
        let offsets = pin.map(|p| rest_offset(&p, &pin, 0.01));
        assert_eq!(offsets, [0.002, 0.002, 0.01]);
        assert_eq!(rest_offset(&pin[0], &pin, 0.0015), 0.0015, "there is room");
    }

    #[test]
    fn what_is_wedged_keeps_no_offset() {
        let wedged = [point(Vec3::Y, -0.003), point(Vec3::NEG_Y, 0.001)];
        assert_eq!(wedged.map(|p| rest_offset(&p, &wedged, 0.01)), [0.0; 2]);
    }

    #[test]
    fn one_side_and_a_groove_are_not_tight() {
        let slope = |x: f32| point(Vec3::new(x, 1.0, 0.0).normalize(), 0.0);
        assert!(!may_be_tight(&[slope(0.0), slope(0.1), slope(-0.1)]));
        let groove = [slope(-1.0), slope(1.0)];
        assert_eq!(groove.map(|p| rest_offset(&p, &groove, 0.01)), [0.01; 2]);
    }
}
