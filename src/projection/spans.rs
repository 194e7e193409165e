//! Scan conversion by definition: the pixel centres that one projected triangle covers, and its heights there, row by
//! row.
//!
//! The height image and the definition of visibility are made with it. The bake uses [`Seen`](super::batch::Seen), the
//! same arithmetic on eight triangles, rows or pixels at a time. Both give the same bits. Rounding does no harm:
//! * an edge is always evaluated from its lower end, whichever triangle it belongs to, so neighbours agree bit for bit
//!   on where it crosses a row, and no pixel is left between them;
//! * heights are computed from the plane's exact normal, relative to a corner, and are clamped to the range of the
//!   corners.

use glam::Vec3;

/// A line that bounds the spans on one side, at `x + slope * (row - y)`.
#[derive(Clone, Copy, Debug)]
struct Bound {
    x: f32,
    y: f32,
    slope: f32,
}

impl Bound {
    fn at(self, row: f32) -> f32 {
        self.x + self.slope * (row - self.y)
    }
}

/// The pixels `first..=last` of a row, none if `first > last`. The i-th of them has the height `height + x_slope * i`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Row {
    pub first: i32,
    pub last: i32,
    pub height: f32,
}

/// A projected triangle, ready to be drawn. Its corners are in pixels: x to the right, y up, height. Pixel centres have
/// integer coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spans {
    /// The first and the last row that may have a covered pixel centre.
    pub rows: (i32, i32),
    /// Change of height per pixel to the right.
    pub x_slope: f32,
    y_slope: f32,
    anchor: Vec3,
    x_range: (f32, f32),
    z_range: (f32, f32),
    left: [Bound; 2],
    right: [Bound; 2],
}

/// The smallest integer not below `x`; `x` must be in the range of `i32`.
fn ceil(x: f32) -> i32 {
    let t = x as i32;
    t + i32::from((t as f32) < x)
}

impl Spans {
    /// Prepares a triangle from its corners and its unit normal in the axes of the image.
    ///
    /// `None` if no row of pixel centres meets it. Coordinates must not be negative, and `normal.z` must not be 0.
    pub fn new(corners: [Vec3; 3], normal: Vec3) -> Option<Self> {
        let [a, b, c] = corners;
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let rows = (ceil(low.y), high.y as i32);
        if rows.0 > rows.1 || ceil(low.x) > high.x as i32 {
            return None;
        }
        // With counter-clockwise winding an upward edge has the triangle on its left, so it bounds the spans on the
        // right.
        let (p, q) = if normal.z > 0.0 { (b, c) } else { (c, b) };
        let beside = |x| Bound { x, y: 0.0, slope: 0.0 };
        let mut left = [beside(low.x); 2];
        let mut right = [beside(high.x); 2];
        let (mut lefts, mut rights) = (0, 0);
        for (from, to) in [(a, p), (p, q), (q, a)] {
            let dy = to.y - from.y;
            if dy > 0.0 {
                right[rights & 1] = Self::bound(from, to);
                rights += 1;
            } else if dy < 0.0 {
                left[lefts & 1] = Self::bound(to, from);
                lefts += 1;
            }
        }

        let steep = -normal.z.recip();
        Some(Self {
            rows,
            x_slope: normal.x * steep,
            y_slope: normal.y * steep,
            anchor: a,
            x_range: (low.x, high.x),
            z_range: (low.z, high.z),
            left,
            right,
        })
    }

    fn bound(low: Vec3, high: Vec3) -> Bound {
        Bound {
            x: low.x,
            y: low.y,
            slope: (high.x - low.x) / (high.y - low.y),
        }
    }

    /// Row `y`, which must be one of `self.rows`.
    pub fn row(&self, y: i32) -> Row {
        let row = y as f32;
        // Clamped to the range of i32, so that `first > last` still holds if the left bound is right of the right
        // bound.
        let left = self.left[0]
            .at(row)
            .max(self.left[1].at(row))
            .max(self.x_range.0)
            .min(self.x_range.1 + 1.0);
        let right = self.right[0]
            .at(row)
            .min(self.right[1].at(row))
            .min(self.x_range.1)
            .max(-1.0);
        let first = ceil(left);
        let height =
            self.anchor.z + self.x_slope * (first as f32 - self.anchor.x) + self.y_slope * (row - self.anchor.y);
        // For a triangle almost edge-on the slopes are huge and the terms cancel badly. The corners bound the result.
        let height = height.max(self.z_range.0).min(self.z_range.1);
        Row {
            first,
            last: right as i32,
            height,
        }
    }
}
