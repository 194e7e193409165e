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
use crate::geometry::mesh::WELD_TOLERANCE;
use thiserror::Error;

/// How to bake a mesh.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BakeSettings {
    /// Whether to bake the table of faces of collision.
    pub faces: bool,
    /// Angular step of the table in whole degrees; must divide 90.
    pub degrees: u32,
    /// Side of the square height image in pixels, 16 to 4096.
    pub image: u32,
    /// Corners no farther apart than this part of the mesh's size, the diagonal of its box, count as one; 0 to 0.01. It
    /// decides whether the mesh is closed, what it weighs, which faces are neighbours, and whether something is inside. The
    /// triangles that are tested stay what they are, and so do the numbers of the faces. With 0 only corners at the same place
    /// are one.
    pub weld_tolerance: f32,
    /// What a closed mesh is whose faces look inward.
    pub inward: Inward,
}

/// What a closed mesh is whose faces look inward.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub enum Inward {
    /// A room. Bodies inside are free, and its walls push to the side to which their faces look. Nothing is ever reported as
    /// wholly inside it. It has no mass of its own: it gets that of a solid of its inside, marked as approximate.
    #[default]
    Room,
    /// A solid whose faces are wound the wrong way: they are turned.
    Solid,
}

impl Default for BakeSettings {
    fn default() -> Self {
        Self {
            faces: false,
            degrees: 1,
            image: 256,
            weld_tolerance: WELD_TOLERANCE,
            inward: Inward::Room,
        }
    }
}

/// Why settings cannot be used.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum SettingsError {
    /// [`BakeSettings::degrees`] does not divide 90.
    #[error("degrees is {0}, but the angular step must divide 90: 1, 2, 3, 5, 6, 9, 10, 15, 18, 30, 45 or 90")]
    Degrees(u32),
    /// [`BakeSettings::image`] is out of range.
    #[error("image is {0}, but the side of the height image must be 16 to 4096 pixels")]
    Image(u32),
    /// [`BakeSettings::weld_tolerance`] is out of range.
    #[error("weld_tolerance is {0}, but the part of a mesh's size within which corners are one must be 0 to 0.01")]
    WeldTolerance(f32),
}

impl BakeSettings {
    /// The smallest height image, in pixels.
    pub const MIN_IMAGE: u32 = 16;
    /// The largest height image, in pixels.
    pub const MAX_IMAGE: u32 = 4096;
    /// The largest tolerance within which corners are one, as a part of the mesh's size.
    pub const MAX_WELD_TOLERANCE: f32 = 0.01;

    /// Checks the ranges that the fields document.
    pub fn validate(&self) -> Result<(), SettingsError> {
        if DirectionGrid::new(self.degrees).is_none() {
            return Err(SettingsError::Degrees(self.degrees));
        }
        if !(Self::MIN_IMAGE..=Self::MAX_IMAGE).contains(&self.image) {
            return Err(SettingsError::Image(self.image));
        }
        if !(0.0..=Self::MAX_WELD_TOLERANCE).contains(&self.weld_tolerance) {
            return Err(SettingsError::WeldTolerance(self.weld_tolerance));
        }
        Ok(())
    }
}
