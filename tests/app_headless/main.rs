//! Whole apps without window, renderer or GPU: `MinimalPlugins`, `FaceoffHeadlessPlugins` and a manual clock.

#[path = "../app/mod.rs"]
mod app;

mod clock;
mod contacts;
mod kinds;
mod many;
mod meshes;
mod motion;
mod reports;
mod response;
