//! The `.glb` container, and the sources of buffers: binary chunk, data URI or other file.

use super::error::GltfError;
use super::schema::Buffer;
use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use std::ops::Range;

/// The byte ranges of the JSON document and of the binary chunk. A `.gltf` file is a document as a whole.
pub(super) fn chunks(
    bytes: &[u8],
    warnings: &mut Vec<String>,
) -> Result<(Range<usize>, Option<Range<usize>>), GltfError> {
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
    if length < FIRST_CHUNK {
        return Err(damaged("its first chunk is not JSON"));
    }
    // Chunks may be beyond the length that the header tells, as long as the file has them. The `gltf` crate reads them
    // too.
    let chunk = |at: usize| -> Result<Option<(u32, Range<usize>)>, GltfError> {
        if at >= bytes.len() {
            return Ok(None);
        }
        let (Some(size), Some(kind)) = (word(at), word(at + 4)) else {
            return Err(damaged("a chunk's header is cut off"));
        };
        let start = at + 8;
        match start.checked_add(size as usize) {
            Some(end) if end <= bytes.len() => Ok(Some((kind, start..end))),
            _ => Err(damaged("a chunk is longer than the file")),
        }
    };
    let Some((JSON, document)) = chunk(12)? else {
        return Err(damaged("its first chunk is not JSON"));
    };
    // Chunks of other kinds belong to extensions.
    let (padded, unpadded) = (document.end.next_multiple_of(4), document.end);
    let binary = match chunk(padded) {
        Ok(Some((BINARY, binary))) => Some(binary),
        found => match chunk(unpadded) {
            // Some programs do not pad the document to four bytes, as they should.
            Ok(Some((BINARY, binary))) => {
                warnings.push("the JSON of the file is not padded to four bytes; it is read all the same".into());
                Some(binary)
            }
            // What follows the end that the header tells need not be a chunk.
            _ if padded >= length => None,
            _ => found?.and(None),
        },
    };
    let end = binary.as_ref().map_or(document.end, |binary| binary.end);
    if end > length {
        warnings.push(format!(
            "the header of the file says that it ends after {length} bytes, but its chunks end after {end}; they are read \
             all the same"
        ));
    }
    Ok((document, binary))
}

/// Where the content of the first chunk begins.
const FIRST_CHUNK: usize = 20;
const JSON: u32 = u32::from_le_bytes(*b"JSON");
const BINARY: u32 = u32::from_le_bytes(*b"BIN\0");

/// The source of a buffer's bytes.
pub(super) enum BufferSource {
    /// The binary chunk of a `.glb` file.
    Chunk,
    /// A data URI in the document; holds its decoded content.
    Inline(Vec<u8>),
    /// The other file with this index.
    File(usize),
    /// None. This is an error only if the buffer is used.
    Missing,
}

/// The source of each buffer, and the other files that are needed: paths relative to the document, without duplicates.
pub(super) fn buffer_sources(
    buffers: &[Buffer],
    has_chunk: bool,
) -> Result<(Vec<BufferSource>, Vec<String>), GltfError> {
    let mut files: Vec<String> = Vec::new();
    let mut sources = Vec::with_capacity(buffers.len());
    for (i, buffer) in buffers.iter().enumerate() {
        let wrong = |reason: &str| GltfError::Buffer {
            buffer: i,
            reason: reason.into(),
        };
        sources.push(match &buffer.uri {
            None if i == 0 && has_chunk => BufferSource::Chunk,
            None => BufferSource::Missing,
            Some(uri) if starts_with_ignoring_case(uri, "data:") => BufferSource::Inline(data(uri).map_err(wrong)?),
            Some(uri) => {
                let path = relative_path(uri).map_err(|reason| wrong(&format!("{:?} {reason}", shortened(uri))))?;
                let file = files.iter().position(|f| *f == path).unwrap_or(files.len());
                if file == files.len() {
                    // The search for duplicates is quadratic, so without a limit a malicious document could take hours.
                    if files.len() >= MAX_FILES {
                        return Err(wrong("the file refers to too many other files"));
                    }
                    files.push(path);
                }
                BufferSource::File(file)
            }
        });
    }
    Ok((sources, files))
}

const MAX_FILES: usize = 1000;

/// The content of a `data:` URI.
fn data(uri: &str) -> Result<Vec<u8>, &'static str> {
    let (kind, content) = uri.split_once(',').ok_or("its data URI has no comma")?;
    if !kind.to_ascii_lowercase().ends_with(";base64") {
        return Err("its data URI is not in base64");
    }
    // Some exporters omit the padding.
    let config = GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent);
    GeneralPurpose::new(&STANDARD, config)
        .decode(content)
        .map_err(|_| "its data URI is damaged base64; export or copy the file again")
}

/// The path in a URI, relative to the document and normalised. It may begin with `..`: see
/// [`Source::files`](crate::asset::import::Source::files).
fn relative_path(uri: &str) -> Result<String, &'static str> {
    let decoded = percent_decoded(uri).ok_or("is not a URI")?;
    if decoded.contains(['\\', '\0', ':']) || decoded.starts_with('/') {
        return Err("is not a relative path; put the file beside the glTF file and export again");
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
        return Err("is not the path of a file");
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
