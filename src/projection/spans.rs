//! Scan conversion: the pixel centres that a projected triangle covers, and its heights there, four rows at a time.
//!
//! All drawing uses [`Spans`]. The depth pass, the visibility pass and the height image therefore use the same
//! arithmetic and can compare heights with `>=`. Rounding does no harm:
//! * an edge is always evaluated from its lower end, whichever triangle it belongs to, so neighbours agree bit for bit
//!   on where it crosses a row, and no pixel is left between them;
//! * heights are computed from the plane's exact normal, relative to a corner, and are clamped to the range of the
//!   corners.
//!
//! The loops are written for SSE2, the baseline of x86-64. They convert to integers, because `floor` and `ceil` are
//! function calls there, and they need one division per edge instead of one per row.

use crate::simd::level::{Baseline, baseline};
use fearless_simd::prelude::*;
use fearless_simd::{f32x4, i32x4};

/// Four numbers in a register.
pub(super) type Four = f32x4<Baseline>;

/// `value` in every lane.
#[inline(always)]
pub(super) fn splat(value: f32) -> Four {
    f32x4::splat(baseline(), value)
}

#[inline(always)]
pub(super) fn four(values: [f32; 4]) -> Four {
    f32x4::simd_from(baseline(), values)
}

/// Numbers in the range of `i32`, rounded toward zero.
#[inline(always)]
fn truncated(values: Four) -> i32x4<Baseline> {
    i32x4::truncate_from(values)
}

/// A point in pixels: x to the right, y up, height. Pixel centres have integer coordinates. The fourth lane is unused.
pub(super) type Pixel = [f32; 4];

/// A line that bounds the spans on one side, at `x + slope * (row - y)`.
#[derive(Clone, Copy, Debug)]
struct Bound {
    x: f32,
    y: f32,
    slope: f32,
}

impl Bound {
    #[inline]
    fn at(self, rows: Four) -> Four {
        splat(self.x) + splat(self.slope) * (rows - splat(self.y))
    }
}

/// Four rows of a triangle. Row `y + k` has the pixels `first[k]..=last[k]`, none if `first[k] > last[k]`. The i-th of
/// them has the height `height[k] + x_slope * i`.
pub(super) struct FourRows {
    pub first: [i32; 4],
    pub last: [i32; 4],
    pub height: [f32; 4],
}

/// A projected triangle, ready to be drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spans {
    /// The first and the last row that may have a covered pixel centre.
    pub rows: (i32, i32),
    /// Change of height per pixel to the right.
    pub x_slope: f32,
    y_slope: f32,
    anchor: Pixel,
    x_range: (f32, f32),
    z_range: (f32, f32),
    left: [Bound; 2],
    right: [Bound; 2],
}

/// The smallest integer not below `x`; `x` must be in the range of `i32`.
#[inline]
fn ceil(x: f32) -> i32 {
    let t = x as i32;
    t + i32::from((t as f32) < x)
}

impl Spans {
    /// Prepares a triangle from its corners and its unit normal in the axes of the image.
    ///
    /// `None` if no row of pixel centres meets it. Coordinates must not be negative, and `normal.z` must not be 0.
    #[inline]
    pub fn new(corners: [Pixel; 3], normal: [f32; 3]) -> Option<Self> {
        let [a, b, c] = corners;
        let (y_low, y_high) = (a[1].min(b[1]).min(c[1]), a[1].max(b[1]).max(c[1]));
        let rows = (ceil(y_low), y_high as i32);
        if rows.0 > rows.1 {
            return None;
        }
        let (x_low, x_high) = (a[0].min(b[0]).min(c[0]), a[0].max(b[0]).max(c[0]));
        if ceil(x_low) > x_high as i32 {
            return None;
        }
        let z_range = (a[2].min(b[2]).min(c[2]), a[2].max(b[2]).max(c[2]));

        // With counter-clockwise winding an upward edge has the triangle on its left, so it bounds the spans on the
        // right.
        let (p, q) = if normal[2] > 0.0 { (b, c) } else { (c, b) };
        let beside = |x| Bound { x, y: 0.0, slope: 0.0 };
        let mut left = [beside(x_low); 2];
        let mut right = [beside(x_high); 2];
        let (mut lefts, mut rights) = (0, 0);
        for (from, to) in [(a, p), (p, q), (q, a)] {
            let dy = to[1] - from[1];
            if dy > 0.0 {
                right[rights & 1] = Self::bound(from, to);
                rights += 1;
            } else if dy < 0.0 {
                left[lefts & 1] = Self::bound(to, from);
                lefts += 1;
            }
        }

        let steep = -normal[2].recip();
        Some(Self {
            rows,
            x_slope: normal[0] * steep,
            y_slope: normal[1] * steep,
            anchor: a,
            x_range: (x_low, x_high),
            z_range,
            left,
            right,
        })
    }

    #[inline]
    fn bound(low: Pixel, high: Pixel) -> Bound {
        Bound {
            x: low[0],
            y: low[1],
            slope: (high[0] - low[0]) / (high[1] - low[1]),
        }
    }

    /// Rows `y..y + 4`. Values for rows outside `self.rows` are meaningless.
    #[inline]
    pub fn four(&self, y: i32) -> FourRows {
        let rows = splat(y as f32) + four([0.0, 1.0, 2.0, 3.0]);
        let one = splat(1.0);
        // Clamped to the range of i32, so that `first > last` still holds if the left bound is right of the right
        // bound.
        let left = self.left[0]
            .at(rows)
            .max(self.left[1].at(rows))
            .max(splat(self.x_range.0))
            .min(splat(self.x_range.1) + one);
        let right = self.right[0]
            .at(rows)
            .min(self.right[1].at(rows))
            .min(splat(self.x_range.1))
            .max(splat(-1.0));
        let cut = f32x4::float_from(truncated(left));
        let first = cut + cut.simd_lt(left).select(one, splat(0.0));
        let height = splat(self.anchor[2])
            + splat(self.x_slope) * (first - splat(self.anchor[0]))
            + splat(self.y_slope) * (rows - splat(self.anchor[1]));
        // For a triangle almost edge-on the slopes are huge and the terms cancel badly. The corners bound the result.
        let height = height.max(splat(self.z_range.0)).min(splat(self.z_range.1));
        FourRows {
            first: truncated(first).into(),
            last: truncated(right).into(),
            height: height.into(),
        }
    }
}

/// The heights along a span, four pixels at a time: `first + x_slope * i` for `i` = 0, 1, 2, ..., together with `i`.
pub(super) struct SpanHeights {
    first: Four,
    x_slope: Four,
    /// Small integers, so the increments are exact.
    i: Four,
}

impl SpanHeights {
    #[inline]
    pub fn new(first: f32, x_slope: f32) -> Self {
        Self {
            first: splat(first),
            x_slope: splat(x_slope),
            i: four([0.0, 1.0, 2.0, 3.0]),
        }
    }

    #[inline]
    pub fn next(&mut self) -> (Four, Four) {
        let i = self.i;
        self.i = i + splat(4.0);
        (self.first + self.x_slope * i, i)
    }
}
