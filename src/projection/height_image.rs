//! [`HeightImage`]: a mesh drawn along a direction; and a simple reference implementation of visibility.

use super::depth::{BACKGROUND, sliver_samples, sliver_shows};
use super::raster::Raster;
use super::spans::Spans;
use crate::geometry::TriMesh;
use crate::geometry::direction::rotation;
use crate::projection::BakeSettings;
use glam::{DMat3, DVec3, Vec3};

/// A mesh drawn along a direction, as in figure 4 of Aly & Elawady 2010.
///
/// Both images have `size * size` pixels in row-major order. Row 0 has the *lowest* y, so a file format whose first row
/// is at the top needs the rows in reverse order.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightImage {
    /// Side of the image in pixels.
    pub size: u32,
    /// Height above the lowest point of the mesh along the direction, in mesh units; 0 for the background.
    pub heights: Vec<f32>,
    /// The visible triangle, as an index into [`TriMesh::triangles`]; [`HeightImage::NONE`] for the background.
    pub faces: Vec<u32>,
}

impl HeightImage {
    /// The value of [`HeightImage::faces`] for the background.
    pub const NONE: u32 = u32::MAX;

    /// Draws `mesh` as seen from far out in `direction`, given in the mesh's own axes. `size` is in pixels and is
    /// clamped to 16..=4096.
    ///
    /// Each pixel shows the highest triangle; of equally high ones, that with the lowest index. A sliver (see
    /// [`raster`](super::raster)) is drawn after all other triangles, into the pixels that contain its samples.
    pub fn draw(mesh: &TriMesh, direction: Vec3, size: u32) -> Self {
        Raster::new(mesh, size).height_image(&rotation(direction))
    }
}

/// Where the points of a mesh are in its [`HeightImage`].
#[derive(Clone, Copy, Debug)]
pub struct ImagePlaces {
    rotation: DMat3,
    center: DVec3,
    pixels_per_unit: f64,
    /// The pixel coordinate of the centre.
    middle: f64,
    /// The height of the lowest point above that of the centre, in mesh units; negative.
    lowest: f64,
}

impl ImagePlaces {
    /// For the image that [`HeightImage::draw`] draws of the same arguments.
    pub fn new(mesh: &TriMesh, direction: Vec3, size: u32) -> Self {
        let size = size.clamp(BakeSettings::MIN_IMAGE, BakeSettings::MAX_IMAGE);
        let (rotation, bounds) = (rotation(direction), mesh.aabb());
        let center = (bounds.min.as_dvec3() + bounds.max.as_dvec3()) * 0.5;
        let offsets = || mesh.used_positions().map(|p| p.as_dvec3() - center);
        let radius = offsets().map(DVec3::length).fold(0.0, f64::max);
        let heights = offsets().map(|p| rotation.row(2).dot(p));
        Self {
            rotation,
            center,
            pixels_per_unit: (f64::from(size) * 0.5 - 1.5) / radius,
            middle: f64::from(size) * 0.5 - 0.5,
            lowest: heights.fold(f64::INFINITY, f64::min),
        }
    }

    /// Column and row of a point, with whole numbers at the centres of pixels and row 0 at the bottom; and its height
    /// in mesh units, as in [`HeightImage::heights`].
    pub fn of(&self, point: Vec3) -> [f32; 3] {
        let p = self.rotation * (point.as_dvec3() - self.center);
        let pixel = |x: f64| (x * self.pixels_per_unit + self.middle) as f32;
        [pixel(p.x), pixel(p.y), (p.z - self.lowest) as f32]
    }
}

impl Raster {
    /// Draws the mesh after `rotation`, seen from `+z`; see [`HeightImage::draw`].
    pub fn height_image(&self, rotation: &DMat3) -> HeightImage {
        self.draw_by_definition(rotation).0
    }

    /// The result of [`Raster::visible`], computed pixel by pixel from the definition. It is slow, and serves to check
    /// the fast implementation.
    pub fn visible_by_definition(&self, rotation: &DMat3) -> Vec<u32> {
        self.draw_by_definition(rotation).1
    }

    fn draw_by_definition(&self, rotation: &DMat3) -> (HeightImage, Vec<u32>) {
        let size = self.size as usize;
        let mut heights = vec![BACKGROUND; size * size];
        let mut faces = vec![HeightImage::NONE; size * size];
        let mut visible = Vec::new();
        let mut slivers = Vec::new();
        self.for_each_drawn(rotation, |t, corners, spans| {
            let mut covers = false;
            for_each_pixel(spans, size, |at, height| {
                covers = true;
                if height > heights[at] {
                    heights[at] = height;
                    faces[at] = t;
                }
            });
            if !covers {
                slivers.push((t, corners));
            }
        });
        self.for_each_drawn(rotation, |t, _, spans| {
            let mut highest = false;
            for_each_pixel(spans, size, |at, height| highest |= height >= heights[at]);
            if highest {
                visible.push(t);
            }
        });
        // All slivers are tested before the first is drawn, because slivers do not hide each other.
        visible.extend(
            slivers
                .iter()
                .filter(|s| sliver_shows(&heights, size, s.1))
                .map(|s| s.0),
        );
        visible.sort_unstable();
        for (t, corners) in slivers {
            for [x, y, height] in sliver_samples(corners) {
                let at = (y + 0.5) as usize * size + (x + 0.5) as usize;
                if height > heights[at] {
                    heights[at] = height;
                    faces[at] = t;
                }
            }
        }

        let (lowest, unit) = self.height_scale(rotation);
        for (height, &face) in heights.iter_mut().zip(&faces) {
            *height = if face == HeightImage::NONE {
                0.0
            } else {
                ((*height - lowest).max(0.0) as f64 * unit) as f32
            };
        }
        let image = HeightImage {
            size: self.size,
            heights,
            faces,
        };
        (image, visible)
    }
}

/// Calls `pixel` for each pixel whose centre the triangle covers, with the index of the pixel and the triangle's
/// height.
fn for_each_pixel(spans: Option<Spans>, size: usize, mut pixel: impl FnMut(usize, f32)) {
    let Some(spans) = spans else { return };
    let (low, high) = spans.rows;
    for y in low..=high {
        let row = spans.row(y);
        for x in row.first..=row.last {
            let height = row.height + spans.x_slope * (x - row.first) as f32;
            pixel(y as usize * size + x as usize, height);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::shapes;

    #[test]
    fn a_vertex_is_at_its_pixel_and_height_unless_something_is_above_it() {
        let mesh = shapes::knot_1120();
        for direction in [Vec3::Z, Vec3::NEG_Y, Vec3::new(0.3, -0.7, 0.2)] {
            let image = HeightImage::draw(&mesh, direction, 256);
            let places = ImagePlaces::new(&mesh, direction, 256);
            let mut seen = 0;
            for point in mesh.used_positions() {
                let [x, y, height] = places.of(point);
                let around = [-1.0, 0.0, 1.0].map(|dy| [-1.0, 0.0, 1.0].map(|dx| [x + dx, y + dy]));
                let drawn = around.as_flattened().iter().map(|[x, y]| {
                    let at = y.round() as usize * 256 + x.round() as usize;
                    image.heights[at]
                });
                let nearest = drawn.clone().map(|h| (h - height).abs()).fold(f32::INFINITY, f32::min);
                // A pixel is a 253rd of the size of 1.
                let highest = drawn.fold(0.0, f32::max);
                assert!(highest > height - 0.01, "{point}: {highest} is below {height}");
                seen += usize::from(nearest < 0.01);
            }
            assert!(seen > 1120, "{seen} of 3360 corners are seen");
        }
    }
}
