//! Reader and writer for PLY. The reader takes text and binary in both orders of bytes, with the crate `ply-rs-bw`:
//! only positions and faces.
//!
//! The crate reads from a stream, so it believes how many elements the header promises. Here the header is checked
//! against the length of the file first.

use super::import_error::ImportError;
use super::polygons::Polygons;
use super::text::shown;
use crate::geometry::TriMesh;
use glam::Vec3;
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType,
};

/// Reads the elements `vertex`, `face` and `tristrips` of a file as one mesh. Others are skipped.
///
/// Polygons are split into triangle fans from their first corner. Where such a fan would fold over, they are split
/// otherwise, into as many triangles. The face index counts these triangles in the order of the file, before any is
/// dropped.
pub(super) fn read(bytes: &[u8], warnings: &mut Vec<String>) -> Result<TriMesh, ImportError> {
    if !is_likely(bytes) {
        return Err(ImportError::NotPly);
    }
    let mut reader = Reader::new(bytes);
    let header = Parser::<Skipped>::new().read_header(&mut reader).map_err(fault)?;
    let mut vertices = Vec::new();
    let mut polygons = Polygons::default();
    for element in header.elements.values() {
        check_count(element, &header, bytes.len())?;
        match element.name.as_str() {
            "vertex" => {
                if !["x", "y", "z"]
                    .iter()
                    .all(|axis| element.properties.contains_key(*axis))
                {
                    return Err(ImportError::PlyProperties("vertex", "x, y and z"));
                }
                let read: Vec<Vertex> = elements(&mut reader, element, &header)?;
                vertices.extend(read.into_iter().map(|vertex| vertex.0));
            }
            "face" => {
                for face in corners(&mut reader, element, &header)? {
                    polygons.push(&face.0)?;
                }
            }
            "tristrips" => {
                for strips in corners(&mut reader, element, &header)? {
                    polygons.push_strips(&strips.0)?;
                }
            }
            _ => {
                elements::<Skipped>(&mut reader, element, &header)?;
            }
        }
    }
    let rest = reader.get_ref().trim_ascii_start().len();
    if rest > 0 {
        warnings.push(format!(
            "{rest} bytes after the last element are not read; the header tells of no more"
        ));
    }
    polygons.finish(vertices, warnings)
}

/// Writes a mesh as a PLY file, binary with the low byte first: all its faces, also those of zero area, in the order of
/// their ids, wound as they are. Reading it gives the same bits.
pub fn to_ply(mesh: &TriMesh) -> Vec<u8> {
    let faces = mesh.all_faces();
    let header = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        mesh.vertices().len(),
        faces.len()
    );
    let mut out = header.into_bytes();
    for v in mesh.vertices() {
        out.extend(v.to_array().iter().flat_map(|x| x.to_le_bytes()));
    }
    for face in faces {
        out.push(3);
        out.extend(face.iter().flat_map(|v| v.to_le_bytes()));
    }
    out
}

/// Whether the content is PLY.
pub(super) fn is_likely(bytes: &[u8]) -> bool {
    bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r")
}

fn elements<E: PropertyAccess>(
    reader: &mut Reader<&[u8]>,
    element: &ElementDef,
    header: &Header,
) -> Result<Vec<E>, ImportError> {
    Parser::new()
        .read_payload_for_element(reader, element, header)
        .map_err(fault)
}

fn corners(reader: &mut Reader<&[u8]>, element: &ElementDef, header: &Header) -> Result<Vec<Corners>, ImportError> {
    if !element.properties.keys().any(|name| is_corners(name)) {
        let what = if element.name == "face" { "face" } else { "tristrips" };
        return Err(ImportError::PlyProperties(what, "a list vertex_indices"));
    }
    elements(reader, element, header)
}

/// Whether a list has the name of the corners of a polygon: most programs write the first name, others the second.
fn is_corners(name: &str) -> bool {
    name == "vertex_indices" || name == "vertex_index"
}

/// Checks that so many elements can be in a file of this length.
fn check_count(element: &ElementDef, header: &Header, length: usize) -> Result<(), ImportError> {
    let size = |scalar: &ScalarType| match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    };
    let least = |property: &PropertyType| match (&header.encoding, property) {
        // A digit, and a space or the end of the line.
        (Encoding::Ascii, _) => 2,
        (_, PropertyType::Scalar(scalar)) => size(scalar),
        // An empty list.
        (_, PropertyType::List(count, _)) => size(count),
    };
    let each: usize = element
        .properties
        .values()
        .map(|property| least(&property.data_type))
        .sum();
    // One byte more, for the last line of a text may have no end.
    let most = (length + 1).checked_div(each).unwrap_or(0);
    if element.count > most {
        return Err(ImportError::PlyCutOff {
            element: shown(element.name.as_bytes()),
            count: element.count,
            length,
        });
    }
    Ok(())
}

fn fault(error: ParseError) -> ImportError {
    // The message quotes lines, however long they are.
    let message = error.to_string();
    let line = error.line();
    let place = line.map_or(String::new(), |line| format!("Line {line}: "));
    let message = message.strip_prefix(&place).unwrap_or(&message);
    let mut short: String = message.split_whitespace().collect::<Vec<_>>().join(" ");
    if let Some((end, _)) = short.char_indices().nth(200) {
        short.truncate(end);
        short.push_str("...");
    }
    ImportError::Ply { line, message: short }
}

/// The position of a vertex; NaN if there is none.
struct Vertex(Vec3);

/// The corners of a polygon.
struct Corners(Vec<i64>);

/// An element that is not used.
struct Skipped;

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self(Vec3::NAN)
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let axis = match name {
            "x" => 0,
            "y" => 1,
            "z" => 2,
            _ => return PropertyAccessResult::Ignored,
        };
        let value = match property {
            Property::Char(v) => v.into(),
            Property::UChar(v) => v.into(),
            Property::Short(v) => v.into(),
            Property::UShort(v) => v.into(),
            Property::Int(v) => v as f32,
            Property::UInt(v) => v as f32,
            Property::Float(v) => v,
            Property::Double(v) => v as f32,
            _ => return PropertyAccessResult::UnsupportedType,
        };
        self.0[axis] = value;
        PropertyAccessResult::Set
    }
}

impl PropertyAccess for Corners {
    fn new() -> Self {
        Self(Vec::new())
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if !is_corners(name) {
            return PropertyAccessResult::Ignored;
        }
        self.0 = match property {
            Property::ListChar(all) => widened(all),
            Property::ListUChar(all) => widened(all),
            Property::ListShort(all) => widened(all),
            Property::ListUShort(all) => widened(all),
            Property::ListInt(all) => widened(all),
            Property::ListUInt(all) => widened(all),
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}

fn widened<T: Into<i64>>(all: Vec<T>) -> Vec<i64> {
    all.into_iter().map(Into::into).collect()
}

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }
}
