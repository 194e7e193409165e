//! `faceoff image`: draws the height image of a mesh, as in figure 4 of Aly & Elawady 2010.

use crate::canvas::{CHARACTER, Canvas, INK};
use crate::marks::Marks;
use crate::{CullingChoice, Outcome, Wrong, mesh, output};
use bevy_faceoff::geometry::TriMesh;
use bevy_faceoff::geometry::direction::Angles;
use bevy_faceoff::projection::{BakeSettings, HeightImage};
use glam::Vec3;
use std::path::{Path, PathBuf};

/// Draw the height image of a mesh, with heights as colours, and its visible faces.
#[derive(clap::Args)]
pub struct Options {
    /// torus, knot, or a mesh file.
    mesh: String,
    /// Projection angle about x, in degrees.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    about_x: f32,
    /// Projection angle about y, in degrees; the mesh is rotated about y first, then about x.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    about_y: f32,
    /// Side of the image in pixels [default: 512, or 96 with --sheet].
    #[arg(long)]
    image: Option<u32>,
    /// Draw a contact sheet of directions 30 degrees apart instead of a single direction.
    #[arg(long)]
    sheet: bool,
    /// Draw the heights in grey, and mark the defects that `faceoff inspect` tells of, with a legend; pale on the far
    /// side.
    #[arg(long, conflicts_with = "sheet")]
    defects: bool,
    /// The PNG file to write, or - for standard output.
    #[arg(short, long, value_name = "OUT.png")]
    output: PathBuf,
}

/// The margin around images, in pixels.
const MARGIN: u32 = 12;
/// The widths of the scale bar and of the numbers beside it, in pixels.
const BAR: (u32, u32) = (16, 9 * CHARACTER);
/// The angle between images of a sheet, in degrees.
const STEP: i32 = 30;

/// Runs the command.
pub fn run(options: &Options) -> Outcome {
    png_only(&options.output)?;
    output::refuse(&options.output, mesh::files(&options.mesh))?;
    let size = options.image.unwrap_or(if options.sheet { 96 } else { 512 });
    BakeSettings {
        image: size,
        ..BakeSettings::default()
    }
    .validate()
    .map_err(|error| Wrong(error.to_string()))?;
    if !(options.about_x.is_finite() && options.about_y.is_finite()) {
        return Err(Wrong("--about-x and --about-y must be finite angles in degrees".into()).into());
    }
    let mesh = mesh::shape(&options.mesh, CullingChoice::Exact)?;
    let canvas = if options.sheet {
        sheet(&mesh.mesh, size)
    } else {
        single(&mesh.mesh, options.about_x, options.about_y, size, options.defects)
    };
    canvas.save(&options.output)
}

/// Rejects names with the extension of another format.
fn png_only(path: &Path) -> Outcome {
    match path.extension() {
        Some(extension) if !extension.eq_ignore_ascii_case("png") => Err(Wrong(format!(
            "{}: images are written as PNG only; give a name that ends in .png",
            path.display()
        ))
        .into()),
        _ => Ok(()),
    }
}

fn direction(about_x: f32, about_y: f32) -> Vec3 {
    let angles = Angles {
        a: about_x.to_radians(),
        b: about_y.to_radians(),
    };
    angles.direction()
}

/// The heights with their scale, and beside them the visible faces. With `defects` these are marked on the heights.
pub fn single(mesh: &TriMesh, about_x: f32, about_y: f32, size: u32, defects: bool) -> Canvas {
    let direction = direction(about_x, about_y);
    let picture = HeightImage::draw(mesh, direction, size);
    let highest = picture.heights.iter().copied().fold(0.0, f32::max);
    let left = MARGIN;
    let bar = left + size + MARGIN;
    let right = bar + BAR.0 + BAR.1 + MARGIN;
    let top = 2 * MARGIN + CHARACTER;
    let marks = defects.then(|| Marks::new(mesh, direction, &picture));
    let legend = marks.as_ref().map_or([0, 0], Marks::legend_size);
    let width = (right + size + MARGIN).max(left + legend[0] + MARGIN);
    let mut canvas = Canvas::new(width, top + size + MARGIN + legend[1]);
    let scale = if defects { grey } else { scale };

    paint(&mut canvas, left, top, &picture, |height, _| {
        scale(share(height, highest))
    });
    canvas.text(left, MARGIN, &format!("height, about x {about_x}, about y {about_y}"));
    for y in 0..size {
        let share = 1.0 - y as f32 / (size - 1) as f32;
        for x in 0..BAR.0 {
            canvas.set(bar + x, top + y, scale(share));
        }
    }
    for tick in 0..=4 {
        let y = top + tick * (size - 1) / 4;
        for x in 0..4 {
            canvas.set(bar + BAR.0 + x, y, INK);
        }
        let height = highest * (1.0 - tick as f32 / 4.0);
        let label = y.saturating_sub(CHARACTER / 2).clamp(top, top + size - CHARACTER);
        canvas.text(bar + BAR.0 + 6, label, &significant(height));
    }
    if let Some(marks) = &marks {
        marks.paint(&mut canvas, [left, top]);
        marks.write_legend(&mut canvas, [left, top + size + MARGIN]);
    }

    let mut visible: Vec<u32> = picture
        .faces
        .iter()
        .copied()
        .filter(|&f| f != HeightImage::NONE)
        .collect();
    visible.sort_unstable();
    visible.dedup();
    paint(&mut canvas, right, top, &picture, |_, face| hue(face));
    let all = mesh.triangles().len();
    canvas.text(right, MARGIN, &format!("{} of {all} faces visible", visible.len()));
    canvas
}

