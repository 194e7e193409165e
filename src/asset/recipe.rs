//! The `.bake.ron` recipe, which says which mesh to bake, and how.
//!
//! ```ron
//! (mesh: "knot.obj", settings: (faces: true, degrees: 1, image: 256, weld_tolerance: 1e-6, inward: Room, shell_thickness: 0.01, rounding: 0.0))
//! ```
//!
//! The path is relative to the recipe, with `/` between folders and `..` for the parent folder. It must not begin with
//! `/`: that would mean the asset folder to Bevy, but the root of the disk to other programs. `settings` and each of
//! its fields are optional; see [`BakeSettings`].
//!
//! The whole scene of a glTF file, or all objects of an OBJ file, are one mesh, unless the recipe chooses a part of it;
//! see [`MeshPart`]:
//!
//! ```ron
//! (mesh: "machine.glb", part: (node: "Arm"))
//! (mesh: "machine.glb", part: (mesh: "Gear", primitive: 0))
//! (mesh: "car.obj", part: (object: "Wheel"))
//! (mesh: "car.obj", part: (group: "rim"))
//! ```
//!
//! A glTF file may name others. Those outside its own folder are read only if the recipe says so:
//!
//! ```ron
//! (mesh: "machine/machine.gltf", read_outside: true)
//! ```

use super::part::MeshPart;
use super::text::without_byte_order_mark;
use crate::projection::{BakeSettings, SettingsError};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// The content of a `.bake.ron` file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// The path of the mesh file, relative to the recipe: a glTF, OBJ, STL, PLY or OFF file, or a baked file to bake
    /// again.
    pub mesh: String,
    /// The part of a glTF or OBJ file to bake; `None` for all of it.
    #[serde(default)]
    pub part: Option<MeshPart>,
    /// Whether files that the mesh file names are read although they are outside its own folder. Default false.
    #[serde(default)]
    pub read_outside: bool,
    /// The settings of the bake.
    #[serde(default)]
    pub settings: BakeSettings,
}

/// Why a recipe is invalid.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum RecipeError {
    /// The recipe is longer than any recipe needs to be. Holds its length in bytes.
    #[error("the recipe has {0} bytes, but a recipe has at most {MAX_LENGTH}: is it the mesh itself?")]
    TooLong(usize),
    /// The text is not RON, or does not have the fields of a recipe.
    #[error("line {line}, column {column}: {reason}; a recipe reads (mesh: \"knot.obj\", settings: (faces: true))")]
    Syntax {
        /// Counted from 1.
        line: usize,
        /// Counted from 1.
        column: usize,
        /// What is wrong.
        reason: String,
    },
    /// The path of the mesh is empty, or is that of another recipe.
    #[error("mesh: {0:?} is not a mesh file; give the path of a mesh file relative to the recipe")]
    Mesh(String),
    /// The path of the mesh is not relative, so its meaning would depend on the system.
    #[error(
        "mesh: {0:?} is not relative to the recipe; give the path without a leading / or drive, with / between folders \
         and .. for the parent folder"
    )]
    NotRelative(String),
    /// The settings are invalid.
    #[error("settings: {0}")]
    Settings(#[from] SettingsError),
}

/// The maximum length of a recipe in bytes.
const MAX_LENGTH: usize = 1 << 16;
/// The maximum nesting of the RON text. A recipe needs two levels.
const MAX_DEPTH: usize = 8;

impl Recipe {
    /// Parses a recipe. Time and memory are bounded for any input.
    ///
    /// # Errors
    /// If the text is not a recipe, its mesh path is not usable, or its settings are invalid.
    pub fn parse(bytes: &[u8]) -> Result<Self, RecipeError> {
        if bytes.len() > MAX_LENGTH {
            return Err(RecipeError::TooLong(bytes.len()));
        }
        let recipe: Self = ron::Options::default()
            .with_recursion_limit(MAX_DEPTH)
            .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
            .from_bytes(without_byte_order_mark(bytes))
            .map_err(|e| RecipeError::Syntax {
                line: e.span.start.line,
                column: e.span.start.col,
                reason: e.code.to_string(),
            })?;
        if recipe.mesh.trim().is_empty() || is_recipe(&recipe.mesh) || recipe.mesh.contains(['#', '\0']) {
            return Err(RecipeError::Mesh(recipe.mesh));
        }
        if !is_relative(&recipe.mesh) {
            return Err(RecipeError::NotRelative(recipe.mesh));
        }
        recipe.settings.validate()?;
        Ok(recipe)
    }

    /// The recipe as one line of text. `read_outside`, `weld_tolerance`, `inward`, `shell_thickness` and `rounding` are
    /// left out if they have their default values.
    pub fn to_text(&self) -> String {
        let BakeSettings {
            faces,
            degrees,
            image,
            weld_tolerance,
            inward,
            shell_thickness,
            rounding,
        } = self.settings;
        let part = self
            .part
            .as_ref()
            .map(|part| format!("part: {part}, "))
            .unwrap_or_default();
        let outside = if self.read_outside { "read_outside: true, " } else { "" };
        let mut settings = format!("faces: {faces}, degrees: {degrees}, image: {image}");
        let default = BakeSettings::default();
        if weld_tolerance != default.weld_tolerance {
            settings += &format!(", weld_tolerance: {weld_tolerance:?}");
        }
        if inward != default.inward {
            settings += &format!(", inward: {inward:?}");
        }
        if shell_thickness != default.shell_thickness {
            settings += &format!(", shell_thickness: {shell_thickness:?}");
        }
        if rounding != default.rounding {
            settings += &format!(", rounding: {rounding:?}");
        }
        format!("(mesh: {:?}, {part}{outside}settings: ({settings}))\n", self.mesh)
    }
}

/// Whether a path is relative on every system. A prefix before `://` is the name of a Bevy asset source.
fn is_relative(path: &str) -> bool {
    let path = path.split_once("://").map_or(path, |(_, path)| path);
    let is_drive = path.as_bytes().get(1) == Some(&b':');
    !path.starts_with('/') && !path.contains('\\') && !is_drive
}

/// Whether a file of this name is a recipe.
pub(crate) fn is_recipe(name: &str) -> bool {
    name.to_ascii_lowercase().ends_with(".bake.ron")
}
