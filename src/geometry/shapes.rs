//! Generated meshes for examples, tests and benchmarks: tori, knots, cubes, balls.
//!
//! All are closed, with faces that point outward. The parametric shapes have the dimensions given. [`ring`] and the
//! shapes named after their triangle count are centred on their bounding box and scaled to a circumscribed sphere of
//! diameter 1.

use crate::geometry::TriMesh;
use glam::{DVec3, Vec3};
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

/// A torus of 240 triangles: 12 by 10 segments, radii 0.7 and 0.3 before scaling.
pub fn torus_240() -> TriMesh {
    normalised(torus_points(12, 10, 0.7, 0.3), tube_faces(12, 10))
}

/// A (2, 3) torus knot of 1120 triangles: 56 by 10 segments, a tube of radius 0.42 around a curve on a torus of radii 2
/// and 1 before scaling.
pub fn knot_1120() -> TriMesh {
    normalised(knot_points(2, 3, 56, 10, 0.42), tube_faces(56, 10))
}

/// A thin torus of 384 triangles. Other rings fit through its hole, so rings can be linked to a chain.
pub fn ring() -> TriMesh {
    normalised(torus_points(24, 8, 0.88, 0.12), tube_faces(24, 8))
}

/// A ball of 320 triangles.
pub fn ball_320() -> TriMesh {
    let (points, faces) = sphere(2);
    normalised(points, faces)
}

/// A torus about the z axis: `major` segments around a circle of radius `major_radius`, `minor` segments around a tube
/// of radius `minor_radius`. It has `2 * major * minor` triangles.
///
/// # Panics
/// If `major` or `minor` is less than 3.
pub fn torus(major: u32, minor: u32, major_radius: f64, minor_radius: f64) -> TriMesh {
    plain(
        torus_points(major, minor, major_radius, minor_radius),
        tube_faces(major, minor),
    )
}

/// A tube around the (p, q) torus knot on a torus of radii 2 and 1. The knot winds `p` times about the z axis and `q`
/// times about the circle of the torus. It has `2 * segments * minor` triangles.
///
/// # Panics
/// If `segments` or `minor` is less than 3.
pub fn torus_knot(p: u32, q: u32, segments: u32, minor: u32, tube_radius: f64) -> TriMesh {
    plain(
        knot_points(p, q, segments, minor, tube_radius),
        tube_faces(segments, minor),
    )
}

/// A cube of 12 triangles, centred on the origin.
pub fn cube(edge: f64) -> TriMesh {
    let points = (0..8)
        .map(|i| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2 & 1) as f64) * edge - edge * 0.5)
        .collect();
    let quads = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let faces = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    plain(points, faces)
}

/// A ball centred on the origin: an icosahedron whose faces are split in four, `subdivisions` times. It has
/// `20 * 4^subdivisions` triangles, and all its vertices are on the sphere.
pub fn ball(radius: f64, subdivisions: u32) -> TriMesh {
    let (points, faces) = sphere(subdivisions);
    plain(points.into_iter().map(|p| p * radius).collect(), faces)
}

fn torus_points(major: u32, minor: u32, major_radius: f64, minor_radius: f64) -> Vec<DVec3> {
    grid(major, minor)
        .map(|(s, t)| {
            let out = DVec3::new(s.cos(), s.sin(), 0.0);
            out * (major_radius + minor_radius * t.cos()) + DVec3::Z * (minor_radius * t.sin())
        })
        .collect()
}

fn knot_points(p: u32, q: u32, segments: u32, minor: u32, tube_radius: f64) -> Vec<DVec3> {
    let (p, q) = (f64::from(p), f64::from(q));
    grid(segments, minor)
        .map(|(s, t)| {
            let (around, along) = (
                DVec3::new((p * s).cos(), (p * s).sin(), 0.0),
                DVec3::new(-(p * s).sin(), (p * s).cos(), 0.0),
            );
            let reach = 2.0 + (q * s).cos();
            let point = around * reach + DVec3::Z * (q * s).sin();
            let tangent =
                (along * (p * reach) - around * (q * (q * s).sin()) + DVec3::Z * (q * (q * s).cos())).normalize();
            // The normal of the torus is perpendicular to every curve on it, so the frame never flips.
            let normal = around * (q * s).cos() + DVec3::Z * (q * s).sin();
            let binormal = normal.cross(tangent);
            point + (normal * t.cos() + binormal * t.sin()) * tube_radius
        })
        .collect()
}

