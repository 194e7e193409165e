//! Rasterization of a mesh along a direction, and the triangles that are visible there.
//!
//! Aly & Elawady 2010 draw each triangle into its own image, with heights interpolated along scan lines, and keep the
//! highest value of each pixel. The faces that remain in the image are the faces of collision for that direction. This
//! module finds the same triangles with less work: it neither stores nor searches an image of face indices.
//!
//! # Definition of visibility
//!
//! The image is square, `size` pixels wide, and centred on the centre `c` of the mesh's bounding box. The sphere about
//! `c` through the farthest vertex fills the image up to a border of 1.5 pixels, in every direction.
//!
//! * A triangle *covers* the pixel centres inside it and on its edges. It is visible if at one of these centres no
//!   other triangle is higher. Triangles of equal height are all visible, so the set depends neither on the order of
//!   the triangles nor on the pixel at which a tie occurs. (A [`HeightImage`](super::HeightImage) shows only one
//!   triangle per pixel: that with the lowest index.)
//! * A triangle that covers no pixel centre is a *sliver*. It is visible if one of its sample points, which are at most
//!   a pixel apart, is at least as high as the lowest of the four surrounding pixel centres. This rule is conservative:
//!   a triangle missing from a group means a missed collision, an extra one only a little work. A sliver never hides
//!   another triangle.
//! * A triangle seen edge-on (cosine below 1e-6) is not visible. So a box seen along an axis shows only one side.
//! * For a closed surface whose faces all point outward, only front faces are drawn: the highest point on a line of
//!   sight is where the line enters the surface. This applies only where `facing::prove` succeeds for the mesh.
//!   Otherwise all triangles are drawn from both sides.

use super::facing::{self, Facing};
use super::spans::{Four, Pixel, SpanHeights, Spans, four, splat};
use crate::geometry::TriMesh;
use crate::projection::BakeSettings;
use fearless_simd::prelude::*;
use glam::{DMat3, DVec3, Vec3};

/// The height of background pixels. Drawn heights are at least 1.
pub(super) const BACKGROUND: f32 = 0.0;

/// Triangles are edge-on if the cosine between normal and direction is smaller than this. Such a triangle, 4096 pixels
/// high, is 0.004 pixels wide.
const EDGE_ON: f32 = 1.0e-6;

/// The rounding allowance in pixels with which a sliver counts as equally high as its surroundings.
const SLIVER_SLACK: f32 = 1.0 / 1024.0;

/// A mesh prepared to be drawn along any direction.
#[derive(Clone, Debug)]
pub struct Raster {
    /// Side of the image in pixels.
    pub(super) size: u32,
    /// Pixels per radius.
    scale: f64,
    /// Radius of the bounding sphere about the centre of the box, in mesh units.
    radius: f64,
    /// The vertices that triangles use, relative to the centre of the box and in radii.
    points: Vec<Vec3>,
    /// Three indices into `points` each, wound so that the normal points outward if the outside is known.
    triangles: Vec<[u32; 3]>,
    /// Unit normals of `triangles`.
    normals: Vec<Vec3>,
    /// Whether back faces are drawn.
    two_sided: bool,
}

/// The buffers of one drawing thread, reused from direction to direction.
#[derive(Clone, Debug, Default)]
pub struct Scratch {
    projected: Vec<Pixel>,
    depth: Vec<f32>,
    drawn: Vec<(u32, Spans)>,
    slivers: Vec<u32>,
    visible: Vec<u64>,
}

/// The affine map from `Raster::points` to pixels; each column is one SIMD vector.
struct View {
    columns: [Four; 3],
    origin: Four,
    axes: [Vec3; 3],
}

impl Raster {
    /// Prepares `mesh` for images of `size` pixels, clamped to the range of [`BakeSettings::image`].
    pub fn new(mesh: &TriMesh, size: u32) -> Self {
        let size = size.clamp(BakeSettings::MIN_IMAGE, BakeSettings::MAX_IMAGE);
        let bounds = mesh.aabb();
        let center = (bounds.min.as_dvec3() + bounds.max.as_dvec3()) * 0.5;
        let used = || mesh.used_positions().map(|p| p.as_dvec3() - center);
        // Never 0: a mesh has a triangle of non-zero area.
        let radius = used().map(DVec3::length_squared).fold(0.0, f64::max).sqrt();

        let mut index = vec![u32::MAX; mesh.vertices().len()];
        let mut points = Vec::new();
        let mut triangles = Vec::with_capacity(mesh.triangles().len());
        let mut normals = Vec::with_capacity(mesh.triangles().len());
        let facing = facing::prove(mesh);
        for (t, corners) in mesh.triangles().iter().enumerate() {
            let [a, b, c] = mesh.corners(t).map(Vec3::as_dvec3);
            let normal = (b - a).cross(c - a).normalize_or_zero().as_vec3();
            let [a, b, c] = corners.map(|v| {
                let slot = &mut index[v as usize];
                if *slot == u32::MAX {
                    *slot = points.len() as u32;
                    points.push(((mesh.vertices()[v as usize].as_dvec3() - center) / radius).as_vec3());
                }
                *slot
            });
            let inward = facing == Facing::Inward;
            triangles.push(if inward { [a, c, b] } else { [a, b, c] });
            normals.push(if inward { -normal } else { normal });
        }
        Self {
            size,
            scale: f64::from(size) * 0.5 - 1.5,
            radius,
            points,
            triangles,
            normals,
            two_sided: facing == Facing::Unknown,
        }
    }

