//! PLY files, text and binary, honest and hostile.

use crate::ply_files::{all_kinds, text};
use bevy_faceoff::asset::{ImportError, import_bytes};
use bevy_faceoff::geometry::{TriMesh, shapes};
use proptest::prelude::*;

fn ply(bytes: impl AsRef<[u8]>) -> Result<TriMesh, ImportError> {
    import_bytes("test.ply", bytes.as_ref())
}

fn message(bytes: impl AsRef<[u8]>) -> String {
    ply(bytes).unwrap_err().to_string()
}

#[test]
fn all_kinds_give_the_vertices_and_triangles_in_file_order() {
    for mesh in [shapes::knot_1120(), shapes::cube(1.0), shapes::ball(0.3, 2)] {
        for bytes in all_kinds(&mesh) {
            let read = ply(&bytes).unwrap();
            assert_eq!(read.vertices(), mesh.vertices());
            assert_eq!(read.triangles(), mesh.triangles());
            // The content is enough.
            assert_eq!(import_bytes("mesh", &bytes).unwrap().triangles(), mesh.triangles());
        }
    }
}

#[test]
fn polygons_are_fans_and_strips_alternate() {
    let vertices = "element vertex 5\nproperty int x\nproperty int y\nproperty float z\n";
    let points = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 2 0\n";
    let polygons = format!(
        "ply\nformat ascii 1.0\n{vertices}element face 3\nproperty list int int vertex_index\nend_header\n{points}4 0 1 2 3\n\
         2 0 1\n3 3 2 4\n"
    );
    assert_eq!(ply(polygons).unwrap().triangles(), [[0, 1, 2], [0, 2, 3], [3, 2, 4]]);
    let strips = format!(
        "ply\nformat ascii 1.0\n{vertices}element tristrips 1\nproperty list int int vertex_indices\nend_header\n{points}\
         8 0 1 3 2 -1 3 2 4\n"
    );
    assert_eq!(ply(strips).unwrap().triangles(), [[0, 1, 3], [3, 1, 2], [3, 2, 4]]);
}

#[test]
fn faces_may_come_before_vertices() {
    let text = "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nelement vertex 3\nproperty float x\n\
                property float y\nproperty float z\nend_header\n3 0 1 2\n0 0 0\n1 0 0\n0 1 0\n";
    assert_eq!(ply(text).unwrap().triangles(), [[0, 1, 2]]);
}

#[test]
fn errors_say_what_and_where() {
    let cube = text(&shapes::cube(1.0));
    assert!(message("not a ply").contains("it is not a PLY file"));
    assert!(
        message("ply\nnonsense\n").starts_with("line 2: "),
        "{}",
        message("ply\nnonsense\n")
    );
    let cut_off = message(&cube[..cube.len() - 20]);
    assert!(
        cut_off.starts_with("line 35: ") && !cut_off.contains("Line"),
        "{cut_off}"
    );
    let promised = message(cube.replace("element vertex 8", "element vertex 99999999999"));
    assert!(promised.contains("99999999999 elements vertex"), "{promised}");
    let nothing = message(cube.replace(
        "element material 1\nproperty list uchar int colours\n",
        "element material 999999999999\n",
    ));
    assert!(nothing.contains("elements material"), "{nothing}");
    let no_z = message(cube.replace("property float z", "property float w"));
    assert!(no_z.contains("element vertex") && no_z.contains("x, y and z"), "{no_z}");
    let no_list = message(cube.replace("vertex_indices", "corners"));
    assert!(no_list.contains("vertex_indices"), "{no_list}");
    let a_float = message(cube.replace("uchar uint vertex_indices", "uchar float vertex_indices"));
    assert!(a_float.contains("vertex_indices"), "{a_float}");
    let beyond = message(cube.replace("-1 3 0", "-1 3 800"));
    assert!(beyond.contains("names vertex 800"), "{beyond}");
    let negative = message(
        cube.replace("uchar uint vertex_indices", "uchar int vertex_indices")
            .replace("-1 3 0", "-1 3 -5"),
    );
    assert!(negative.contains("polygon 0 names vertex -5"), "{negative}");
    let no_faces = message(
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n",
    );
    assert!(no_faces.contains("1 vertices and no faces"), "{no_faces}");
    // Beyond single precision.
    let large = message(cube.replacen("-5e-1 -0.5", "-5e-1 1e99", 1));
    assert!(large.contains("vertex 0 is not finite"), "{large}");
    // However long the line, the message is short.
    let long = message(cube.replacen("-5e-1 ", &"x".repeat(1 << 20), 1));
    assert!(long.len() < 400, "{} bytes", long.len());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// Nothing panics, hangs or takes much memory, whatever is changed or cut off.
    #[test]
    fn damaged_files_are_errors_or_meshes(kind in 0..4usize, at in any::<prop::sample::Index>(), byte in any::<u8>(), cut in any::<prop::sample::Index>()) {
        let mut bytes = all_kinds(&shapes::cube(1.0))[kind].clone();
        let at = at.index(bytes.len());
        bytes[at] = byte;
        let _ = ply(&bytes);
        bytes.truncate(cut.index(bytes.len()));
        let _ = ply(&bytes);
    }
}
