//! Reader and writer for Wavefront OBJ: only positions and faces.
//!
//! Why not the `tobj` crate: its errors have no line numbers. It rejects whole files for data that collisions never
//! use: a normal or texture index out of range, colours at only some vertices, a comment that is not UTF-8. And it
//! splits a file at objects, groups and materials into models with separate vertices, which would have to be merged
//! again.

use super::import_error::ImportError;
use super::obj_part::Choice;
use super::part::MeshPart;
use super::polygons::{Fans, TooMany};
use super::text::{number, shown, without_byte_order_mark, words};
use crate::geometry::{MeshError, TriMesh};
use glam::Vec3;
use std::fmt::Write;

/// Reads all objects of a file as one mesh, or only the chosen object or group.
///
/// Polygons are split into triangle fans from their first corner. Where such a fan would fold over, they are split
/// otherwise, into as many triangles. The face index counts these triangles in the order of the file, over all objects
/// and groups or those of the part, before any is dropped. Only `v` and `f` lines are read, and `o` or `g` lines for a
/// part. Materials, normals, texture coordinates, colours, curves, points and lines are ignored, as are polygons with
/// fewer than three corners. Negative indices count backwards from the last vertex read.
pub(super) fn read(bytes: &[u8], part: Option<&MeshPart>, warnings: &mut Vec<String>) -> Result<TriMesh, ImportError> {
    let mut obj = Obj {
        choice: part.map(Choice::of).transpose()?,
        ..Obj::default()
    };
    let bytes = without_byte_order_mark(bytes);
    let mut continued: Vec<u8> = Vec::new();
    let mut first_line = 1;
    for (line, text) in (1..).zip(bytes.split(|&b| b == b'\n')) {
        // A comment ends with its line, even if its last character is a backslash.
        let text = without_comment(text).trim_ascii_end();
        if continued.is_empty() {
            first_line = line;
        }
        if let Some(part) = text.strip_suffix(b"\\") {
            continued.extend_from_slice(part);
            continued.push(b' ');
        } else if continued.is_empty() {
            obj.line(line, text)?;
        } else {
            continued.extend_from_slice(text);
            obj.line(first_line, &std::mem::take(&mut continued))?;
        }
    }
    if !continued.is_empty() {
        obj.line(first_line, &continued)?;
    }
    obj.finish(warnings)
}

/// A line up to its comment. A name may contain `#`, so where names are, a comment begins as a word of its own.
fn without_comment(line: &[u8]) -> &[u8] {
    let has_name = matches!(words(line).next(), Some(b"o" | b"g"));
    let begins = |at: usize| line[at] == b'#' && (!has_name || at == 0 || line[at - 1].is_ascii_whitespace());
    match (0..line.len()).find(|&at| begins(at)) {
        Some(end) => &line[..end],
        None => line,
    }
}

/// Writes a mesh as the text of an OBJ file: all its faces, also those of zero area, in the order of their ids, wound
/// as they are. Positions are written with the fewest digits that identify each `f32`, so reading them gives the same
/// bits.
pub fn to_obj(mesh: &TriMesh) -> String {
    let mut out = String::new();
    for v in mesh.vertices() {
        writeln!(out, "v {} {} {}", v.x, v.y, v.z).expect("writing to a string cannot fail");
    }
    for face in mesh.all_faces() {
        let [a, b, c] = face.map(|v| u64::from(v) + 1);
        writeln!(out, "f {a} {b} {c}").expect("writing to a string cannot fail");
    }
    out
}

#[derive(Default)]
struct Obj<'a> {
    choice: Option<Choice<'a>>,
    vertices: Vec<Vec3>,
    faces: Fans,
    /// Scratch: the corners of a face.
    corners: Vec<u32>,
    /// The largest index that was read before its vertex, and its line.
    forward: Option<(u32, usize)>,
    /// The number of faces with fewer than three corners.
    short: usize,
}

