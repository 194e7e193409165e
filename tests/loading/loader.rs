//! Collision meshes through Bevy's asset server, in an app without window or renderer.

use crate::asset_app::{alone, app, finish, plain, server, write};
use crate::log;
use bevy::app::ScheduleRunnerPlugin;
use bevy::asset::{AssetLoader, LoadContext, LoadState, io::Reader};
use bevy::prelude::*;
use bevy_faceoff::asset::{CollisionMesh, format, to_obj};
use bevy_faceoff::geometry::{Orientation, shapes};
use bevy_faceoff::plugin::assets::{CollisionMeshSettings, register};
use bevy_faceoff::projection::BakeSettings;
use std::sync::RwLockWriteGuard;
use std::time::{Duration, Instant};
use tempfile::TempDir;
use tracing::Level;

/// Another asset, loaded by another loader that does next to nothing.
#[derive(Asset, TypePath)]
struct Text(#[allow(dead_code)] String);

#[derive(TypePath)]
struct TextLoader;

impl AssetLoader for TextLoader {
    type Asset = Text;
    type Settings = ();
    type Error = std::io::Error;
    async fn load(&self, reader: &mut dyn Reader, _: &(), _: &mut LoadContext<'_>) -> std::io::Result<Text> {
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes).await?;
        Ok(Text(String::from_utf8_lossy(&bytes).into_owned()))
    }
    fn extensions(&self) -> &[&str] {
        &["txt", "obj"]
    }
}

const FACET_STL: &[u8] = b"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n\
                           endfacet\nendsolid\n";

struct Stage {
    app: App,
    folder: TempDir,
    _alone: RwLockWriteGuard<'static, ()>,
}

impl Stage {
    /// An app over a folder with these files.
    fn new(files: &[(&str, &[u8])]) -> Self {
        let alone = alone();
        let folder = tempfile::tempdir().unwrap();
        for (name, bytes) in files {
            write(folder.path(), name, bytes);
        }
        let mut app = app(plain(folder.path()));
        assert!(register(&mut app));
        app.init_asset::<Text>().register_asset_loader(TextLoader);
        finish(&mut app);
        Self {
            app,
            folder,
            _alone: alone,
        }
    }

    /// Lets go of a bake that still runs: Bevy learns of dropped handles in its updates.
    fn abandon(&mut self, handle: Handle<CollisionMesh>) {
        drop(handle);
        for _ in 0..3 {
            self.app.update();
        }
    }

    fn server(&self) -> AssetServer {
        server(&self.app)
    }

    fn load(&self, path: &str) -> Handle<CollisionMesh> {
        self.server().load(path.to_owned())
    }

    /// Runs the app until `handle` is loaded or has failed; returns how long the slowest update took.
    fn settle<A: Asset>(&mut self, handle: &Handle<A>) -> Duration {
        let start = Instant::now();
        let mut slowest = Duration::ZERO;
        loop {
            let update = Instant::now();
            self.app.update();
            slowest = slowest.max(update.elapsed());
            match self.server().load_state(handle) {
                LoadState::Loaded | LoadState::Failed(_) => return slowest,
                _ => assert!(start.elapsed() < Duration::from_secs(120), "never settles"),
            }
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    fn loaded(&mut self, path: &str) -> CollisionMesh {
        let handle = self.load(path);
        self.settle(&handle);
        self.get(&handle)
    }

    fn get(&self, handle: &Handle<CollisionMesh>) -> CollisionMesh {
        match self.server().load_state(handle) {
            LoadState::Failed(error) => panic!("{error}"),
            state => assert!(state.is_loaded()),
        }
        self.app
            .world()
            .resource::<Assets<CollisionMesh>>()
            .get(handle)
            .unwrap()
            .clone()
    }

    fn failure(&mut self, path: &str) -> String {
        let handle = self.load(path);
        self.settle(&handle);
        match self.server().load_state(&handle) {
            LoadState::Failed(error) => error.to_string(),
            _ => panic!("{path} loaded"),
        }
    }
}

fn torus_obj() -> String {
    to_obj(&shapes::torus_240())
}

/// A bake of many seconds.
fn long_bake() -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("long.obj", to_obj(&shapes::torus(150, 100, 0.7, 0.3)).into_bytes()),
        (
            "long.bake.ron",
            b"(mesh: \"long.obj\", settings: (faces: true, degrees: 1, image: 1024))".to_vec(),
        ),
    ]
}

