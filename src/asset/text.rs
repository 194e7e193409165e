//! Helpers for the readers of text formats.

use super::import_error::ImportError;

/// The content of a text file. Some programs begin it with a byte order mark.
pub(super) fn without_byte_order_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

/// The words of a line.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// Parses a finite number.
pub(super) fn number(line: usize, word: &[u8]) -> Result<f32, ImportError> {
    let number: f32 = std::str::from_utf8(word)
        .ok()
        .and_then(|w| w.parse().ok())
        .ok_or_else(|| ImportError::NotANumber {
            line,
            word: shown(word),
        })?;
    // A number too large for single precision parses as infinity.
    if number.is_finite() {
        Ok(number)
    } else {
        Err(ImportError::NotFinite {
            line,
            word: shown(word),
        })
    }
}

/// A word of a file, escaped and shortened for an error message.
pub(super) fn shown(word: &[u8]) -> String {
    // A word can be as long as the file.
    let text = String::from_utf8_lossy(&word[..word.len().min(256)]);
    let mut out: String = text.chars().take(40).flat_map(char::escape_default).collect();
    if text.chars().nth(40).is_some() {
        out.push_str("...");
    }
    out
}
