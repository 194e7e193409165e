//! What needs more of Bevy than the plugin itself does: its meshes, its glTF loader, its gizmos.

#[cfg(any(
    feature = "bevy_gltf",
    feature = "bevy_picking",
    feature = "debug_panel",
    feature = "interpolation"
))]
#[path = "../common/app.rs"]
mod app;
#[path = "../common/asset_app.rs"]
mod asset_app;
#[cfg(feature = "bevy_gltf")]
mod bevy_gltf;
#[cfg(feature = "bevy_mesh")]
mod bevy_mesh;
#[cfg(all(feature = "bevy_gltf", feature = "bevy_scene", feature = "debug_gizmos"))]
mod bsn;
#[cfg(feature = "debug_gizmos")]
mod debug_gizmos;
#[cfg(feature = "debug_panel")]
mod debug_panel;
#[path = "../common/gltf_files.rs"]
mod gltf_files;
#[cfg(feature = "interpolation")]
mod interpolated_writes;
#[cfg(feature = "interpolation")]
mod interpolation;
#[cfg(feature = "bevy_picking")]
mod picking;
#[cfg(feature = "bevy_gltf")]
mod prefab;
#[cfg(feature = "bevy_gltf")]
mod saved_scenes;
