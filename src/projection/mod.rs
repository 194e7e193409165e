//! The offline stage of the method: what can be seen of a mesh from every direction, and how far it reaches.
//!
//! * [`raster`] draws a mesh from a direction as an image of heights (Aly & Elawady 2010, section "height projection"),
//!   and finds the triangles that can be seen in it.
//! * [`faces`] keeps these triangles for every direction: the *faces of collision*.
//! * [`heights`] keeps how far the mesh reaches in a few hundred directions, for culls that can miss nothing.
//!
//! Everything here is pure: no ECS, no GPU, and no thread but those of the pool that the caller hands in.

mod bake;
mod codec;
mod decode;
pub mod faces;
mod groups;
pub mod heights;
mod picture;
mod pool;
pub mod progress;
pub mod raster;
mod skin;
mod spans;

pub use faces::{FaceTable, Group};
pub use heights::SupportHeights;
pub use pool::bake_pool;
pub use progress::{Cancelled, Progress};
pub use raster::HeightImage;

use crate::geometry::direction::DirectionGrid;
use thiserror::Error;

/// What to bake for a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BakeSettings {
    /// Whether to bake the table of faces of collision.
    pub faces: bool,
    /// Angular step of the table in whole degrees; must divide 90.
    pub degrees: u32,
    /// Side of the square height image in pixels, 16 to 4096.
    pub image: u32,
}

impl Default for BakeSettings {
    fn default() -> Self {
        Self {
            faces: false,
            degrees: 1,
            image: 256,
        }
    }
}

/// Why settings cannot be used.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum SettingsError {
    /// [`BakeSettings::degrees`] does not divide 90.
    #[error("degrees is {0}, but the angular step must divide 90: 1, 2, 3, 5, 6, 9, 10, 15, 18, 30, 45 or 90")]
    Degrees(u32),
    /// [`BakeSettings::image`] is out of range.
    #[error("image is {0}, but the side of the height image must be 16 to 4096 pixels")]
    Image(u32),
}

impl BakeSettings {
    /// The smallest height image, in pixels.
    pub const MIN_IMAGE: u32 = 16;
    /// The largest height image, in pixels.
    pub const MAX_IMAGE: u32 = 4096;

    /// Checks the ranges that the fields document.
    pub fn validate(&self) -> Result<(), SettingsError> {
        if DirectionGrid::new(self.degrees).is_none() {
            return Err(SettingsError::Degrees(self.degrees));
        }
        if !(Self::MIN_IMAGE..=Self::MAX_IMAGE).contains(&self.image) {
            return Err(SettingsError::Image(self.image));
        }
        Ok(())
    }
}
