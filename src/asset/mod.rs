//! Baked meshes as Bevy assets: the asset, its file, its loader.
//!
//! A [`CollisionMesh`] comes from a file through Bevy's asset server (see [`loader`]), from a file on disk through
//! [`import::import_file`], or from vertices and faces through [`CollisionMesh::new`].

mod bytes;
pub mod collision_mesh;
pub mod format;
pub mod gltf;
pub mod import;
mod import_error;
mod obj;
pub mod recipe;
mod stl;
mod text;

pub use collision_mesh::{BakedMesh, CollisionMesh};
pub use gltf::{GltfError, MeshChoice, MeshPart};
pub use import::{ImportError, Imported, import_bytes, import_file, import_part};
pub use obj::to_obj;
pub use recipe::Recipe;
