//! What is called with arbitrary bytes. A target panics if something is wrong.

use crate::pairs;
use bevy_faceoff::asset::{MeshPart, Recipe, format, import_bytes, import_part};
use lz4_flex::frame::{BlockMode, BlockSize, FrameEncoder, FrameInfo};
use std::io::Write;

#[path = "../../src/bin/faceoff/scene_file.rs"]
#[expect(dead_code, reason = "only its syntax is tested")]
mod scene_file;

/// The targets that read files. An extension names each.
pub const READERS: [&str; 9] = ["obj", "stl", "ply", "off", "gltf", "glb", "faceoff", "recipe", "scene"];

/// A target by its name.
///
/// # Panics
/// If there is none.
pub fn named(name: &str) -> Box<dyn Fn(&[u8])> {
    match name {
        "faces" => Box::new(pairs::same_faces),
        "contacts" => Box::new(pairs::valid_contacts),
        "step" => Box::new(pairs::finite_step),
        _ if READERS.contains(&name) => {
            let name = name.to_owned();
            Box::new(move |bytes| {
                reads(&name, bytes);
            })
        }
        _ => panic!("{name:?} is no target: choose faces, contacts, step or one of {READERS:?}"),
    }
}

/// Whether a reader accepts the bytes.
pub fn reads(name: &str, bytes: &[u8]) -> bool {
    match name {
        "faceoff" => {
            let as_they_are = format::from_bytes(bytes).is_ok();
            as_they_are | packed(bytes).is_some_and(|file| format::from_bytes(&file).is_ok())
        }
        "recipe" => Recipe::parse(bytes).is_ok(),
        "scene" => str::from_utf8(bytes).is_ok_and(|text| scene_file::SceneFile::parse(text).is_ok()),
        _ => {
            let file = format!("a.{name}");
            let parts = match name {
                "obj" => [MeshPart::Object("part".into()), MeshPart::Group("one".into())],
                _ => [MeshPart::from(0), MeshPart::Node("a".into())],
            };
            let parts = parts.map(|part| import_part(&file, bytes, Some(&part)));
            let mesh = import_bytes(&file, bytes);
            for mesh in parts.iter().flatten().chain(&mesh) {
                assert!(mesh.vertices().iter().all(|v| v.is_finite()));
                let corners = mesh.triangles().iter().flatten();
                assert!(corners.max().is_some_and(|&v| (v as usize) < mesh.vertices().len()));
            }
            mesh.is_ok()
        }
    }
}

/// Length of the header of a baked file without what follows from its content.
pub const HEADER: usize = 76;

/// A baked file from a header and its content, with a length and a checksum that are right. Random changes of a whole
/// file would only ever test the checksum.
fn packed(bytes: &[u8]) -> Option<Vec<u8>> {
    let (header, content) = bytes.split_at_checked(HEADER)?;
    let mut start = header.to_vec();
    start.extend((content.len() as u64).to_le_bytes());
    let info = FrameInfo::new()
        .block_mode(BlockMode::Independent)
        .block_size(BlockSize::Max256KB);
    let mut encoder = FrameEncoder::with_frame_info(info, Vec::new());
    encoder.write_all(content).ok()?;
    let frame = encoder.finish().ok()?;
    let sum = blake3::Hasher::new().update(&start).update(&frame).finalize();
    Some([&start, sum.as_bytes().as_slice(), &frame].concat())
}