fn stage_with_long_bake(more: &[(&str, &[u8])]) -> Stage {
    let long = long_bake();
    let mut files: Vec<(&str, &[u8])> = long.iter().map(|(n, b)| (*n, b.as_slice())).collect();
    files.extend(more);
    Stage::new(&files)
}

#[test]
fn all_kinds_of_files() {
    let obj = torus_obj();
    let settings = BakeSettings {
        faces: true,
        degrees: 30,
        image: 32,
        ..BakeSettings::default()
    };
    let faceoff = format::to_bytes(&CollisionMesh::new(&shapes::knot_1120()), [0; 32]);
    let mut stage = Stage::new(&[
        ("knot.faceoff", &faceoff),
        ("meshes/torus.obj", obj.as_bytes()),
        (
            "sub/deep.bake.ron",
            b"(mesh: \"../meshes/torus.obj\", settings: (faces: true, degrees: 30, image: 32))",
        ),
        ("plain.bake.ron", b"(mesh: \"meshes/torus.obj\")"),
        ("facet.stl", FACET_STL),
        ("facet.bake.ron", b"(mesh: \"facet.stl\")"),
        (
            "knot.bake.ron",
            b"(mesh: \"knot.faceoff\", settings: (faces: true, degrees: 45, image: 16))",
        ),
    ]);
    assert_eq!(stage.loaded("knot.faceoff"), CollisionMesh::new(&shapes::knot_1120()));
    let by_type = stage.loaded("meshes/torus.obj");
    assert_eq!(by_type, CollisionMesh::new(&shapes::torus_240()));
    assert_eq!(by_type.mesh.orientation(), Orientation::Outward);
    let deep = stage.loaded("sub/deep.bake.ron");
    assert_eq!(deep.settings, settings);
    assert!(deep.faces.is_some());
    assert_eq!(deep.mesh, by_type.mesh);
    assert_eq!(stage.loaded("plain.bake.ron"), by_type);
    assert_eq!(stage.loaded("facet.stl").mesh.triangles().len(), 1);
    assert_eq!(stage.loaded("facet.bake.ron").mesh.triangles().len(), 1);
    let rebaked = stage.loaded("knot.bake.ron");
    assert!(rebaked.faces.is_some() && rebaked.settings.degrees == 45);
}

#[test]
fn other_loaders_keep_their_files() {
    let obj = torus_obj();
    let mut stage = Stage::new(&[("torus.obj", obj.as_bytes())]);
    let text: Handle<Text> = stage.server().load("torus.obj");
    let mesh = stage.load("torus.obj");
    stage.settle(&text);
    stage.settle(&mesh);
    assert!(stage.server().load_state(&text).is_loaded());
    assert_eq!(stage.get(&mesh).mesh.triangles().len(), 240);
}

#[test]
fn settings_of_a_load_outrank_the_file() {
    let obj = torus_obj();
    let faceoff = format::to_bytes(&CollisionMesh::new(&shapes::torus_240()), [0; 32]);
    let mut stage = Stage::new(&[
        ("torus.obj", obj.as_bytes()),
        ("torus.faceoff", &faceoff),
        ("torus.bake.ron", b"(mesh: \"torus.obj\")"),
    ]);
    let wanted = BakeSettings {
        faces: true,
        degrees: 45,
        image: 16,
        ..BakeSettings::default()
    };
    for path in ["torus.obj", "torus.faceoff", "torus.bake.ron"] {
        let handle: Handle<CollisionMesh> = stage
            .server()
            .load_builder()
            .with_settings(move |s: &mut CollisionMeshSettings| s.bake = Some(wanted))
            .load(path);
        stage.settle(&handle);
        let mesh = stage.get(&handle);
        assert_eq!(mesh.settings, wanted);
        assert!(mesh.faces.is_some());
    }
}

