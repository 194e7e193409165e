//! [`FormatError`]: why a `.faceoff` file cannot be read.

use crate::projection::faces::TableError;
use thiserror::Error;

/// The version of the file format. It changes when the meaning of the bytes changes. Files of another version are
/// rejected.
pub const FORMAT_VERSION: u32 = 5;

/// Why bytes are not a valid `.faceoff` file of this version.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum FormatError {
    /// The first bytes are not [`MAGIC`](super::format::MAGIC).
    #[error("this is not a .faceoff file")]
    Magic,
    /// The file has another format version than [`FORMAT_VERSION`].
    #[error("the file has format version {0}, this build reads version {FORMAT_VERSION}: bake the mesh again")]
    Version(u32),
    /// The file ends too early.
    #[error("the file is cut off ({what} is missing): copy it again or bake the mesh again")]
    Truncated {
        /// What could not be read.
        what: &'static str,
    },
    /// The checksum does not match the bytes.
    #[error("the file is damaged (its checksum does not match): copy it again or bake the mesh again")]
    Checksum,
    /// The checksum matches, but the content is invalid.
    #[error("the file is damaged ({0}): bake the mesh again")]
    Damaged(&'static str),
    /// The lz4 frame cannot be decompressed.
    #[error("the file is damaged (its content does not decompress: {0}): bake the mesh again")]
    Compression(String),
    /// The face table is invalid.
    #[error("{0}: bake the mesh again")]
    Table(#[from] TableError),
}
