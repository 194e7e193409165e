//! The `.bake.ron` recipe: which mesh to bake, and how.
//!
//! ```ron
//! (mesh: "knot.obj", settings: (faces: true, degrees: 1, image: 256, weld_tolerance: 1e-6, inward: Room))
//! ```
//!
//! The path is relative to the recipe, with `/` between folders and `..` for the one above; it begins with no `/`, which would be
//! the asset folder to Bevy and the whole disk to others. `settings` and each of its fields may be left out; see [`BakeSettings`]. Of a glTF file
//! the whole scene is one mesh, unless the recipe chooses a part of it, see [`MeshPart`]:
//!
//! ```ron
//! (mesh: "machine.glb", part: (mesh: "Gear", primitive: 0))
//! ```

use super::gltf::MeshPart;
use crate::projection::{BakeSettings, SettingsError};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// What a `.bake.ron` file says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// The mesh file, relative to the recipe: glTF, OBJ or STL, or a baked file whose mesh is to be baked otherwise.
    pub mesh: String,
    /// The part of a glTF file to bake; without it, the whole scene.
    #[serde(default)]
    pub part: Option<MeshPart>,
    /// How to bake it.
    #[serde(default)]
    pub settings: BakeSettings,
}

/// Why a recipe cannot be followed.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum RecipeError {
    /// More than any recipe needs.
    #[error("the recipe has {0} bytes, and {LONGEST} are more than enough: is it the mesh itself?")]
    TooLong(usize),
    /// Not RON, or not the fields of a recipe.
    #[error("line {line}, column {column}: {reason}; a recipe reads (mesh: \"knot.obj\", settings: (faces: true))")]
    Syntax {
        /// Counted from 1.
        line: usize,
        /// Counted from 1.
        column: usize,
        /// What is wrong.
        reason: String,
    },
    /// The path of the mesh is empty, or names another recipe.
    #[error("mesh: {0:?} is no mesh file; name a mesh file relative to the recipe")]
    Mesh(String),
    /// The path of the mesh means one thing here and another there.
    #[error(
        "mesh: {0:?} is not relative to the recipe; name the mesh without a leading / or drive, with / between folders and .. \
         for the one above"
    )]
    NotRelative(String),
    /// Settings that cannot be baked with.
    #[error("settings: {0}")]
    Settings(#[from] SettingsError),
}

const LONGEST: usize = 1 << 16;
/// A recipe nests two deep.
const DEEPEST: usize = 8;

impl Recipe {
    /// Reads a recipe. Whatever the bytes, this ends soon and takes little memory.
    pub fn parse(bytes: &[u8]) -> Result<Self, RecipeError> {
        if bytes.len() > LONGEST {
            return Err(RecipeError::TooLong(bytes.len()));
        }
        let recipe: Self = ron::Options::default()
            .with_recursion_limit(DEEPEST)
            .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
            .from_bytes(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes))
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

    /// The recipe as text, in one line. How to join corners and what to make of inward faces is left out where it is the
    /// default.
    pub fn to_text(&self) -> String {
        let BakeSettings {
            faces,
            degrees,
            image,
            weld_tolerance,
            inward,
        } = self.settings;
        let part = self
            .part
            .as_ref()
            .map(|part| format!("part: {part}, "))
            .unwrap_or_default();
        let mut settings = format!("faces: {faces}, degrees: {degrees}, image: {image}");
        let default = BakeSettings::default();
        if weld_tolerance != default.weld_tolerance {
            settings += &format!(", weld_tolerance: {weld_tolerance:?}");
        }
        if inward != default.inward {
            settings += &format!(", inward: {inward:?}");
        }
        format!("(mesh: {:?}, {part}settings: ({settings}))\n", self.mesh)
    }
}

/// Whether a path means the same on every system, and to whoever reads the recipe. What stands before `://` is one of Bevy's
/// asset sources.
fn is_relative(path: &str) -> bool {
    let path = path.split_once("://").map_or(path, |(_, path)| path);
    let is_drive = path.as_bytes().get(1) == Some(&b':');
    !path.starts_with('/') && !path.contains('\\') && !is_drive
}

/// Whether a file of this name is a recipe.
pub(crate) fn is_recipe(name: &str) -> bool {
    name.to_ascii_lowercase().ends_with(".bake.ron")
}
