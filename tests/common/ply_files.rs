//! Writes PLY files.
#![allow(dead_code)]

use bevy_faceoff::geometry::TriMesh;
use std::fmt::Write;

pub fn header(format: &str, mesh: &TriMesh) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment made by a test\nobj_info none\nelement vertex {}\nproperty float x\nproperty double y\n\
         property uchar red\nproperty float z\nelement material 1\nproperty list uchar int colours\nelement face {}\n\
         property short group\nproperty list uchar uint vertex_indices\nend_header\n",
        mesh.vertices().len(),
        mesh.triangles().len()
    )
}

pub fn text(mesh: &TriMesh) -> String {
    let mut out = header("ascii", mesh);
    for v in mesh.vertices() {
        writeln!(out, "{:e} {} 7 {}", v.x, v.y, v.z).unwrap();
    }
    out += "3 1 2 3\n";
    for [a, b, c] in mesh.triangles() {
        writeln!(out, "-1 3 {a} {b} {c}").unwrap();
    }
    out
}

/// A binary file; `order` turns the bytes of a number in little-endian order into those of the file.
pub fn binary(format: &str, order: impl Fn(&mut [u8]), mesh: &TriMesh) -> Vec<u8> {
    let mut out = header(format, mesh).into_bytes();
    let mut put = |bytes: &mut [u8]| {
        order(bytes);
        out.extend_from_slice(bytes);
    };
    for v in mesh.vertices() {
        put(&mut v.x.to_le_bytes());
        put(&mut f64::from(v.y).to_le_bytes());
        put(&mut [7]);
        put(&mut v.z.to_le_bytes());
    }
    put(&mut [1]);
    put(&mut 5i32.to_le_bytes());
    for triangle in mesh.triangles() {
        put(&mut (-1i16).to_le_bytes());
        put(&mut [3]);
        for index in triangle {
            put(&mut index.to_le_bytes());
        }
    }
    out
}

pub fn all_kinds(mesh: &TriMesh) -> [Vec<u8>; 4] {
    [
        text(mesh).into_bytes(),
        text(mesh).replace('\n', "\r\n").into_bytes(),
        binary("binary_little_endian", |_| {}, mesh),
        binary("binary_big_endian", <[u8]>::reverse, mesh),
    ]
}
