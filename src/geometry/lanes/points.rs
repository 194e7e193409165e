//! Eight points in SIMD registers.

use crate::geometry::cluster::CLUSTER;
use glam::Vec3;
use wide::f32x8;

/// The x, y and z coordinates of eight points, one point per lane.
pub type Points = [f32x8; 3];

/// Gathers eight points; `at` gives the point of a lane.
#[inline(always)]
pub fn points(at: impl Fn(usize) -> Vec3) -> Points {
    let (mut x, mut y, mut z) = ([0.0; CLUSTER], [0.0; CLUSTER], [0.0; CLUSTER]);
    for (lane, ((x, y), z)) in x.iter_mut().zip(&mut y).zip(&mut z).enumerate() {
        [*x, *y, *z] = at(lane).to_array();
    }
    [x, y, z].map(f32x8::new)
}