#[test]
fn broken_files_fail_by_name_and_the_app_goes_on() {
    let obj = torus_obj();
    let mut cut = format::to_bytes(&CollisionMesh::new(&shapes::torus_240()), [0; 32]);
    cut.truncate(cut.len() / 2);
    let mut stage = Stage::new(&[
        ("good.obj", obj.as_bytes()),
        ("cut.faceoff", &cut),
        ("empty.faceoff", b""),
        ("bad.obj", b"v 1 2\n"),
        ("nothing.obj", b""),
        ("scene.glb", b"glTF1234"),
        ("syntax.bake.ron", b"(mash: 1)"),
        ("settings.bake.ron", b"(mesh: \"good.obj\", settings: (degrees: 7))"),
        ("missing.bake.ron", b"(mesh: \"gone.obj\")"),
        ("broken.bake.ron", b"(mesh: \"bad.obj\")"),
        ("outside.bake.ron", b"(mesh: \"../../secret.obj\")"),
        ("source.bake.ron", b"(mesh: \"nowhere://good.obj\")"),
        ("loop.bake.ron", b"(mesh: \"loop.bake.ron\")"),
        ("root.bake.ron", b"(mesh: \"/good.obj\")"),
        ("drive.bake.ron", b"(mesh: \"C:/good.obj\")"),
        ("slash.bake.ron", b"(mesh: \"sub\\\\good.obj\")"),
    ]);
    for (path, words) in [
        ("cut.faceoff", vec!["cut.faceoff", "damaged"]),
        ("empty.faceoff", vec!["empty.faceoff", "not a .faceoff"]),
        ("bad.obj", vec!["bad.obj", "line 1"]),
        ("nothing.obj", vec!["nothing.obj", "no faces"]),
        ("scene.glb", vec!["scene.glb", "export it as glTF 2.0"]),
        ("syntax.bake.ron", vec!["syntax.bake.ron", "line 1"]),
        ("settings.bake.ron", vec!["settings.bake.ron", "must divide 90"]),
        ("missing.bake.ron", vec!["missing.bake.ron", "gone.obj"]),
        ("broken.bake.ron", vec!["broken.bake.ron", "bad.obj", "line 1"]),
        ("outside.bake.ron", vec!["outside.bake.ron", "outside the asset folder"]),
        ("source.bake.ron", vec!["source.bake.ron", "nowhere"]),
        ("loop.bake.ron", vec!["loop.bake.ron", "not a mesh file"]),
        (
            "root.bake.ron",
            vec!["root.bake.ron", "\"/good.obj\"", "relative to the recipe"],
        ),
        ("drive.bake.ron", vec!["drive.bake.ron", "relative to the recipe"]),
        ("slash.bake.ron", vec!["slash.bake.ron", "relative to the recipe"]),
        ("absent.faceoff", vec!["absent.faceoff"]),
    ] {
        let message = stage.failure(path);
        for word in words {
            assert!(message.contains(word), "{path}: {message}");
        }
    }
    assert_eq!(stage.loaded("good.obj").mesh.triangles().len(), 240);
}

#[test]
fn reloading_a_recipe_reads_its_mesh_again() {
    // What hot reloading does to whatever read a file that changed.
    let mut stage = Stage::new(&[
        ("mesh.obj", torus_obj().as_bytes()),
        ("mesh.bake.ron", b"(mesh: \"mesh.obj\")"),
    ]);
    let handle = stage.load("mesh.bake.ron");
    stage.settle(&handle);
    assert_eq!(stage.get(&handle).mesh.triangles().len(), 240);
    write(stage.folder.path(), "mesh.obj", to_obj(&shapes::cube(1.0)).as_bytes());
    stage.server().reload("mesh.bake.ron");
    let start = Instant::now();
    while stage.get(&handle).mesh.triangles().len() != 12 {
        assert!(start.elapsed() < Duration::from_secs(30));
        stage.app.update();
        std::thread::sleep(Duration::from_millis(2));
    }
}

