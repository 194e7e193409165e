//! The `.glb` container, and where buffers have their bytes.

use super::error::GltfError;
use super::schema::Buffer;
use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use std::ops::Range;

/// Where in a file its document and its binary chunk are. A `.gltf` file is all document.
pub(super) fn chunks(bytes: &[u8]) -> Result<(Range<usize>, Option<Range<usize>>), GltfError> {
    if !bytes.starts_with(b"glTF") {
        return Ok((0..bytes.len(), None));
    }
    let word = |at: usize| {
        let word = bytes.get(at..at + 4)?;
        Some(u32::from_le_bytes([word[0], word[1], word[2], word[3]]))
    };
    let damaged = |what| GltfError::Container(what);
    let version = word(4).ok_or(damaged("its header is cut off"))?;
    if version != 2 {
        return Err(GltfError::Version(version.to_string()));
    }
    let length = word(8).ok_or(damaged("its header is cut off"))? as usize;
    if length > bytes.len() {
        return Err(damaged("it is cut off"));
    }
    let chunk = |at: usize| -> Result<Option<(u32, Range<usize>)>, GltfError> {
        if at >= length {
            return Ok(None);
        }
        let (Some(size), Some(kind)) = (word(at), word(at + 4)) else {
            return Err(damaged("a chunk's header is cut off"));
        };
        let start = at + 8;
        match start.checked_add(size as usize) {
            Some(end) if end <= length => Ok(Some((kind, start..end))),
            _ => Err(damaged("a chunk is longer than the file")),
        }
    };
    let Some((JSON, document)) = chunk(12)? else {
        return Err(damaged("its first chunk is no document"));
    };
    // Chunks of other kinds belong to extensions.
    let binary = chunk(document.end.next_multiple_of(4))?.filter(|(kind, _)| *kind == BINARY);
    Ok((document, binary.map(|(_, range)| range)))
}

const JSON: u32 = u32::from_le_bytes(*b"JSON");
const BINARY: u32 = u32::from_le_bytes(*b"BIN\0");

/// Where a buffer has its bytes.
pub(super) enum Place {
    /// In the binary chunk.
    Chunk,
    /// They stood in the document.
    Here(Vec<u8>),
    /// In the file of this number.
    File(usize),
    /// Nowhere, which matters only if the buffer is used.
    Missing,
}

/// Finds the bytes of all buffers, and the other files that are needed: paths relative to the document, each once.
pub(super) fn places(buffers: &[Buffer], has_chunk: bool) -> Result<(Vec<Place>, Vec<String>), GltfError> {
    let mut files: Vec<String> = Vec::new();
    let mut places = Vec::with_capacity(buffers.len());
    for (i, buffer) in buffers.iter().enumerate() {
        let wrong = |reason: &str| GltfError::Buffer {
            buffer: i,
            reason: reason.into(),
        };
        places.push(match &buffer.uri {
            None if i == 0 && has_chunk => Place::Chunk,
            None => Place::Missing,
            Some(uri) if starts_with_ignoring_case(uri, "data:") => Place::Here(data(uri).map_err(wrong)?),
            Some(uri) => {
                let path = relative_path(uri).map_err(|reason| wrong(&format!("{:?} {reason}", shortened(uri))))?;
                let file = files.iter().position(|f| *f == path).unwrap_or(files.len());
                if file == files.len() {
                    // Each is looked for among all before it, so that a document of nothing but names would take hours.
                    if files.len() >= MOST_FILES {
                        return Err(wrong("the file names too many others"));
                    }
                    files.push(path);
                }
                Place::File(file)
            }
        });
    }
    Ok((places, files))
}

const MOST_FILES: usize = 1000;

/// The content of a `data:` URI.
fn data(uri: &str) -> Result<Vec<u8>, &'static str> {
    let (kind, content) = uri.split_once(',').ok_or("its data URI has no comma")?;
    if !kind.to_ascii_lowercase().ends_with(";base64") {
        return Err("its data URI is not in base64");
    }
    // Some exporters leave the padding out.
    let config = GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent);
    GeneralPurpose::new(&STANDARD, config)
        .decode(content)
        .map_err(|_| "its data URI is damaged base64; export or copy the file again")
}

/// The path that a URI names, relative to the document, without detours. It may lead up: whether that is too far only the
/// caller knows.
fn relative_path(uri: &str) -> Result<String, &'static str> {
    let decoded = percent_decoded(uri).ok_or("is no URI")?;
    if decoded.contains(['\\', '\0', ':']) || decoded.starts_with('/') {
        return Err("is no relative path; put the file beside the glTF file and export again");
    }
    let mut parts: Vec<&str> = Vec::new();
    for part in decoded.split('/') {
        match part {
            "" | "." => {}
            ".." if parts.last().is_some_and(|last| *last != "..") => {
                parts.pop();
            }
            part => parts.push(part),
        }
    }
    if parts.last().is_none_or(|last| *last == "..") {
        return Err("names no file");
    }
    Ok(parts.join("/"))
}

fn percent_decoded(uri: &str) -> Option<String> {
    let mut out = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, tail @ ..] = rest {
        rest = tail;
        if *first != b'%' {
            out.push(*first);
            continue;
        }
        let (digits, tail) = rest.split_at_checked(2)?;
        let digit = |d: u8| char::from(d).to_digit(16);
        out.push((digit(digits[0])? * 16 + digit(digits[1])?) as u8);
        rest = tail;
    }
    String::from_utf8(out).ok()
}

fn starts_with_ignoring_case(text: &str, start: &str) -> bool {
    text.get(..start.len()).is_some_and(|s| s.eq_ignore_ascii_case(start))
}

fn shortened(text: &str) -> String {
    text.chars().take(80).collect()
}
