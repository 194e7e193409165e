//! Our readers and well-kept crates read the same triangles from a file, in the same order. No maintained crate reads
//! OFF.

use crate::gltf_files::*;
use bevy_faceoff::asset::{ImportError, MeshPart, import_bytes, import_part};
use bevy_faceoff::geometry::{MeshError, TriMesh, shapes};
use fastrand::Rng;
use glam::{Mat4, Vec3};
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, Property};
use serde_json::json;
use std::fmt::Write;
use std::io::Cursor;

type Triangle = [Vec3; 3];

/// The triangles that our reader finds. It leaves out those without an area, and refuses a file that has no others.
fn ours(name: &str, bytes: &[u8], part: Option<&MeshPart>) -> Vec<Triangle> {
    match import_part(name, bytes, part) {
        Ok(mesh) => (0..mesh.triangles().len()).map(|t| mesh.corners(t)).collect(),
        Err(ImportError::Mesh(MeshError::AllDegenerate { .. })) => Vec::new(),
        Err(error) => panic!("{error}"),
    }
}

/// The triangles that have an area.
fn with_area(triangles: Vec<Triangle>) -> Vec<Triangle> {
    let corners = (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]);
    match TriMesh::new(triangles.as_flattened().to_vec(), corners.collect()) {
        Ok(mesh) => mesh.face_ids().iter().map(|&face| triangles[face as usize]).collect(),
        Err(_) => Vec::new(),
    }
}

/// A corner of a convex polygon of at most 60 corners. Fans of such are what all readers make of polygons.
fn on_a_ring(corner: i32) -> [f32; 3] {
    let (y, x) = (corner as f32 * 0.1).sin_cos();
    [4.0 * x + y, 3.0 * y, x - 2.0 * y]
}

/// Random text of an OBJ file with objects `a`, `b` and so on: convex polygons of 1 to 7 corners of every form, with indices
/// that count from the start or back.
fn random_obj(random: &mut Rng) -> String {
    let mut text = String::from("# made by a test\nmtllib none.mtl\nvt 0 0\nvt 1 0\nvn 0 0 1\n");
    let mut vertices = 0;
    // With `tobj` all vertices have a colour or none.
    let color = if random.bool() { " 1 0.5 0" } else { "" };
    for object in 0..random.usize(1..6) {
        writeln!(text, "o {}", ["a", "b", "c d", "a"][object % 4]).unwrap();
        for _ in 0..random.usize(3..12) {
            let [x, y, z] = on_a_ring(vertices);
            writeln!(text, "v {x} {y:e} {z}{color}").unwrap();
            vertices += 1;
        }
        for _ in 0..random.usize(1..9) {
            text += ["f", " f ", "\tf\t"][random.usize(..3)];
            let form = random.usize(..4);
            let mut corners: Vec<i32> = (0..random.usize(1..8)).map(|_| random.i32(1..=vertices)).collect();
            corners.sort_unstable();
            for back in corners {
                let index = if random.bool() { -back } else { vertices + 1 - back };
                match form {
                    0 => write!(text, " {index}"),
                    1 => write!(text, " {index}/2"),
                    2 => write!(text, " {index}//-1"),
                    _ => write!(text, " {index}/-2/1"),
                }
                .unwrap();
            }
            text += ["\n", "\r\n", " \n", "\ns off\nusemtl red\n"][random.usize(..4)];
        }
    }
    text
}

/// The triangles that `tobj` finds, with the name of the object of each.
fn tobj(text: &str) -> Vec<(String, Triangle)> {
    let options = tobj::LoadOptions {
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
        ..Default::default()
    };
    let (models, _) = tobj::load_obj_buf(&mut Cursor::new(text), &options, |_| Ok(Default::default())).unwrap();
    let triangles = models.into_iter().flat_map(|model| {
        let at = |i: u32| Vec3::from_slice(&model.mesh.positions[3 * i as usize..]);
        let corners = model.mesh.indices.as_chunks().0.iter().map(|face| face.map(at));
        corners
            .map(|triangle| (model.name.clone(), triangle))
            .collect::<Vec<_>>()
    });
    triangles.collect()
}

