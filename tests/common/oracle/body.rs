//! The oracle's meshes and poses.

use super::tritri::{Triangle, degenerate};
use glam::{DMat3, DVec3, Quat, Vec3};
use std::collections::HashMap;
use std::sync::Arc;

/// A mesh with the data that the oracle derives.
#[derive(Debug)]
pub struct Mesh {
    pub name: String,
    pub vertices: Vec<Vec3>,
    pub faces: Vec<[u32; 3]>,
    /// Indices of the faces of non-zero area.
    pub solid: Vec<u32>,
    /// Whether every edge, identified by the positions of its ends, has an even number of faces.
    pub closed: bool,
    /// A vertex of every connected component.
    pub components: Vec<u32>,
    /// The centre curve of a tube, for the linking number; else empty.
    pub core: Vec<DVec3>,
}

impl Mesh {
    /// A mesh without a core.
    pub fn new(name: &str, vertices: Vec<Vec3>, faces: Vec<[u32; 3]>) -> Arc<Self> {
        Self::with_core(name, vertices, faces, vec![])
    }

    /// A tube about `core`.
    pub fn with_core(name: &str, vertices: Vec<Vec3>, faces: Vec<[u32; 3]>, core: Vec<DVec3>) -> Arc<Self> {
        let places = places(&vertices);
        let at = |face: [u32; 3]| face.map(|v| vertices[v as usize].as_dvec3());
        let solid: Vec<u32> = (0..faces.len() as u32)
            .filter(|&f| !degenerate(&at(faces[f as usize])))
            .collect();
        assert!(!solid.is_empty(), "{name} has no face with an area");
        Arc::new(Self {
            name: name.to_owned(),
            closed: closed(&faces, &places),
            components: components(&faces, &solid, &places),
            vertices,
            faces,
            solid,
            core,
        })
    }
}

/// For each vertex, a number shared by all vertices at its position. Adding zero makes -0 equal to 0.
fn places(vertices: &[Vec3]) -> Vec<usize> {
    let mut numbers = HashMap::new();
    vertices
        .iter()
        .map(|v| {
            let next = numbers.len();
            *numbers
                .entry([v.x, v.y, v.z].map(|c| (c + 0.0).to_bits()))
                .or_insert(next)
        })
        .collect()
}

fn closed(faces: &[[u32; 3]], places: &[usize]) -> bool {
    let mut odd = std::collections::HashSet::new();
    for face in faces {
        let corners = face.map(|v| places[v as usize]);
        if corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0] {
            continue;
        }
        for i in 0..3 {
            let [u, v] = [corners[i], corners[(i + 1) % 3]];
            let edge = if u < v { (u, v) } else { (v, u) };
            if !odd.insert(edge) {
                odd.remove(&edge);
            }
        }
    }
    odd.is_empty()
}

/// Flood fill from face to face over shared positions; returns one vertex of each component.
fn components(faces: &[[u32; 3]], solid: &[u32], places: &[usize]) -> Vec<u32> {
    let mut faces_at: HashMap<usize, Vec<u32>> = HashMap::new();
    for &f in solid {
        for v in faces[f as usize] {
            faces_at.entry(places[v as usize]).or_default().push(f);
        }
    }
    let mut wet = vec![false; faces.len()];
    let mut found = vec![];
    for &start in solid {
        if wet[start as usize] {
            continue;
        }
        found.push(faces[start as usize][0]);
        wet[start as usize] = true;
        let mut queue = vec![start];
        while let Some(f) = queue.pop() {
            for v in faces[f as usize] {
                for &next in &faces_at[&places[v as usize]] {
                    if !std::mem::replace(&mut wet[next as usize], true) {
                        queue.push(next);
                    }
                }
            }
        }
    }
    found
}

/// A mesh in the world: scaled along its own axes, then rotated, then moved.
#[derive(Clone, Debug)]
pub struct Body {
    pub mesh: Arc<Mesh>,
    pub translation: Vec3,
    pub rotation: Quat,
    pub scale: Vec3,
}

impl Body {
    /// A body of equal scale along all axes.
    pub fn new(mesh: &Arc<Mesh>, translation: DVec3, rotation: Quat, scale: f64) -> Self {
        Self {
            mesh: mesh.clone(),
            translation: translation.as_vec3(),
            rotation,
            scale: Vec3::splat(scale as f32),
        }
    }

