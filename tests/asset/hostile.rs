//! Files of each format, cut off at every byte and with every bit changed: an error, or a mesh that is valid.

use crate::gltf_files::Gltf;
use crate::{ply_files, stl_files};
use bevy_faceoff::asset::{MeshPart, Recipe, import_bytes, import_part, to_obj};
use bevy_faceoff::geometry::shapes;

/// Files that are all read, with a part of each if it has parts.
fn files() -> Vec<(&'static str, Vec<u8>, Option<MeshPart>)> {
    let cube = shapes::cube(1.0);
    let obj = to_obj(&cube).replacen("f ", "o Cube # 1\ng a b\nf ", 1);
    let mut gltf = Gltf::of(&cube);
    gltf.json["nodes"][0]["name"] = "Arm".into();
    let mut files = vec![
        ("x.obj", obj.clone().into_bytes(), Some(MeshPart::Object("Cube".into()))),
        ("x.obj", obj.into_bytes(), Some(MeshPart::Group("b".into()))),
        ("x.off", off().into_bytes(), None),
        ("x.stl", stl_files::binary("solid", &cube), None),
        ("x.stl", stl_files::text(&cube).into_bytes(), None),
        ("x.glb", gltf.glb(), Some(MeshPart::Node("Arm".into()))),
        ("x.gltf", gltf.with_data_uri(), Some(MeshPart::Node("Arm".into()))),
    ];
    files.extend(ply_files::all_kinds(&cube).map(|bytes| ("x.ply", bytes, None)));
    files
}

fn off() -> String {
    "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n".into()
}

/// Reads the file and its part, and checks what comes of it. Returns whether both are meshes.
fn reads(name: &str, bytes: &[u8], part: Option<&MeshPart>) -> bool {
    [part, None].into_iter().all(|part| {
        import_part(name, bytes, part).is_ok_and(|mesh| {
            assert!(mesh.vertices().iter().all(|v| v.is_finite()));
            let corners = mesh.triangles().as_flattened();
            assert!(corners.iter().all(|&v| (v as usize) < mesh.vertices().len()));
            true
        })
    })
}

#[test]
fn cut_off_at_every_byte() {
    for (name, bytes, part) in files() {
        assert!(reads(name, &bytes, part.as_ref()), "{name}");
        for length in 0..bytes.len() {
            let there = reads(name, &bytes[..length], part.as_ref());
            // A text of lines does not tell where it ends, nor does the last number.
            let last = match name {
                "x.obj" => 0,
                "x.off" | "x.ply" | "x.stl" => bytes.len() - 8,
                _ => bytes.len(),
            };
            assert!(!there || length >= last, "{name}: {length} of {}", bytes.len());
        }
    }
}

#[test]
fn every_bit_changed() {
    for (name, bytes, part) in files() {
        for at in 0..bytes.len() {
            for bit in 0..8 {
                let mut changed = bytes.clone();
                changed[at] ^= 1 << bit;
                reads(name, &changed, part.as_ref());
                let _ = import_bytes("x", &changed);
            }
        }
    }
}

#[test]
fn recipes_cut_off_or_changed() {
    let text = "(mesh: \"a.obj\", part: (object: \"b\"), read_outside: true, settings: (faces: true, inward: Room))";
    assert!(Recipe::parse(text.as_bytes()).is_ok());
    for length in 0..text.len() {
        assert!(Recipe::parse(&text.as_bytes()[..length]).is_err(), "{length}");
        for bit in 0..8 {
            let mut changed = text.as_bytes().to_vec();
            changed[length] ^= 1 << bit;
            let _ = Recipe::parse(&changed);
        }
    }
}

#[test]
fn lines_and_names_without_end() {
    let long = "x".repeat(1 << 20);
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for text in [
        format!("{vertices}o {long}\nf 1 2 3\n"),
        format!("{vertices}g {}\nf 1 2 3\n", "a ".repeat(1 << 19)),
        format!("{vertices}{}f 1 2 3\n", "o\n".repeat(1 << 19)),
        format!("{vertices}o \\\n{}f 1 2 3\n", "\\\n".repeat(1 << 18)),
    ] {
        let error = import_part("x.obj", text.as_bytes(), Some(&MeshPart::Object("none".into()))).unwrap_err();
        assert!(error.to_string().len() < 500, "{} bytes", error.to_string().len());
        let error = import_part("x.obj", text.as_bytes(), Some(&MeshPart::Group(long.clone()))).unwrap_err();
        assert!(error.to_string().len() < 500, "{} bytes", error.to_string().len());
    }
}
