//! Reader and writer for OFF, the text format of Geomview: only positions and faces.
//!
//! Each vertex and each face is expected to begin on a line of its own, as all programs write them; what follows on the
//! line, for example a colour, is ignored. The corners of a face may go on over further lines. There is no maintained
//! crate that reads it.

use super::import_error::ImportError;
use super::polygons::Polygons;
use super::text::{number, shown, without_byte_order_mark, words};
use crate::geometry::TriMesh;
use glam::Vec3;
use std::fmt::Write;

/// Reads a file as one mesh.
///
/// Polygons are split into triangle fans from their first corner. Where such a fan would fold over, they are split
/// otherwise, into as many triangles. The face index counts these triangles in the order of the file, before any is
/// dropped.
pub(super) fn read(bytes: &[u8], warnings: &mut Vec<String>) -> Result<TriMesh, ImportError> {
    let mut lines = (1..)
        .zip(without_byte_order_mark(bytes).split(|&b| b == b'\n'))
        .filter_map(|(line, text)| {
            let text = text.split(|&b| b == b'#').next().unwrap_or_default().trim_ascii();
            (!text.is_empty()).then_some((line, text))
        });
    let (mut line, mut rest) = lines.next().unwrap_or((1, b""));
    rest = after_keyword(line, rest)?;
    if rest.is_empty() {
        (line, rest) = lines.next().unwrap_or((line, b""));
    }
    let mut counts = words(rest).map(|word| count(line, word));
    let mut next_count = || counts.next().unwrap_or(Err(ImportError::OffCounts { line }));
    let (vertex_count, face_count) = (next_count()?, next_count()?);
    let cut_off = |what: &'static str, read: usize, wanted: u64| ImportError::OffCutOff {
        what,
        wanted,
        there: read as u64,
    };
    let mut vertices = Vec::new();
    while (vertices.len() as u64) < vertex_count {
        let (line, text) = lines
            .next()
            .ok_or_else(|| cut_off("vertices", vertices.len(), vertex_count))?;
        let mut words = words(text);
        let mut position = [0.0f32; 3];
        for x in &mut position {
            *x = number(line, words.next().ok_or(ImportError::ShortVertex { line })?)?;
        }
        vertices.push(Vec3::from_array(position));
    }
    let mut polygons = Polygons::default();
    let (mut corners, mut read) = (Vec::new(), 0);
    while (read as u64) < face_count {
        let (line, text) = lines.next().ok_or_else(|| cut_off("faces", read, face_count))?;
        let (mut at, mut rest) = (line, words(text));
        let wanted = rest.next().map_or(Ok(0), |word| count(line, word))?;
        corners.clear();
        while (corners.len() as u64) < wanted {
            match rest.next() {
                Some(word) => corners.push(integer(at, word)?),
                // The face goes on in the next line.
                None => {
                    let (next, text) = lines.next().ok_or(ImportError::OffShortFace { line, wanted })?;
                    (at, rest) = (next, words(text));
                }
            }
        }
        polygons.push(&corners)?;
        read += 1;
    }
    if let Some((line, _)) = lines.next() {
        warnings.push(format!(
            "line {line} and what follows is not read, for the file says that it has {vertex_count} vertices and \
             {face_count} faces"
        ));
    }
    polygons.finish(vertices, warnings)
}

/// Writes a mesh as the text of an OFF file: all its faces, also those of zero area, in the order of their ids, wound
/// as they are. Reading it gives the same bits.
pub fn to_off(mesh: &TriMesh) -> String {
    let faces = mesh.all_faces();
    let mut out = format!("OFF\n{} {} 0\n", mesh.vertices().len(), faces.len());
    for v in mesh.vertices() {
        writeln!(out, "{} {} {}", v.x, v.y, v.z).expect("writing to a string cannot fail");
    }
    for [a, b, c] in faces {
        writeln!(out, "3 {a} {b} {c}").expect("writing to a string cannot fail");
    }
    out
}

/// Whether the content looks like OFF.
pub(super) fn is_likely(bytes: &[u8]) -> bool {
    let first = bytes
        .trim_ascii_start()
        .split(|&b| b == b'\n')
        .next()
        .unwrap_or_default();
    first.len() < 64 && keyword(first).is_some_and(|rest| rest.first().is_none_or(|b| !b.is_ascii_alphabetic()))
}

/// What follows the keyword `OFF`, with the prefixes of formats that add normals, colours or texture coordinates.
fn keyword(text: &[u8]) -> Option<&[u8]> {
    let text = text.strip_prefix(b"ST").unwrap_or(text);
    let text = text.strip_prefix(b"C").unwrap_or(text);
    let text = text.strip_prefix(b"N").unwrap_or(text);
    text.strip_prefix(b"OFF")
}

/// The rest of the first line after the keyword. It may be missing, and some files have no space after it.
fn after_keyword(line: usize, text: &[u8]) -> Result<&[u8], ImportError> {
    let rest = keyword(text).unwrap_or(text).trim_ascii();
    if rest.first().is_none_or(u8::is_ascii_digit) {
        return Ok(rest);
    }
    Err(ImportError::OffKind {
        line,
        word: shown(text),
    })
}

fn count(line: usize, word: &[u8]) -> Result<u64, ImportError> {
    let number = integer(line, word)?;
    u64::try_from(number).map_err(|_| ImportError::OffCounts { line })
}

fn integer(line: usize, word: &[u8]) -> Result<i64, ImportError> {
    let parsed = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
    parsed.ok_or_else(|| ImportError::NotAnInteger {
        line,
        word: shown(word),
    })
}
