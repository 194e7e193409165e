//! Polygons with more than three corners, convex or not.

use bevy_faceoff::asset::{CollisionMesh, import_bytes, import_part};
use bevy_faceoff::geometry::{Orientation, TriMesh, shapes};
use bevy_faceoff::queries::{Check, CheckOptions, Placement};
use glam::{Quat, Vec3};
use std::fmt::Write;

/// A polygon of the plane z = 0, counter-clockwise, and its copy at z = 1, with walls between them. The polygons begin with this
/// corner.
fn prism(outline: &[[f32; 2]], first: usize) -> (Vec<Vec3>, Vec<Vec<usize>>) {
    let count = outline.len();
    let level = |z| outline.iter().map(move |&[x, y]| Vec3::new(x, y, z));
    let mut top: Vec<usize> = (count..2 * count).collect();
    top.rotate_left(first);
    let mut bottom: Vec<usize> = (0..count).rev().collect();
    bottom.rotate_left(first);
    let wall = |i: usize| vec![i, (i + 1) % count, count + (i + 1) % count, count + i];
    let faces = [top, bottom].into_iter().chain((0..count).map(wall));
    (level(0.0).chain(level(1.0)).collect(), faces.collect())
}

/// The polygons as a file of each text format.
fn files((vertices, faces): &(Vec<Vec3>, Vec<Vec<usize>>)) -> [(&'static str, String); 3] {
    let (v, f) = (vertices.len(), faces.len());
    let mut obj = String::new();
    let mut rest = String::new();
    for p in vertices {
        writeln!(rest, "{} {} {}", p.x, p.y, p.z).unwrap();
    }
    let mut points = String::new();
    for p in vertices {
        writeln!(points, "v {} {} {}", p.x, p.y, p.z).unwrap();
    }
    for face in faces {
        write!(obj, "f").unwrap();
        write!(rest, "{}", face.len()).unwrap();
        for &corner in face {
            write!(obj, " {}", corner + 1).unwrap();
            write!(rest, " {corner}").unwrap();
        }
        obj.push('\n');
        rest.push('\n');
    }
    // An OBJ file may have its vertices at the end.
    let ply = format!(
        "ply\nformat ascii 1.0\nelement vertex {v}\nproperty float x\nproperty float y\nproperty float z\nelement face {f}\n\
         property list uchar int vertex_indices\nend_header\n{rest}"
    );
    [
        ("l.obj", obj + &points),
        ("l.ply", ply),
        ("l.off", format!("OFF\n{v} {f} 0\n{rest}")),
    ]
}

fn touches(mesh: &TriMesh, at: Vec3) -> bool {
    let place = |mesh: &TriMesh, translation, scale| Placement {
        mesh: CollisionMesh::new(mesh),
        translation,
        rotation: Quat::IDENTITY,
        scale,
    };
    // Taller than the prism, so that it would cross caps that cover the notch.
    let bar = place(&shapes::cube(1.0), at, Vec3::new(0.5, 0.5, 4.0));
    let both = [place(mesh, Vec3::ZERO, Vec3::ONE), bar];
    Check::new(&both, &CheckOptions::default()).unwrap().flatten().count() > 0
}

const L: [[f32; 2]; 6] = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];

#[test]
fn a_prism_with_a_notch_is_free_there_whatever_its_first_corner() {
    for first in 0..6 {
        for (name, text) in files(&prism(&L, first)) {
            let mesh = import_bytes(name, text.as_bytes()).unwrap();
            assert_eq!(mesh.triangles().len(), 2 * 4 + 6 * 2, "{name}");
            let baked = CollisionMesh::new(&mesh);
            assert_eq!(baked.mesh.orientation(), Orientation::Outward);
            assert!(baked.mesh.turned().is_empty(), "{name} from {first}");
            assert!((baked.mass.volume - 3.0).abs() < 1e-5, "{name} from {first}");
            assert!(!touches(&mesh, Vec3::new(1.5, 1.5, 0.5)), "{name} from {first}");
            assert!(touches(&mesh, Vec3::new(0.5, 1.5, 0.5)), "{name} from {first}");
        }
    }
}

#[test]
fn a_part_of_an_obj_file_may_have_polygons_with_notches() {
    let [(_, text), ..] = files(&prism(&L, 0));
    let text = format!("o other\nf 1 2 3\no wanted\n{text}");
    let part = bevy_faceoff::asset::MeshPart::Object("wanted".into());
    let mesh = import_part("l.obj", text.as_bytes(), Some(&part)).unwrap();
    assert!(!touches(&mesh, Vec3::new(1.5, 1.5, 0.5)));
}

#[test]
fn convex_polygons_stay_fans() {
    let ring: Vec<[f32; 2]> = (0..37)
        .map(|i| (i as f32 * 0.169_815_8).sin_cos())
        .map(|(y, x)| [x, y])
        .collect();
    for first in [0, 5, 36] {
        let (vertices, faces) = prism(&ring, first);
        let fans = faces.iter().flat_map(|face| {
            let pairs = face[1..].windows(2);
            pairs.map(|pair| [face[0], pair[0], pair[1]].map(|i| i as u32))
        });
        let fans: Vec<[u32; 3]> = fans.collect();
        for (name, text) in files(&(vertices, faces)) {
            assert_eq!(import_bytes(name, text.as_bytes()).unwrap().triangles(), fans, "{name}");
        }
    }
}
