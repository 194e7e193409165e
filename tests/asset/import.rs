//! OBJ files and recipes, honest and hostile.

use bevy_faceoff::asset::format::to_bytes;
use bevy_faceoff::asset::recipe::RecipeError;
use bevy_faceoff::asset::{CollisionMesh, ImportError, Imported, Recipe, import_bytes, import_file, to_obj};
use bevy_faceoff::geometry::{MeshError, Orientation, TriMesh, shapes};
use bevy_faceoff::projection::{BakeSettings, Inward};
use proptest::prelude::*;

#[path = "../../examples/make_assets.rs"]
mod make_assets;

fn obj(text: &str) -> Result<TriMesh, ImportError> {
    import_bytes("test.obj", text.as_bytes())
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn the_assets_are_what_the_generator_writes() {
    for (name, text) in make_assets::files() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("assets")
            .join(&name);
        let there = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(
            there == text,
            "assets/{name} is out of date: run `cargo run --example make_assets`"
        );
        let Imported::Mesh { mesh, settings, .. } = import_file(&path).unwrap() else {
            panic!("{name} is not baked")
        };
        assert_eq!(mesh.orientation(), Orientation::Outward);
        assert_eq!(
            settings.faces,
            name.ends_with(".bake.ron") && ["torus", "knot"].contains(&name.split('.').next().unwrap())
        );
    }
}

#[test]
fn a_written_mesh_reads_back_bit_for_bit() {
    for mesh in [shapes::knot_1120(), shapes::ball(1.0 / 3.0, 3)] {
        assert_eq!(obj(&to_obj(&mesh)).unwrap(), mesh);
    }
}

#[test]
fn polygons_become_fans_in_file_order() {
    let mesh = obj(&format!("{SQUARE}v 2 2 1\nf 1 2 3 4\nf 5 4 3\nf 1 2 3 4 5\n")).unwrap();
    assert_eq!(
        mesh.triangles(),
        [[0, 1, 2], [0, 2, 3], [4, 3, 2], [0, 1, 2], [0, 2, 3], [0, 3, 4]]
    );
    assert_eq!(mesh.face_ids(), [0, 1, 2, 3, 4, 5]);
}

#[test]
fn dropped_faces_keep_their_number() {
    let mesh = obj(&format!("{SQUARE}f 1 1 2\nf 1 2 3\nf 2 2 2 2\nf 3 4 1\n")).unwrap();
    assert_eq!(mesh.face_ids(), [1, 4]);
    assert_eq!(mesh.dropped(), 3);
}

#[test]
fn negative_indices_count_back() {
    let mesh = obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\nf -1 -3 -4\n").unwrap();
    assert_eq!(mesh.triangles(), [[0, 1, 2], [3, 1, 0]]);
}

