//! Builds valid and invalid glTF files.
#![allow(dead_code)]

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use bevy_faceoff::geometry::TriMesh;
use serde_json::{Value, json};

/// A document and its one buffer.
#[derive(Clone)]
pub struct Gltf {
    pub json: Value,
    pub bin: Vec<u8>,
}

pub const I8: u32 = 5120;
pub const U8: u32 = 5121;
pub const I16: u32 = 5122;
pub const U16: u32 = 5123;
pub const U32: u32 = 5125;
pub const F32: u32 = 5126;

impl Gltf {
    pub fn new() -> Self {
        Self {
            json: json!({
                "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "meshes": [],
                "accessors": [], "bufferViews": [], "buffers": [{"byteLength": 0}],
                "materials": [{"alphaMode": "nonsense", "pbrMetallicRoughness": {"baseColorTexture": {"index": 99}}}],
            }),
            bin: Vec::new(),
        }
    }

    /// One mesh in one node.
    pub fn of(mesh: &TriMesh) -> Self {
        let mut gltf = Self::new();
        let primitive = gltf.primitive(mesh, U16);
        let index = gltf.mesh("First", vec![primitive]);
        gltf.root_node(json!({"mesh": index}));
        gltf
    }

    fn push(&mut self, list: &str, item: Value) -> usize {
        let list = self.json[list].as_array_mut().unwrap();
        list.push(item);
        list.len() - 1
    }

    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0xee);
        let offset = self.bin.len();
        self.bin.extend(bytes);
        self.push(
            "bufferViews",
            json!({"buffer": 0, "byteOffset": offset, "byteLength": bytes.len()}),
        )
    }

    pub fn accessor(&mut self, item: Value) -> usize {
        self.push("accessors", item)
    }

    pub fn positions(&mut self, positions: &[[f32; 3]]) -> usize {
        let view = self.view(&floats(positions));
        self.accessor(json!({"bufferView": view, "componentType": F32, "count": positions.len(), "type": "VEC3"}))
    }

    pub fn indices(&mut self, indices: &[u32], component: u32) -> usize {
        let view = self.view(&integers(indices, component));
        self.accessor(json!({"bufferView": view, "componentType": component, "count": indices.len(), "type": "SCALAR"}))
    }

    pub fn primitive(&mut self, mesh: &TriMesh, component: u32) -> Value {
        let positions: Vec<[f32; 3]> = mesh.vertices().iter().map(|v| v.to_array()).collect();
        let position = self.positions(&positions);
        let indices = self.indices(mesh.triangles().as_flattened(), component);
        json!({"attributes": {"POSITION": position, "NORMAL": 77}, "indices": indices, "material": 5})
    }

    pub fn mesh(&mut self, name: &str, primitives: Vec<Value>) -> usize {
        self.push("meshes", json!({"name": name, "primitives": primitives}))
    }

    pub fn node(&mut self, node: Value) -> usize {
        self.push("nodes", node)
    }

    pub fn root_node(&mut self, node: Value) -> usize {
        let node = self.node(node);
        self.json["scenes"][0]["nodes"]
            .as_array_mut()
            .unwrap()
            .push(json!(node));
        node
    }

    /// The document as Bevy's loader accepts it. That one is stricter than ours: materials and normals have to be
    /// right, or absent, and positions need bounds.
    pub fn for_bevy(mut self) -> Self {
        let bin = &self.bin;
        let views = self.json["bufferViews"].clone();
        let object = self.json.as_object_mut().unwrap();
        for mesh in object["meshes"].as_array_mut().unwrap() {
            for primitive in mesh["primitives"].as_array_mut().unwrap() {
                if primitive["material"] == 5 {
                    primitive.as_object_mut().unwrap().remove("material");
                }
                primitive["attributes"].as_object_mut().unwrap().remove("NORMAL");
            }
        }
        object["materials"].as_array_mut().unwrap().remove(0);
        for mesh in object["meshes"].as_array_mut().unwrap() {
            for primitive in mesh["primitives"].as_array_mut().unwrap() {
                if let Some(material) = primitive.get_mut("material") {
                    *material = json!(material.as_u64().unwrap() - 1);
                }
            }
        }
        if object["materials"].as_array().unwrap().is_empty() {
            object.remove("materials");
        }
        for accessor in object["accessors"].as_array_mut().unwrap() {
            if accessor["type"] != "VEC3" {
                continue;
            }
            let view = &views[accessor["bufferView"].as_u64().unwrap() as usize];
            let [start, length] = ["byteOffset", "byteLength"].map(|key| view[key].as_u64().unwrap() as usize);
            let (mut min, mut max) = ([f32::MAX; 3], [f32::MIN; 3]);
            for (i, number) in bin[start..start + length].as_chunks().0.iter().enumerate() {
                let number = f32::from_le_bytes(*number);
                (min[i % 3], max[i % 3]) = (min[i % 3].min(number), max[i % 3].max(number));
            }
            (accessor["min"], accessor["max"]) = (json!(min), json!(max));
        }
        self
    }

    /// Adds a material of this name and returns its number.
    pub fn material(&mut self, name: &str) -> usize {
        self.push("materials", json!({"name": name}))
    }

    pub fn glb(&self) -> Vec<u8> {
        let mut gltf = self.clone();
        gltf.fit();
        glb(gltf.json.to_string().as_bytes(), Some(&self.bin))
    }

    /// Writes the length of the buffer into the document, if it has a buffer.
    pub fn fit(&mut self) {
        if let Some(length) = self.json.pointer_mut("/buffers/0/byteLength") {
            *length = json!(self.bin.len());
        }
    }

    pub fn with_uri(&self, uri: &str) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"][0] = json!({"byteLength": self.bin.len(), "uri": uri});
        serde_json::to_vec_pretty(&json).unwrap()
    }

    pub fn with_data_uri(&self) -> Vec<u8> {
        self.with_uri(&format!(
            "data:application/octet-stream;base64,{}",
            STANDARD.encode(&self.bin)
        ))
    }
}

pub fn glb(json: &[u8], bin: Option<&[u8]>) -> Vec<u8> {
    let mut chunks = Vec::new();
    for (kind, bytes, pad) in [(b"JSON", Some(json), b' '), (b"BIN\0", bin, 0)] {
        let Some(bytes) = bytes else { continue };
        let length = bytes.len().next_multiple_of(4);
        chunks.extend((length as u32).to_le_bytes());
        chunks.extend(kind);
        chunks.extend(bytes);
        chunks.resize(chunks.len() + length - bytes.len(), pad);
    }
    let mut out = b"glTF\x02\0\0\0".to_vec();
    out.extend((chunks.len() as u32 + 12).to_le_bytes());
    out.extend(chunks);
    out
}

pub fn floats(positions: &[[f32; 3]]) -> Vec<u8> {
    positions.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect()
}

pub fn integers(numbers: &[u32], component: u32) -> Vec<u8> {
    let size = match component {
        U8 | I8 => 1,
        U16 | I16 => 2,
        _ => 4,
    };
    numbers.iter().flat_map(|i| i.to_le_bytes()[..size].to_vec()).collect()
}
