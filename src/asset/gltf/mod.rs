//! Reader for glTF 2.0: the triangles of `.gltf` and `.glb` files.
//!
//! Supported are triangle lists, strips and fans; indices of any size or none; sparse accessors; quantized positions;
//! and buffers in the file, in `data:` URIs and in other files. A mesh with a skin is read as it was modelled: by the
//! specification its joints place it, not its node. Skins, morph targets and instances (`EXT_mesh_gpu_instancing`) are
//! not applied, and hidden nodes (`KHR_node_visibility`) are read: warnings tell so. Draco and meshopt compression are
//! rejected.
//!
//! Why not the `gltf` crate: its validation looks up the accessor of a primitive's positions before it checks that the
//! accessor exists, so an invalid index makes it panic. Its iterators over accessors panic or overflow on empty
//! accessors, short strides, and sparse accessors with too few values. It truncates indices to 32 bits. And it rejects
//! whole files for materials and extensions that do not affect a mesh. Only its list of fields would remain useful, and
//! collisions need few of them. So this reader uses `serde_json` directly.

mod accessor;
mod container;
mod error;
mod scene;
mod schema;

pub use error::GltfError;

use super::import_error::ImportError;
use super::part::MeshPart;
use super::text::without_byte_order_mark;
use crate::geometry::TriMesh;
use accessor::Data;
use container::BufferSource;
use schema::{OtherRoot, Root};
use std::ops::Range;

/// A glTF document, and the sources of its buffers.
pub(super) struct Document {
    root: Root,
    chunk: Option<Range<usize>>,
    sources: Vec<BufferSource>,
    /// The other files it needs: paths relative to its own, without duplicates.
    pub(super) files: Vec<String>,
    /// What is wrong with the file, but read all the same.
    pub(super) warnings: Vec<String>,
}

impl Document {
    /// Parses the document, without its buffers.
    pub(super) fn open(bytes: &[u8]) -> Result<Self, GltfError> {
        let mut warnings = Vec::new();
        let (document, chunk) = container::chunks(bytes, &mut warnings)?;
        let chunk_text = &bytes[document];
        // Some programs pad the document with zeros, where spaces should be. The library `cgltf` reads them too.
        let text = without_zeros(chunk_text);
        if text.len() < chunk_text.len() {
            warnings
                .push("the JSON of the file is padded with zeros instead of spaces; it is read all the same".into());
        }
        // serde_json rejects documents nested deeper than 128 levels.
        let text = without_byte_order_mark(text);
        let root: Root = serde_json::from_slice(text).map_err(|error| {
            // Fields of glTF 1.0 have other types. Its version is the better error.
            let version = serde_json::from_slice(text)
                .ok()
                .and_then(|OtherRoot { asset }| asset.version());
            if let Some(version) = version.filter(|version| !is_supported(version)) {
                return GltfError::Version(version.chars().take(20).collect());
            }
            GltfError::Document {
                line: error.line(),
                column: error.column(),
                reason: reason(&error),
            }
        })?;
        let version = root.asset.min_version.as_ref().unwrap_or(&root.asset.version);
        if !is_supported(version) {
            return Err(GltfError::Version(version.chars().take(20).collect()));
        }
        if let Some(extension) = root.extensions_required.iter().find(|e| !is_harmless(e)) {
            return Err(GltfError::Extension(extension.chars().take(60).collect()));
        }
        let (sources, files) = container::buffer_sources(&root.buffers, chunk.is_some())?;
        scene::warn_unread(&root, &mut warnings);
        Ok(Self {
            root,
            chunk,
            sources,
            files,
            warnings,
        })
    }

    /// Reads the triangles of a part, or of the whole scene. `bytes` must be those passed to [`Document::open`], and
    /// `files` the contents of [`Document::files`].
    pub(super) fn read(
        &self,
        bytes: &[u8],
        part: Option<&MeshPart>,
        files: &[Vec<u8>],
    ) -> Result<TriMesh, ImportError> {
        let length = bytes.len() as u64 + files.iter().map(|f| f.len() as u64).sum::<u64>();
        let mut buffers = Vec::with_capacity(self.sources.len());
        for (buffer, (source, described)) in self.sources.iter().zip(&self.root.buffers).enumerate() {
            let content = match source {
                BufferSource::Chunk => self.chunk.clone().and_then(|chunk| bytes.get(chunk)),
                BufferSource::Inline(content) => Some(content.as_slice()),
                BufferSource::File(file) => files.get(*file).map(Vec::as_slice),
                BufferSource::Missing => None,
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
            Some(MeshPart::Mesh { mesh, primitive }) => scene::read_mesh(&data, mesh, *primitive),
            Some(MeshPart::Node(node)) => scene::read_node(&data, node),
            Some(part) => Err(ImportError::wrong_part(part, "a glTF", "a mesh or a node")),
        }
    }
}

fn is_supported(version: &str) -> bool {
    version == "2" || version.starts_with("2.")
}

/// A text without the zeros at its end.
fn without_zeros(text: &[u8]) -> &[u8] {
    let length = text.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1);
    &text[..length]
}

/// Whether a required extension is supported or does not affect shapes.
fn is_harmless(extension: &str) -> bool {
    let appearance = [
        "KHR_materials_",
        "KHR_texture_",
        "KHR_lights_",
        "EXT_texture_",
        "MSFT_texture_",
        "EXT_lights_",
    ];
    extension == "KHR_mesh_quantization" || appearance.iter().any(|prefix| extension.starts_with(prefix))
}

/// The message of a parse error without its position, which [`GltfError::Document`] holds separately.
fn reason(error: &serde_json::Error) -> String {
    let text = error.to_string();
    let text = text
        .rsplit_once(" at line ")
        .map_or(text.as_str(), |(reason, _)| reason);
    text.chars().take(200).collect()
}

/// Whether the content looks like glTF. Used if the file name does not identify the format.
pub(super) fn is_likely(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(1 << 16)];
    bytes.starts_with(b"glTF")
        || (start.trim_ascii_start().starts_with(b"{")
            && [b"\"asset\"".as_slice(), b"\"meshes\"", b"\"accessors\""]
                .iter()
                .any(|key| start.windows(key.len()).any(|w| w == *key)))
}