#[test]
fn a_long_bake_stalls_nobody() {
    let obj = torus_obj();
    let texts: Vec<(String, Vec<u8>)> = (0..20).map(|i| (format!("{i}.txt"), vec![b'x'])).collect();
    let objs: Vec<(String, &[u8])> = (0..20).map(|i| (format!("{i}.obj"), obj.as_bytes())).collect();
    let mut files: Vec<(&str, &[u8])> = texts.iter().map(|(n, b)| (n.as_str(), b.as_slice())).collect();
    files.extend(objs.iter().map(|(n, b)| (n.as_str(), *b)));
    let mut stage = stage_with_long_bake(&files);
    stage.app.update();

    // Time to load ten other files and ten small meshes, and the slowest update meanwhile.
    let measure = |stage: &mut Stage, first: usize| {
        let start = Instant::now();
        let mut slowest = Duration::ZERO;
        for i in first..first + 10 {
            let text: Handle<Text> = stage.server().load(format!("{i}.txt"));
            slowest = slowest.max(stage.settle(&text));
            let mesh = stage.load(&format!("{i}.obj"));
            slowest = slowest.max(stage.settle(&mesh));
        }
        (start.elapsed() / 10, slowest)
    };
    let quiet = measure(&mut stage, 0);
    let long = stage.load("long.bake.ron");
    let start = Instant::now();
    while start.elapsed() < Duration::from_millis(500) {
        stage.app.update();
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(
        stage.server().load_state(&long).is_loading(),
        "the bake is too short for this test"
    );
    let busy = measure(&mut stage, 10);
    assert!(
        stage.server().load_state(&long).is_loading(),
        "the bake is too short for this test"
    );
    eprintln!("load and slowest update: quiet {quiet:?}, beside a bake {busy:?}");
    for (quiet, busy) in [(quiet.0, busy.0), (quiet.1, busy.1)] {
        assert!(
            busy < quiet * 10 + Duration::from_millis(200),
            "quiet {quiet:?}, busy {busy:?}"
        );
    }
    stage.abandon(long);
}

#[test]
fn dropping_the_handle_cancels_the_bake() {
    let short = b"(mesh: \"torus.obj\", settings: (faces: true, degrees: 45, image: 16))";
    let mut stage = stage_with_long_bake(&[("torus.obj", torus_obj().as_bytes()), ("short.bake.ron", short)]);
    let long = stage.load("long.bake.ron");
    let start = Instant::now();
    while start.elapsed() < Duration::from_millis(500) {
        stage.app.update();
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(
        stage.server().load_state(&long).is_loading(),
        "the bake is too short for this test"
    );
    stage.abandon(long);
    // The pool serves one table after the other, so this one loads soon only if the long one stopped.
    let start = Instant::now();
    assert!(stage.loaded("short.bake.ron").faces.is_some());
    eprintln!("the next table was there after {:?}", start.elapsed());
    assert!(start.elapsed() < Duration::from_secs(5));
}

#[test]
fn registering_without_assets_is_an_error_not_a_panic() {
    let mut app = App::new();
    app.add_plugins(MinimalPlugins.build().disable::<ScheduleRunnerPlugin>());
    assert!(!register(&mut app));
    app.update();
    let mut stage = Stage::new(&[]);
    assert!(register(&mut stage.app));
    stage.app.update();
}

#[test]
fn an_imperfect_mesh_is_named_once_in_the_log() {
    if log::ran_alone("loader::an_imperfect_mesh_is_named_once_in_the_log") {
        return;
    }
    let obj = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 2\nf 1 2\n";
    let mut stage = Stage::new(&[
        ("sheet.obj", obj),
        ("sheet.bake.ron", b"(mesh: \"sheet.obj\")"),
        ("cube.obj", to_obj(&shapes::cube(1.0)).as_bytes()),
    ]);
    log::keep(&[Level::WARN]);
    assert!(stage.loaded("sheet.bake.ron").mass.approximate);
    stage.loaded("sheet.bake.ron");
    stage.loaded("cube.obj");
    for _ in 0..10 {
        stage.app.update();
    }
    let warnings = log::lines();
    assert_eq!(warnings.len(), 3, "{warnings:?}");
    assert!(
        warnings.iter().all(|w| w.starts_with("sheet.bake.ron: ")),
        "{warnings:?}"
    );
    assert!(warnings[0].contains("fewer than three corners"));
    assert!(warnings[1].contains("1 of 2 faces") && warnings[2].contains("open"));
}

/// Bakes as the command line does, with the hash of its source.
fn bake_of(folder: &TempDir, source: &str) -> Vec<u8> {
    let bevy_faceoff::asset::Imported::Mesh { mesh, source_hash, .. } =
        bevy_faceoff::asset::import_file(folder.path().join(source)).unwrap()
    else {
        panic!("{source} is baked already");
    };
    format::to_bytes(&CollisionMesh::new(&mesh), source_hash)
}

#[test]
fn a_baked_file_older_than_its_source_is_told_and_baked_anew() {
    if log::ran_alone("loader::a_baked_file_older_than_its_source_is_told_and_baked_anew") {
        return;
    }
    log::keep(&[Level::WARN]);
    let mut stage = Stage::new(&[
        (
            "parts.obj",
            format!("o Wheel\n{}", to_obj(&shapes::cube(1.0))).as_bytes(),
        ),
        (
            "parts_Wheel.bake.ron",
            b"(mesh: \"parts.obj\", part: (object: \"Wheel\"))",
        ),
        ("alone.obj", to_obj(&shapes::cube(1.0)).as_bytes()),
        ("proxy.obj", to_obj(&shapes::cube(1.0)).as_bytes()),
        ("proxy.stl", FACET_STL),
        ("broken.obj", to_obj(&shapes::cube(1.0)).as_bytes()),
        ("broken.bake.ron", b"(mesh: \"broken.obj\")"),
    ]);
    for (baked, source) in [
        ("parts_Wheel.faceoff", "parts_Wheel.bake.ron"),
        ("alone.faceoff", "alone.obj"),
        ("proxy.faceoff", "proxy.obj"),
        ("broken.faceoff", "broken.bake.ron"),
        ("shipped.faceoff", "alone.obj"),
    ] {
        write(stage.folder.path(), baked, bake_of(&stage.folder, source));
    }
    let all = [
        "parts_Wheel.faceoff",
        "alone.faceoff",
        "proxy.faceoff",
        "broken.faceoff",
        "shipped.faceoff",
    ];
    for name in all {
        assert_eq!(stage.loaded(name).mesh.triangles().len(), 12, "{name}");
    }
    assert_eq!(log::take(), [""; 0], "all are up to date");
    for _ in 0..3 {
        stage.app.update();
    }

    // All sources change but that of the one that is not there.
    let torus = torus_obj();
    let others = [
        ("alone.obj", &*torus),
        ("proxy.obj", &*torus),
        ("broken.obj", "v 1 2\n"),
    ];
    write(stage.folder.path(), "parts.obj", format!("o Wheel\n{torus}"));
    for (name, text) in others {
        write(stage.folder.path(), name, text);
    }
    for (name, triangles, words) in [
        // What the recipe names is the source, so it is baked.
        (
            "parts_Wheel.faceoff",
            240,
            &["parts.obj has changed", "`faceoff bake` with parts_Wheel.bake.ron"][..],
        ),
        // A file of the same name may be another mesh.
        ("alone.faceoff", 12, &["not baked from alone.obj", "bake it again"]),
        ("proxy.faceoff", 12, &["not baked from proxy", "bake it again"]),
        (
            "broken.faceoff",
            12,
            &["broken.obj has changed", "The old mesh is used"],
        ),
        ("shipped.faceoff", 12, &[]),
    ] {
        assert_eq!(stage.loaded(name).mesh.triangles().len(), triangles, "{name}");
        let lines = log::take();
        assert_eq!(lines.len(), usize::from(!words.is_empty()), "{lines:?}");
        for word in words {
            assert!(lines[0].starts_with(name) && lines[0].contains(word), "{lines:?}");
        }
    }

    // Once it is baked again nothing is told.
    write(
        stage.folder.path(),
        "parts_Wheel.faceoff",
        bake_of(&stage.folder, "parts_Wheel.bake.ron"),
    );
    for _ in 0..3 {
        stage.app.update();
    }
    assert_eq!(stage.loaded("parts_Wheel.faceoff").mesh.triangles().len(), 240);
    assert_eq!(log::take(), [""; 0]);
}
