//! Meshes to project.

use bevy_faceoff::geometry::TriMesh;
use glam::Vec3;
use std::f32::consts::TAU;

/// A closed tube about a closed curve, `around * about * 2` triangles.
pub fn tube(around: u32, about: u32, radius: f32, center: impl Fn(f32) -> Vec3) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut vertices = Vec::new();
    for i in 0..around {
        let s = i as f32 / around as f32;
        let here = center(s);
        let tangent = (center(s + 1.0e-3) - center(s - 1.0e-3)).normalize();
        let normal = here.with_z(0.0).reject_from_normalized(tangent).normalize();
        let binormal = tangent.cross(normal);
        for j in 0..about {
            let (sin, cos) = (TAU * j as f32 / about as f32).sin_cos();
            vertices.push(here + radius * (cos * normal + sin * binormal));
        }
    }
    let at = |i: u32, j: u32| i % around * about + j % about;
    let mut faces = Vec::new();
    for (i, j) in (0..around).flat_map(|i| (0..about).map(move |j| (i, j))) {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        faces.extend([[a, c, b], [a, d, c]]);
    }
    (vertices, faces)
}

pub fn torus() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    tube(12, 10, 0.4, |s| Vec3::new((TAU * s).cos(), (TAU * s).sin(), 0.0))
}

pub fn knot() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    tube(56, 10, 0.35, |s| {
        let (p, q) = (2.0 * TAU * s, 3.0 * TAU * s);
        Vec3::new((2.0 + q.cos()) * p.cos(), (2.0 + q.cos()) * p.sin(), -q.sin())
    })
}

/// A cube with corners `center +- half`, side k = triangles 2k and 2k + 1, in the order of [`SIDES`].
pub fn cube(center: Vec3, half: f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let vertices = (0..8)
        .map(|i| {
            center + half * Vec3::new(i as f32 % 2.0, (i / 2) as f32 % 2.0, (i / 4) as f32) * 2.0 - Vec3::splat(half)
        })
        .collect();
    let quads = [
        [1, 3, 7, 5],
        [0, 4, 6, 2],
        [2, 6, 7, 3],
        [0, 1, 5, 4],
        [4, 5, 7, 6],
        [0, 2, 3, 1],
    ];
    let faces = quads
        .iter()
        .flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]])
        .collect();
    (vertices, faces)
}

pub const SIDES: [Vec3; 6] = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];

pub fn mesh((vertices, faces): (Vec<Vec3>, Vec<[u32; 3]>)) -> TriMesh {
    TriMesh::new(vertices, faces).expect("a valid mesh")
}

pub fn flipped(faces: Vec<[u32; 3]>, which: impl Fn(usize) -> bool) -> Vec<[u32; 3]> {
    let flip = |(i, [a, b, c]): (usize, [u32; 3])| if which(i) { [a, c, b] } else { [a, b, c] };
    faces.into_iter().enumerate().map(flip).collect()
}

pub fn joined(a: (Vec<Vec3>, Vec<[u32; 3]>), b: (Vec<Vec3>, Vec<[u32; 3]>)) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let shift = a.0.len() as u32;
    let faces = a.1.into_iter().chain(b.1.into_iter().map(|t| t.map(|v| v + shift)));
    (a.0.into_iter().chain(b.0).collect(), faces.collect())
}

/// A fixed sequence of numbers in -1..1.
pub struct Noise(pub u64);

impl Noise {
    pub fn next(&mut self) -> f32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1_u64 << 23) as f32 - 1.0
    }

    pub fn vector(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next())
    }
}

pub fn soup(count: u32, size: f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut noise = Noise(5);
    let mut vertices = Vec::new();
    for _ in 0..count {
        let center = noise.vector();
        vertices.extend([0; 3].map(|_| center + size * noise.vector()));
    }
    (vertices, (0..count).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect())
}
