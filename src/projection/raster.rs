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

use super::batch::{Batch, ProjectedTriangles, View, ViewLanes};
use super::depth::{Depth, Span, no_bounds};
use super::facing::{self, Facing};
use super::spans::Spans;
use crate::geometry::TriMesh;
use crate::geometry::cluster::CLUSTER;
use crate::projection::BakeSettings;
use crate::simd::lanes::{Simd, bits};
use crate::simd::level::with_simd;
use glam::{DMat3, DVec3, Vec3};

/// A mesh prepared to be drawn along any direction.
#[derive(Clone, Debug)]
pub struct Raster {
    /// Side of the image in pixels.
    pub(super) size: u32,
    /// Pixels per radius.
    scale: f64,
    /// Radius of the bounding sphere about the centre of the box, in mesh units.
    radius: f64,
    /// The number of triangles.
    triangles: u32,
    /// The triangles in their order. Corners are relative to the centre of the box and in radii. They are wound so that
    /// the normal points outward if the outside is known.
    batches: Vec<Batch>,
    /// Whether back faces are drawn.
    two_sided: bool,
}

/// The buffers of one drawing thread, reused from direction to direction.
#[derive(Clone, Debug, Default)]
pub struct Scratch {
    depth: Depth,
    /// The batches with triangles to draw.
    seen: Vec<Drawn>,
    visible: Vec<u64>,
}

/// A batch between the first pass and the second.
#[derive(Clone, Debug, Default)]
struct Drawn {
    batch: usize,
    projected: ProjectedTriangles,
    /// One bit for each triangle that covers a pixel centre. The others that face the viewer are slivers.
    covering: u32,
    /// A span of each triangle that covers a pixel centre.
    likely: [Span; CLUSTER],
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

        let facing = facing::prove(mesh);
        let place = |p: Vec3| ((p.as_dvec3() - center) / radius).as_vec3();
        let triangle = |t: usize| {
            let corners = mesh.corners(t);
            let [a, b, c] = corners.map(Vec3::as_dvec3);
            let normal = (b - a).cross(c - a).normalize_or_zero().as_vec3();
            let [a, b, c] = corners.map(place);
            if facing == Facing::Inward {
                ([a, c, b], -normal)
            } else {
                ([a, b, c], normal)
            }
        };
        let count = mesh.triangles().len();
        let batches = (0..count.div_ceil(CLUSTER)).map(|batch| {
            Batch::new(|lane| {
                let t = batch * CLUSTER + lane;
                (t < count).then(|| triangle(t))
            })
        });
        Self {
            size,
            scale: f64::from(size) * 0.5 - 1.5,
            radius,
            triangles: count as u32,
            batches: batches.collect(),
            two_sided: facing == Facing::Unknown,
        }
    }

    /// The triangles that are visible after `rotation`, seen from `+z`, in ascending order.
    ///
    /// [`rotation`](crate::geometry::direction::rotation) gives the rotation of a direction.
    pub fn visible(&self, rotation: &DMat3) -> Vec<u32> {
        let mut scratch = Scratch::default();
        let words = self.visible_bits(rotation, &mut scratch);
        (0..self.triangles)
            .filter(|&t| words[t as usize / 64] >> (t % 64) & 1 == 1)
            .collect()
    }

    /// [`Raster::visible`] as a set of bits, in reused buffers.
    ///
    /// The first pass writes only heights, so its inner loop is a `max`. The second pass tests for each drawn triangle
    /// whether it is the highest at any pixel, and stops at the first such pixel. It begins in the row that the first
    /// pass met in the middle of the triangle. For most visible triangles that suffices; only hidden ones are traversed
    /// completely.
    ///
    /// Neither the order of the triangles nor that of the rows matters to a maximum, or to whether there is a pixel. So
    /// the set equals that of [`Raster::visible_by_definition`] if the heights do: see [`super::batch`].
    pub(super) fn visible_bits<'s>(&self, rotation: &DMat3, scratch: &'s mut Scratch) -> &'s [u64] {
        let view = self.view(rotation);
        with_simd!(simd => self.draw(simd, &view, scratch));
        &scratch.visible
    }

    #[inline(always)]
    fn draw<S: Simd>(&self, simd: S, view: &View, Scratch { depth, seen, visible }: &mut Scratch) {
        depth.resize(self.size);
        visible.clear();
        visible.resize(self.triangles.div_ceil(64) as usize, 0);
        let view = ViewLanes::new(simd, view);
        let mut bounds = no_bounds(simd);
        let mut used = 0;
        for (number, batch) in (0..).zip(&self.batches) {
            if used == seen.len() {
                seen.push(Drawn::default());
            }
            let drawn = &mut seen[used];
            if batch.look(simd, &view, self.two_sided, &mut drawn.projected) {
                used += 1;
                drawn.batch = number;
                drawn.covering = depth.raise(simd, &drawn.projected, &mut drawn.likely);
                bounds = drawn.projected.join_bounds(simd, bounds);
            }
        }
        for drawn in &seen[..used] {
            let mut shows = 0_u64;
            for lane in bits(drawn.projected.facing) {
                let found = if drawn.covering >> lane & 1 == 1 {
                    depth.shows(simd, &drawn.projected, lane, drawn.likely[lane])
                } else {
                    depth.sliver_shows(drawn.projected.corners(lane))
                };
                shows |= u64::from(found) << lane;
            }
            let first = drawn.batch * CLUSTER;
            visible[first / 64] |= shows << (first % 64);
        }
        if used > 0 {
            depth.clear(bounds);
        }
    }

    fn view(&self, rotation: &DMat3) -> View {
        let middle = (f64::from(self.size) * 0.5 - 0.5) as f32;
        View {
            columns: [rotation.x_axis, rotation.y_axis, rotation.z_axis].map(|v| (v * self.scale).as_vec3()),
            // The lowest point of the bounding sphere is at height 2, above the background.
            origin: Vec3::new(middle, middle, (self.scale + 2.0) as f32),
            axes: [0, 1, 2].map(|i| rotation.row(i).as_vec3()),
        }
    }

    /// Each triangle, with its unit normal.
    fn each_triangle(&self) -> impl Iterator<Item = ([Vec3; 3], Vec3)> + '_ {
        (0..self.triangles as usize).map(|t| self.batches[t / CLUSTER].triangle(t % CLUSTER))
    }

    /// Calls `draw` for each triangle to draw, with its projected corners, and with its spans if any row meets it.
    pub(super) fn for_each_drawn(&self, rotation: &DMat3, mut draw: impl FnMut(u32, [Vec3; 3], Option<Spans>)) {
        let view = self.view(rotation);
        for (t, (corners, normal)) in (0..).zip(self.each_triangle()) {
            if let Some(normal) = view.facing(normal, self.two_sided) {
                let corners = corners.map(|p| view.project(p));
                draw(t, corners, Spans::new(corners, normal));
            }
        }
    }

    /// The height of the lowest projected point in pixels, and the mesh units per pixel.
    pub(super) fn height_scale(&self, rotation: &DMat3) -> (f32, f64) {
        let view = self.view(rotation);
        let lowest = self
            .each_triangle()
            .flat_map(|(corners, _)| corners.map(|p| view.project(p).z))
            .fold(f32::INFINITY, f32::min);
        (lowest, self.radius / self.scale)
    }
}