#[test]
fn obj_as_tobj_reads_it() {
    let mut random = Rng::with_seed(1);
    let mut compared = 0;
    for _ in 0..300 {
        let text = random_obj(&mut random);
        let theirs = tobj(&text);
        if theirs.is_empty() {
            assert!(import_bytes("x.obj", text.as_bytes()).is_err());
            continue;
        }
        let all = theirs.iter().map(|(_, triangle)| *triangle).collect();
        assert_eq!(ours("x.obj", text.as_bytes(), None), with_area(all), "{text}");
        // For `tobj` a group is an object with another keyword.
        let grouped = text.replace("o ", "g ");
        for name in ["a", "b", "c d"] {
            let of_it: Vec<Triangle> = theirs.iter().filter(|(of, _)| of == name).map(|(_, t)| *t).collect();
            if of_it.is_empty() {
                continue;
            }
            let theirs = with_area(of_it);
            let part = MeshPart::Object(name.into());
            assert_eq!(ours("x.obj", text.as_bytes(), Some(&part)), theirs, "{name}:\n{text}");
            let part = MeshPart::Group(name.into());
            assert_eq!(
                ours("x.obj", grouped.as_bytes(), Some(&part)),
                theirs,
                "{name}:\n{text}"
            );
            compared += 1;
        }
    }
    assert!(compared > 200, "{compared}");
}

fn stl_io(bytes: &[u8]) -> std::io::Result<Vec<Triangle>> {
    let mut cursor = Cursor::new(bytes);
    let triangles = stl_io::create_stl_reader(&mut cursor)?.collect::<std::io::Result<Vec<_>>>()?;
    Ok(triangles.iter().map(|t| t.vertices.map(|v| Vec3::from(v.0))).collect())
}

#[test]
fn stl_as_stl_io_reads_it() {
    let mut random = Rng::with_seed(2);
    for _ in 0..100 {
        let triangles: Vec<stl_io::Triangle> = (0..random.usize(1..40))
            .map(|_| {
                let mut vector = || stl_io::Vector::new([(); 3].map(|()| random.f32() * 2000.0 - 1000.0));
                stl_io::Triangle {
                    normal: vector(),
                    vertices: [vector(), vector(), vector()],
                }
            })
            .collect();
        let mut binary = Vec::new();
        stl_io::write_stl(&mut binary, triangles.iter()).unwrap();
        let mut text = String::from("solid a test \n");
        for triangle in &triangles {
            let [x, y, z] = triangle.normal.0;
            write!(text, "facet normal {x} {y} {z}\n outer loop\n").unwrap();
            for [x, y, z] in triangle.vertices.map(|v| v.0) {
                writeln!(text, "  vertex {x} {y:e} {z:E}").unwrap();
            }
            text += " endloop\nendfacet\n\n";
        }
        text += "endsolid a test\n";
        for bytes in [&binary[..], text.as_bytes(), text.replace('\n', "\r\n").as_bytes()] {
            let theirs = stl_io(bytes).unwrap();
            assert_eq!(theirs.len(), triangles.len());
            assert_eq!(ours("x.stl", bytes, None), with_area(theirs));
        }
    }
}

/// What `stl.rs` says about that crate.
#[test]
fn what_stl_io_does_not_read() {
    let cube = shapes::cube(1.0);
    let corners: Vec<Triangle> = (0..12).map(|t| cube.corners(t)).collect();
    // A header with a line feed, and one whose first line is the numbers that follow it.
    let with_line = crate::stl_files::binary("solid cube\n", &cube);
    let without = crate::stl_files::binary("solid cube", &cube);
    let text = crate::stl_files::text(&cube);
    let finite = text.replace("-nan(ind)", "1");
    for (bytes, read) in [
        (&with_line[..], None),
        (&without, Some(12)),
        (text.as_bytes(), None),
        (finite.as_bytes(), Some(12)),
        (finite.to_uppercase().as_bytes(), None),
        (finite.replacen(" a name with facet in it", "", 1).as_bytes(), None),
        (finite.replace("-nan(ind)", "nan").as_bytes(), Some(12)),
    ] {
        assert_eq!(stl_io(bytes).ok().map(|triangles| triangles.len()), read);
        assert_eq!(ours("x.stl", bytes, None), corners);
    }
    let two = format!("{finite}{finite}");
    assert_eq!(stl_io(two.as_bytes()).unwrap().len(), 12);
    assert_eq!(ours("x.stl", two.as_bytes(), None).len(), 24);
    let mut not_finite = without.clone();
    not_finite[84 + 12..84 + 16].copy_from_slice(&f32::NAN.to_le_bytes());
    assert_eq!(stl_io(&not_finite).unwrap().len(), 12);
    assert!(import_bytes("x.stl", &not_finite).is_err());
}

