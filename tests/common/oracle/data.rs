//! Optional third-party data, which is not part of the repository.

use super::body::Mesh;
pub use bevy_faceoff::testing::external::file;
use glam::Vec3;
use std::sync::Arc;

/// A third-party mesh, if it exists, read without the product's code.
pub fn mesh(name: &str) -> Option<Arc<Mesh>> {
    let path = file(&format!("meshes/{name}"))?;
    let text = std::fs::read_to_string(&path).unwrap();
    let (vertices, faces) = parse_obj(&text);
    Some(Mesh::new(name, vertices, faces))
}

/// Vertices and faces of a Wavefront file. Polygons become fans; faces keep the order of the file.
pub fn parse_obj(text: &str) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut vertices: Vec<Vec3> = vec![];
    let mut faces = vec![];
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let c: Vec<f32> = words.take(3).map(|w| w.parse().unwrap()).collect();
                vertices.push(Vec3::from_slice(&c));
            }
            Some("f") => {
                let index = |word: &str| {
                    let number: i64 = word.split('/').next().unwrap().parse().unwrap();
                    (if number < 0 {
                        vertices.len() as i64 + number
                    } else {
                        number - 1
                    }) as u32
                };
                let corners: Vec<u32> = words.map(index).collect();
                faces.extend((2..corners.len()).map(|i| [corners[0], corners[i - 1], corners[i]]));
            }
            _ => {}
        }
    }
    (vertices, faces)
}
