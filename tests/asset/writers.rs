//! Writers of mesh files: what they write is read again with the same bits.

use bevy_faceoff::asset::{import_bytes, to_obj, to_off, to_ply, to_stl};
use bevy_faceoff::geometry::{TriMesh, shapes};
use glam::Vec3;

/// A mesh with an unused vertex, a face of zero area among the others, and coordinates of all sizes.
fn odd_mesh() -> TriMesh {
    let vertices = vec![
        Vec3::new(1.0 / 3.0, -0.0, 1e-38),
        Vec3::new(9.99999e8, 0.1, f32::MIN_POSITIVE),
        Vec3::new(-1.0, 0.7, -1e-45),
        Vec3::ONE,
        Vec3::new(16_777_217.0, std::f32::consts::PI, 2.0),
    ];
    TriMesh::new(vertices, vec![[0, 1, 2], [2, 2, 1], [4, 2, 1]]).unwrap()
}

#[test]
fn what_is_written_is_read_with_the_same_bits() {
    let bits = |mesh: &TriMesh| -> Vec<[u32; 3]> {
        let vertices = mesh.vertices().iter();
        vertices.map(|v| v.to_array().map(f32::to_bits)).collect()
    };
    for mesh in [odd_mesh(), shapes::knot_1120(), shapes::knot_1120().flipped()] {
        for (name, file) in [
            ("mesh.obj", to_obj(&mesh).into_bytes()),
            ("mesh.off", to_off(&mesh).into_bytes()),
            ("mesh.ply", to_ply(&mesh)),
        ] {
            let read = import_bytes(name, &file).unwrap();
            assert_eq!(bits(&read), bits(&mesh), "{name}");
            assert_eq!(read.all_faces(), mesh.all_faces(), "{name}");
            assert_eq!(read.dropped(), mesh.dropped(), "{name}");
        }
        let file = to_stl(&mesh);
        let read = import_bytes("mesh.stl", &file).unwrap();
        let corners = |mesh: &TriMesh| -> Vec<[Vec3; 3]> {
            let faces = mesh.all_faces().into_iter();
            faces.map(|face| face.map(|v| mesh.vertices()[v as usize])).collect()
        };
        assert_eq!(corners(&read), corners(&mesh));
        assert_eq!(file.len(), 84 + 50 * mesh.all_faces().len());
    }
}

#[test]
fn normals_in_stl_are_those_of_the_faces() {
    let cube = shapes::cube(1.0);
    let file = to_stl(&cube);
    for (t, triangle) in file[84..].chunks_exact(50).enumerate() {
        let float = |i: usize| f32::from_le_bytes(triangle[i..i + 4].try_into().unwrap());
        let normal = Vec3::new(float(0), float(4), float(8));
        let [a, b, c] = cube.corners(t);
        assert!(normal.distance((a + b + c).normalize()) < 0.9 && normal.abs().max_element() == 1.0);
        assert_eq!(normal, (b - a).cross(c - a).normalize());
    }
}