/// The two angles of each point of a tube, section by section.
fn grid(major: u32, minor: u32) -> impl Iterator<Item = (f64, f64)> {
    assert!(
        major >= 3 && minor >= 3,
        "a tube needs at least 3 segments in each direction"
    );
    (0..major).flat_map(move |i| {
        (0..minor).map(move |j| {
            let at = |k: u32, n: u32| TAU * f64::from(k) / f64::from(n);
            (at(i, major), at(j, minor))
        })
    })
}

fn tube_faces(major: u32, minor: u32) -> Vec<[u32; 3]> {
    let at = |i: u32, j: u32| i % major * minor + j % minor;
    (0..major)
        .flat_map(|i| (0..minor).map(move |j| (i, j)))
        .flat_map(|(i, j)| {
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

fn sphere(subdivisions: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let (mut points, mut faces) = icosahedron();
    for _ in 0..subdivisions {
        let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
        let mut cut = Vec::with_capacity(faces.len() * 4);
        for [a, b, c] in faces {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(u, v)| {
                *middles.entry((u.min(v), u.max(v))).or_insert_with(|| {
                    points.push((points[u as usize] + points[v as usize]).normalize());
                    points.len() as u32 - 1
                })
            });
            cut.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        faces = cut;
    }
    (points, faces)
}

/// Two poles and two rings of five.
fn icosahedron() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let z = 1.0 / 5.0f64.sqrt();
    let ring = |k: u32, turn: f64, z: f64| {
        let angle = TAU * f64::from(k) / 5.0 + turn;
        DVec3::new(angle.cos() * 2.0 / 5.0f64.sqrt(), angle.sin() * 2.0 / 5.0f64.sqrt(), z)
    };
    let mut points = vec![DVec3::Z];
    points.extend((0..5).map(|k| ring(k, 0.0, z)));
    points.extend((0..5).map(|k| ring(k, PI / 5.0, -z)));
    points.push(DVec3::NEG_Z);
    let faces = (0..5)
        .flat_map(|k| {
            let next = (k + 1) % 5;
            let (upper, upper_next, lower, lower_next) = (1 + k, 1 + next, 6 + k, 6 + next);
            [
                [0, upper, upper_next],
                [upper, lower, upper_next],
                [upper_next, lower, lower_next],
                [11, lower_next, lower],
            ]
        })
        .collect();
    (points, faces)
}

/// Centres and scales; see the module's documentation. Coordinates are rounded to millionths. This keeps files short,
/// and hides the last digits, in which the sine functions of two systems may differ.
fn normalised(points: Vec<DVec3>, faces: Vec<[u32; 3]>) -> TriMesh {
    let low = points.iter().fold(DVec3::INFINITY, |a, b| a.min(*b));
    let high = points.iter().fold(DVec3::NEG_INFINITY, |a, b| a.max(*b));
    let middle = (low + high) * 0.5;
    let reach = points.iter().map(|p| p.distance(middle)).fold(0.0, f64::max);
    let points = points
        .iter()
        .map(|p| ((*p - middle) * (0.5 / reach) * 1e6).round() / 1e6)
        .collect();
    plain(points, faces)
}

fn plain(points: Vec<DVec3>, faces: Vec<[u32; 3]>) -> TriMesh {
    // Adding zero turns -0 into 0.
    let vertices: Vec<Vec3> = points.iter().map(|p| p.as_vec3() + Vec3::ZERO).collect();
    TriMesh::new(vertices, faces).expect("generated coordinates are finite and generated indices in range")
}
