//! What a mesh file holds besides the shape. The writers of meshes leave it out.

use std::fs;
use std::path::Path;

/// The lines of an OBJ file that are neither vertices nor faces, and what they hold.
const LINES: [(&[u8], &str); 8] = [
    (b"vt", "vt lines (texture coordinates)"),
    (b"vn", "vn lines (normals)"),
    (b"usemtl", "usemtl lines (materials)"),
    (b"mtllib", "mtllib lines (files of materials)"),
    (b"o", "o lines (objects)"),
    (b"g", "g lines (groups)"),
    (b"l", "l lines (polylines)"),
    (b"p", "p lines (points)"),
];

/// What is not kept of a file, each with its number. Files of other formats than OBJ and PLY have nothing to tell.
pub fn lost(file: &Path) -> Vec<String> {
    let extension = file.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    let of: fn(&[u8]) -> Vec<String> = match extension.as_deref() {
        Some("obj") => obj_lines,
        Some("ply") => ply_properties,
        _ => return Vec::new(),
    };
    let is_file = fs::metadata(file).is_ok_and(|there| there.is_file());
    let bytes = is_file.then(|| fs::read(file).ok()).flatten();
    bytes.map_or(Vec::new(), |bytes| of(&bytes))
}

fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

fn obj_lines(bytes: &[u8]) -> Vec<String> {
    let mut counts = [0_usize; LINES.len()];
    for line in bytes.split(|&byte| byte == b'\n') {
        let keyword = words(line).next();
        if let Some(kind) = LINES.iter().position(|(name, _)| keyword == Some(name)) {
            counts[kind] += 1;
        }
    }
    let found = LINES.iter().zip(counts).filter(|(_, count)| *count > 0);
    found.map(|((_, what), count)| format!("{count} {what}")).collect()
}

/// The properties and elements that the header of a PLY file names besides positions and corners.
fn ply_properties(bytes: &[u8]) -> Vec<String> {
    let mut lost = Vec::new();
    let mut element = String::new();
    for line in bytes.split(|&byte| byte == b'\n' || byte == b'\r') {
        let line: Vec<_> = words(line).map(String::from_utf8_lossy).collect();
        let line: Vec<&str> = line.iter().map(AsRef::as_ref).collect();
        match line[..] {
            ["end_header"] => break,
            ["element", name, ..] => {
                element = name.chars().take(40).collect();
                if !["vertex", "face", "tristrips"].contains(&name) {
                    lost.push(format!("the element {element}"));
                }
            }
            ["property", .., name] => {
                let is_kept = match element.as_str() {
                    "vertex" => ["x", "y", "z"].contains(&name),
                    "face" | "tristrips" => ["vertex_indices", "vertex_index"].contains(&name),
                    // The element is listed as a whole.
                    _ => true,
                };
                if !is_kept {
                    let name: String = name.chars().take(40).collect();
                    lost.push(format!("the property {name} of {element}"));
                }
            }
            _ => {}
        }
    }
    lost
}
