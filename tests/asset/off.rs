//! OFF files, honest and hostile.

use bevy_faceoff::asset::{ImportError, import_bytes};
use bevy_faceoff::geometry::{TriMesh, shapes};
use proptest::prelude::*;
use std::fmt::Write;

fn off(bytes: impl AsRef<[u8]>) -> Result<TriMesh, ImportError> {
    import_bytes("test.off", bytes.as_ref())
}

fn message(bytes: impl AsRef<[u8]>) -> String {
    off(bytes).unwrap_err().to_string()
}

fn text(head: &str, mesh: &TriMesh) -> String {
    let (vertices, triangles) = (mesh.vertices(), mesh.triangles());
    let mut out = format!(
        "{head}{} {} 0 # counts\n\n# a comment\n",
        vertices.len(),
        triangles.len()
    );
    for v in vertices {
        writeln!(out, " {:e} {} {} 255 0 0 1", v.x, v.y, v.z).unwrap();
    }
    for [a, b, c] in triangles {
        writeln!(out, "3\t{a} {b} {c} 0.5 0.5 0.5").unwrap();
    }
    out
}

#[test]
fn all_heads_give_the_vertices_and_triangles_in_file_order() {
    // With the counts on the same line, as in a well-known collection even without a space; without a head.
    let heads = [
        "OFF\n",
        "OFF ",
        "OFF",
        "# made by a test\nOFF\n",
        "COFF\n",
        "STCNOFF\n",
        "NOFF\r\n",
        "\u{feff}OFF\n",
        "",
    ];
    for mesh in [shapes::knot_1120(), shapes::cube(1.0)] {
        for head in heads {
            let text = text(head, &mesh);
            let read = off(&text).unwrap_or_else(|error| panic!("{head:?}: {error}"));
            assert_eq!(read.vertices(), mesh.vertices());
            assert_eq!(read.triangles(), mesh.triangles());
        }
        assert_eq!(
            import_bytes("mesh", text("OFF\n", &mesh).as_bytes())
                .unwrap()
                .triangles(),
            mesh.triangles()
        );
    }
}

#[test]
fn polygons_are_fans() {
    let text = "OFF\n5 3 6\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 2 0\n4 0 1 2 3\n1 0\n3 3 2 4 255 0 0\n";
    assert_eq!(off(text).unwrap().triangles(), [[0, 1, 2], [0, 2, 3], [3, 2, 4]]);
}

#[test]
fn the_corners_of_a_face_may_go_on_over_further_lines() {
    let text = "OFF\n5 3 6\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 2 0\n4 0 1\n2 3\n3\n3\n2 4 255 0 0\n3 0 1 2\n";
    assert_eq!(
        off(text).unwrap().triangles(),
        [[0, 1, 2], [0, 2, 3], [3, 2, 4], [0, 1, 2]]
    );
}

#[test]
fn errors_say_what_and_where() {
    for (text, wanted) in [
        ("", "a count is missing"),
        ("OFF BINARY\n", "OFF BINARY"),
        ("4OFF\n1 1 1\n", "not an integer"),
        ("nOFF\n4\n", "not the start of an OFF file"),
        ("OFF\n3\n", "line 2: a count is missing"),
        ("OFF\n3 -1 0\n", "a count is missing or negative"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n", "3 vertices, but there are 2"),
        (
            "OFF\n99999999999 1 0\n0 0 0\n1 0 0\n",
            "99999999999 vertices, but there are 2",
        ),
        ("OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "2 faces, but there are 1"),
        (
            "OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n",
            "line 4: a vertex needs three",
        ),
        ("OFF\n3 1 0\n0 0 0\n1 0 x\n0 1 0\n3 0 1 2\n", "line 4: \"x\""),
        ("OFF\n3 1 0\n0 0 0\n1 0 inf\n0 1 0\n3 0 1 2\n", "line 4: inf"),
        (
            "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n",
            "line 6: a face says that it has 4",
        ),
        (
            "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2.5\n",
            "line 6: \"2.5\" is not an integer",
        ),
        // A face that lacks a corner takes it from the next one, and then there are too few.
        (
            "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n3 0 1 2\n",
            "2 faces, but there are 1",
        ),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -2\n", "names vertex -2"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "names vertex 3"),
        ("OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", "3 vertices and no faces"),
    ] {
        assert!(message(text).contains(wanted), "{text:?}: {}", message(text));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// Nothing panics, hangs or takes much memory, whatever is changed or cut off.
    #[test]
    fn damaged_files_are_errors_or_meshes(at in any::<prop::sample::Index>(), byte in any::<u8>(), cut in any::<prop::sample::Index>()) {
        let mut bytes = text("OFF\n", &shapes::cube(1.0)).into_bytes();
        let at = at.index(bytes.len());
        bytes[at] = byte;
        let _ = off(&bytes);
        bytes.truncate(cut.index(bytes.len()));
        let _ = off(&bytes);
    }
}
