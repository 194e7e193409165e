//! Bakes meshes ahead of time with Bevy's asset processor. Source files are in one folder, the assets that a game ships
//! with in another.
//!
//! `cargo run --release --example bake_assets`
//!
//! It runs an app on the same assets three times. The first run bakes. The second has nothing to bake. The third is the
//! game as players get it, without a processor and without source files. All folders are temporary.
//!
//! A game sets `AssetPlugin::mode` to `AssetMode::Processed`, as here, and keeps the defaults for the rest: the folders
//! `assets` and `imported_assets`, and a processor if Bevy's feature `asset_processor` is on.

use bevy::app::ScheduleRunnerPlugin;
use bevy::asset::LoadState;
use bevy::asset::processor::{AssetProcessor, FileTransactionLogFactory};
use bevy::prelude::*;
use bevy::tasks::block_on;
use bevy_faceoff::asset::to_obj;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;
use std::error::Error;
use std::path::Path;
use std::time::{Duration, Instant, SystemTime};

const RECIPE: &str = "knot.bake.ron";

fn main() -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let folder = folder.path();
    let sources = folder.join("assets");
    std::fs::create_dir(&sources)?;
    std::fs::write(sources.join("knot.obj"), to_obj(&shapes::knot_1120()))?;
    std::fs::write(
        sources.join(RECIPE),
        "(mesh: \"knot.obj\", settings: (faces: true, degrees: 3))",
    )?;

    let first = start(folder, true)?;
    let baked_at = time_of_bake(folder)?;
    // With a coarse clock two bakes in quick succession could have the same time.
    std::thread::sleep(Duration::from_millis(50));
    let second = start(folder, true)?;
    assert_eq!(time_of_bake(folder)?, baked_at, "the second run baked again");
    println!("the second run baked nothing");

    std::fs::remove_dir_all(&sources)?;
    let shipped = start(folder, false)?;
    assert!(first == second && second == shipped, "all three are the same mesh");
    println!("the third run did not need {}", sources.display());
    Ok(())
}

/// Runs the app once: loads the recipe and prints how long it took.
fn start(folder: &Path, process: bool) -> Result<CollisionMesh, Box<dyn Error>> {
    let began = Instant::now();
    let text = |path: &Path| path.to_string_lossy().into_owned();
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins.build().disable::<ScheduleRunnerPlugin>(),
        FaceoffHeadlessPlugins {
            assets: AssetPlugin {
                mode: AssetMode::Processed,
                file_path: text(&folder.join("assets")),
                processed_file_path: text(&folder.join("imported_assets")),
                use_asset_processor_override: Some(process),
                ..default()
            },
            ..default()
        },
    ));
    // By default Bevy writes its transaction log, from which it recovers after a crash, into the working folder.
    if let Some(processor) = app.world().get_resource::<AssetProcessor>() {
        let file_path = folder.join("log");
        processor
            .data()
            .set_log_factory(Box::new(FileTransactionLogFactory { file_path }))
            .map_err(|_| "the processor has begun already")?;
    }
    app.finish();
    app.cleanup();

    let server = app.world().resource::<AssetServer>().clone();
    let handle: Handle<CollisionMesh> = server.load(RECIPE);
    let mesh = loop {
        app.update();
        match server.load_state(&handle) {
            LoadState::Failed(error) => return Err(error.to_string().into()),
            _ if began.elapsed() > Duration::from_secs(300) => return Err("it takes too long".into()),
            _ => {}
        }
        if let Some(mesh) = app.world().resource::<Assets<CollisionMesh>>().get(&handle) {
            break mesh.clone();
        }
        std::thread::sleep(Duration::from_millis(1));
    };
    if let Some(processor) = app.world().get_resource::<AssetProcessor>().cloned() {
        block_on(processor.data().wait_until_finished());
    }
    println!(
        "{}: {RECIPE} loaded after {:.0} ms, {mesh:?}",
        if process { "with processor" } else { "as shipped" },
        began.elapsed().as_secs_f64() * 1e3
    );
    Ok(mesh)
}

fn time_of_bake(folder: &Path) -> std::io::Result<SystemTime> {
    folder.join("imported_assets").join(RECIPE).metadata()?.modified()
}
