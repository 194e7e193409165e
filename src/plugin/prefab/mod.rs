//! Colliders for whole scenes: [`MeshColliderHierarchy`]. Needs the feature `bevy_gltf`.
//!
//! # Where settings come from
//!
//! Later ones override earlier ones, field by field:
//!
//! 1. [`MeshColliderHierarchy::default`];
//! 2. properties in the glTF file: those of the material, then of the mesh, then of the node;
//! 3. [`MeshColliderHierarchy::by_name`]: the name of the mesh, then of the entity with the `Mesh3d`, then of the node.
//!
//! # Properties in glTF files
//!
//! In Blender they are *custom properties* of an object, of its mesh (the tab Data) or of a material, exported with
//! *Include, Custom Properties*. In a glTF file they are the `extras` of nodes, meshes and materials.
//!
//! | property | value | of | effect |
//! |---|---|---|---|
//! | `faceoff` | `"none"` or `false` | object, mesh, material | no collider |
//! | | `"collider"` or `true` | object, mesh, material | a collider, also where the default is none |
//! | | `"sensor"` | object, mesh, material | a collider that is a [`Sensor`](crate::plugin::components::Sensor) |
//! | `faceoff_density` | a number above 0, kg/m^3 | object, mesh, material | [`Density`](crate::plugin::components::Density) |
//! | `faceoff_friction` | a number of 0 or more | object, mesh, material | [`Friction`](crate::types::material::Friction) |
//! | `faceoff_restitution` | a number from 0 to 1 | object, mesh, material | [`Restitution`](crate::types::material::Restitution) |
//! | `faceoff_layers` | a layer from 0 to 31, or a list of them | object, mesh, material | [`CollisionLayers::memberships`](crate::types::body::CollisionLayers::memberships) |
//! | `faceoff_filters` | a layer from 0 to 31, or a list of them | object, mesh, material | [`CollisionLayers::filters`](crate::types::body::CollisionLayers::filters) |
//! | `faceoff_rounding` | a number of 0 or more, mesh units | object, mesh, material | [`ColliderSettings::rounding`] |
//! | `faceoff_body` | `"dynamic"`, `"kinematic"` or `"static"` | object | [`RigidBody`](crate::types::body::RigidBody) |
//! | `faceoff_mass` | a number above 0, kg | object with `faceoff_body` | [`Mass`](crate::plugin::components::Mass) |
//!
//! The properties of an object hold for its own mesh, not for the objects below it. Those of an object with
//! `faceoff_body` also hold for colliders of this body that have none of their own. Properties with other names are
//! left to others. One that begins with `faceoff` and cannot be read is an error, which names the node and the file;
//! all others take effect.
//!
//! # Baked meshes and recipes beside the file
//!
//! For the mesh `Gear` of `machine.glb` the file `machine_Gear.faceoff` is used if it exists, or else the recipe
//! `machine_Gear.bake.ron`, in the same folder:
//!
//! ```ron
//! (mesh: "machine.glb", part: (mesh: "Gear"), settings: (faces: true))
//! ```
//!
//! Keep the recipe beside the baked file while you work on the scene. It tells what the file was baked from: if that
//! has changed since, a warning names both and the mesh is baked anew. Without a recipe nothing tells, because a baked
//! file may be another, simpler mesh on purpose.
//!
//! Other characters than letters, digits and `-` in both names become `_`: `Cube.001` of `house.v2.glb` has the recipe
//! `house_v2_Cube_001.bake.ron`. No file is used for a mesh without a name, with [`ColliderSettings::bake`] or a
//! rounding, for a part of a mesh, or if Bevy's loader has turned the mesh (`GltfConvertCoordinates::rotate_meshes`).

mod error;
mod extras;
mod make;
mod plan;
mod scene_types;
mod scenes;
mod settings;

pub use error::{PrefabError, PrefabFault, PropertyError};
pub use make::MeshColliderHierarchyPlugin;
pub use settings::{ColliderSettings, MeshColliderHierarchy, MeshColliderHierarchyReady};
