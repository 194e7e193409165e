//! Files that a mesh file names outside its own folder.

use crate::gltf_files::Gltf;
use bevy_faceoff::asset::{ImportError, Imported, Recipe, import_bytes, import_file};
use bevy_faceoff::geometry::shapes;
use std::path::Path;

fn write(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) {
    let path = folder.join(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, bytes).unwrap();
}

#[test]
fn they_are_read_only_if_a_recipe_says_so() {
    let gltf = Gltf::of(&shapes::cube(1.0));
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, "data/cube.bin", &gltf.bin);
    write(folder, "meshes/cube.bin", &gltf.bin);
    write(folder, "refused.bake.ron", "(mesh: \"meshes/x.gltf\")");
    write(folder, "read.bake.ron", "(mesh: \"meshes/x.gltf\", read_outside: true)");
    write(
        folder,
        "meshes/beside.bake.ron",
        "(mesh: \"x.gltf\", read_outside: false)",
    );
    let triangles = |name: &str| match import_file(folder.join(name)) {
        Ok(Imported::Mesh { mesh, .. }) => Ok(mesh.triangles().len()),
        Ok(Imported::Baked { .. }) => panic!("not baked"),
        Err(error) => Err(error.to_string()),
    };
    // The names alone decide: the last one is in the folder of the mesh, by way of another.
    for uri in [
        "../data/cube.bin",
        "a/../../data/cube.bin",
        "%2e%2e/data/cube.bin",
        "../meshes/cube.bin",
    ] {
        write(folder, "meshes/x.gltf", gltf.with_uri(uri));
        for name in ["meshes/x.gltf", "refused.bake.ron", "meshes/beside.bake.ron"] {
            let message = triangles(name).unwrap_err();
            for word in ["x.gltf: it names \"../", "cube.bin", "read_outside: true"] {
                assert!(message.contains(word), "{uri}, {name}: {message}");
            }
        }
        assert_eq!(triangles("read.bake.ron"), Ok(12), "{uri}");
    }
    // The bytes alone give another error: no other file is read at all.
    let of_bytes = import_bytes("x.gltf", &gltf.with_uri("../data/cube.bin")).unwrap_err();
    assert!(matches!(of_bytes, ImportError::Gltf(_)), "{of_bytes}");
    for uri in ["cube.bin", "../meshes/../meshes/./cube.bin"] {
        write(folder, "meshes/x.gltf", gltf.with_uri(uri));
        assert_eq!(triangles("meshes/x.gltf").is_ok(), !uri.starts_with(".."), "{uri}");
    }
    // What is not relative is not read in any case.
    let whole = folder.join("data/cube.bin");
    for uri in [whole.to_str().unwrap(), "file:///etc/hostname", "/etc/hostname"] {
        write(folder, "meshes/x.gltf", gltf.with_uri(uri));
        let message = triangles("read.bake.ron").unwrap_err();
        assert!(message.contains("is not a relative path"), "{uri}: {message}");
    }
}

#[test]
fn the_mesh_of_a_recipe_may_be_anywhere() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, "cube.obj", bevy_faceoff::asset::to_obj(&shapes::cube(1.0)));
    write(folder, "recipes/cube.bake.ron", "(mesh: \"../cube.obj\")");
    assert!(import_file(folder.join("recipes/cube.bake.ron")).is_ok());
    let recipe = Recipe::parse(b"(mesh: \"x.gltf\", read_outside: true)").unwrap();
    assert!(recipe.read_outside && recipe.to_text().contains("read_outside: true"));
    assert_eq!(Recipe::parse(recipe.to_text().as_bytes()).unwrap(), recipe);
    let recipe = Recipe::parse(b"(mesh: \"x.gltf\")").unwrap();
    assert!(!recipe.read_outside && !recipe.to_text().contains("read_outside"));
}
