//! Files that are something else than their name says: the message tells what they are.

use bevy_faceoff::asset::import_bytes;

fn message(name: &str, bytes: impl AsRef<[u8]>) -> String {
    import_bytes(name, bytes.as_ref()).unwrap_err().to_string()
}

const OBJ: &str = "# a triangle\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const OFF: &str = "OFF\n3 1 3\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
const STL: &str = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n";

#[test]
fn a_pointer_of_git_lfs_is_named() {
    let pointer = "version https://git-lfs.github.com/spec/v1\n\
                   oid sha256:4d7a214614ab2935c943f9e0ff69d22eadbb8f32b1258daaa5e2ca24d17e2393\nsize 12345\n";
    for name in ["a.obj", "a.stl", "a.ply", "a.off", "a.gltf", "a.glb", "a.faceoff", "a"] {
        let message = message(name, pointer);
        assert!(message.contains("pointer of Git LFS"), "{name}: {message}");
    }
}

#[test]
fn text_in_utf_16_is_named() {
    for (name, text) in [
        ("a.obj", OBJ),
        ("a.off", OFF),
        ("a.stl", STL),
        ("a.gltf", "{}"),
        ("a", OBJ),
    ] {
        let units = || std::iter::once(0xfeff).chain(text.encode_utf16());
        let little: Vec<u8> = units().flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> = units().flat_map(u16::to_be_bytes).collect();
        for bytes in [little, big] {
            let message = message(name, bytes);
            assert!(message.contains("UTF-16"), "{name}: {message}");
        }
    }
}

#[test]
fn lines_that_end_with_a_carriage_return_alone_are_named_and_those_with_both_are_read() {
    for (name, text) in [("a.obj", OBJ), ("a.off", OFF), ("a.stl", STL)] {
        let message = message(name, text.replace('\n', "\r"));
        assert!(message.contains("carriage return"), "{name}: {message}");
        let both = text.replace('\n', "\r\n");
        assert_eq!(
            import_bytes(name, both.as_bytes()).unwrap().triangles().len(),
            1,
            "{name}"
        );
    }
}

/// Its meshes and accessors are objects with names, where those of glTF 2.0 are lists.
#[test]
fn gltf_1_is_named() {
    for version in ["\"1.0\"", "\"1.0.1\"", "1.0"] {
        let text = format!(
            "{{\"asset\": {{\"version\": {version}}}, \"scene\": \"main\", \"scenes\": {{\"main\": {{\"nodes\": [\"a\"]}}}}, \
             \"nodes\": {{\"a\": {{\"meshes\": [\"b\"]}}}}, \"meshes\": {{\"b\": {{}}}}, \"accessors\": {{}}}}"
        );
        for name in ["a.gltf", "a"] {
            let message = message(name, &text);
            assert!(message.contains("glTF \"1.0"), "{name}: {message}");
            assert!(message.contains("export it as glTF 2.0"), "{name}: {message}");
        }
    }
    // What is wrong with a file of the right version is still told.
    let wrong = message("a.gltf", "{\"asset\": {\"version\": \"2.0\"}, \"meshes\": {}}");
    assert!(wrong.contains("line 1"), "{wrong}");
}