/// A sheet of height images for directions all around.
fn sheet(mesh: &TriMesh, size: u32) -> Canvas {
    let (columns, rows) = (360 / STEP as u32, 180 / STEP as u32 + 1);
    let cell = [size + MARGIN, size + MARGIN + CHARACTER];
    let mut canvas = Canvas::new(MARGIN + columns * cell[0], MARGIN + rows * cell[1]);
    // All images have the same scale, so that they can be compared.
    let highest = 2.0
        * mesh
            .used_positions()
            .map(|p| p.distance(mesh.aabb().center()))
            .fold(0.0, f32::max);
    for row in 0..rows {
        for column in 0..columns {
            let (a, b) = (90 - STEP * row as i32, STEP * column as i32);
            let (x, y) = (MARGIN + column * cell[0], MARGIN + row * cell[1]);
            canvas.text(x, y, &format!("{a},{b}"));
            let picture = HeightImage::draw(mesh, direction(a as f32, b as f32), size);
            paint(&mut canvas, x, y + CHARACTER, &picture, |height, _| {
                scale(share(height, highest))
            });
        }
    }
    canvas
}

/// Paints the visible pixels of a height image, with its row 0 at the bottom.
fn paint(canvas: &mut Canvas, left: u32, top: u32, picture: &HeightImage, colour: impl Fn(f32, u32) -> [u8; 3]) {
    let size = picture.size;
    let pixels = picture.heights.iter().zip(&picture.faces).enumerate();
    for (i, (&height, &face)) in pixels.filter(|(_, (_, face))| **face != HeightImage::NONE) {
        let (x, y) = (i as u32 % size, i as u32 / size);
        canvas.set(left + x, top + size - 1 - y, colour(height, face));
    }
}

/// A height from 0 to 1. A flat mesh is at its highest everywhere.
fn share(height: f32, highest: f32) -> f32 {
    if highest > 0.0 { height / highest } else { 1.0 }
}

/// A height with four digits, in the few characters that there are.
fn significant(height: f32) -> String {
    if height == 0.0 {
        return "0".into();
    }
    match height.log10().floor() as i32 {
        magnitude @ -3..=4 => format!("{height:.*}", (3 - magnitude).max(0) as usize),
        _ => format!("{height:.3e}"),
    }
}

/// The colour of a height from 0 to 1; low is dark.
fn scale(share: f32) -> [u8; 3] {
    let colour = colorous::VIRIDIS.eval_continuous(f64::from(share.clamp(0.0, 1.0)));
    [colour.r, colour.g, colour.b]
}

/// The grey of a height from 0 to 1; low is dark. Unlike the colours of marks.
fn grey(share: f32) -> [u8; 3] {
    [(90.0 + 140.0 * share.clamp(0.0, 1.0)) as u8; 3]
}

/// A colour for each face, unlike those of its neighbours: steps of the golden angle around the colour wheel.
fn hue(face: u32) -> [u8; 3] {
    let colour = colorous::SINEBOW.eval_continuous((f64::from(face) * 0.618_033_988_75).fract());
    [colour.r, colour.g, colour.b]
}

#[cfg(test)]
mod tests {
    use super::{BAR, CHARACTER, significant};

    #[test]
    fn heights_of_any_size_have_four_digits() {
        for (height, text) in [
            (0.0, "0"),
            (0.0004567, "4.567e-4"),
            (0.004567, "0.004567"),
            (0.25, "0.2500"),
            (3.0, "3.000"),
            (1234.5, "1234"),
            (98765.0, "98765"),
            (1.5e30, "1.500e30"),
            (1.5e-30, "1.500e-30"),
        ] {
            assert_eq!(significant(height), text);
            assert!(text.len() as u32 * CHARACTER <= BAR.1, "{text} fits");
        }
    }
}
