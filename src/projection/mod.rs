//! The offline stage of the method: the visible triangles and the support heights of a mesh in each direction.
//!
//! * [`HeightImage`] is a mesh drawn along a direction as an image of heights (Aly & Elawady 2010, section "height
//!   projection"). [`raster`] finds the triangles that are visible in it.
//! * [`FaceTable`] stores the visible triangles for all directions: the *faces of collision*.
//! * [`SupportHeights`] stores the extent of the mesh in a few hundred directions. The culls that use it are
//!   conservative.
//!
//! This module uses neither the ECS nor the GPU, and no threads but those of the pool passed by the caller.

mod bake;
mod batch;
mod codec;
mod decode;
mod depth;
pub mod faces;
mod facing;
mod groups;
mod height_image;
pub(crate) mod heights;
mod pool;
mod progress;
pub mod raster;
mod spans;

pub use faces::{FaceTable, Group};
pub use height_image::{HeightImage, ImagePlaces};
pub use heights::SupportHeights;
pub use pool::bake_pool;
pub use progress::{Cancelled, Progress};

use crate::geometry::SHELL_THICKNESS;
use crate::geometry::direction::DirectionGrid;
use crate::geometry::mesh::{MAX_COORDINATE, WELD_TOLERANCE};
#[cfg(feature = "bevy")]
use bevy::prelude::*;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// How to bake a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(
    feature = "bevy",
    derive(Reflect),
    reflect(Default, Debug, PartialEq, Serialize, Deserialize)
)]
#[serde(default, deny_unknown_fields)]
pub struct BakeSettings {
    /// Whether to bake the face table.
    pub faces: bool,
    /// Angular step of the table in whole degrees; must divide 90.
    pub degrees: u32,
    /// Side of the square height image in pixels, 16 to 4096.
    pub image: u32,
    /// The weld tolerance, relative to the diagonal of the mesh's bounding box; 0 to 0.01.
    ///
    /// Vertices within this distance count as one when the bake decides whether the mesh is closed, which faces are
    /// neighbours, its mass, and whether something is inside. The tested triangles and the face indices do not change.
    /// With 0 only vertices at exactly the same position count as one.
    pub weld_tolerance: f32,
    /// How to treat a closed mesh whose faces point inward.
    pub inward: Inward,
    /// The thickness of the shell that gives an open mesh its mass if it encloses nothing, relative to the diagonal of
    /// its bounding box; more than 0, at most 0.5. See
    /// [`MassProperties::with_shell`](crate::geometry::MassProperties::with_shell).
    pub shell_thickness: f32,
    /// Radius of the rounding, mesh units; 0 for none. The surface is then all that is within this distance of the
    /// mesh, which is its *core*: edges and corners are round, and a sheet has a thickness of twice the radius.
    ///
    /// A scale multiplies it by its smallest component, because a round surface stays round only under even scales.
    pub rounding: f32,
}

/// How to treat a closed mesh whose faces point inward.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(
    feature = "bevy",
    derive(Reflect),
    reflect(Default, Debug, PartialEq, Serialize, Deserialize)
)]
pub enum Inward {
    /// As a room. Bodies inside are free, and its walls push in the direction in which their faces point. Nothing is
    /// ever reported as wholly inside. A room has no mass of its own. It gets the mass of a solid that fills it, marked
    /// as approximate.
    #[default]
    Room,
    /// As a solid with reversed winding: its faces are turned.
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
            shell_thickness: SHELL_THICKNESS,
            rounding: 0.0,
        }
    }
}

/// Why bake settings are invalid.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum SettingsError {
    /// [`BakeSettings::degrees`] does not divide 90.
    #[error("degrees is {0}, but the angular step must divide 90: 1, 2, 3, 5, 6, 9, 10, 15, 18, 30, 45 or 90")]
    Degrees(u32),
    /// [`BakeSettings::image`] is out of range.
    #[error("image is {0}, but the side of the height image must be 16 to 4096 pixels")]
    Image(u32),
    /// [`BakeSettings::weld_tolerance`] is out of range.
    #[error("weld_tolerance is {0}, but must be 0 to 0.01 of the mesh's size")]
    WeldTolerance(f32),
    /// [`BakeSettings::shell_thickness`] is out of range.
    #[error("shell_thickness is {0}, but must be more than 0 and at most 0.5 of the mesh's size")]
    ShellThickness(f32),
    /// [`BakeSettings::rounding`] is out of range.
    #[error("rounding is {0}, but must be 0 to {MAX_COORDINATE} mesh units")]
    Rounding(f32),
}

impl BakeSettings {
    /// The smallest height image, in pixels.
    pub const MIN_IMAGE: u32 = 16;
    /// The largest height image, in pixels.
    pub const MAX_IMAGE: u32 = 4096;
    /// The largest weld tolerance, relative to the diagonal of the mesh's bounding box.
    pub const MAX_WELD_TOLERANCE: f32 = 0.01;
    /// The largest shell thickness, relative to the diagonal of the mesh's bounding box.
    pub const MAX_SHELL_THICKNESS: f32 = 0.5;

    /// Checks that all fields are in their documented ranges.
    ///
    /// # Errors
    /// For the first field that is out of range.
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
        if !(self.shell_thickness > 0.0 && self.shell_thickness <= Self::MAX_SHELL_THICKNESS) {
            return Err(SettingsError::ShellThickness(self.shell_thickness));
        }
        if !(0.0..=MAX_COORDINATE).contains(&self.rounding) {
            return Err(SettingsError::Rounding(self.rounding));
        }
        Ok(())
    }
}
