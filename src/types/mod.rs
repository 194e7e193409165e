//! Types that users and stages share: kinds of bodies, materials, settings.
//!
//! They are plain data. With the feature `bevy` they are also components and resources.

pub mod body;
pub mod energy;
pub mod feature_id;
pub mod gpu_work;
pub mod hooks;
pub mod kernel_cache;
pub mod limits;
pub mod material;
pub mod settings;
pub mod solver_settings;
pub mod stage;
