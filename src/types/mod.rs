//! The words that users and stages share: kinds of bodies, materials, settings. Plain data, without an engine; with the
//! feature `bevy` they are components and resources.

pub mod body;
pub mod feature_id;
pub mod material;
pub mod settings;
pub mod solver_settings;
pub mod stage;