    /// The triangles that are visible after `rotation`, seen from `+z`, in ascending order.
    ///
    /// [`rotation`](crate::geometry::direction::rotation) gives the rotation of a direction.
    pub fn visible(&self, rotation: &DMat3) -> Vec<u32> {
        let mut scratch = Scratch::default();
        let words = self.visible_bits(rotation, &mut scratch);
        (0..self.triangles.len() as u32)
            .filter(|&t| words[t as usize / 64] >> (t % 64) & 1 == 1)
            .collect()
    }

    /// [`Raster::visible`] as a set of bits, in reused buffers.
    ///
    /// The first pass writes only heights, so its inner loop is a `max`. The second pass tests for each drawn triangle
    /// whether it is the highest at any pixel, and stops at the first such pixel. For most visible triangles that takes
    /// a few pixels; only hidden ones are traversed completely.
    pub(super) fn visible_bits<'s>(&self, rotation: &DMat3, scratch: &'s mut Scratch) -> &'s [u64] {
        let view = self.view(rotation);
        self.project(&view, &mut scratch.projected);
        let Scratch {
            projected,
            depth,
            drawn,
            slivers,
            visible,
        } = scratch;
        let stride = self.size as usize + BLOCK;
        clear(depth, projected, stride, self.size as usize);
        drawn.clear();
        slivers.clear();
        visible.clear();
        visible.resize(self.triangles.len().div_ceil(64), 0);

        for t in 0..self.triangles.len() {
            let Some(normal) = self.faces_viewer(&view, t) else {
                continue;
            };
            match Spans::new(self.corners(projected, t), normal) {
                Some(spans) if raise(depth, stride, &spans) => drawn.push((t as u32, spans)),
                _ => slivers.push(t as u32),
            }
        }
        for (t, spans) in drawn.iter() {
            if is_highest_somewhere(depth, stride, spans) {
                visible[*t as usize / 64] |= 1 << (t % 64);
            }
        }
        for &t in slivers.iter() {
            if sliver_shows(depth, stride, self.corners(projected, t as usize)) {
                visible[t as usize / 64] |= 1 << (t % 64);
            }
        }
        visible
    }

    fn view(&self, rotation: &DMat3) -> View {
        let middle = f64::from(self.size) * 0.5 - 0.5;
        let column = |v: DVec3| {
            let v = (v * self.scale).as_vec3();
            four([v.x, v.y, v.z, 0.0])
        };
        View {
            columns: [
                column(rotation.x_axis),
                column(rotation.y_axis),
                column(rotation.z_axis),
            ],
            // The lowest point of the bounding sphere is at height 2, above the background.
            origin: four([middle as f32, middle as f32, (self.scale + 2.0) as f32, 0.0]),
            axes: [0, 1, 2].map(|i| rotation.row(i).as_vec3()),
        }
    }

    fn project(&self, view: &View, projected: &mut Vec<Pixel>) {
        let [x, y, z] = view.columns;
        projected.clear();
        projected.extend(
            self.points
                .iter()
                .map(|p| Pixel::from(x * splat(p.x) + y * splat(p.y) + z * splat(p.z) + view.origin)),
        );
    }

    #[inline]
    fn corners(&self, projected: &[Pixel], t: usize) -> [Pixel; 3] {
        self.triangles[t].map(|v| projected[v as usize])
    }

    /// The normal of triangle `t` in the axes of the image, if the triangle is to be drawn.
    #[inline]
    fn faces_viewer(&self, view: &View, t: usize) -> Option<[f32; 3]> {
        let normal = self.normals[t];
        let z = normal.dot(view.axes[2]);
        let toward = if self.two_sided { z.abs() } else { z };
        (toward > EDGE_ON).then(|| [normal.dot(view.axes[0]), normal.dot(view.axes[1]), z])
    }

    /// Calls `draw` for each triangle to draw, with its projected corners, and with its spans if any row meets it.
    pub(super) fn for_each_drawn(&self, rotation: &DMat3, mut draw: impl FnMut(u32, [Pixel; 3], Option<Spans>)) {
        let view = self.view(rotation);
        let mut projected = Vec::new();
        self.project(&view, &mut projected);
        for t in 0..self.triangles.len() {
            if let Some(normal) = self.faces_viewer(&view, t) {
                let corners = self.corners(&projected, t);
                draw(t as u32, corners, Spans::new(corners, normal));
            }
        }
    }

    /// The height of the lowest projected point in pixels, and the mesh units per pixel.
    pub(super) fn height_scale(&self, rotation: &DMat3) -> (f32, f64) {
        let mut projected = Vec::new();
        self.project(&self.view(rotation), &mut projected);
        let lowest = projected.iter().map(|p| p[2]).fold(f32::INFINITY, f32::min);
        (lowest, self.radius / self.scale)
    }
}