#[test]
fn corners_may_name_textures_and_normals_that_do_not_exist() {
    let mesh = obj(&format!(
        "{SQUARE}vt 0 0\nf 1/9 2/9 3/9\nf 1//-7 3//0 4//x\nf 1/1/1 2/ 3/1/\n"
    ))
    .unwrap();
    assert_eq!(mesh.triangles(), [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
}

#[test]
fn objects_groups_and_materials_do_not_split_or_reorder() {
    let mesh = obj(
        "mtllib missing.mtl\no first\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\no second\ng a b\nv 0 0 1\nusemtl \
         blue\nf 4 2 1\nusemtl red\ns off\nf 1 4 3\ng\nf 2 3 4\n",
    )
    .unwrap();
    assert_eq!(mesh.triangles(), [[0, 1, 2], [3, 1, 0], [0, 3, 2], [1, 2, 3]]);
}

#[test]
fn colours_weights_comments_and_other_lines_are_passed_over() {
    let mesh = import_bytes(
        "x.OBJ",
        b"\xef\xbb\xbf# caf\xe9 \xff\nv 0 0 0 1 0.5 0.5\nv 1 0 0 # one\n  v\t0 1 0 1.0\nl 1 2\np 3\nf 1 2\nf 3\nf\nvn 0 0\n\
          curv 1 2\nf 1 2 3#end",
    )
    .unwrap();
    assert_eq!(mesh.triangles(), [[0, 1, 2]]);
    assert_eq!(mesh.face_ids(), [0]);
}

#[test]
fn line_ends_and_continued_lines() {
    let expected = obj(&format!("{SQUARE}f 1 2 3 4\n")).unwrap();
    for text in [
        format!("{SQUARE}f 1 2 3 4").replace('\n', "\r\n"),
        format!("{SQUARE}f 1 2 3 4"),
        format!("{SQUARE}f 1 \\\n2 3\\\n 4\n\n\n"),
        format!("{SQUARE}f 1 \\\n2 3 4\\").replace('\n', "\r\n"),
        format!("f 1 2 3 4\n{SQUARE}"),
    ] {
        assert_eq!(obj(&text).unwrap(), expected, "{text:?}");
    }
}

#[test]
fn errors_name_the_line() {
    let message = |text: &str| obj(text).unwrap_err().to_string();
    for (text, expected) in [
        ("v 0 0 0\nv 1 x 0\n", "line 2: \"x\" is not a number"),
        ("v 0 0 0\n\nv 1 nan 0\n", "line 3: nan is not a finite"),
        ("v 1 2 1e60\n", "line 1: 1e60 is not a finite"),
        ("v 1 -inf 0\n", "line 1: -inf is not a finite"),
        ("v 1 2\n", "line 1: a vertex needs three"),
        (
            &format!("{SQUARE}f 1 2 0\n"),
            "line 5: a face names vertex 0, but there are 4",
        ),
        (
            &format!("{SQUARE}f 1 2 3\nf 1 2 7\nf 1 2 6"),
            "line 6: a face names vertex 7",
        ),
        (&format!("{SQUARE}f 1 2 -5\n"), "line 5: a face names vertex -5"),
        (&format!("{SQUARE}f 1 2 3.5\n"), "line 5: \"3.5\" is not a face corner"),
        (&format!("{SQUARE}f 1 2 /3\n"), "line 5: \"/3\" is not a face corner"),
        (
            &format!("{SQUARE}f 1 2 99999999999999999999\n"),
            "line 5: \"99999999999999999999\" is not",
        ),
        (
            &format!("{SQUARE}f 1 2 9223372036854775807\n"),
            "line 5: a face names vertex 9223372036854775807",
        ),
        (
            &format!("{SQUARE}f 1 2 -9223372036854775808\n"),
            "line 5: a face names vertex -9223372036854775808",
        ),
        (&format!("{SQUARE}f \\\n1 2\\\n 9\n"), "line 5: a face names vertex 9"),
        ("", "there are 0 vertices and no faces"),
        (SQUARE, "there are 4 vertices and no faces"),
        ("v 2e9 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n", "vertex 0 at"),
    ] {
        let message = message(text);
        assert!(message.starts_with(expected), "{text:?}: {message}");
    }
    let long = format!("v {} 0 0", "y".repeat(10_000));
    assert!(message(&long).len() < 200);
    assert!(matches!(
        obj(&format!("{SQUARE}f 1 1 1\n")),
        Err(ImportError::Mesh(MeshError::AllDegenerate { faces: 1 }))
    ));
}

#[test]
fn formats_are_recognised_or_refused_by_name_and_content() {
    let text = format!("# mesh\n{SQUARE}f 1 2 3");
    assert!(import_bytes("no_extension", text.as_bytes()).is_ok());
    for name in ["x.glb", "x.obj", "x"] {
        assert!(matches!(
            import_bytes(name, b"glTF\x02\0\0\0"),
            Err(ImportError::Gltf(_))
        ));
    }
    assert!(matches!(import_bytes("x.txt", b"hello"), Err(ImportError::Unknown)));
    assert!(matches!(
        import_bytes("x.bake.ron", b"()"),
        Err(ImportError::RecipeNotMesh)
    ));
    let binary: Vec<u8> = (0..100_000u32)
        .map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8)
        .collect();
    assert!(import_bytes("x.obj", &binary).is_err());
    assert!(import_bytes("x.faceoff", &binary).is_err());
    assert!(import_bytes("x", &binary).is_err());
}

#[test]
fn a_million_triangles() {
    let mesh = shapes::torus(1000, 500, 1.0, 0.3);
    let text = to_obj(&mesh);
    let start = std::time::Instant::now();
    let read = obj(&text).unwrap();
    eprintln!(
        "{} triangles, {} MB read in {:?}",
        read.triangles().len(),
        text.len() >> 20,
        start.elapsed()
    );
    assert_eq!(read.triangles().len(), 1_000_000);
    assert!(start.elapsed().as_secs() < 60);
}

#[test]
fn files_are_named_in_errors() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::create_dir(at("sub")).unwrap();
    std::fs::write(at("bad.obj"), "v 0 0").unwrap();
    std::fs::write(at("sub/square.obj"), format!("{SQUARE}f 1 2 3 4")).unwrap();
    std::fs::write(
        at("square.bake.ron"),
        "(mesh: \"sub/square.obj\", settings: (image: 64))",
    )
    .unwrap();
    std::fs::write(at("sub/up.bake.ron"), "(mesh: \"../bad.obj\")").unwrap();
    std::fs::write(at("broken.bake.ron"), "(mesh: \"x.obj\", settings: (picture: 64))").unwrap();
    let message = |name: &str| import_file(at(name)).unwrap_err().to_string();
    assert!(message("bad.obj").contains("bad.obj: line 1"));
    assert!(message("sub/up.bake.ron").contains("bad.obj: line 1"));
    assert!(message("missing.obj").contains("missing.obj: "));
    assert!(message("broken.bake.ron").contains("broken.bake.ron: line 1, column"));
    let Imported::Mesh { mesh, settings, .. } = import_file(at("square.bake.ron")).unwrap() else {
        panic!("not baked")
    };
    assert_eq!(mesh.triangles().len(), 2);
    assert_eq!((settings.faces, settings.degrees, settings.image), (false, 1, 64));
}

