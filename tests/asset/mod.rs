//! Files of meshes and of baked meshes, good and hostile ones.

mod format;
mod gltf;
mod hostile_gltf;
mod import;
mod off;
mod origin;
mod ply;
mod stl;
mod writers;
