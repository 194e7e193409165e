//! Steps with contacts, without an app: what bodies do that lie on, hang on and fall onto each other.

mod bullets;
mod meshes;
mod planes;
mod world;
