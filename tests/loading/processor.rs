//! Bevy's asset processor: recipes are baked once, and again when something has changed.

use crate::asset_app::*;
use crate::gltf_files::Gltf;
use crate::log;
use bevy::asset::io::{AssetSourceBuilder, AssetSourceEvent, AssetSourceId, AssetWatcher};
use bevy::asset::processor::{AssetProcessor, FileTransactionLogFactory, ProcessorState};
use bevy::prelude::*;
use bevy::tasks::block_on;
use bevy_faceoff::asset::format::{self, BAKER_VERSION};
use bevy_faceoff::asset::{CollisionMesh, Imported, import_file, to_obj};
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::plugin::assets::processor::ProcessorSettings;
use bevy_faceoff::plugin::assets::register;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};
use tracing::Level;

const RECIPES: [&str; 3] = ["cube.bake.ron", "sub/torus.bake.ron", "scene.bake.ron"];

fn assets(folder: &Path) -> PathBuf {
    folder.join("assets")
}

fn imported(folder: &Path) -> PathBuf {
    folder.join("imported")
}

fn plugin(folder: &Path, process: bool) -> AssetPlugin {
    AssetPlugin {
        file_path: assets(folder).to_string_lossy().into_owned(),
        processed_file_path: imported(folder).to_string_lossy().into_owned(),
        mode: AssetMode::Processed,
        watch_for_changes_override: Some(false),
        use_asset_processor_override: Some(process),
        ..default()
    }
}

/// One start of a program under development: processes what there is to process, and loads all recipes.
fn develop(folder: &Path) -> Vec<Result<CollisionMesh, String>> {
    let mut app = app(plugin(folder, true));
    start(&mut app, folder);
    finish_processing(&mut app);
    RECIPES.map(|recipe| loaded(&mut app, recipe)).to_vec()
}

/// Sets a program under development up.
fn start(app: &mut App, folder: &Path) {
    let processor = app.world().resource::<AssetProcessor>().clone();
    let file_path = folder.join("log");
    processor
        .data()
        .set_log_factory(Box::new(FileTransactionLogFactory { file_path }))
        .unwrap();
    register(app);
    finish(app);
}

/// Bevy 0.19 sometimes never ends a load that was asked for while it bakes: on a busy machine in three of ten runs.
fn finish_processing(app: &mut App) {
    let processor = app.world().resource::<AssetProcessor>().clone();
    update_until(app, |_| block_on(processor.get_state()) == ProcessorState::Finished);
}

/// A released game: no processor, and no source files.
fn play(folder: &Path) -> Vec<Result<CollisionMesh, String>> {
    let mut app = app(plugin(folder, false));
    register(&mut app);
    finish(&mut app);
    RECIPES.map(|recipe| loaded(&mut app, recipe)).to_vec()
}

/// When each recipe was baked.
fn bakes(folder: &Path) -> BTreeMap<&'static str, SystemTime> {
    // Coarse clocks give two bakes in quick succession the same time.
    std::thread::sleep(Duration::from_millis(20));
    RECIPES
        .map(|recipe| {
            (
                recipe,
                imported(folder).join(recipe).metadata().unwrap().modified().unwrap(),
            )
        })
        .into()
}

/// Which recipes a start bakes.
fn baked_by(folder: &Path) -> Vec<&'static str> {
    let before = bakes(folder);
    for mesh in develop(folder) {
        mesh.unwrap();
    }
    let after = bakes(folder);
    RECIPES
        .into_iter()
        .filter(|recipe| before[recipe] != after[recipe])
        .collect()
}

fn project() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let at = assets(folder.path());
    write(&at, "cube.obj", to_obj(&shapes::cube(1.0)));
    write(&at, "cube.bake.ron", "(mesh: \"cube.obj\")");
    write(&at, "torus.obj", to_obj(&shapes::torus_240()));
    write(
        &at,
        "sub/torus.bake.ron",
        "(mesh: \"../torus.obj\", settings: (faces: true, degrees: 45, image: 16))",
    );
    let scene = Gltf::of(&shapes::ball_320());
    write(&at, "scene.gltf", scene.with_uri("scene.bin"));
    write(&at, "scene.bin", &scene.bin);
    write(&at, "scene.bake.ron", "(mesh: \"scene.gltf\")");
    folder
}