#[test]
fn recipes() {
    let recipe = Recipe::parse(b"(mesh: \"knot.obj\", settings: (faces: true, degrees: 2))").unwrap();
    assert_eq!(recipe.mesh, "knot.obj");
    assert_eq!(
        recipe.settings,
        BakeSettings {
            faces: true,
            degrees: 2,
            image: 256,
            ..BakeSettings::default()
        }
    );
    assert_eq!(Recipe::parse(recipe.to_text().as_bytes()).unwrap(), recipe);
    assert_eq!(
        Recipe::parse(b"(mesh: \"a\")").unwrap().settings,
        BakeSettings::default()
    );

    let recipe = Recipe::parse(b"(mesh: \"a\", settings: (weld_tolerance: 1e-5, inward: Solid))").unwrap();
    assert_eq!(
        recipe.settings,
        BakeSettings {
            weld_tolerance: 1e-5,
            inward: Inward::Solid,
            ..BakeSettings::default()
        }
    );
    assert_eq!(Recipe::parse(recipe.to_text().as_bytes()).unwrap(), recipe);

    let error = |text: &str| Recipe::parse(text.as_bytes()).unwrap_err();
    for text in ["weld_tolerance: 0.02", "weld_tolerance: -1e-6", "weld_tolerance: NaN"] {
        let error = error(&format!("(mesh: \"a\", settings: ({text}))")).to_string();
        assert!(
            error.contains("weld_tolerance is") && error.contains("0 to 0.01"),
            "{error}"
        );
    }
    for part in [
        "(mesh: 3)",
        "(mesh: \"Gear \\\"1\\\"\", primitive: 2)",
        "Some((mesh: 3, primitive: Some(1)))",
    ] {
        let recipe = Recipe::parse(format!("(mesh: \"a.glb\", part: {part})").as_bytes()).unwrap();
        assert!(recipe.part.is_some());
        assert_eq!(Recipe::parse(recipe.to_text().as_bytes()).unwrap(), recipe);
    }

    assert!(matches!(error("(mesh: \"\")"), RecipeError::Mesh(_)));
    assert!(matches!(error("(mesh: \"b.bake.ron\")"), RecipeError::Mesh(_)));
    assert!(matches!(error("(mesh: \"b.glb#Mesh0\")"), RecipeError::Mesh(_)));
    for settings in [
        "degrees: 0",
        "degrees: 7",
        "degrees: 180",
        "image: 8",
        "image: 4097",
        "degrees: 4294967295",
    ] {
        let text = format!("(mesh: \"a.obj\", settings: ({settings}))");
        assert!(matches!(error(&text), RecipeError::Settings(_)), "{text}");
    }
    for text in [
        "",
        "(",
        "()",
        "(mesh: 5)",
        "(mesh: \"a\", mash: 1)",
        "(mesh: \"a\", settings: (image: -1))",
        "(mesh: \"a\", settings: (image: 99999999999))",
        "(mesh: \"a\") x",
        &"(".repeat(50_000),
        &format!("(mesh: \"a\", settings: {}", "[".repeat(50_000)),
        &format!("(mesh: \"a\", x: {}1", "Some(".repeat(10_000)),
        &format!("/*{}", "/*".repeat(20_000)),
    ] {
        let error = error(text);
        assert!(matches!(error, RecipeError::Syntax { .. }), "{error}");
        assert!(error.to_string().len() < 500, "{error}");
    }
    assert!(matches!(error(&" ".repeat(70_000)), RecipeError::TooLong(70_000)));
    assert!(Recipe::parse(b"(mesh: \"\xff\")").is_err());
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..Default::default() })]

    #[test]
    fn no_bytes_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        let _ = import_bytes("a.obj", &bytes);
        let _ = import_bytes("a.faceoff", &bytes);
        let _ = Recipe::parse(&bytes);
    }

    #[test]
    fn no_obj_like_text_panics(text in "([vf#\\\\]|[0-9]{1,3}|-1|/|\\.|e|nan| |\n|\r){0,80}") {
        let _ = obj(&text);
        let _ = obj(&format!("{SQUARE}{text}"));
    }
}

