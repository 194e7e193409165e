//! Collision meshes as assets of an app: loaders, processor, hot reload, and bakes beside a running app.

#[path = "../common/asset_app.rs"]
mod asset_app;
mod bake_beside_steps;
mod gltf;
#[path = "../common/gltf_files.rs"]
mod gltf_files;
mod hot_reload;
mod loader;
#[path = "../common/log.rs"]
mod log;
mod processor;
