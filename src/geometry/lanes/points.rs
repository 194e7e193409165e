//! Eight numbers or points in memory.

use crate::geometry::cluster::CLUSTER;
use glam::Vec3;

/// Eight numbers in memory, aligned for SIMD.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(32))]
pub struct Stored(pub [f32; CLUSTER]);

/// The x, y and z coordinates of eight points in memory, one point per lane.
pub type StoredPoints = [Stored; 3];

/// Gathers eight points; `at` gives the point of a lane.
#[inline(always)]
pub fn points(at: impl Fn(usize) -> Vec3) -> StoredPoints {
    let mut points = StoredPoints::default();
    for lane in 0..CLUSTER {
        let [x, y, z] = at(lane).to_array();
        (points[0].0[lane], points[1].0[lane], points[2].0[lane]) = (x, y, z);
    }
    points
}
