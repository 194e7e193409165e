//! An app without window or renderer that loads assets from a folder.
#![allow(dead_code)]

use bevy::app::ScheduleRunnerPlugin;
use bevy::asset::LoadState;
use bevy::prelude::*;
use bevy_faceoff::asset::CollisionMesh;
use std::path::Path;
use std::sync::{RwLock, RwLockReadGuard, RwLockWriteGuard};
use std::time::{Duration, Instant};

/// Apps of a process share one bake pool and the cores of one machine.
static MACHINE: RwLock<()> = RwLock::new(());

/// For tests of waiting times and order: no other test of the process runs meanwhile.
pub fn alone() -> RwLockWriteGuard<'static, ()> {
    MACHINE.write().unwrap_or_else(|e| e.into_inner())
}

/// For tests that may run beside others of this kind.
pub fn beside_others() -> RwLockReadGuard<'static, ()> {
    MACHINE.read().unwrap_or_else(|e| e.into_inner())
}

pub fn write(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) {
    let path = folder.join(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, bytes).unwrap();
}

/// An app that loads assets from `folder`, with plugins yet to be added.
pub fn app(assets: AssetPlugin) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins.build().disable::<ScheduleRunnerPlugin>(), assets));
    app
}

pub fn plain(folder: &Path) -> AssetPlugin {
    AssetPlugin {
        file_path: folder.to_string_lossy().into_owned(),
        ..default()
    }
}

pub fn finish(app: &mut App) {
    app.finish();
    app.cleanup();
}

pub fn server(app: &App) -> AssetServer {
    app.world().resource::<AssetServer>().clone()
}

#[track_caller]
pub fn update_until(app: &mut App, mut done: impl FnMut(&mut App) -> bool) {
    let start = Instant::now();
    while !done(app) {
        assert!(start.elapsed() < Duration::from_secs(60), "it never happens");
        app.update();
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Runs the app until a handle is loaded, or returns the error.
#[track_caller]
pub fn settle<A: Asset>(app: &mut App, handle: &Handle<A>) -> Result<(), String> {
    let server = server(app);
    let state = || server.load_state(handle);
    update_until(app, |_| matches!(state(), LoadState::Loaded | LoadState::Failed(_)));
    match state() {
        LoadState::Failed(error) => Err(error.to_string()),
        _ => Ok(()),
    }
}

#[track_caller]
pub fn loaded(app: &mut App, path: &str) -> Result<CollisionMesh, String> {
    let handle = server(app).load(path.to_owned());
    settle(app, &handle)?;
    Ok(app
        .world()
        .resource::<Assets<CollisionMesh>>()
        .get(&handle)
        .unwrap()
        .clone())
}