impl Obj<'_> {
    fn line(&mut self, line: usize, text: &[u8]) -> Result<(), ImportError> {
        let mut words = words(text);
        match words.next() {
            Some(b"v") => self.vertex(line, words),
            Some(b"f") => self.face(line, words),
            Some(keyword) => {
                if let Some(choice) = &mut self.choice {
                    choice.line(keyword, words);
                }
                Ok(())
            }
            None => Ok(()),
        }
    }

    fn vertex<'a>(&mut self, line: usize, mut words: impl Iterator<Item = &'a [u8]>) -> Result<(), ImportError> {
        let mut position = [0.0f32; 3];
        for x in &mut position {
            let word = words.next().ok_or(ImportError::ShortVertex { line })?;
            *x = number(line, word)?;
        }
        if self.vertices.len() >= u32::MAX as usize - 1 {
            return Err(ImportError::TooLarge { line });
        }
        self.vertices.push(position.into());
        Ok(())
    }

    fn face<'a>(&mut self, line: usize, words: impl Iterator<Item = &'a [u8]>) -> Result<(), ImportError> {
        let mut corners = std::mem::take(&mut self.corners);
        corners.clear();
        for word in words {
            corners.push(self.index(line, word)?);
        }
        if self.choice.as_ref().is_none_or(|choice| choice.inside) {
            self.short += usize::from(corners.len() < 3);
            self.faces
                .push(&corners)
                .map_err(|TooMany| ImportError::TooLarge { line })?;
        }
        self.corners = corners;
        Ok(())
    }

    /// The vertex index, counted from 0, of a corner such as `7`, `7/1`, `7//3` or `-1/-1/-1`.
    fn index(&mut self, line: usize, word: &[u8]) -> Result<u32, ImportError> {
        let number = word.split(|&b| b == b'/').next().unwrap_or_default();
        let number: i64 = std::str::from_utf8(number)
            .ok()
            .and_then(|n| n.parse().ok())
            .ok_or_else(|| ImportError::NotAnIndex {
                line,
                word: shown(word),
            })?;
        let count = self.vertices.len() as i64;
        let index = if number < 0 {
            number.checked_add(count)
        } else {
            number.checked_sub(1)
        };
        let index = index
            .and_then(|i| u32::try_from(i).ok())
            .ok_or(ImportError::NoSuchVertex {
                line,
                index: number,
                vertices: self.vertices.len(),
            })?;
        // Some programs write all faces first, so whether the vertex exists is known only at the end.
        if i64::from(index) >= count && self.forward.is_none_or(|(i, _)| index > i) {
            self.forward = Some((index, line));
        }
        Ok(index)
    }

    fn finish(self, warnings: &mut Vec<String>) -> Result<TriMesh, ImportError> {
        if let Some((index, line)) = self.forward
            && index as usize >= self.vertices.len()
            && !(self.faces.triangles.is_empty() && self.choice.is_none())
        {
            return Err(ImportError::NoSuchVertex {
                line,
                index: i64::from(index) + 1,
                vertices: self.vertices.len(),
            });
        }
        if self.short > 0 {
            warnings.push(format!(
                "faces with fewer than three corners, {} in all, are left out",
                self.short
            ));
        }
        let faces = self.faces.finish(&self.vertices, warnings);
        match self.choice {
            Some(choice) if faces.is_empty() => Err(choice.error()),
            Some(_) => Ok(only_used(&self.vertices, faces)?),
            None if faces.is_empty() => Err(ImportError::NoFaces {
                vertices: self.vertices.len(),
            }),
            None => Ok(TriMesh::new(self.vertices, faces)?),
        }
    }
}

/// The mesh without the vertices that no face uses, which belong to other parts.
fn only_used(vertices: &[Vec3], mut faces: Vec<[u32; 3]>) -> Result<TriMesh, MeshError> {
    const UNUSED: u32 = u32::MAX;
    let mut index = vec![UNUSED; vertices.len()];
    for &corner in faces.as_flattened() {
        index[corner as usize] = 0;
    }
    let mut used = Vec::new();
    for (vertex, index) in vertices.iter().zip(&mut index) {
        if *index != UNUSED {
            *index = used.len() as u32;
            used.push(*vertex);
        }
    }
    for corner in faces.as_flattened_mut() {
        *corner = index[*corner as usize];
    }
    TriMesh::new(used, faces)
}