fn triangles(meshes: &[Result<CollisionMesh, String>]) -> Vec<usize> {
    meshes
        .iter()
        .map(|m| m.as_ref().unwrap().mesh.triangles().len())
        .collect()
}

#[test]
fn recipes_are_baked_once_and_in_place() {
    let _beside = beside_others();
    let folder = project();
    let folder = folder.path();
    let developed = develop(folder);
    assert_eq!(triangles(&developed), [12, 240, 320]);
    for (recipe, mesh) in RECIPES.iter().zip(&developed) {
        let bytes = std::fs::read(imported(folder).join(recipe)).unwrap();
        let (baked, header) = format::from_bytes(&bytes).unwrap();
        assert_eq!(&baked, mesh.as_ref().unwrap());
        assert_eq!(header.settings.faces, recipe.contains("torus"));
        let on_disk = import_file(imported(folder).join(recipe)).unwrap();
        assert!(matches!(on_disk, Imported::Baked { mesh, .. } if mesh == baked));
        // The folder of assets stays what it was.
        assert!(
            std::fs::read(assets(folder).join(recipe))
                .unwrap()
                .starts_with(b"(mesh")
        );
    }
    // bevyengine/bevy#14189: a second start has nothing to do.
    assert_eq!(baked_by(folder), [""; 0]);
    assert_eq!(baked_by(folder), [""; 0]);
    std::fs::remove_dir_all(assets(folder)).unwrap();
    assert_eq!(play(folder), developed);
}

#[test]
fn changes_are_baked_again() {
    let _beside = beside_others();
    let folder = project();
    let folder = folder.path();
    develop(folder);
    let at = assets(folder);
    write(&at, "torus.obj", to_obj(&shapes::cube(2.0)));
    assert_eq!(baked_by(folder), ["sub/torus.bake.ron"]);
    assert_eq!(triangles(&play(folder)), [12, 12, 320]);

    let scene = Gltf::of(&shapes::torus_240());
    write(&at, "scene.gltf", scene.with_uri("scene.bin"));
    write(&at, "scene.bin", &scene.bin);
    assert_eq!(baked_by(folder), ["scene.bake.ron"]);
    let mut bin = scene.bin.clone();
    bin[3] ^= 1;
    write(&at, "scene.bin", bin);
    assert_eq!(baked_by(folder), ["scene.bake.ron"]);

    write(
        &at,
        "cube.bake.ron",
        "(mesh: \"cube.obj\", settings: (faces: true, degrees: 90, image: 16))",
    );
    assert_eq!(baked_by(folder), ["cube.bake.ron"]);
    assert!(play(folder)[0].as_ref().unwrap().faces.is_some());

    // Settings of the processor outrank the recipe; a new version of the baker is nothing but another setting.
    for (version, degrees) in [(BAKER_VERSION, 45), (BAKER_VERSION, 30), (BAKER_VERSION + 1, 30)] {
        let meta = format!(
            "(meta_format_version: \"1.0\", asset: Process(\
             processor: \"bevy_faceoff::plugin::assets::processor::CollisionMeshProcessor\", \
             settings: (baker_version: {version}, bake: Some((faces: true, degrees: {degrees}, image: 16)))))"
        );
        write(&at, "cube.bake.ron.meta", meta);
        assert_eq!(baked_by(folder), ["cube.bake.ron"]);
        assert_eq!(play(folder)[0].as_ref().unwrap().settings.degrees, degrees);
        assert_eq!(baked_by(folder), [""; 0]);
    }
}

#[test]
fn the_version_is_part_of_what_bevy_hashes() {
    let _beside = beside_others();
    let text = ron::to_string(&ProcessorSettings::default()).unwrap();
    assert!(text.contains(&format!("baker_version:{BAKER_VERSION}")), "{text}");
}

#[test]
fn a_broken_mesh_is_an_error_until_it_is_mended() {
    let _beside = beside_others();
    let folder = project();
    let folder = folder.path();
    let at = assets(folder);
    write(&at, "cube.obj", "v 1 2\n");
    let developed = develop(folder);
    assert!(developed[0].is_err());
    assert!(developed[1].is_ok() && developed[2].is_ok());
    write(&at, "cube.obj", to_obj(&shapes::cube(1.0)));
    assert_eq!(triangles(&develop(folder)), [12, 240, 320]);
}

