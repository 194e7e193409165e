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
