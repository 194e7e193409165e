//! The offline stage of the method: what can be seen of a mesh from every direction, and how far it reaches.

pub mod faces;
pub mod heights;
pub mod progress;

pub use faces::FaceTable;
pub use heights::SupportHeights;
pub use progress::{Cancelled, Progress};

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
