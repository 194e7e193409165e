//! Vector arithmetic on eight points at a time, in single precision, and on four in double precision.
//!
//! An [`f32x8`] and an [`f64x4`] are in a register: two of SSE2 and NEON, one of AVX2. [`Stored`] is in memory.
//! [`level`](super::level) tells where the token `S` comes from, and why everything here is inlined.
//!
//! `a.min(b)` and `a.max(b)` give what the instructions of x86 give: `b` where one of both is NaN, or where both are
//! zero.

pub use fearless_simd::prelude::{Select, Simd, SimdBase, SimdCombine, SimdFloat, SimdFrom, SimdMask, SimdSplit};
pub use fearless_simd::{f32x8, f64x4, mask32x8, mask64x4};

use crate::geometry::lanes::{Stored, StoredPoints};
use fearless_simd::f32x4;
use glam::{DVec3, Mat3, Vec3};
use std::ops::{Add, Mul, Sub};

/// The x, y and z coordinates of eight points, one point per lane.
pub type Points<S> = [f32x8<S>; 3];

/// The x, y and z coordinates of four points in double precision, one point per lane.
pub type DPoints<S> = [f64x4<S>; 3];

/// A number in each lane.
pub trait Numbers: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {}

impl<N: Copy + Add<Output = N> + Sub<Output = N> + Mul<Output = N>> Numbers for N {}

/// `[f(0), f(1), f(2)]`. An array's `map` is not always inlined.
#[inline(always)]
pub fn each<T>(f: impl Fn(usize) -> T) -> [T; 3] {
    [f(0), f(1), f(2)]
}

/// `[f(0), ..., f(7)]`. Closures of an array's `map` and `from_fn` are not always inlined.
#[inline(always)]
pub fn each_lane<T>(f: impl Fn(usize) -> T) -> [T; 8] {
    [f(0), f(1), f(2), f(3), f(4), f(5), f(6), f(7)]
}

/// `value` in every lane.
#[inline(always)]
pub fn splat<S: Simd>(simd: S, value: f32) -> f32x8<S> {
    f32x8::splat(simd, value)
}

/// `v` in every lane.
#[inline(always)]
pub fn splat_point<S: Simd>(simd: S, v: Vec3) -> Points<S> {
    [splat(simd, v.x), splat(simd, v.y), splat(simd, v.z)]
}

#[inline(always)]
pub fn load<S: Simd>(simd: S, from: &Stored) -> f32x8<S> {
    f32x8::simd_from(simd, from.0)
}

#[inline(always)]
pub fn load_points<S: Simd>(simd: S, [x, y, z]: &StoredPoints) -> Points<S> {
    [load(simd, x), load(simd, y), load(simd, z)]
}

#[inline(always)]
pub fn store<S: Simd>(from: f32x8<S>) -> Stored {
    Stored(from.into())
}

#[inline(always)]
pub fn store_points<S: Simd>([x, y, z]: Points<S>) -> StoredPoints {
    [store(x), store(y), store(z)]
}

