//! Small valid inputs of each target, made here.

use super::targets::HEADER;
use bevy_faceoff::asset::{CollisionMesh, format, to_obj};
use bevy_faceoff::geometry::{TriMesh, shapes};
use lz4_flex::frame::FrameDecoder;
use std::io::Read;

/// The seeds of a target.
pub fn of(name: &str) -> Vec<Vec<u8>> {
    let cube = shapes::cube(1.0);
    match name {
        "obj" => vec![to_obj(&cube).into_bytes(), OBJ.into()],
        "stl" => vec![STL.into(), binary_stl(&cube)],
        "ply" => vec![PLY.into(), binary_ply(&cube)],
        "off" => vec![OFF.into(), COLORED_OFF.into()],
        "gltf" => vec![gltf(&cube).into_bytes()],
        "glb" => vec![glb(&cube)],
        "faceoff" => baked(&cube).into(),
        "recipe" => RECIPES.map(Vec::from).into(),
        "scene" => SCENES.map(Vec::from).into(),
        // Any bytes are meshes and poses.
        _ => (0..8u64)
            .map(|seed| {
                let mut random = fastrand::Rng::with_seed(seed);
                (0..160).map(|_| random.u8(..)).collect()
            })
            .collect(),
    }
}

const OBJ: &str = "mtllib a.mtl\no part\nv 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1e0\nvn 0 0 1\nvt 0 0\ng one\n\
    f 1/1/1 2/1/1 3/1/1\nf -4//1 -3//1 -1//1\nf 1 2 \\\n 4 3\n";
const STL: &str = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n\
    endsolid a\n";
const PLY: &str = "ply\nformat ascii 1.0\ncomment a\nelement vertex 4\nproperty float x\nproperty double y\n\
    property float z\nproperty uchar red\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n\
    0 0 0 1\n1 0 0 2\n0 1 0 3\n0 0 1 4\n3 0 1 2\n4 0 1 2 3\n";
const OFF: &str = "OFF\n# a\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n4 0 1 2 3\n";
const COLORED_OFF: &str = "COFF\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 255 0 0 255\n0 1 0 255 0 0 255\n3 0 1 2 1 0 0\n";
const RECIPES: [&str; 2] = [
    "(mesh: \"a.glb\")",
    "(mesh: \"a.obj\", part: (mesh: \"b\"), settings: (faces: true, degrees: 10, image: 64, weld_tolerance: 0.001, \
     inward: Room))",
];
const SCENES: [&str; 2] = [
    "(meshes: {\"a\": \"a.obj\"}, bodies: [(mesh: \"a\")])",
    "(meshes: {\"a\": \"a.obj\", \"b\": \"b.stl\"}, bodies: [(mesh: \"a\", translation: (1, 2, 3), rotation: (0, 0, 0, 1), \
     scale: (1, 1, 2)), (mesh: \"b\")])",
];

fn binary_stl(mesh: &TriMesh) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend((mesh.triangles().len() as u32).to_le_bytes());
    for corners in triangles(mesh) {
        bytes.extend([0; 12]);
        bytes.extend(corners.iter().flat_map(|c| c.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

/// The nine coordinates of each triangle.
fn triangles(mesh: &TriMesh) -> impl Iterator<Item = [f32; 9]> {
    mesh.triangles().iter().map(|triangle| {
        let corners = triangle.map(|v| mesh.vertices()[v as usize].to_array());
        std::array::from_fn(|i| corners[i / 3][i % 3])
    })
}

fn binary_ply(mesh: &TriMesh) -> Vec<u8> {
    let mut bytes = format!(
        "ply\nformat binary_big_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        mesh.vertices().len(),
        mesh.triangles().len()
    )
    .into_bytes();
    bytes.extend(
        mesh.vertices()
            .iter()
            .flat_map(|v| v.to_array())
            .flat_map(f32::to_be_bytes),
    );
    for triangle in mesh.triangles() {
        bytes.push(3);
        bytes.extend(triangle.iter().flat_map(|v| v.to_be_bytes()));
    }
    bytes
}

/// Corners and indices of a mesh, as glTF stores them.
fn buffer(mesh: &TriMesh) -> Vec<u8> {
    let corners = mesh
        .vertices()
        .iter()
        .flat_map(|v| v.to_array())
        .flat_map(f32::to_le_bytes);
    let indices = mesh.triangles().iter().flatten().flat_map(|v| v.to_le_bytes());
    corners.chain(indices).collect()
}

fn json(mesh: &TriMesh, uri: &str) -> String {
    let (corners, indices) = (mesh.vertices().len(), 3 * mesh.triangles().len());
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"name":"a","mesh":0,"scale":[1,2,1],"children":[1]}},{{"mesh":0,"translation":[2,0,0]}}],"meshes":[{{"name":"m","primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],"accessors":[{{"bufferView":0,"componentType":5126,"count":{corners},"type":"VEC3"}},{{"bufferView":1,"componentType":5125,"count":{indices},"type":"SCALAR"}}],"bufferViews":[{{"buffer":0,"byteLength":{}}},{{"buffer":0,"byteOffset":{},"byteLength":{}}}],"buffers":[{{"byteLength":{}{uri}}}]}}"#,
        12 * corners,
        12 * corners,
        4 * indices,
        12 * corners + 4 * indices
    )
}

fn gltf(mesh: &TriMesh) -> String {
    use base64::Engine;
    let data = base64::engine::general_purpose::STANDARD.encode(buffer(mesh));
    json(
        mesh,
        &format!(r#","uri":"data:application/octet-stream;base64,{data}""#),
    )
}

fn glb(mesh: &TriMesh) -> Vec<u8> {
    let mut json = json(mesh, "").into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let chunks = [(b"JSON", json), (b"BIN\0", buffer(mesh))];
    let length = 12 + chunks.iter().map(|(_, chunk)| 8 + chunk.len()).sum::<usize>();
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((length as u32).to_le_bytes());
    for (name, chunk) in chunks {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(name);
        bytes.extend(chunk);
    }
    bytes
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