    /// A copy of the body translated by `by`; rounded to `f32` like any position.
    pub fn moved(&self, by: DVec3) -> Self {
        Self {
            translation: (self.translation.as_dvec3() + by).as_vec3(),
            ..self.clone()
        }
    }

    /// World position of a point of the mesh.
    pub fn place(&self, p: DVec3) -> DVec3 {
        self.translation.as_dvec3() + rotation_matrix(self.rotation) * (self.scale.as_dvec3() * p)
    }

    /// Its triangles in the world.
    pub fn world(&self) -> World {
        let matrix = rotation_matrix(self.rotation);
        let [translation, scale] = [self.translation.as_dvec3(), self.scale.as_dvec3()];
        let vertices: Vec<DVec3> = self
            .mesh
            .vertices
            .iter()
            .map(|v| translation + matrix * (scale * v.as_dvec3()))
            .collect();
        let corners = |&f: &u32| self.mesh.faces[f as usize].map(|v| vertices[v as usize]);
        let triangles: Vec<Triangle> = self.mesh.solid.iter().map(corners).collect();
        let boxes: Vec<Bounds> = triangles.iter().map(|t| Bounds::around(t)).collect();
        let bounds = boxes.iter().copied().reduce(Bounds::union).unwrap();
        let center = (bounds.low + bounds.high) * 0.5;
        let radius = triangles
            .iter()
            .flatten()
            .map(|p| p.distance(center))
            .fold(0.0, f64::max);
        let components = self.mesh.components.iter().map(|&v| vertices[v as usize]).collect();
        World {
            faces: self.mesh.solid.clone(),
            closed: self.mesh.closed,
            triangles,
            boxes,
            bounds,
            radius,
            components,
        }
    }
}

/// The matrix of a quaternion of any length but zero. Exact for half turns and for turns of 120 degrees about the
/// cube's diagonals.
fn rotation_matrix(q: Quat) -> DMat3 {
    let [x, y, z, w] = q.to_array().map(f64::from);
    let norm = x * x + y * y + z * z + w * w;
    let (xx, yy, zz) = (2.0 * x * x / norm, 2.0 * y * y / norm, 2.0 * z * z / norm);
    let (xy, yz, zx) = (2.0 * x * y / norm, 2.0 * y * z / norm, 2.0 * z * x / norm);
    let (wx, wy, wz) = (2.0 * w * x / norm, 2.0 * w * y / norm, 2.0 * w * z / norm);
    DMat3::from_cols(
        DVec3::new(1.0 - (yy + zz), xy + wz, zx - wy),
        DVec3::new(xy - wz, 1.0 - (xx + zz), yz + wx),
        DVec3::new(zx + wy, yz - wx, 1.0 - (xx + yy)),
    )
}

/// A body's triangles in the world.
pub struct World {
    /// Input face of each triangle.
    pub faces: Vec<u32>,
    pub triangles: Vec<Triangle>,
    pub boxes: Vec<Bounds>,
    pub bounds: Bounds,
    /// Radius of the sphere about the centre of `bounds`.
    pub radius: f64,
    pub closed: bool,
    /// A point of every connected component.
    pub components: Vec<DVec3>,
}

impl World {
    /// The triangle of input face `face`, if the face has an area.
    pub fn triangle(&self, face: u32) -> Option<&Triangle> {
        self.faces.binary_search(&face).ok().map(|i| &self.triangles[i])
    }
}

/// A closed box.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    pub low: DVec3,
    pub high: DVec3,
}

impl Bounds {
    pub fn around(points: &[DVec3]) -> Self {
        let [low, high] = [
            points.iter().copied().reduce(DVec3::min),
            points.iter().copied().reduce(DVec3::max),
        ];
        Self {
            low: low.unwrap(),
            high: high.unwrap(),
        }
    }

    pub fn union(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    /// Whether the closed boxes share a point.
    pub fn meets(&self, other: &Self) -> bool {
        (0..3).all(|k| self.low[k] <= other.high[k] && other.low[k] <= self.high[k])
    }

    pub fn contains(&self, p: DVec3) -> bool {
        (0..3).all(|k| self.low[k] <= p[k] && p[k] <= self.high[k])
    }
}
