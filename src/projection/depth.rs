//! The image of the greatest heights, and which triangles show in it.

use super::batch::{LANES, ProjectedTriangles, Rows};
use crate::geometry::cluster::CLUSTER;
use crate::simd::lanes::{Points, Select, Simd, SimdFrom, f32x8, splat, splat_point};
use fearless_simd::prelude::*;
use glam::Vec3;

/// The height of background pixels. Drawn heights are at least 1.
pub(super) const BACKGROUND: f32 = 0.0;

/// The rounding allowance in pixels with which a sliver counts as equally high as its surroundings.
const SLIVER_SLACK: f32 = 1.0 / 1024.0;

/// Pixels per block. The spans of small triangles are about as long, so the loop over blocks mostly ends after one or
/// two. The unused lanes cost less than a branch misprediction at the end of each span.
const BLOCK: usize = CLUSTER;

/// The greatest height at each pixel. Rows have some pixels more than the image is wide, because spans are drawn in
/// whole blocks.
///
/// Between directions it holds only background.
#[derive(Clone, Debug, Default)]
pub(super) struct Depth {
    size: usize,
    stride: usize,
    heights: Vec<f32>,
}

impl Depth {
    /// Makes this an image of `size` by `size` pixels.
    pub fn resize(&mut self, size: u32) {
        if self.size != size as usize {
            self.size = size as usize;
            self.stride = self.size + BLOCK;
            self.heights.clear();
            self.heights.resize(self.size * self.stride, BACKGROUND);
        }
    }

    /// Clears the part that drawing triangles within these bounds can reach. All spans are within the boxes of their
    /// triangles.
    pub fn clear<S: Simd>(&mut self, [low, high]: [Points<S>; 2]) {
        let least = |v: f32x8<S>| v.as_array().iter().copied().fold(f32::INFINITY, f32::min) as usize;
        let largest = |v: f32x8<S>| v.as_array().iter().copied().fold(f32::NEG_INFINITY, f32::max) as usize;
        // Blocks extend further, but write only background there.
        let (x0, x1) = (least(low[0]), (largest(high[0]) + 1).min(self.stride));
        for y in least(low[1])..(largest(high[1]) + 1).min(self.size) {
            self.heights[y * self.stride + x0..y * self.stride + x1].fill(BACKGROUND);
        }
    }

    /// Raises the image to the heights of eight triangles. Returns one bit for each triangle that covers a pixel
    /// centre, and sets its span in `likely`, that of the middle row if there is one.
    #[inline(always)]
    pub fn raise<S: Simd>(&mut self, simd: S, projected: &ProjectedTriangles, likely: &mut [Span; CLUSTER]) -> u32 {
        // Locals, because the compiler cannot know that a store into the image leaves its length alone.
        let (stride, heights) = (self.stride, self.heights.as_mut_slice());
        let mut covering = 0;
        let (most, calls) = projected.row_counts();
        // A row of each triangle at a time is cheap where triangles have few rows. Otherwise eight rows of a triangle
        // at a time are, because its spans follow each other in memory (measured).
        if most * 2 <= calls {
            for row in 0..most {
                let rows = projected.row_of_each(simd, row);
                for lane in lanes(rows.covered) {
                    let (low, high) = projected.rows(lane);
                    let span = Span::new(low + row, stride, &rows, lane);
                    if covering >> lane & 1 == 0 || row == (high - low) / 2 {
                        likely[lane] = span;
                    }
                    raise_span(simd, heights, span, projected.x_slope(lane));
                }
                covering |= rows.covered;
            }
            return covering;
        }
        for lane in lanes(projected.crossing) {
            let (low, high) = projected.rows(lane);
            let x_slope = projected.x_slope(lane);
            for y in (low..=high).step_by(CLUSTER) {
                let rows = projected.rows_of(simd, lane, y);
                if rows.covered == 0 {
                    continue;
                }
                let middle = (low + high) / 2 - y;
                if (0..CLUSTER as i32).contains(&middle) && rows.covered >> middle & 1 == 1 {
                    likely[lane] = Span::new(y + middle, stride, &rows, middle as usize % CLUSTER);
                } else if covering >> lane & 1 == 0 {
                    let k = rows.covered.trailing_zeros() as usize % CLUSTER;
                    likely[lane] = Span::new(y + k as i32, stride, &rows, k);
                }
                covering |= 1 << lane;
                for k in lanes(rows.covered) {
                    raise_span(simd, heights, Span::new(y + k as i32, stride, &rows, k), x_slope);
                }
            }
        }
        covering
    }