/// Clears the part of the depth image that drawing and sampling can reach.
fn clear(depth: &mut Vec<f32>, projected: &[Pixel], stride: usize, size: usize) {
    depth.resize(stride * size, BACKGROUND);
    let (low, high) = projected
        .iter()
        .fold((splat(f32::INFINITY), splat(f32::NEG_INFINITY)), |(low, high), &p| {
            (low.min(four(p)), high.max(four(p)))
        });
    let (low, high): (Pixel, Pixel) = (low.into(), high.into());
    // Samples read one pixel beyond the centres. Blocks extend further, but write only background there.
    let (x0, x1) = (low[0] as usize, (high[0] as usize + 2).min(stride));
    for y in low[1] as usize..(high[1] as usize + 2).min(size) {
        depth[y * stride + x0..y * stride + x1].fill(BACKGROUND);
    }
}

/// Raises the depth image to the triangle's height. Returns whether the triangle covers any pixel centre.
#[inline]
fn raise(depth: &mut [f32], stride: usize, spans: &Spans) -> bool {
    let (low, high) = spans.rows;
    let mut covers = false;
    let mut y = low;
    while y <= high {
        let rows = spans.four(y);
        for k in 0..((high - y + 1) as usize).min(4) {
            let (first, last) = (rows.first[k], rows.last[k]);
            if first > last {
                continue;
            }
            covers = true;
            let width = last - first;
            let start = (y as usize + k) * stride + first as usize;
            let mut heights = SpanHeights::new(rows.height[k], spans.x_slope);
            let width = splat(width as f32);
            for block in blocks_mut(depth, start, last - first) {
                for pixels in block.as_chunks_mut::<4>().0 {
                    let (height, i) = heights.next();
                    let height = i.simd_le(width).select(height, splat(0.0));
                    *pixels = four(*pixels).max(height).into();
                }
            }
        }
        y += 4;
    }
    covers
}

/// Whether the triangle is at least as high as the finished depth image at one of its pixels.
#[inline]
fn is_highest_somewhere(depth: &[f32], stride: usize, spans: &Spans) -> bool {
    let (low, high) = spans.rows;
    // Start in the middle and wrap around: the ends of a partly hidden triangle are hidden more often.
    let groups = (high - low) / 4 + 1;
    (0..groups).map(|g| (g + groups / 2) % groups).any(|g| {
        let y = low + 4 * g;
        let rows = spans.four(y);
        (0..((high - y + 1) as usize).min(4)).any(|k| {
            let (first, last) = (rows.first[k], rows.last[k]);
            if first > last {
                return false;
            }
            let width = last - first;
            let start = (y as usize + k) * stride + first as usize;
            let mut heights = SpanHeights::new(rows.height[k], spans.x_slope);
            let width = splat(width as f32);
            blocks(depth, start, last - first).iter().any(|block| {
                let mut highest = splat(0.0).simd_lt(splat(0.0));
                for &pixels in block.as_chunks::<4>().0 {
                    let (height, i) = heights.next();
                    highest |= height.simd_ge(four(pixels)) & i.simd_le(width);
                }
                highest.any_true()
            })
        })
    })
}

/// Pixels per block. The spans of small triangles are about as long, so the loop over blocks mostly ends after one or
/// two. The unused lanes cost less than a branch misprediction at the end of each span (measured against 4 and 16).
const BLOCK: usize = 8;

/// The blocks that contain the pixels `start..=start + extent`.
#[inline]
fn blocks(depth: &[f32], start: usize, extent: i32) -> &[[f32; BLOCK]] {
    let len = (extent as usize / BLOCK + 1) * BLOCK;
    depth[start..start + len].as_chunks().0
}

/// Mutable [`blocks`].
#[inline]
fn blocks_mut(depth: &mut [f32], start: usize, extent: i32) -> &mut [[f32; BLOCK]] {
    let len = (extent as usize / BLOCK + 1) * BLOCK;
    depth[start..start + len].as_chunks_mut().0
}

/// Whether a sliver is visible at one of its samples. Rows of `depth` are `stride` pixels apart.
pub(super) fn sliver_shows(depth: &[f32], stride: usize, corners: [Pixel; 3]) -> bool {
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
pub(super) fn sliver_samples(corners: [Pixel; 3]) -> impl Iterator<Item = [f32; 3]> {
    let [a, b, c] = corners.map(|p| Vec3::new(p[0], p[1], p[2]));
    let center = (a + b + c) / 3.0;
    let toward = move |corner: Vec3| {
        let offset = corner - center;
        let steps = offset.x.hypot(offset.y) as u32 + 1;
        (1..steps).map(move |i| (center + offset * (i as f32 / steps as f32)).to_array())
    };
    std::iter::once(center.to_array())
        .chain(toward(a))
        .chain(toward(b))
        .chain(toward(c))
}
