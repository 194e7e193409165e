//! STL files, binary and text, honest and hostile.

use crate::stl_files::{binary, text};
use bevy_faceoff::asset::{ImportError, Imported, import_bytes, import_file};
use bevy_faceoff::geometry::{MeshError, Orientation, TriMesh, shapes};
use proptest::prelude::*;

fn stl(bytes: impl AsRef<[u8]>) -> Result<TriMesh, ImportError> {
    import_bytes("test.stl", bytes.as_ref())
}

fn message(bytes: impl AsRef<[u8]>) -> String {
    stl(bytes).unwrap_err().to_string()
}

const FACET: &str = "facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet\n";

#[test]
fn both_kinds_give_the_triangles_in_file_order() {
    for mesh in [shapes::knot_1120(), shapes::cube(1.0), shapes::ball(0.3, 2)] {
        let text = text(&mesh);
        let kinds: [&[u8]; 5] = [
            &binary("exported by some program", &mesh),
            &binary("solid exported by some other program", &mesh),
            text.as_bytes(),
            text.replace('\n', "\r\n").as_bytes(),
            text.to_uppercase().as_bytes(),
        ]
        .map(|b| &*b.to_vec().leak());
        for bytes in kinds {
            for name in ["x.stl", "x.STL", "without_extension"] {
                let read = import_bytes(name, bytes).unwrap();
                assert_eq!(read.orientation(), Orientation::Outward);
                assert_eq!(read.face_ids(), mesh.face_ids());
                assert!(read.vertices().len() <= mesh.vertices().len());
                for t in 0..mesh.triangles().len() {
                    assert_eq!(read.corners(t), mesh.corners(t));
                }
            }
        }
    }
}

#[test]
fn binary_files_may_end_in_other_data() {
    let mut bytes = binary("", &shapes::cube(1.0));
    bytes.extend(b"comment");
    assert_eq!(stl(bytes).unwrap().triangles().len(), 12);
}

#[test]
fn solids_of_a_text_make_one_mesh() {
    let text = format!("\u{feff}\n solid\n{FACET}endsolid\nsolid facet\n{FACET}{FACET}endsolid vertex\n\n");
    assert_eq!(stl(text).unwrap().face_ids(), [0, 1, 2]);
}

#[test]
fn both_zeros_are_one_place() {
    let facet = FACET.replace("vertex 0 0 0", "vertex -0 0 -0.0");
    let mesh = stl(format!("solid\n{FACET}{facet}endsolid")).unwrap();
    assert_eq!(mesh.vertices().len(), 3);
}

#[test]
fn slivers_keep_their_number() {
    let sliver = FACET.replace("vertex 0 1 0", "vertex 1 0 0");
    let mesh = stl(format!("solid\n{sliver}{FACET}endsolid")).unwrap();
    assert_eq!((mesh.face_ids(), mesh.dropped()), ([1].as_slice(), 1));
    assert!(matches!(
        stl(format!("solid\n{sliver}endsolid")),
        Err(ImportError::Mesh(MeshError::AllDegenerate { faces: 1 }))
    ));
}

#[test]
fn errors_say_where_and_what() {
    for (text, expected) in [
        ("", "0 bytes are too few"),
        ("solid", "line 1: the file ends here"),
        ("solid x\nendsolid x\n", "the mesh has no faces"),
        (&format!("solid\n{FACET}"), "line 2: the file ends here"),
        (
            "solid\nfacet normal 0 0 1\nendsolid",
            "line 3: a solid ends within a facet",
        ),
        ("solid\nfacet facet", "line 2: a facet begins within"),
        ("solid\nvertex 0 0 0", "line 2: a vertex is outside"),
        ("solid\n\nendfacet", "line 3: an endfacet has no facet"),
        ("solid\nfacet vertex 0 0 0\nendfacet", "line 3: a facet has fewer"),
        ("solid\nfacet vertex 0 0\nvertex", "line 3: a vertex needs three"),
        ("solid\nfacet vertex 0 0 x", "line 2: \"x\" is not a number"),
        ("solid\nfacet vertex 0 nan 0", "line 2: nan is not a finite"),
        ("solid\nfacet vertex 0 -inf 0", "line 2: -inf is not a finite"),
        ("solid\nfacet vertex 0 1e99 0", "line 2: 1e99 is not a finite"),
        ("solid\nfacet vertex 0 2,5 0", "line 2: \"2,5\" is not a number"),
        ("solid\nface", "line 2: \"face\" is not an STL keyword"),
        (
            &format!("solid\n{}", FACET.replace("endloop", "\nvertex 5 5 5 endloop")),
            "line 3: a facet has more than three",
        ),
        ("hello, this is no mesh", "22 bytes are too few"),
        (&"no mesh at all ".repeat(20), "the file says that it has"),
    ] {
        let message = message(text);
        assert!(message.starts_with(expected), "{text:?}: {message}");
    }
    assert!(message(format!("solid\n{}", "y".repeat(1 << 20))).len() < 200);

    let good = binary("", &shapes::cube(1.0));
    assert!(message(&good[..good.len() - 1]).contains("has 12 triangles, but there are 11"));
    assert!(message(&good[..60]).contains("60 bytes are too few"));
    for wrong in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut bytes = good.clone();
        bytes[84 + 50 * 7 + 20..][..4].copy_from_slice(&wrong.to_le_bytes());
        assert!(message(bytes).contains("triangle 7 has a coordinate that is not finite"));
    }
    let mut far = good.clone();
    far[84 + 12..][..4].copy_from_slice(&3e9f32.to_le_bytes());
    assert!(message(far).contains("larger unit"));
}

