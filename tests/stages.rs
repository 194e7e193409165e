//! The stages of a step, one by one, and whole steps, on plain arrays. No engine, no GPU.

mod angles;
mod broad_phase;
mod ccd;
mod dynamics;
mod force_scan;
mod limits;
mod manifolds;
#[path = "common/oracle/mod.rs"]
mod oracle;
mod queries;
mod sleep;
mod solver;
mod triangle_test;
#[path = "common/world.rs"]
mod world;
