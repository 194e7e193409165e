//! Exact meshes in Avian.

mod chains;
mod colliders;
mod contacts;
mod engine_features;
mod engine_scenes;
mod rest;
mod sliding;
mod steps;
mod waiting;
mod world;