    /// Whether a triangle is at least as high as the finished image at one of its pixels.
    ///
    /// `likely` is one of its spans and is tested first: most visible triangles show there.
    #[inline(always)]
    pub fn shows<S: Simd>(&self, simd: S, projected: &ProjectedTriangles, lane: usize, likely: Span) -> bool {
        let x_slope = projected.x_slope(lane);
        if self.span_shows(simd, likely, x_slope) {
            return true;
        }
        let (low, high) = projected.rows(lane);
        for y in (low..=high).step_by(CLUSTER) {
            let rows = projected.rows_of(simd, lane, y);
            for k in lanes(rows.covered) {
                if self.span_shows(simd, Span::new(y + k as i32, self.stride, &rows, k), x_slope) {
                    return true;
                }
            }
        }
        false
    }

    #[inline(always)]
    fn span_shows<S: Simd>(&self, simd: S, span: Span, x_slope: f32) -> bool {
        let (height, extent, x_slope) = (splat(simd, span.height), splat(simd, span.extent), splat(simd, x_slope));
        let mut i = f32x8::simd_from(simd, LANES);
        for &pixels in self.heights[span.blocks()].as_chunks::<BLOCK>().0 {
            let heights = height + x_slope * i;
            if (heights.simd_ge(f32x8::simd_from(simd, pixels)) & i.simd_le(extent)).any_true() {
                return true;
            }
            i += splat(simd, BLOCK as f32);
        }
        false
    }

    /// Whether a sliver shows in the finished image.
    pub fn sliver_shows(&self, corners: [Vec3; 3]) -> bool {
        sliver_shows(&self.heights, self.stride, corners)
    }
}

/// The pixels of a triangle in one row, at least one.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Span {
    /// Where it begins in the image.
    start: u32,
    /// The number of pixels less one.
    extent: f32,
    /// The height of the first pixel.
    height: f32,
}

impl Span {
    #[inline(always)]
    fn new(y: i32, stride: usize, rows: &Rows, k: usize) -> Self {
        Self {
            start: y as u32 * stride as u32 + rows.first[k] as u32,
            extent: rows.extent[k],
            height: rows.height[k],
        }
    }

    /// The blocks that contain it.
    #[inline(always)]
    fn blocks(self) -> std::ops::Range<usize> {
        let start = self.start as usize;
        start..start + (self.extent as i32 as usize / BLOCK + 1) * BLOCK
    }
}

#[inline(always)]
fn raise_span<S: Simd>(simd: S, depth: &mut [f32], span: Span, x_slope: f32) {
    let (height, extent, x_slope) = (splat(simd, span.height), splat(simd, span.extent), splat(simd, x_slope));
    let mut i = f32x8::simd_from(simd, LANES);
    for pixels in depth[span.blocks()].as_chunks_mut::<BLOCK>().0 {
        let heights = height + x_slope * i;
        let heights = i.simd_le(extent).select(heights, splat(simd, BACKGROUND));
        *pixels = f32x8::simd_from(simd, *pixels).max(heights).into();
        i += splat(simd, BLOCK as f32);
    }
}

/// Bounds that nothing has joined yet.
#[inline(always)]
pub(super) fn no_bounds<S: Simd>(simd: S) -> [Points<S>; 2] {
    [splat_point(simd, Vec3::INFINITY), splat_point(simd, Vec3::NEG_INFINITY)]
}

/// The set bits of a mask of eight lanes.
#[inline(always)]
fn lanes(mask: u32) -> impl Iterator<Item = usize> {
    crate::simd::lanes::bits(mask).map(|lane| lane % CLUSTER)
}

/// Whether a sliver is visible at one of its samples. Rows of `depth` are `stride` pixels apart.
pub(super) fn sliver_shows(depth: &[f32], stride: usize, corners: [Vec3; 3]) -> bool {
    sliver_samples(corners).any(|[x, y, height]| {
        let at = y as usize * stride + x as usize;
        let lowest = depth[at]
            .min(depth[at + 1])
            .min(depth[at + stride])
            .min(depth[at + stride + 1]);
        height >= lowest - SLIVER_SLACK
    })
}

/// Points inside a triangle, less than a pixel apart: the centroid, and points on the lines from it to the corners.
///
/// A sliver is short or thin, so these three lines pass through all pixels it touches, except pixels it barely clips.
pub(super) fn sliver_samples([a, b, c]: [Vec3; 3]) -> impl Iterator<Item = [f32; 3]> {
    let center = (a + b + c) / 3.0;
    let toward = move |corner: Vec3| {
        let offset = corner - center;
        // A call of `hypot` is saved for most slivers: they are smaller than a pixel.
        let short = offset.x * offset.x + offset.y * offset.y < 0.99;
        let steps = if short { 1 } else { offset.x.hypot(offset.y) as u32 + 1 };
        (1..steps).map(move |i| (center + offset * (i as f32 / steps as f32)).to_array())
    };
    std::iter::once(center.to_array())
        .chain(toward(a))
        .chain(toward(b))
        .chain(toward(c))
}
