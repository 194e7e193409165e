//! Scan conversion: which pixel centres a projected triangle covers, and its height there, four rows at a time.
//!
//! All drawing goes through [`Spans`], so that the depth pass, the visibility pass and the picture evaluate the very
//! same arithmetic and can compare heights with `>=`. Rounding is kept harmless by construction:
//! * an edge is evaluated from its lower end whichever triangle it belongs to, so neighbours agree bit for bit on where
//!   it crosses a row, and no pixel falls between them;
//! * heights come from the plane's exact normal, relative to a corner, and are clamped to the corners' range.
//!
//! The loops are written for SSE2, x86-64's baseline: conversions to integer instead of `floor` and `ceil`, which are
//! function calls there, and one division per edge instead of one per row.

use wide::f32x4;

/// A point in pixels: x to the right, y up, height; centres of pixels are whole numbers. The fourth lane is unused.
pub(super) type Pixel = [f32; 4];

/// A line that bounds the spans on one side: `x + slope * (row - y)`.
#[derive(Clone, Copy, Debug)]
struct Bound {
    x: f32,
    y: f32,
    slope: f32,
}

impl Bound {
    #[inline]
    fn at(self, rows: f32x4) -> f32x4 {
        f32x4::splat(self.x) + f32x4::splat(self.slope) * (rows - f32x4::splat(self.y))
    }
}

/// Four rows of a triangle: in row `y + k` the pixels `first[k]..=last[k]`, none if `first[k] > last[k]`, and the height
/// `height[k] + x_slope * i` at the i-th of them.
pub(super) struct FourRows {
    pub first: [i32; 4],
    pub last: [i32; 4],
    pub height: [f32; 4],
}

/// A projected triangle, ready to be drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spans {
    /// First and last row that may hold a centre.
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

/// The smallest whole number that is not below `x`, for `x` that an `i32` can hold.
#[inline]
fn ceil(x: f32) -> i32 {
    let t = x as i32;
    t + i32::from((t as f32) < x)
}

impl Spans {
    /// Prepares the triangle `corners` with the unit normal `normal` in the picture's axes.
    ///
    /// `None` if no row of pixel centres meets it. Coordinates must be at least 0, and `normal.z` not 0.
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

        // Around a triangle counter-clockwise, edges that run up have it on their left and end the spans.
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

    /// Rows `y..y + 4`. Those beyond `self.rows` are meaningless.
    #[inline]
    pub fn four(&self, y: i32) -> FourRows {
        let rows = f32x4::splat(y as f32) + f32x4::new([0.0, 1.0, 2.0, 3.0]);
        let one = f32x4::splat(1.0);
        // Kept within reach of i32, and `first` right of `last` if the bounds are.
        let left = self.left[0]
            .at(rows)
            .fast_max(self.left[1].at(rows))
            .fast_max(f32x4::splat(self.x_range.0))
            .fast_min(f32x4::splat(self.x_range.1) + one);
        let right = self.right[0]
            .at(rows)
            .fast_min(self.right[1].at(rows))
            .fast_min(f32x4::splat(self.x_range.1))
            .fast_max(f32x4::splat(-1.0));
        let cut = f32x4::from_i32x4(left.fast_trunc_int());
        let first = cut + (cut.simd_lt(left) & one);
        let height = f32x4::splat(self.anchor[2])
            + f32x4::splat(self.x_slope) * (first - f32x4::splat(self.anchor[0]))
            + f32x4::splat(self.y_slope) * (rows - f32x4::splat(self.anchor[1]));
        // Seen almost edge-on the slopes are huge and the terms cancel badly; the corners bound what can come out.
        let height = height
            .fast_max(f32x4::splat(self.z_range.0))
            .fast_min(f32x4::splat(self.z_range.1));
        FourRows {
            first: first.fast_trunc_int().to_array(),
            last: right.fast_trunc_int().to_array(),
            height: height.to_array(),
        }
    }
}

/// The heights along a span, four pixels at a time: `first + x_slope * i` for `i` = 0, 1, 2, ..., and `i` itself.
pub(super) struct SpanHeights {
    first: f32x4,
    x_slope: f32x4,
    /// Small whole numbers, so counting on is exact.
    i: f32x4,
}

impl SpanHeights {
    #[inline]
    pub fn new(first: f32, x_slope: f32) -> Self {
        Self {
            first: f32x4::splat(first),
            x_slope: f32x4::splat(x_slope),
            i: f32x4::new([0.0, 1.0, 2.0, 3.0]),
        }
    }

    #[inline]
    pub fn next(&mut self) -> (f32x4, f32x4) {
        let i = self.i;
        self.i = i + f32x4::splat(4.0);
        (self.first + self.x_slope * i, i)
    }
}
