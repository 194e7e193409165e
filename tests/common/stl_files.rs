//! Writes STL files.
#![allow(dead_code)]

use bevy_faceoff::geometry::TriMesh;
use std::fmt::Write;

/// A binary file. The normals are NaN and the last two bytes of each triangle are not zero: neither may matter.
pub fn binary(header: &str, mesh: &TriMesh) -> Vec<u8> {
    let mut out = header.as_bytes().to_vec();
    out.resize(80, b' ');
    out.extend((mesh.triangles().len() as u32).to_le_bytes());
    for t in 0..mesh.triangles().len() {
        out.extend([f32::NAN; 3].iter().flat_map(|x| x.to_le_bytes()));
        out.extend(
            mesh.corners(t)
                .iter()
                .flat_map(|c| c.to_array())
                .flat_map(f32::to_le_bytes),
        );
        out.extend([1, 2]);
    }
    out
}

pub fn text(mesh: &TriMesh) -> String {
    let mut out = String::from("solid a name with facet in it\n");
    for t in 0..mesh.triangles().len() {
        out += "  facet normal 0 0 -nan(ind)\n    outer loop\n";
        for c in mesh.corners(t) {
            writeln!(out, "      vertex {:e} {} {}", c.x, c.y, c.z).unwrap();
        }
        out += "    endloop\n  endfacet\n";
    }
    out + "endsolid a name\n"
}