/// Tells Bevy what changed in the folder of assets.
struct Watcher;

impl AssetWatcher for Watcher {}

fn has_triangles(app: &mut App, handle: &Handle<CollisionMesh>, count: usize) -> bool {
    let meshes = app.world().resource::<Assets<CollisionMesh>>();
    meshes
        .get(handle)
        .is_some_and(|mesh| mesh.mesh.triangles().len() == count)
}

#[test]
fn what_is_baked_after_it_was_loaded_is_swapped_in() {
    let _beside = beside_others();
    let folder = project();
    let folder = folder.path();
    let mut app = App::new();
    let (sender, changes) = std::sync::mpsc::channel();
    let [from, to] = [assets(folder), imported(folder)].map(|path| path.to_string_lossy().into_owned());
    let source = AssetSourceBuilder::platform_default(&from, Some(&to)).with_watcher(move |events| {
        sender.send(events).unwrap();
        Some(Box::new(Watcher))
    });
    app.register_asset_source(AssetSourceId::Default, source).add_plugins((
        MinimalPlugins.build().disable::<bevy::app::ScheduleRunnerPlugin>(),
        plugin(folder, true),
    ));
    start(&mut app, folder);
    let changes = changes.recv().unwrap();
    finish_processing(&mut app);
    let handles = RECIPES.map(|recipe| server(&app).load::<CollisionMesh>(recipe));
    for (handle, count) in handles.iter().zip([12, 240, 320]) {
        settle(&mut app, handle).unwrap();
        assert!(has_triangles(&mut app, handle, count));
    }
    let change = |app: &mut App, name: &str, text: String, done: &dyn Fn(&mut App) -> bool| {
        write(&assets(folder), name, text);
        changes.try_send(AssetSourceEvent::ModifiedAsset(name.into())).unwrap();
        update_until(app, done);
    };
    let [cube, torus, scene] = &handles;
    change(&mut app, "cube.obj", to_obj(&shapes::torus_240()), &|app| {
        has_triangles(app, cube, 240)
    });
    let coarse = "(mesh: \"../torus.obj\", settings: (faces: true, degrees: 90, image: 16))";
    change(&mut app, "sub/torus.bake.ron", coarse.into(), &|app| {
        let meshes = app.world().resource::<Assets<CollisionMesh>>();
        meshes.get(torus).unwrap().settings.degrees == 90
    });
    // What is broken changes nothing until it is mended.
    write(&assets(folder), "cube.obj", "v 1 2\n");
    changes
        .try_send(AssetSourceEvent::ModifiedAsset("cube.obj".into()))
        .unwrap();
    for _ in 0..50 {
        app.update();
        std::thread::sleep(Duration::from_millis(1));
    }
    assert!(has_triangles(&mut app, cube, 240));
    change(&mut app, "cube.obj", to_obj(&shapes::cube(2.0)), &|app| {
        has_triangles(app, cube, 12)
    });
    assert!(has_triangles(&mut app, scene, 320));
}

#[test]
fn processed_meshes_are_loaded_through_recipes_and_the_log_says_so() {
    if log::ran_alone("processor::processed_meshes_are_loaded_through_recipes_and_the_log_says_so") {
        return;
    }
    let _beside = beside_others();
    log::keep(&[Level::ERROR]);
    let folder = project();
    let folder = folder.path();
    let baked = CollisionMesh::new(&shapes::knot_1120());
    write(&assets(folder), "knot.faceoff", format::to_bytes(&baked, [0; 32]));
    let facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
    write(&assets(folder), "cube.stl", format!("solid\n{facet}endsolid\n"));
    develop(folder);
    for process in [true, false] {
        let mut app = app(plugin(folder, process));
        if process {
            start(&mut app, folder);
            finish_processing(&mut app);
        } else {
            register(&mut app);
            finish(&mut app);
        }
        assert_eq!(loaded(&mut app, "knot.faceoff").unwrap(), baked);
        for raw in ["cube.obj", "scene.gltf", "cube.stl"] {
            log::lines().clear();
            loaded(&mut app, raw).unwrap_err();
            app.update();
            let errors = log::lines();
            let told = |error: &&String| error.starts_with(raw) && error.contains(&format!("(mesh: \"{raw}\")"));
            assert_eq!(errors.iter().filter(told).count(), 1, "{errors:?}");
        }
    }
}
