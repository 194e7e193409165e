//! Steps with contacts, without an app: what bodies do that lie on, hang on and fall onto each other.

mod bounce;
mod bullets;
mod chain;
mod cloud;
mod elastic;
mod incline;
mod meshes;
mod motion;
mod planes;
mod pour;
mod rest;
mod same_bits;
mod small_games;
mod spin;
mod thread;