/// The triangles of a primitive as the `gltf` crate reads it.
fn primitive(primitive: &gltf::Primitive, bin: &[u8], place: Mat4) -> Vec<Triangle> {
    let reader = primitive.reader(|_| Some(bin));
    let at: Vec<Vec3> = reader.read_positions().unwrap().map(Vec3::from).collect();
    let corners: Vec<usize> = match reader.read_indices() {
        Some(indices) => indices.into_u32().map(|i| i as usize).collect(),
        None => (0..at.len()).collect(),
    };
    let faces: Vec<[usize; 3]> = match primitive.mode() {
        gltf::mesh::Mode::Triangles => corners.as_chunks().0.to_vec(),
        gltf::mesh::Mode::TriangleStrip => (0..corners.len() - 2)
            .map(|i| [corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]])
            .collect(),
        gltf::mesh::Mode::TriangleFan => (1..corners.len() - 1)
            .map(|i| [corners[i], corners[i + 1], corners[0]])
            .collect(),
        _ => Vec::new(),
    };
    faces
        .into_iter()
        .map(|face| face.map(|i| place.transform_point3(at[i])))
        .collect()
}

fn node(node: &gltf::Node, bin: &[u8], above: Mat4, own: bool) -> Vec<Triangle> {
    let place = if own {
        above
    } else {
        above * Mat4::from_cols_array_2d(&node.transform().matrix())
    };
    let mut all: Vec<Triangle> = node
        .mesh()
        .iter()
        .flat_map(gltf::Mesh::primitives)
        .flat_map(|p| primitive(&p, bin, place))
        .collect();
    for child in node.children() {
        all.extend(self::node(&child, bin, place, false));
    }
    all
}

/// Nodes in a random tree, with meshes of one to three primitives of every mode and size of index.
fn random_gltf(random: &mut Rng) -> Gltf {
    let mut gltf = Gltf::new();
    let meshes = random.usize(1..4);
    for mesh in 0..meshes {
        let primitives = (0..random.usize(1..4))
            .map(|_| {
                let count = random.usize(4..20);
                let positions: Vec<[f32; 3]> = (0..count).map(|_| [(); 3].map(|()| random.f32() * 4.0 - 2.0)).collect();
                let position = gltf.positions(&positions);
                let corners: Vec<u32> = (0..3 * random.usize(1..9))
                    .map(|_| random.u32(..count as u32))
                    .collect();
                let indices = gltf.indices(&corners, [U8, U16, U32][random.usize(..3)]);
                json!({"attributes": {"POSITION": position}, "indices": indices, "mode": random.u32(4..7)})
            })
            .collect();
        gltf.mesh(&format!("mesh {mesh}"), primitives);
    }
    let mut roots = Vec::new();
    for n in 0..random.usize(1..6) {
        let [x, y, z] = [(); 3].map(|()| random.i32(-5..5));
        // No mirrors, for which ours turns the triangles.
        let mut node = json!({"name": format!("node {n}"), "translation": [x, y, z], "scale": [1 + x.abs(), 2, 0.5],
            "rotation": [0.6, 0.0, 0.8 * f32::from(random.bool()), 0.0]});
        let [_, _, z, _] = std::array::from_fn(|i| node["rotation"][i].as_f64().unwrap());
        node["rotation"][3] = json!((1.0 - 0.36 - z * z).max(0.0).sqrt());
        if random.u32(..4) > 0 {
            node["mesh"] = json!(random.usize(..meshes));
        }
        // The nodes without a parent so far may become children.
        let children: Vec<usize> = (0..random.usize(..3)).filter_map(|_| roots.pop()).collect();
        if !children.is_empty() {
            node["children"] = json!(children);
        }
        roots.push(gltf.node(node));
    }
    gltf.json["scenes"][0]["nodes"] = json!(roots);
    gltf.json["nodes"][roots[0]]["mesh"] = json!(0);
    gltf.for_bevy()
}

