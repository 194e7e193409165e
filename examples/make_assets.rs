//! Writes the generated meshes, their bake recipes and a glTF scene into `assets/`: `cargo run --example make_assets`.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use bevy_faceoff::asset::{Recipe, to_obj};
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::projection::BakeSettings;
use glam::Vec3;
use serde_json::{Value, json};
use std::collections::HashMap;
use std::path::Path;

/// The twelve pentominoes in a box of 10 by 6. A letter is the name of a piece.
const PENTOMINOES: [&[u8; 10]; 6] = [
    b"WIIIIITUUU",
    b"WWNNTTTUXU",
    b"YWWNNNTXXX",
    b"YLLLLZZFXV",
    b"YYPPLZFFFV",
    b"YPPPZZFVVV",
];

/// By how much a piece is smaller than its cells, on each side.
const INSET: f32 = 0.01;

/// Name and text of every file.
pub fn files() -> Vec<(String, String)> {
    [
        ("torus", shapes::torus_240(), true),
        ("knot", shapes::knot_1120(), true),
        ("ring", shapes::ring(), false),
        ("cube", shapes::cube(1.0), false),
        ("ball", shapes::ball_320(), false),
    ]
    .into_iter()
    .flat_map(|(name, mesh, faces)| {
        let recipe = Recipe {
            mesh: format!("{name}.obj"),
            part: None,
            read_outside: false,
            settings: BakeSettings {
                faces,
                ..Default::default()
            },
        };
        [
            (format!("{name}.obj"), to_obj(&mesh)),
            (format!("{name}.bake.ron"), recipe.to_text()),
        ]
    })
    .chain([("pentominoes.gltf".into(), pentominoes())])
    .collect()
}

/// A scene in glTF: the pentominoes, eleven of which are concave, upright in their box, and a knot on top.
fn pentominoes() -> String {
    let mut gltf = Gltf::default();
    for name in b'A'..=b'Z' {
        if let Some((mesh, center)) = piece(name) {
            let hue = f32::from(name - b'F') / 21.0;
            gltf.node(&char::from(name).to_string(), &mesh, center, 1.0, hue, json!({}));
        }
    }
    // Heavier than the rest. These are the names that Blender's custom properties would have.
    let extras = json!({"faceoff_density": 3.0, "faceoff_restitution": 0.4});
    gltf.node(
        "Knot",
        &shapes::knot_1120(),
        Vec3::new(0.0, 3.9, 0.0),
        1.6,
        0.02,
        extras,
    );
    gltf.to_text()
}

/// A piece about its centre, and where that is.
fn piece(name: u8) -> Option<(TriMesh, Vec3)> {
    let has = |x: i32, y: i32| {
        let row = usize::try_from(y).ok().and_then(|y| PENTOMINOES.get(y));
        row.zip(usize::try_from(x).ok()).and_then(|(row, x)| row.get(x)) == Some(&name)
    };
    let (mut vertices, mut faces, mut known) = (Vec::new(), Vec::new(), HashMap::new());
    // The corner of a cell, moved inward.
    let mut corner = |x: i32, y: i32, z: i32| {
        *known.entry([x, y, z]).or_insert_with(|| {
            let around = [(-1, -1), (0, -1), (-1, 0), (0, 0)]
                .into_iter()
                .filter(|(dx, dy)| has(x + dx, y + dy));
            let inward = around.fold([0, 0], |[i, j], (dx, dy)| [i + 2 * dx + 1, j + 2 * dy + 1]);
            let [i, j] = inward.map(|n: i32| INSET * n.signum() as f32);
            let (x, y) = (x as f32 + i - 5.0, 3.0 - (y as f32 + j));
            vertices.push(Vec3::new(x, y, (z as f32 - 0.5) * (1.0 - 2.0 * INSET)));
            vertices.len() as u32 - 1
        })
    };
    let mut quad = |corners: [[i32; 3]; 4]| {
        let [a, b, c, d] = corners.map(|[x, y, z]| corner(x, y, z));
        faces.extend([[a, b, c], [a, c, d]]);
    };
    for (x, y) in (0..6)
        .flat_map(|y| (0..10).map(move |x| (x, y)))
        .filter(|&(x, y)| has(x, y))
    {
        let (right, low) = (x + 1, y + 1);
        quad([[x, low, 1], [right, low, 1], [right, y, 1], [x, y, 1]]);
        quad([[x, y, 0], [right, y, 0], [right, low, 0], [x, low, 0]]);
        for (dx, dy, [from, to]) in [
            (-1, 0, [[x, y], [x, low]]),
            (1, 0, [[right, low], [right, y]]),
            (0, -1, [[right, y], [x, y]]),
            (0, 1, [[x, low], [right, low]]),
        ] {
            if !has(x + dx, y + dy) {
                quad([
                    [from[0], from[1], 0],
                    [to[0], to[1], 0],
                    [to[0], to[1], 1],
                    [from[0], from[1], 1],
                ]);
            }
        }
    }
    let mesh = TriMesh::new(vertices.clone(), faces.clone()).ok()?;
    let bounds = mesh.aabb();
    let center = 0.5 * (bounds.min + bounds.max);
    vertices.iter_mut().for_each(|v| *v -= center);
    Some((TriMesh::new(vertices, faces).ok()?, center))
}

