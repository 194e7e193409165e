//! Meshes before they move: geometry, the bake by height projection, and their files. No engine, no GPU.

mod asset;
mod geometry;
#[path = "common/gltf_files.rs"]
mod gltf_files;
#[path = "common/oracle/mod.rs"]
mod oracle;
#[path = "common/ply_files.rs"]
mod ply_files;
mod projection;
#[path = "common/stl_files.rs"]
mod stl_files;
