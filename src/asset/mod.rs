//! Baked meshes, their file format, and the readers and writers of mesh files.
//!
//! A [`CollisionMesh`] is baked from vertices and faces by [`CollisionMesh::new`], or read from a file by
//! [`import_file`]. Bevy's asset server can load one too; the plugin registers a loader.

mod bytes;
pub mod collision_mesh;
mod ears;
pub mod format;
mod format_error;
pub mod gltf;
pub mod import;
mod import_error;
mod obj;
mod obj_part;
mod off;
pub mod origin;
mod part;
mod ply;
mod polygons;
mod primitives;
pub mod recipe;
mod stl;
mod text;
mod warnings;

pub use collision_mesh::{BakedMesh, CollisionMesh};
pub use gltf::GltfError;
pub use import::{ImportError, Imported, import_bytes, import_file, import_part};
pub use obj::to_obj;
pub use off::to_off;
pub use origin::{Origin, input_files};
pub use part::{MeshPart, NameOrIndex};
pub use ply::to_ply;
pub use primitives::{SIDES, ShapeError};
pub use recipe::Recipe;
pub use stl::to_stl;