/// A glTF file with its buffer in it.
#[derive(Default)]
struct Gltf {
    nodes: Vec<Value>,
    meshes: Vec<Value>,
    materials: Vec<Value>,
    accessors: Vec<Value>,
    views: Vec<Value>,
    buffer: Vec<u8>,
}

impl Gltf {
    /// Adds a node with a mesh and a material of their own.
    fn node(&mut self, name: &str, mesh: &TriMesh, place: Vec3, scale: f32, hue: f32, extras: Value) {
        let index = self.nodes.len();
        let bounds = mesh.aabb();
        let corners = mesh
            .vertices()
            .iter()
            .flat_map(|v| v.to_array())
            .flat_map(f32::to_le_bytes);
        let positions = self.accessor(
            corners.collect(),
            json!({
                "componentType": 5126, "type": "VEC3", "count": mesh.vertices().len(),
                "min": bounds.min.to_array(), "max": bounds.max.to_array(),
            }),
        );
        let indices = mesh.triangles().as_flattened();
        let bytes = indices.iter().flat_map(|&i| (i as u16).to_le_bytes());
        let indices = self.accessor(
            bytes.collect(),
            json!({
                "componentType": 5123, "type": "SCALAR", "count": indices.len(),
            }),
        );
        // Red, green and blue a third of a turn apart.
        let color = [0.0, 1.0, 2.0].map(|i: f32| 0.5 + 0.4 * (std::f32::consts::TAU * (hue - i / 3.0)).cos());
        self.materials.push(json!({"name": name, "pbrMetallicRoughness": {
            "baseColorFactor": [color[0], color[1], color[2], 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.6,
        }}));
        self.meshes.push(json!({"name": name, "primitives": [
            {"attributes": {"POSITION": positions}, "indices": indices, "material": index},
        ]}));
        self.nodes.push(json!({
            "name": name, "mesh": index, "translation": place.to_array(), "scale": Vec3::splat(scale).to_array(), "extras": extras,
        }));
    }

    fn accessor(&mut self, bytes: Vec<u8>, mut accessor: Value) -> usize {
        self.buffer.resize(self.buffer.len().next_multiple_of(4), 0);
        let view = json!({"buffer": 0, "byteOffset": self.buffer.len(), "byteLength": bytes.len()});
        self.buffer.extend(bytes);
        accessor["bufferView"] = json!(self.views.len());
        self.views.push(view);
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn to_text(&self) -> String {
        let roots: Vec<_> = (0..self.nodes.len()).collect();
        let uri = format!("data:application/octet-stream;base64,{}", STANDARD.encode(&self.buffer));
        let json = json!({
            "asset": {"version": "2.0", "generator": "examples/make_assets.rs"},
            "scene": 0, "scenes": [{"nodes": roots}], "nodes": self.nodes, "meshes": self.meshes,
            "materials": self.materials, "accessors": self.accessors, "bufferViews": self.views,
            "buffers": [{"byteLength": self.buffer.len(), "uri": uri}],
        });
        format!("{json:#}\n")
    }
}

#[allow(dead_code)] // A test includes this file to compare its output with the files in the repository.
fn main() -> std::io::Result<()> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
    std::fs::create_dir_all(&folder)?;
    for (name, text) in files() {
        let path = folder.join(name);
        std::fs::write(&path, &text)?;
        println!("{} ({} bytes)", path.display(), text.len());
    }
    Ok(())
}