#[test]
fn a_huge_count_allocates_nothing() {
    for header in ["", "solid"] {
        let mut bytes = binary(header, &shapes::cube(1.0));
        bytes[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
        bytes[79] = 0;
        assert!(message(bytes).contains("has 4294967295 triangles, but there are 12"));
    }
}

#[test]
fn files_and_recipes() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("cube.stl"), binary("solid", &shapes::cube(1.0))).unwrap();
    std::fs::write(at("cube.bake.ron"), "(mesh: \"cube.stl\")").unwrap();
    std::fs::write(at("cut.stl"), &binary("", &shapes::cube(1.0))[..100]).unwrap();
    for name in ["cube.stl", "cube.bake.ron"] {
        let imported = import_file(at(name)).unwrap();
        assert!(matches!(&imported, Imported::Mesh { mesh, .. } if mesh.triangles().len() == 12));
    }
    let message = import_file(at("cut.stl")).unwrap_err().to_string();
    assert!(message.contains("cut.stl: the file says"), "{message}");
}

#[test]
fn every_truncation_is_an_error() {
    let mesh = shapes::cube(1.0);
    let text = text(&mesh);
    for whole in [
        binary("solid", &mesh),
        binary("", &mesh),
        text.trim_end().replace("endsolid a name", "endsolid").into_bytes(),
    ] {
        for length in 0..whole.len() {
            assert!(stl(&whole[..length]).is_err(), "{length} of {}", whole.len());
        }
        assert!(stl(&whole).is_ok());
    }
}

#[test]
fn changed_bits_do_not_panic() {
    let mesh = shapes::cube(1.0);
    for whole in [binary("solid", &mesh), text(&mesh).into_bytes()] {
        for at in 0..whole.len() {
            for bit in 0..8 {
                let mut bytes = whole.clone();
                bytes[at] ^= 1 << bit;
                let _ = stl(&bytes);
                let _ = import_bytes("x", &bytes);
            }
        }
    }
}

#[test]
fn a_million_triangles() {
    let mesh = shapes::torus(1000, 500, 1.0, 0.3);
    for bytes in [binary("", &mesh), text(&mesh).into_bytes()] {
        let start = std::time::Instant::now();
        let read = stl(&bytes).unwrap();
        eprintln!(
            "1000000 triangles, {} MB read in {:?}",
            bytes.len() >> 20,
            start.elapsed()
        );
        assert_eq!((read.triangles().len(), read.vertices().len()), (1_000_000, 500_000));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..Default::default() })]

    #[test]
    fn no_bytes_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        let _ = stl(&bytes);
        let _ = stl([b"solid ".as_slice(), &bytes].concat());
    }

    #[test]
    fn no_stl_like_text_panics(text in "((end)?(solid|facet|loop)|normal|outer|vertex|[0-9]|nan|-1e9| |\n){0,60}") {
        let _ = stl(&text);
        let _ = stl(format!("solid\n{FACET}{text}"));
    }
}

#[test]
fn a_header_without_triangles_before_triangles_is_wrong() {
    let mut bytes = binary("a", &shapes::cube(1.0));
    bytes[80..84].fill(0);
    let message = import_bytes("x.stl", &bytes).unwrap_err().to_string();
    assert!(
        message.contains("0 triangles, but 600 bytes follow, enough for 12"),
        "{message}"
    );
}
