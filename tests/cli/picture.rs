//! `faceoff image` and `faceoff inspect`.

use crate::Folder;
use bevy_faceoff::asset::to_obj;
use bevy_faceoff::geometry::{TriMesh, shapes};
use glam::Vec3;
use serde_json::Value;

/// Width, height and rows of a PNG file.
fn png(folder: &Folder, name: &str) -> image::RgbImage {
    image::load_from_memory(&folder.read(name)).unwrap().to_rgb8()
}

/// Pixels that are neither paper nor ink, in a part of the picture.
fn coloured(picture: &image::RgbImage, from: [u32; 2], size: u32) -> usize {
    let grey = |p: &image::Rgb<u8>| p.0[0] == p.0[1] && p.0[1] == p.0[2];
    let inside = |at: u32, from: u32| (from..from + size).contains(&at);
    picture
        .enumerate_pixels()
        .filter(|(x, y, p)| inside(*x, from[0]) && inside(*y, from[1]) && !grey(p))
        .count()
}

#[test]
fn a_cube_seen_along_an_axis_fills_its_square_and_shows_two_faces() {
    let folder = Folder::new();
    folder.asset("cube.obj");
    folder.good(&["image", "cube.obj", "--image", "64", "-o", "cube.png"]);
    let picture = png(&folder, "cube.png");
    // Heights on the left, faces on the right, each 64 pixels wide.
    let [left, right] = [[12, 32], [12 + 64 + 12 + 16 + 72 + 12, 32]];
    let [heights, faces] = [left, right].map(|from| coloured(&picture, from, 64));
    assert_eq!(heights, faces);
    assert!(heights > 1000, "{heights}");
    let mut colours: Vec<_> = (0..64)
        .flat_map(|y| (0..64).map(move |x| (x, y)))
        .map(|(x, y)| picture.get_pixel(right[0] + x, right[1] + y).0)
        .filter(|c| *c != [250; 3])
        .collect();
    colours.sort_unstable();
    colours.dedup();
    assert_eq!(colours.len(), 2, "the two triangles of one side");
}

/// A ball without its topmost face, seen from above and from below.
#[test]
fn defects_are_marked_where_they_are_and_pale_on_the_far_side() {
    let folder = Folder::new();
    let ball = shapes::ball(1.0, 2);
    folder.write("sound.obj", to_obj(&ball));
    folder.good(&["image", "sound.obj", "--image", "128", "--defects", "-o", "sound.png"]);
    let heights = |picture: &image::RgbImage| coloured(picture, [12, 32], 128);
    assert_eq!(heights(&png(&folder, "sound.png")), 0, "grey heights, no marks");
    let height = |t: usize| ball.corners(t).iter().map(|p| p.z).sum::<f32>();
    let count = ball.triangles().len();
    let missing = (0..count).max_by(|&a, &b| height(a).total_cmp(&height(b))).unwrap();
    let faces = (0..count).filter(|&t| t != missing).map(|t| ball.triangles()[t]);
    let open = TriMesh::new(ball.vertices().to_vec(), faces.collect()).unwrap();
    folder.write("open.obj", to_obj(&open));
    let picture = |about_x: &str, name: &str| {
        let run = folder.run(&[
            "image",
            "open.obj",
            "--image",
            "128",
            "--about-x",
            about_x,
            "--defects",
            "-o",
            name,
        ]);
        assert!(run.success, "{}", run.stderr);
        png(&folder, name)
    };
    let (near, far) = (picture("0", "near.png"), picture("180", "far.png"));
    assert!(
        near.height() > png(&folder, "sound.png").height(),
        "a legend of two kinds"
    );
    // Strong colours on the heights, and those among them near the hole.
    let strong = |picture: &image::RgbImage| -> (usize, usize) {
        let spread = |p: image::Rgb<u8>| p.0.iter().max().unwrap() - p.0.iter().min().unwrap();
        let pixels = (0..128).flat_map(|x| (0..128).map(move |y| (x, y)));
        let strong = pixels.filter(|(x, y)| spread(*picture.get_pixel(12 + x, 32 + y)) > 80);
        let middle: Vec3 = ball.corners(missing).iter().map(|p| *p / 3.0).sum();
        let hole = [63.5 + 62.5 * middle.x, 63.5 - 62.5 * middle.y];
        let is_near = |(x, y): &(u32, u32)| (*x as f32 - hole[0]).hypot(*y as f32 - hole[1]) < 20.0;
        (strong.clone().count(), strong.filter(is_near).count())
    };
    let (all, beside) = strong(&near);
    assert!(all > 20 && all == beside, "{beside} of {all} beside the hole");
    assert_eq!(strong(&far).0, 0);
    assert!(heights(&far) > 20, "{}", heights(&far));
    folder.bad(
        &["image", "open.obj", "--defects", "--sheet", "-o", "no.png"],
        &["--sheet"],
    );
}

