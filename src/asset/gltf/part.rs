//! [`MeshPart`]: the choice of a part of a glTF file.

use serde::{Deserialize, Serialize};
use std::fmt;

/// A part of a glTF file: one mesh or one of its primitives, without the transforms of nodes.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeshPart {
    /// The mesh.
    pub mesh: MeshChoice,
    /// The index of the primitive in the mesh; `None` for all of them.
    #[serde(default)]
    pub primitive: Option<u32>,
}

/// A mesh of a glTF file, written as `0` or `"Body"`.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(untagged)]
pub enum MeshChoice {
    /// The mesh with this index.
    Index(u32),
    /// The first mesh with this name.
    Name(String),
}

impl From<u32> for MeshPart {
    fn from(index: u32) -> Self {
        Self {
            mesh: MeshChoice::Index(index),
            primitive: None,
        }
    }
}

impl From<&str> for MeshPart {
    fn from(name: &str) -> Self {
        Self {
            mesh: MeshChoice::Name(name.into()),
            primitive: None,
        }
    }
}

impl fmt::Display for MeshChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Index(index) => write!(f, "{index}"),
            Self::Name(name) => write!(f, "{name:?}"),
        }
    }
}

/// As RON, as in a recipe.
impl fmt::Display for MeshPart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "(mesh: {}", self.mesh)?;
        match self.primitive {
            Some(primitive) => write!(f, ", primitive: {primitive})"),
            None => write!(f, ")"),
        }
    }
}
