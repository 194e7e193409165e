//! Small valid inputs of each target, made here.

use super::targets::HEADER;
use crate::gltf_files::Gltf;
use crate::{ply_files, stl_files};
use bevy_faceoff::asset::{CollisionMesh, format, to_obj};
use bevy_faceoff::geometry::{TriMesh, shapes};
use lz4_flex::frame::FrameDecoder;
use serde_json::json;
use std::io::Read;

/// The seeds of a target.
pub fn of(name: &str) -> Vec<Vec<u8>> {
    let cube = shapes::cube(1.0);
    match name {
        "obj" => vec![to_obj(&cube).into_bytes(), OBJ.into()],
        "stl" => vec![stl_files::text(&cube).into_bytes(), stl_files::binary("a", &cube)],
        "ply" => ply_files::all_kinds(&cube).into(),
        "off" => vec![OFF.into(), COLORED_OFF.into()],
        "gltf" => vec![gltf(&cube).with_data_uri()],
        "glb" => vec![gltf(&cube).glb()],
        "faceoff" => baked(&cube).into(),
        "recipe" => RECIPES.map(Vec::from).into(),
        "scene" => SCENES.map(Vec::from).into(),
        // Any bytes are meshes and poses: of two bodies, and of up to four in many combinations of kinds and settings.
        _ => (0..if name == "step" { 32 } else { 8u64 })
            .map(|seed| {
                let mut random = fastrand::Rng::with_seed(seed);
                let length = if name == "step" { 400 } else { 160 };
                (0..length).map(|_| random.u8(..)).collect()
            })
            .collect(),
    }
}

const OBJ: &str = "mtllib a.mtl\no part\nv 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1e0\nvn 0 0 1\nvt 0 0\ng one\n\
    f 1/1/1 2/1/1 3/1/1\nf -4//1 -3//1 -1//1\no b\ng two three\nf 1 2 \\\n 4 3\n";
const OFF: &str = "OFF\n# a\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n4 0 1 2 3\n";
const COLORED_OFF: &str = "COFF\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 255 0 0 255\n0 1 0 255 0 0 255\n3 0 1 2 1 0 0\n";
const RECIPES: [&str; 4] = [
    "(mesh: \"a.glb\")",
    "(mesh: \"a.glb\", part: (node: \"b\"), read_outside: true)",
    "(mesh: \"a.obj\", part: (object: \"b\"))",
    "(mesh: \"a.obj\", part: (mesh: \"b\"), settings: (faces: true, degrees: 10, image: 64, weld_tolerance: 0.001, \
     inward: Room))",
];
const SCENES: [&str; 2] = [
    "(meshes: {\"a\": \"a.obj\"}, bodies: [(mesh: \"a\")])",
    "(meshes: {\"a\": \"a.obj\", \"b\": \"b.stl\"}, bodies: [(mesh: \"a\", translation: (1, 2, 3), rotation: (0, 0, 0, 1), \
     scale: (1, 1, 2)), (mesh: \"b\")])",
];

/// A mesh in a node that is scaled, and in one below it.
fn gltf(mesh: &TriMesh) -> Gltf {
    let mut gltf = Gltf::of(mesh);
    let below = gltf.node(json!({"mesh": 0, "translation": [2, 0, 0]}));
    gltf.root_node(json!({"name": "a", "scale": [1, 2, 1], "children": [below]}));
    gltf
}

/// A whole baked file, and one as the target packs it.
fn baked(mesh: &TriMesh) -> [Vec<u8>; 2] {
    let mesh = CollisionMesh::new(mesh);
    let file = format::to_bytes(&mesh, [0; 32]);
    let mut content = Vec::new();
    let mut decoder = FrameDecoder::new(&file[format::HEADER_LENGTH..]);
    decoder.read_to_end(&mut content).expect("the file is valid");
    let packed = [&file[..HEADER], &content].concat();
    [file, packed]
}
