//! STL, binary and text.
//!
//! A reader of our own. The `stl_io` crate is careful about memory, but takes every file that begins with `solid ` for text,
//! which many binary files do, and offers no way to tell it otherwise; of a text with several solids it reads the first and
//! drops the rest; it refuses texts in capitals, texts that begin with a bare `solid`, and normals that are NaN, which
//! exporters write for slivers and nobody needs; and its errors carry no line number.

use super::import::ImportError;
use super::text::{number, shown};
use crate::geometry::{MeshError, TriMesh};
use glam::Vec3;
use std::collections::HashMap;

/// A header that says nothing, and the number of triangles.
const PREFIX: usize = 84;
/// A normal, three corners and two bytes that every program uses otherwise.
const TRIANGLE: usize = 50;

/// Reads all solids of a file as one mesh. A face's index is the number of its triangle in the file. Corners at the same
/// place become one vertex. Normals are passed over: the order of the corners says which side is outside.
pub(super) fn read(bytes: &[u8]) -> Result<TriMesh, ImportError> {
    if is_binary(bytes) {
        read_binary(bytes)
    } else {
        read_text(bytes)
    }
}

/// Whether bytes without a telling name are STL.
pub(super) fn is_likely(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(1 << 16)];
    let text = begins_with_solid(bytes) && start.windows(5).any(|w| w.eq_ignore_ascii_case(b"facet"));
    text || (bytes.len() > PREFIX && announced_length(bytes) == Some(bytes.len() as u64))
}

/// The length decides, since binary headers may begin with `solid` too. Where it does not fit, only a `solid` without any
/// zero byte near it can be a text.
fn is_binary(bytes: &[u8]) -> bool {
    announced_length(bytes) == Some(bytes.len() as u64)
        || !begins_with_solid(bytes)
        || bytes[..bytes.len().min(PREFIX)].contains(&0)
}

fn announced_length(bytes: &[u8]) -> Option<u64> {
    announced(bytes).map(|n| PREFIX as u64 + u64::from(n) * TRIANGLE as u64)
}

/// How many triangles a binary file says it has.
fn announced(bytes: &[u8]) -> Option<u32> {
    let count = bytes.get(PREFIX - 4..PREFIX)?;
    Some(u32::from_le_bytes([count[0], count[1], count[2], count[3]]))
}

fn begins_with_solid(bytes: &[u8]) -> bool {
    without_mark(bytes)
        .trim_ascii_start()
        .get(..5)
        .is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
}

fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

fn read_binary(bytes: &[u8]) -> Result<TriMesh, ImportError> {
    let triangles = announced(bytes).ok_or(ImportError::StlHeader { length: bytes.len() })?;
    let body = &bytes[PREFIX..];
    let there = body.len() / TRIANGLE;
    // What follows the last triangle, a comment or padding, is nobody's business.
    if there < triangles as usize {
        return Err(ImportError::StlCutOff { triangles, there });
    }
    let mut soup = Soup::default();
    for (face, triangle) in body.chunks_exact(TRIANGLE).take(triangles as usize).enumerate() {
        let float = |i: usize| f32::from_le_bytes([triangle[i], triangle[i + 1], triangle[i + 2], triangle[i + 3]]);
        let corners = [12, 24, 36].map(|at| Vec3::new(float(at), float(at + 4), float(at + 8)));
        if !corners.iter().all(|c| c.is_finite()) {
            return Err(ImportError::StlNotFinite { face });
        }
        soup.push(corners)?;
    }
    Ok(soup.finish()?)
}

/// Words may stand on as many lines as they like; only a name ends with its line.
fn read_text(bytes: &[u8]) -> Result<TriMesh, ImportError> {
    let mut text = Text::default();
    let mut last_line = 1;
    for (line, words) in (1..).zip(without_mark(bytes).split(|&b| b == b'\n')) {
        for word in words.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty()) {
            last_line = line;
            if text.word(line, word)? == Then::NextLine {
                break;
            }
        }
    }
    if !text.ended {
        return Err(ImportError::StlText {
            line: last_line,
            reason: "the file ends here, without endsolid: it is cut off; export or copy it again",
        });
    }
    Ok(text.soup.finish()?)
}

