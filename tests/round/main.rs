//! Rounded meshes: balls, capsules and rounded boxes, against theory and against closed forms. No engine, no GPU.

mod bounce;
mod closed_forms;
mod distance;
mod ghosts;
mod rays;
mod rolling;
#[path = "../common/world.rs"]
#[allow(dead_code, reason = "other tests use the rest")]
mod world;