#[test]
fn gltf_as_the_gltf_crate_reads_it() {
    let mut random = Rng::with_seed(3);
    let close = |ours: Vec<Triangle>, theirs: Vec<Triangle>, what: &str| {
        let theirs = with_area(theirs);
        assert_eq!(ours.len(), theirs.len(), "{what}");
        for (a, b) in ours.as_flattened().iter().zip(theirs.as_flattened()) {
            assert!(a.distance(*b) < 1e-4 * (1.0 + b.length()), "{what}: {a} {b}");
        }
    };
    for _ in 0..200 {
        let gltf = random_gltf(&mut random);
        let bytes = gltf.glb();
        let theirs = gltf::Gltf::from_slice(&bytes).unwrap();
        let bin = theirs.blob.as_deref().unwrap();
        let scene = theirs.default_scene().unwrap();
        let all = scene.nodes().flat_map(|n| node(&n, bin, Mat4::IDENTITY, false));
        close(ours("x.glb", &bytes, None), all.collect(), "scene");
        for mesh in theirs.meshes() {
            let name = mesh.name().unwrap();
            let all: Vec<Triangle> = mesh
                .primitives()
                .flat_map(|p| primitive(&p, bin, Mat4::IDENTITY))
                .collect();
            close(ours("x.glb", &bytes, Some(&name.into())), all, name);
        }
        for one in theirs.nodes() {
            let (name, all) = (one.name().unwrap(), node(&one, bin, Mat4::IDENTITY, true));
            if !all.is_empty() {
                close(ours("x.glb", &bytes, Some(&MeshPart::Node(name.into()))), all, name);
            }
        }
    }
}

#[test]
fn containers_that_the_gltf_crate_reads() {
    let gltf = Gltf::of(&shapes::cube(1.0)).for_bevy();
    let whole = gltf.glb();
    let document = u32::from_le_bytes(whole[12..16].try_into().unwrap()) as usize;
    // The header tells only a part; the document is longer by a byte and not padded; other bytes follow.
    let mut short = whole.clone();
    short[8..12].copy_from_slice(&(20 + document as u32).to_le_bytes());
    let mut unpadded = [&whole[..20 + document], b" ", &whole[20 + document..]].concat();
    unpadded[12..16].copy_from_slice(&(document as u32 + 1).to_le_bytes());
    unpadded[8..12].copy_from_slice(&(whole.len() as u32 + 1).to_le_bytes());
    for bytes in [short, unpadded, [&whole[..], b"rest"].concat()] {
        assert!(gltf::Gltf::from_slice(&bytes).is_ok());
        assert_eq!(ours("x.glb", &bytes, None).len(), 12);
    }
}

#[test]
fn ply_as_its_crate_tells_it() {
    let mut random = Rng::with_seed(4);
    for _ in 0..100 {
        let count = random.usize(3..20);
        let mut faces = String::new();
        let face_count = random.usize(1..9);
        for _ in 0..face_count {
            let corners = random.usize(3..7);
            write!(faces, "{corners}").unwrap();
            let mut corners: Vec<usize> = (0..corners).map(|_| random.usize(..count)).collect();
            corners.sort_unstable();
            for corner in corners {
                write!(faces, " {corner}").unwrap();
            }
            faces += "\n";
        }
        let mut text = format!(
            "ply\nformat ascii 1.0\nelement vertex {count}\nproperty float x\nproperty float y\nproperty float z\nproperty uchar \
             red\nelement face {face_count}\nproperty list uchar int vertex_indices\nend_header\n"
        );
        for vertex in 0..count {
            let [x, y, z] = on_a_ring(vertex as i32);
            writeln!(text, "{x} {y} {z} 255").unwrap();
        }
        text += &faces;
        let ply = Parser::<DefaultElement>::new().read_ply(&mut text.as_bytes()).unwrap();
        let at: Vec<Vec3> = ply.payload["vertex"]
            .iter()
            .map(|vertex| {
                Vec3::from(["x", "y", "z"].map(|axis| match vertex[axis] {
                    Property::Float(number) => number,
                    ref other => panic!("{other:?}"),
                }))
            })
            .collect();
        let mut theirs = Vec::new();
        for face in &ply.payload["face"] {
            let Property::ListInt(corners) = &face["vertex_indices"] else {
                panic!("{face:?}")
            };
            for i in 2..corners.len() {
                theirs.push([0, i - 1, i].map(|i| at[corners[i] as usize]));
            }
        }
        assert_eq!(ours("x.ply", text.as_bytes(), None), with_area(theirs));
    }
}
