//! The core alone, without an engine: `cargo test --no-default-features --test core`.

mod casts;
mod contacts;
mod coplanar;
mod features;
mod nearest;
mod overlaps;
mod placed;
mod points;
mod rays;
mod scene;
mod step;
mod support;
