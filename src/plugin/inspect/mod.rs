//! What the tools for development show: where colliders are, and which bodies form islands.
#![cfg_attr(
    not(feature = "debug_gizmos"),
    allow(dead_code, reason = "the panel alone does not use all of it")
)]

pub(crate) mod islands;
pub(crate) mod poses;