/// A text STL file as far as it was read.
#[derive(Default)]
struct Text {
    soup: Soup,
    /// The corners of the facet that has begun.
    facet: Option<Few<Vec3>>,
    /// The coordinates of the vertex that has begun.
    vertex: Option<Few<f32>>,
    /// How many words of a normal are to come.
    normal: u32,
    ended: bool,
}

#[derive(PartialEq)]
enum Then {
    NextWord,
    NextLine,
}

impl Text {
    fn word(&mut self, line: usize, word: &[u8]) -> Result<Then, ImportError> {
        let wrong = |reason| Err(ImportError::StlText { line, reason });
        if self.normal > 0 {
            self.normal -= 1;
            return Ok(Then::NextWord);
        }
        let mut keyword = [0; 8];
        if let Some(start) = keyword.get_mut(..word.len()) {
            start.copy_from_slice(word);
            start.make_ascii_lowercase();
        }
        let keyword = &keyword[..word.len().min(8)];
        if let Some(vertex) = &mut self.vertex {
            if [b"vertex".as_slice(), b"endloop", b"endfacet"].contains(&keyword) {
                return Err(ImportError::ShortVertex { line });
            }
            if let Some(vertex) = vertex.push(number(line, word)?) {
                self.vertex = None;
                if let Some(facet) = &mut self.facet {
                    facet.push(vertex.into());
                }
            }
            return Ok(Then::NextWord);
        }
        match keyword {
            b"solid" | b"endsolid" => {
                if self.facet.is_some() {
                    return wrong("a facet does not end before its solid does");
                }
                // Whatever the name is: it may even be `facet`.
                self.ended = keyword == b"endsolid";
                return Ok(Then::NextLine);
            }
            b"facet" if self.facet.is_some() => return wrong("a facet begins before the last one has ended"),
            b"facet" => self.facet = Some(Few::default()),
            b"normal" => self.normal = 3,
            b"outer" | b"loop" | b"endloop" => {}
            b"vertex" => match &self.facet {
                None => return wrong("a vertex stands outside of any facet"),
                Some(facet) if facet.count == 3 => {
                    return wrong("a facet has more than three corners; export the mesh as triangles");
                }
                Some(_) => self.vertex = Some(Few::default()),
            },
            b"endfacet" => match self.facet.take() {
                None => return wrong("a facet ends that never began"),
                Some(facet) if facet.count < 3 => return wrong("a facet has fewer than three corners"),
                Some(facet) => self.soup.push(facet.items)?,
            },
            _ => {
                return Err(ImportError::StlWord {
                    line,
                    word: shown(word),
                });
            }
        }
        Ok(Then::NextWord)
    }
}

/// At most three of something.
#[derive(Default)]
struct Few<T> {
    items: [T; 3],
    count: usize,
}

impl<T: Copy> Few<T> {
    /// Returns all three with the third.
    fn push(&mut self, item: T) -> Option<[T; 3]> {
        self.items[self.count] = item;
        self.count += 1;
        (self.count == 3).then_some(self.items)
    }
}

/// Triangles that do not know their neighbours.
#[derive(Default)]
struct Soup {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    known: HashMap<[u32; 3], u32>,
}

impl Soup {
    fn push(&mut self, corners: [Vec3; 3]) -> Result<(), MeshError> {
        let mut triangle = [0; 3];
        for (index, corner) in triangle.iter_mut().zip(corners) {
            // Adding zero makes one of the two zeros.
            let corner = corner + Vec3::ZERO;
            let count = self.vertices.len();
            let next = u32::try_from(count).map_err(|_| MeshError::TooLarge {
                what: "vertices",
                count,
            })?;
            *index = *self.known.entry(corner.to_array().map(f32::to_bits)).or_insert(next);
            if *index == next {
                self.vertices.push(corner);
            }
        }
        self.triangles.push(triangle);
        Ok(())
    }

    fn finish(self) -> Result<TriMesh, MeshError> {
        TriMesh::new(self.vertices, self.triangles)
    }
}
