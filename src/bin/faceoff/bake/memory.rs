//! How much memory a bake may take, estimated before anything but names and lengths is known.

use bevy_faceoff::projection::BakeSettings;
use serde::Deserialize;
use std::fs;
use std::path::Path;

/// Bytes of memory per triangle while a mesh is imported and baked, without a face table. Closed meshes of half a
/// million triangles take 300, with the bytes of their files.
const TRIANGLE: u64 = 512;
/// Bytes of memory per triangle in the buffers of a thread that draws for a face table.
const DRAWN: u64 = 160;
/// How many copies of a face table there are at most: as runs, as a table, as bytes to write.
const TABLES: u64 = 3;
/// What a bake takes whatever its mesh.
const LEAST: u64 = 1 << 20;

/// An estimate from above of the memory, in bytes, that the bake of a mesh file takes on so many threads.
///
/// It is no promise: a glTF scene that places one mesh many times has more triangles than its bytes tell.
pub fn estimate(mesh: &Path, settings: &BakeSettings, threads: usize) -> u64 {
    let bytes = file_bytes(mesh);
    let triangles = bytes / least_bytes_per_triangle(mesh);
    let mut need = triangles
        .saturating_mul(TRIANGLE)
        .saturating_add(LEAST)
        .saturating_add(bytes);
    if settings.faces {
        // About as many as a sphere has directions one step apart.
        let step = u64::from(settings.degrees.clamp(1, 90));
        let directions = 64_442 / (step * step) + 2;
        let image = u64::from(settings.image.min(BakeSettings::MAX_IMAGE)).pow(2) * size_of::<f32>() as u64;
        need += TABLES * directions * triangles.div_ceil(8) + threads as u64 * (image + triangles * DRAWN);
    }
    need
}

/// How many bytes of a file a triangle takes at least, with its share of vertices, in files that exist.
fn least_bytes_per_triangle(mesh: &Path) -> u64 {
    match extension(mesh).as_str() {
        "stl" => 50,
        "obj" | "off" => 20,
        "ply" => 16,
        "faceoff" => 10,
        _ => 12,
    }
}

/// The length of a mesh file and of the buffers that it names, in bytes; 0 for what cannot be read. The document tells
/// the length of a buffer whose URI is not its path.
fn file_bytes(mesh: &Path) -> u64 {
    let length = |path: &Path| fs::metadata(path).map_or(0, |there| if there.is_file() { there.len() } else { 0 });
    let own = length(mesh);
    if own == 0 || extension(mesh) != "gltf" {
        return own;
    }
    let document: Document = fs::read(mesh)
        .ok()
        .and_then(|bytes| serde_json::from_slice(&bytes).ok())
        .unwrap_or_default();
    let others = document.buffers.iter().filter_map(|buffer| {
        let uri = buffer.uri.as_ref().filter(|uri| !uri.starts_with("data:"))?;
        let is_encoded = uri.contains('%');
        Some(if is_encoded {
            buffer.byte_length
        } else {
            length(&mesh.with_file_name(uri))
        })
    });
    others.fold(own, u64::saturating_add)
}

fn extension(mesh: &Path) -> String {
    mesh.extension()
        .map(|extension| extension.to_string_lossy().to_ascii_lowercase())
        .unwrap_or_default()
}

/// The part of a glTF document that tells its length.
#[derive(Default, Deserialize)]
struct Document {
    #[serde(default)]
    buffers: Vec<Buffer>,
}

#[derive(Deserialize)]
struct Buffer {
    uri: Option<String>,
    #[serde(default, rename = "byteLength")]
    byte_length: u64,
}