#[test]
fn a_recipe_of_a_baked_file_gives_the_faces_of_its_source() {
    let folder = tempfile::tempdir().unwrap();
    let cube = shapes::cube(1.0);
    let faces = cube.triangles().iter().enumerate();
    let turned = faces.map(|(i, &[a, b, c])| if i % 3 == 0 { [a, c, b] } else { [a, b, c] });
    let source = TriMesh::new(cube.vertices().to_vec(), turned.collect()).unwrap();
    let baked = CollisionMesh::new(&source);
    assert!(!baked.mesh.turned().is_empty());
    std::fs::write(folder.path().join("a.faceoff"), to_bytes(&baked, [0; 32])).unwrap();
    std::fs::write(folder.path().join("b.bake.ron"), r#"(mesh: "a.faceoff")"#).unwrap();
    let read = import_file(folder.path().join("b.bake.ron")).unwrap();
    let mut faces: Vec<_> = (read.mesh().face_ids().iter().zip(read.mesh().triangles())).collect();
    faces.sort_unstable();
    let corners = |mesh: &TriMesh, face: &[u32; 3]| face.map(|v| mesh.vertices()[v as usize]);
    for ((_, face), wanted) in faces.into_iter().zip(source.triangles()) {
        let (mut a, b) = (corners(read.mesh(), face), corners(&source, wanted));
        let at = a.iter().position(|&p| p == b[0]).unwrap();
        a.rotate_left(at);
        assert_eq!(a, b);
    }
}
