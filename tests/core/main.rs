//! The core alone, without an engine: `cargo test --no-default-features --test core`.

mod contacts;
mod features;
mod placed;
mod scene;
mod step;
