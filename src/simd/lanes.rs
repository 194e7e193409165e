//! Vector arithmetic on eight points at a time.

use crate::geometry::lanes::Points;
use glam::{Mat3, Vec3};
use wide::f32x8;

/// `[f(0), f(1), f(2)]`. An array's `map` is not always inlined, and SIMD vectors pass through memory in a call. That
/// took a third of the triangle test's time.
#[inline(always)]
pub fn each<T>(f: impl Fn(usize) -> T) -> [T; 3] {
    [f(0), f(1), f(2)]
}

#[inline(always)]
pub fn splat(v: Vec3) -> Points {
    each(|i| f32x8::splat(v[i]))
}

#[inline(always)]
pub fn sub(a: Points, b: Points) -> Points {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub fn mul(a: Points, b: Points) -> Points {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

#[inline(always)]
pub fn dot(a: Points, b: Points) -> f32x8 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub fn cross(a: Points, b: Points) -> Points {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// The sum of the absolute coordinates.
#[inline(always)]
pub fn norm1(a: Points) -> f32x8 {
    a[0].abs() + a[1].abs() + a[2].abs()
}

#[inline(always)]
pub fn min(a: Points, b: Points) -> Points {
    [a[0].fast_min(b[0]), a[1].fast_min(b[1]), a[2].fast_min(b[2])]
}

#[inline(always)]
pub fn max(a: Points, b: Points) -> Points {
    [a[0].fast_max(b[0]), a[1].fast_max(b[1]), a[2].fast_max(b[2])]
}

/// In each lane, `a` where the mask is set, else `b`.
#[inline(always)]
pub fn pick(mask: f32x8, a: Points, b: Points) -> Points {
    [
        mask.bitselect(a[0], b[0]),
        mask.bitselect(a[1], b[1]),
        mask.bitselect(a[2], b[2]),
    ]
}

/// The rows of a matrix, with each entry broadcast to all lanes.
pub struct Rows([Points; 3]);

impl Rows {
    pub fn new(m: Mat3) -> Self {
        Self(each(|i| splat(m.row(i))))
    }

    #[inline(always)]
    pub fn times(&self, p: Points) -> Points {
        each(|i| dot(self.0[i], p))
    }
}

/// A mask of the lanes in which the box `min_a..max_a` overlaps the box `min_b..max_b`.
#[inline(always)]
pub fn boxes_meet(min_a: Points, max_a: Points, min_b: Points, max_b: Points) -> f32x8 {
    let meet = |i: usize| min_a[i].simd_le(max_b[i]) & min_b[i].simd_le(max_a[i]);
    meet(0) & meet(1) & meet(2)
}

/// The point in one lane.
#[inline(always)]
pub fn lane_of(p: &Points, lane: usize) -> Vec3 {
    Vec3::new(p[0].as_array()[lane], p[1].as_array()[lane], p[2].as_array()[lane])
}

/// The indices of the set bits, in ascending order.
pub fn bits(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        (mask != 0).then(|| {
            let bit = mask.trailing_zeros() as usize;
            mask &= mask - 1;
            bit
        })
    })
}
