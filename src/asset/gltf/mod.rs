//! glTF 2.0: the triangles of `.gltf` and `.glb` files.
//!
//! A reader of our own over `serde_json`. The `gltf` crate was looked at: its check of a document looks up the accessor of a
//! primitive's positions before it has checked that it is there, and so panics on a wrong number; its iterators over
//! accessors panic or overflow on empty accessors, short strides and sparse ones with too few values; it cuts indices down
//! to 32 bits; and it refuses whole files for materials and extensions that do not concern a mesh. What would be left to use
//! is its list of fields, of which collisions need few.
//!
//! Read are triangles, strips and fans, with indices of any size or none, sparse accessors and quantised positions; buffers
//! in the file, in `data:` URIs and in other files. Skins and morph targets are not applied. Draco and meshopt are refused.

mod accessor;
mod container;
mod error;
mod scene;
mod schema;

pub use error::GltfError;

use super::import::ImportError;
use crate::geometry::TriMesh;
use accessor::Data;
use container::Place;
use schema::Root;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::Range;

/// A part of a glTF file: one mesh, or one primitive of it, as it was modelled, without the transforms of nodes.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeshPart {
    /// Which mesh.
    pub mesh: MeshChoice,
    /// Which of its primitives; all of them without it.
    #[serde(default)]
    pub primitive: Option<u32>,
}

/// A mesh of a glTF file, written as `0` or `"Body"`.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(untagged)]
pub enum MeshChoice {
    /// By its number in the file.
    Index(u32),
    /// By its name; the first mesh of that name.
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

/// As RON, the way a recipe has it.
impl fmt::Display for MeshPart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "(mesh: {}", self.mesh)?;
        match self.primitive {
            Some(primitive) => write!(f, ", primitive: {primitive})"),
            None => write!(f, ")"),
        }
    }
}

/// A document, and where its buffers are.
pub(super) struct Document {
    root: Root,
    chunk: Option<Range<usize>>,
    places: Vec<Place>,
    /// The other files it needs: paths relative to its own, each once.
    pub(super) files: Vec<String>,
}

impl Document {
    /// Reads all but the triangles.
    pub(super) fn open(bytes: &[u8]) -> Result<Self, GltfError> {
        let (document, chunk) = container::chunks(bytes)?;
        let text = &bytes[document];
        // Documents nested deeper than 128 levels are refused by serde_json.
        let root: Root =
            serde_json::from_slice(text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text)).map_err(|error| {
                GltfError::Document {
                    line: error.line(),
                    column: error.column(),
                    reason: reason(&error),
                }
            })?;
        let version = root.asset.min_version.as_ref().unwrap_or(&root.asset.version);
        if version != "2" && !version.starts_with("2.") {
            return Err(GltfError::Version(version.chars().take(20).collect()));
        }
        if let Some(extension) = root.extensions_required.iter().find(|e| !is_harmless(e)) {
            return Err(GltfError::Extension(extension.chars().take(60).collect()));
        }
        let (places, files) = container::places(&root.buffers, chunk.is_some())?;
        Ok(Self {
            root,
            chunk,
            places,
            files,
        })
    }

    /// Reads the triangles of a part, or of the whole scene. `bytes` are those it was opened with, `files` the contents of
    /// [`Document::files`].
    pub(super) fn read(
        &self,
        bytes: &[u8],
        part: Option<&MeshPart>,
        files: &[Vec<u8>],
    ) -> Result<TriMesh, ImportError> {
        let length = bytes.len() as u64 + files.iter().map(|f| f.len() as u64).sum::<u64>();
        let mut buffers = Vec::with_capacity(self.places.len());
        for (buffer, (place, described)) in self.places.iter().zip(&self.root.buffers).enumerate() {
            let content = match place {
                Place::Chunk => self.chunk.clone().and_then(|chunk| bytes.get(chunk)),
                Place::Here(content) => Some(content.as_slice()),
                Place::File(file) => files.get(*file).map(Vec::as_slice),
                Place::Missing => None,
            };
            let needed = described.byte_length;
            if let Some(content) = content.filter(|c| (c.len() as u64) < needed) {
                let there = content.len();
                let reason = format!("it has {there} of its {needed} bytes: it is cut off; export or copy it again");
                return Err(GltfError::Buffer { buffer, reason }.into());
            }
            buffers.push(content.map(|c| &c[..needed as usize]));
        }
        let data = Data {
            root: &self.root,
            buffers,
            length,
        };
        match part {
            None => scene::read_scene(&data),
            Some(part) => scene::read_part(&data, part),
        }
    }
}

/// Whether a required extension changes nothing about shapes, or is read.
fn is_harmless(extension: &str) -> bool {
    let looks = [
        "KHR_materials_",
        "KHR_texture_",
        "KHR_lights_",
        "EXT_texture_",
        "MSFT_texture_",
        "EXT_lights_",
    ];
    extension == "KHR_mesh_quantization" || looks.iter().any(|prefix| extension.starts_with(prefix))
}

/// What is wrong with a document, without the place, which is told apart from it.
fn reason(error: &serde_json::Error) -> String {
    let text = error.to_string();
    let text = text
        .rsplit_once(" at line ")
        .map_or(text.as_str(), |(reason, _)| reason);
    text.chars().take(200).collect()
}

/// Whether bytes without a telling name are glTF.
pub(super) fn is_likely(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(1 << 16)];
    bytes.starts_with(b"glTF")
        || (start.trim_ascii_start().starts_with(b"{")
            && [b"\"asset\"".as_slice(), b"\"meshes\"", b"\"accessors\""]
                .iter()
                .any(|key| start.windows(key.len()).any(|w| w == *key)))
}
