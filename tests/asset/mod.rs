//! Files of meshes and of baked meshes, good and hostile ones.

mod format;
mod gltf;
mod hostile;
mod hostile_gltf;
mod import;
mod lenient;
mod off;
mod origin;
mod other_kinds;
mod other_readers;
mod outside;
mod parts;
mod ply;
mod polygons;
mod stl;
mod writers;