#[inline(always)]
pub fn add<N: Numbers>(a: [N; 3], b: [N; 3]) -> [N; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
pub fn sub<N: Numbers>(a: [N; 3], b: [N; 3]) -> [N; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub fn mul<N: Numbers>(a: [N; 3], b: [N; 3]) -> [N; 3] {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

#[inline(always)]
pub fn scale<N: Numbers>(a: [N; 3], by: N) -> [N; 3] {
    [a[0] * by, a[1] * by, a[2] * by]
}

/// Adds the same number to all coordinates of a point.
#[inline(always)]
pub fn widen<S: Simd>(a: Points<S>, by: f32x8<S>) -> Points<S> {
    [a[0] + by, a[1] + by, a[2] + by]
}

#[inline(always)]
pub fn abs<S: Simd, N: SimdFloat<S>>(a: [N; 3]) -> [N; 3] {
    [a[0].abs(), a[1].abs(), a[2].abs()]
}

#[inline(always)]
pub fn dot<N: Numbers>(a: [N; 3], b: [N; 3]) -> N {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub fn cross<N: Numbers>(a: [N; 3], b: [N; 3]) -> [N; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// The sum of the absolute coordinates.
#[inline(always)]
pub fn norm1<S: Simd>(a: Points<S>) -> f32x8<S> {
    a[0].abs() + a[1].abs() + a[2].abs()
}

#[inline(always)]
pub fn min<S: Simd, N: SimdFloat<S>>(a: [N; 3], b: [N; 3]) -> [N; 3] {
    [a[0].min(b[0]), a[1].min(b[1]), a[2].min(b[2])]
}

#[inline(always)]
pub fn max<S: Simd, N: SimdFloat<S>>(a: [N; 3], b: [N; 3]) -> [N; 3] {
    [a[0].max(b[0]), a[1].max(b[1]), a[2].max(b[2])]
}

/// The least of three numbers.
#[inline(always)]
pub fn least<S: Simd, N: SimdFloat<S>>([a, b, c]: [N; 3]) -> N {
    a.min(b).min(c)
}

/// The largest of three numbers.
#[inline(always)]
pub fn largest<S: Simd, N: SimdFloat<S>>([a, b, c]: [N; 3]) -> N {
    a.max(b).max(c)
}

/// Heights of corners over the plane through `origin`, times the length of its normal.
#[inline(always)]
pub fn heights<N: Numbers>([p, q, r]: &[[N; 3]; 3], origin: [N; 3], normal: [N; 3]) -> [N; 3] {
    [
        dot(sub(*p, origin), normal),
        dot(sub(*q, origin), normal),
        dot(sub(*r, origin), normal),
    ]
}

/// In each lane, `a` where the mask is set, else `b`.
#[inline(always)]
pub fn pick<S: Simd, M: Copy + Select<N>, N: SimdFloat<S>>(mask: M, a: [N; 3], b: [N; 3]) -> [N; 3] {
    [
        mask.select(a[0], b[0]),
        mask.select(a[1], b[1]),
        mask.select(a[2], b[2]),
    ]
}

/// The rows of a matrix, with each entry broadcast to all lanes.
#[derive(Clone, Copy)]
pub struct Rows<S: Simd>([Points<S>; 3]);

impl<S: Simd> Rows<S> {
    #[inline(always)]
    pub fn new(simd: S, m: Mat3) -> Self {
        Self([
            splat_point(simd, m.row(0)),
            splat_point(simd, m.row(1)),
            splat_point(simd, m.row(2)),
        ])
    }

    #[inline(always)]
    pub fn times(&self, p: Points<S>) -> Points<S> {
        [dot(self.0[0], p), dot(self.0[1], p), dot(self.0[2], p)]
    }
}

/// The lanes in which no coordinate of `a` is greater than that of `b`.
#[inline(always)]
pub fn all_le<S: Simd>(a: Points<S>, b: Points<S>) -> mask32x8<S> {
    a[0].simd_le(b[0]) & a[1].simd_le(b[1]) & a[2].simd_le(b[2])
}

/// The lanes in which the box `min_a..max_a` overlaps the box `min_b..max_b`.
#[inline(always)]
pub fn boxes_meet<S: Simd>(min_a: Points<S>, max_a: Points<S>, min_b: Points<S>, max_b: Points<S>) -> mask32x8<S> {
    all_le(min_a, max_b) & all_le(min_b, max_a)
}

/// The lanes whose bits are set.
#[inline(always)]
pub fn lanes<S: Simd>(simd: S, bits: u32) -> mask32x8<S> {
    mask32x8::from_bitmask(simd, bits.into())
}

/// One bit per lane.
#[inline(always)]
pub fn bitmask<S: Simd>(mask: mask32x8<S>) -> u32 {
    mask.to_bitmask() as u32
}

/// One bit per lane, of four.
#[inline(always)]
pub fn bitmask_of_four<S: Simd>(mask: mask64x4<S>) -> u32 {
    mask.to_bitmask() as u32
}

/// Four numbers of each of eight lanes: the first numbers, the second ones, and so on.
#[inline(always)]
pub fn columns<S: Simd>(simd: S, [a, b, c, d, e, f, g, h]: [&[f32; 4]; 8]) -> [f32x8<S>; 4] {
    let low = transposed(four_rows(simd, [a, b, c, d]));
    let high = transposed(four_rows(simd, [e, f, g, h]));
    [
        low[0].combine(high[0]),
        low[1].combine(high[1]),
        low[2].combine(high[2]),
        low[3].combine(high[3]),
    ]
}

/// The four numbers of each of eight lanes, from [`columns`].
#[inline(always)]
pub fn rows<S: Simd>([x, y, z, w]: [f32x8<S>; 4]) -> [[f32; 4]; 8] {
    let (x, y, z, w) = (x.split(), y.split(), z.split(), w.split());
    let [a, b, c, d] = transposed([x.0, y.0, z.0, w.0]);
    let [e, f, g, h] = transposed([x.1, y.1, z.1, w.1]);
    [
        a.into(),
        b.into(),
        c.into(),
        d.into(),
        e.into(),
        f.into(),
        g.into(),
        h.into(),
    ]
}

/// The least of each coordinate, of all lanes.
#[inline(always)]
pub fn least_point<S: Simd>([x, y, z]: Points<S>) -> Vec3 {
    let (x, y, z) = (x.split(), y.split(), z.split());
    let [x, y, z] = [x.0.min(x.1), y.0.min(y.1), z.0.min(z.1)];
    let [a, b, c, d] = transposed([x, y, z, z]);
    let least: [f32; 4] = a.min(b).min(c.min(d)).into();
    Vec3::new(least[0], least[1], least[2])
}

/// The largest of each coordinate, of all lanes.
#[inline(always)]
pub fn largest_point<S: Simd>([x, y, z]: Points<S>) -> Vec3 {
    -least_point([-x, -y, -z])
}

#[inline(always)]
fn four_rows<S: Simd>(simd: S, [a, b, c, d]: [&[f32; 4]; 4]) -> [f32x4<S>; 4] {
    [
        f32x4::simd_from(simd, *a),
        f32x4::simd_from(simd, *b),
        f32x4::simd_from(simd, *c),
        f32x4::simd_from(simd, *d),
    ]
}

/// The columns of a matrix, given by its rows.
#[inline(always)]
fn transposed<S: Simd>([a, b, c, d]: [f32x4<S>; 4]) -> [f32x4<S>; 4] {
    let (first, third) = (a.zip_low(c), a.zip_high(c));
    let (second, fourth) = (b.zip_low(d), b.zip_high(d));
    [
        first.zip_low(second),
        first.zip_high(second),
        third.zip_low(fourth),
        third.zip_high(fourth),
    ]
}

/// Four points, one per lane.
#[inline(always)]
pub fn four_points<S: Simd>(simd: S, [a, b, c, d]: [DVec3; 4]) -> DPoints<S> {
    [
        f64x4::simd_from(simd, [a.x, b.x, c.x, d.x]),
        f64x4::simd_from(simd, [a.y, b.y, c.y, d.y]),
        f64x4::simd_from(simd, [a.z, b.z, c.z, d.z]),
    ]
}

/// The point in one lane.
#[inline(always)]
pub fn lane_of(p: &StoredPoints, lane: usize) -> Vec3 {
    Vec3::new(p[0].0[lane], p[1].0[lane], p[2].0[lane])
}

/// The number of one lane in every lane.
#[inline(always)]
pub fn broadcast<S: Simd>(values: &f32x8<S>, lane: usize) -> f32x8<S> {
    splat(values.simd, values[lane])
}

/// The point of one lane in every lane.
#[inline(always)]
pub fn broadcast_point<S: Simd>([x, y, z]: &Points<S>, lane: usize) -> Points<S> {
    [broadcast(x, lane), broadcast(y, lane), broadcast(z, lane)]
}

/// The indices of the set bits, in ascending order.
#[inline(always)]
pub fn bits(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        (mask != 0).then(|| {
            let bit = mask.trailing_zeros() as usize;
            mask &= mask - 1;
            bit
        })
    })
}

/// The lanes of each set of lanes, ascending, and then others.
const SET_LANES: [[u8; 8]; 256] = {
    let mut all = [[0; 8]; 256];
    let mut set = 0;
    while set < all.len() {
        let (mut lane, mut count) = (0, 0);
        while lane < 8 {
            if set >> lane & 1 == 1 {
                all[set][count] = lane as u8;
                count += 1;
            }
            lane += 1;
        }
        set += 1;
    }
    all
};

/// The lanes whose bits are set, ascending, and then others.
#[inline(always)]
pub fn set_lanes(mask: u32) -> &'static [u8; 8] {
    &SET_LANES[mask as usize % SET_LANES.len()]
}

/// Appends the first items of `eight`, as many as `mask` has lanes. No branches, which processors would mispredict.
#[inline(always)]
pub fn push_some<T: Copy>(list: &mut Vec<T>, eight: [T; 8], mask: u32) {
    let count = list.len() + mask.count_ones() as usize;
    list.extend_from_slice(&eight);
    list.truncate(count);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lanes_of_every_mask_are_appended_in_order() {
        let mut list = vec![9];
        for mask in 0..256 {
            let before = list.len();
            push_some(&mut list, *set_lanes(mask), mask);
            assert!(list[before..].iter().map(|lane| usize::from(*lane)).eq(bits(mask)));
        }
        assert_eq!(list.len(), 1 + 256 * 4);
    }
}
