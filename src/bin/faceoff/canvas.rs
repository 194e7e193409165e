//! An image to draw on: coloured pixels, text in a bitmap font, PNG output.

use crate::{Outcome, output};
use font8x8::UnicodeFonts;
use image::{Rgb, RgbImage};
use std::io::Cursor;
use std::path::Path;

/// Side of a character in pixels.
pub const CHARACTER: u32 = 8;

/// The colour of the background.
pub const PAPER: [u8; 3] = [250; 3];

/// The colour of text and marks.
pub const INK: [u8; 3] = [40; 3];

/// An image with row 0 at the top.
pub struct Canvas(RgbImage);

impl Canvas {
    /// An empty image.
    pub fn new(width: u32, height: u32) -> Self {
        Self(RgbImage::from_pixel(width, height, Rgb(PAPER)))
    }

    /// Sets the colour of a pixel. Pixels outside the image are ignored.
    pub fn set(&mut self, x: u32, y: u32, colour: [u8; 3]) {
        if x < self.0.width() && y < self.0.height() {
            self.0.put_pixel(x, y, Rgb(colour));
        }
    }

    /// Mixes a disc about (`x`, `y`) into the image: `share` of its colour, from 0 to 1, and the rest of what is there.
    /// Its edge is smooth.
    pub fn disc(&mut self, [x, y]: [f32; 2], radius: f32, colour: [u8; 3], share: f32) {
        let reach = radius + 1.0;
        let pixels = |at: f32, side: u32| (at - reach).max(0.0) as u32..((at + reach + 1.0).max(0.0) as u32).min(side);
        for py in pixels(y, self.0.height()) {
            for px in pixels(x, self.0.width()) {
                let inside = radius + 0.5 - (px as f32 - x).hypot(py as f32 - y);
                let share = share * inside.clamp(0.0, 1.0);
                let there = self.0.get_pixel_mut(px, py);
                for (there, new) in there.0.iter_mut().zip(colour) {
                    *there = (f32::from(*there) + (f32::from(new) - f32::from(*there)) * share).round() as u8;
                }
            }
        }
    }

    /// Writes `text` with its upper left corner at (`x`, `y`). Characters outside ASCII are left blank.
    pub fn text(&mut self, x: u32, y: u32, text: &str) {
        for (i, character) in text.chars().enumerate() {
            let rows = font8x8::BASIC_FONTS.get(character).unwrap_or_default();
            for (dy, row) in rows.into_iter().enumerate() {
                for dx in (0..CHARACTER).filter(|bit| row >> bit & 1 == 1) {
                    self.set(x + CHARACTER * i as u32 + dx, y + dy as u32, INK);
                }
            }
        }
    }

    /// Writes a PNG file, or PNG to standard output if `path` is `-`.
    pub fn save(&self, path: &Path) -> Outcome {
        let png = self.png().map_err(|e| format!("cannot draw {}: {e}", path.display()))?;
        output::save(path, &png)
    }

    /// The bytes of a PNG file.
    pub fn png(&self) -> Result<Vec<u8>, image::ImageError> {
        let mut png = Cursor::new(Vec::new());
        self.0.write_to(&mut png, image::ImageFormat::Png)?;
        Ok(png.into_inner())
    }
}
