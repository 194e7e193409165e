//! Reader for STL, binary and text; writer of binary STL.
//!
//! Why not the `stl_io` crate (0.11): it is careful about memory, but takes a binary file for text if its header begins
//! with `solid ` and all bytes up to the first line feed are UTF-8, as in a header with a line feed of its own. Of a
//! text with several solids it reads only the first. It rejects text in capitals, text that begins with a bare `solid`,
//! and in text NaN normals, which exporters write for slivers and which nobody needs. In binary files it lets
//! coordinates pass that are not finite. Its errors have no line numbers. `tests/asset/other_readers.rs` compares the
//! two.

use super::import_error::ImportError;
use super::text::{number, shown, without_byte_order_mark, words};
use crate::geometry::{MeshError, TriMesh};
use glam::Vec3;
use std::collections::HashMap;

/// The length of the header: 80 bytes without meaning, and the number of triangles.
const PREFIX: usize = 84;
/// The length of a triangle: a normal, three corners, and two bytes without a standard meaning.
const TRIANGLE: usize = 50;

/// Reads all solids of a file as one mesh. The index of a face is that of its triangle in the file. Corners at the same
/// position become one vertex. Normals are ignored: the winding defines the outside.
pub(super) fn read(bytes: &[u8], warnings: &mut Vec<String>) -> Result<TriMesh, ImportError> {
    if is_binary(bytes) {
        read_binary(bytes, warnings)
    } else {
        read_text(bytes)
    }
}

/// Writes a mesh as a binary STL file: all its faces, also those of zero area, in the order of their ids, wound as they
/// are. STL has no list of vertices: vertices at the same place are one when it is read, and unused ones are gone.
pub fn to_stl(mesh: &TriMesh) -> Vec<u8> {
    let faces = mesh.all_faces();
    let mut out = vec![0; PREFIX - 4];
    // A mesh has fewer faces than 32 bits count.
    out.extend((faces.len() as u32).to_le_bytes());
    for face in faces {
        let [a, b, c] = face.map(|v| mesh.vertices()[v as usize]);
        let [x, y, z] = [a, b, c].map(|p| p.as_dvec3());
        let normal = (y - x).cross(z - x).normalize_or_zero().as_vec3();
        for part in [normal, a, b, c] {
            out.extend(part.to_array().iter().flat_map(|x| x.to_le_bytes()));
        }
        out.extend([0; 2]);
    }
    out
}

/// Whether the content looks like STL. Used if the file name does not identify the format.
pub(super) fn is_likely(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(1 << 16)];
    let text = begins_with_solid(bytes) && start.windows(5).any(|w| w.eq_ignore_ascii_case(b"facet"));
    text || (bytes.len() > PREFIX && expected_length(bytes) == Some(bytes.len() as u64))
}

/// Whether a file is text.
pub(super) fn is_text(bytes: &[u8]) -> bool {
    !is_binary(bytes)
}

/// Whether a file is binary. The length decides, because binary headers may begin with `solid` too. If the length does
/// not match, a file is text if it begins with `solid` and has no zero byte near the start.
fn is_binary(bytes: &[u8]) -> bool {
    expected_length(bytes) == Some(bytes.len() as u64)
        || !begins_with_solid(bytes)
        || bytes[..bytes.len().min(PREFIX)].contains(&0)
}

/// The length of a binary file according to its header.
fn expected_length(bytes: &[u8]) -> Option<u64> {
    expected_triangles(bytes).map(|n| PREFIX as u64 + u64::from(n) * TRIANGLE as u64)
}

/// The number of triangles of a binary file according to its header.
fn expected_triangles(bytes: &[u8]) -> Option<u32> {
    let count = bytes.get(PREFIX - 4..PREFIX)?;
    Some(u32::from_le_bytes([count[0], count[1], count[2], count[3]]))
}

fn begins_with_solid(bytes: &[u8]) -> bool {
    without_byte_order_mark(bytes)
        .trim_ascii_start()
        .get(..5)
        .is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
}

fn read_binary(bytes: &[u8], warnings: &mut Vec<String>) -> Result<TriMesh, ImportError> {
    let triangles = expected_triangles(bytes).ok_or(ImportError::StlHeader { length: bytes.len() })?;
    let body = &bytes[PREFIX..];
    let there = body.len() / TRIANGLE;
    if there < triangles as usize {
        return Err(ImportError::StlCutOff { triangles, there });
    }
    // A comment or padding; or triangles, if the header is wrong.
    let rest = body.len() - triangles as usize * TRIANGLE;
    if triangles == 0 && rest > 0 {
        return Err(ImportError::StlNoTriangles { rest, there });
    }
    if rest > 0 {
        warnings.push(format!(
            "{rest} bytes after the last of its {triangles} triangles are not read"
        ));
    }
    let mut soup = TriangleSoup::default();
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

/// Line breaks between words have no meaning, except that the name of a solid ends with its line.
fn read_text(bytes: &[u8]) -> Result<TriMesh, ImportError> {
    let mut text = Text::default();
    let mut last_line = 1;
    for (number, line) in (1..).zip(without_byte_order_mark(bytes).split(|&b| b == b'\n')) {
        for word in words(line) {
            last_line = number;
            if text.word(number, word)? == Then::NextLine {
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

/// The state of the parser of text STL.
#[derive(Default)]
struct Text {
    soup: TriangleSoup,
    /// The corners of the current facet so far.
    facet: Option<UpToThree<Vec3>>,
    /// The coordinates of the current vertex so far.
    vertex: Option<UpToThree<f32>>,
    /// The number of words of the current normal still to skip.
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
                    return wrong("a solid ends within a facet");
                }
                // Skip the name, which may be a keyword such as `facet`.
                self.ended = keyword == b"endsolid";
                return Ok(Then::NextLine);
            }
            b"facet" if self.facet.is_some() => return wrong("a facet begins within another facet"),
            b"facet" => self.facet = Some(UpToThree::default()),
            b"normal" => self.normal = 3,
            b"outer" | b"loop" | b"endloop" => {}
            b"vertex" => match &self.facet {
                None => return wrong("a vertex is outside of any facet"),
                Some(facet) if facet.count == 3 => {
                    return wrong("a facet has more than three corners; export the mesh as triangles");
                }
                Some(_) => self.vertex = Some(UpToThree::default()),
            },
            b"endfacet" => match self.facet.take() {
                None => return wrong("an endfacet has no facet"),
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

/// A list of at most three items.
#[derive(Default)]
struct UpToThree<T> {
    items: [T; 3],
    count: usize,
}

impl<T: Copy> UpToThree<T> {
    /// Adds an item; returns all three once there are three.
    fn push(&mut self, item: T) -> Option<[T; 3]> {
        self.items[self.count] = item;
        self.count += 1;
        (self.count == 3).then_some(self.items)
    }
}

/// Triangles, with corners at the same position merged.
#[derive(Default)]
struct TriangleSoup {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    known: HashMap<[u32; 3], u32>,
}

impl TriangleSoup {
    fn push(&mut self, corners: [Vec3; 3]) -> Result<(), MeshError> {
        let mut triangle = [0; 3];
        for (index, corner) in triangle.iter_mut().zip(corners) {
            // Adding zero turns -0 into 0.
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