#[test]
fn a_sheet_shows_every_direction() {
    let folder = Folder::new();
    folder.good(&["image", "torus", "--sheet", "--image", "32", "-o", "sheet.png"]);
    let picture = png(&folder, "sheet.png");
    assert_eq!(picture.dimensions(), (12 + 12 * 44, 12 + 7 * 52));
    for row in 0..7 {
        for column in 0..12 {
            let from = [12 + column * 44, 20 + row * 52];
            assert!(coloured(&picture, from, 32) > 100, "row {row}, column {column}");
        }
    }
}

#[test]
fn pictures_that_cannot_be_drawn_or_written_are_refused() {
    let folder = Folder::new();
    for (arguments, named) in [
        (["torus", "--image", "8", "-o", "t.png"], "image is 8"),
        (["torus", "--about-x", "NaN", "-o", "t.png"], "--about-x"),
        (["none.obj", "--about-x", "0", "-o", "t.png"], "none.obj"),
        (["torus", "--image", "16", "-o", "no/t.png"], "no/t.png"),
    ] {
        folder.bad(&[&["image"], &arguments[..]].concat(), &[named]);
    }
}

#[test]
fn pictures_are_png_by_any_name_or_on_standard_output() {
    let folder = Folder::new();
    for name in ["t.jpg", "t.png.gif"] {
        folder.bad(&["image", "torus", "--image", "16", "-o", name], &[name, "PNG", ".png"]);
        assert!(!folder.path(name).exists());
    }
    folder.good(&["image", "torus", "--image", "16", "-o", "T.PNG"]);
    folder.good(&["image", "torus", "--image", "16", "-o", "bare"]);
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_faceoff"))
        .args(["image", "torus", "--image", "16", "-o", "-"])
        .current_dir(folder.path("."))
        .output()
        .unwrap();
    assert!(output.status.success());
    assert_eq!(output.stdout, folder.read("T.PNG"));
    assert_eq!(folder.read("bare"), folder.read("T.PNG"));
    assert!(!folder.path("-").exists());
}

#[test]
fn inspect_tells_what_a_mesh_and_a_baked_file_hold() {
    let folder = Folder::new();
    folder.asset("torus.obj");
    folder.asset("torus.bake.ron");
    folder.good(&[
        "bake",
        "torus.obj",
        "-o",
        ".",
        "--faces",
        "--degrees",
        "30",
        "--image",
        "32",
    ]);
    let read = |file: &str| -> Value { serde_json::from_str(&folder.good(&["inspect", file, "--json"])).unwrap() };
    let (raw, recipe, baked) = (read("torus.obj"), read("torus.bake.ron"), read("torus.faceoff"));
    for report in [&raw, &recipe, &baked] {
        assert_eq!(report["triangles"], 240);
        assert_eq!(report["clusters"], 30);
        assert_eq!(report["closed"], true);
        assert_eq!(report["source_hash"], raw["source_hash"]);
        assert!((0.1..0.2).contains(&report["volume"].as_f64().unwrap()));
    }
    assert_eq!((&raw["table"], &recipe["table"]), (&Value::Null, &Value::Null));
    assert_eq!(recipe["settings"]["faces"], true);
    assert_eq!(baked["table"]["directions"], 62);
    assert!(baked["table"]["memory_bytes"].as_u64().unwrap() > 0);
    let text = folder.good(&["inspect", "torus.faceoff"]);
    assert!(
        text.contains("62 directions") && text.contains("240 in 30 clusters"),
        "{text}"
    );
    folder.bad(&["inspect", "none.obj"], &["none.obj"]);
}

#[test]
fn frames_show_the_bodies_of_every_kth_step_and_of_the_last() {
    let folder = Folder::new();
    folder.good(&[
        "simulate",
        "--bodies",
        "30",
        "--steps",
        "5",
        "--frames",
        "deep/frames",
        "--every",
        "2",
    ]);
    let mut files: Vec<_> = std::fs::read_dir(folder.path("deep/frames"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    files.sort_unstable();
    assert_eq!(files, ["frame_000002.png", "frame_000004.png", "frame_000005.png"]);
    let [first, last] = ["deep/frames/frame_000002.png", "deep/frames/frame_000005.png"].map(|f| png(&folder, f));
    assert_eq!(first.dimensions(), (960, 720));
    let bodies = coloured(&first, [0, 0], 960);
    assert!((20_000..400_000).contains(&bodies), "{bodies} coloured pixels");
    assert_ne!(first, last, "the bodies move");
    folder.write("file", "");
    folder.bad(
        &["simulate", "--bodies", "1", "--steps", "1", "--frames", "file/x"],
        &["file/x"],
    );
    folder.bad(
        &["simulate", "--bodies", "1", "--steps", "1", "--json", "file/x"],
        &["file/x"],
    );
}

#[test]
fn what_is_flat_is_not_black() {
    let folder = Folder::new();
    folder.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
    let run = folder.run(&["image", "flat.obj", "--image", "64", "-o", "flat.png"]);
    assert!(run.success, "{}", run.stderr);
    let middle = png(&folder, "flat.png").get_pixel(12 + 32, 32 + 32).0;
    // The colour of the highest heights.
    assert_eq!(middle, [253, 231, 37]);
}
