//! Bevy's components in glTF scenes.

use crate::plugin::registration::register_hierarchy;
use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::{
    DynamicSkinnedMeshBounds, InheritedVisibility, NoFrustumCulling, ViewVisibility, Visibility, VisibilityClass,
};
use bevy::gltf::*;
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy::transform::components::TransformTreeChanged;

/// Registers the components of nodes and meshes: Bevy spawns scenes of registered components only.
pub(super) fn register(app: &mut App) {
    register_hierarchy(app);
    app.register_type::<TransformTreeChanged>()
        .register_type::<Visibility>()
        .register_type::<InheritedVisibility>()
        .register_type::<ViewVisibility>()
        .register_type::<VisibilityClass>()
        .register_type::<Aabb>()
        .register_type::<NoFrustumCulling>()
        .register_type::<DynamicSkinnedMeshBounds>()
        .register_type::<Mesh3d>()
        .register_type::<SkinnedMesh>()
        .register_type::<MorphWeights>()
        .register_type::<MeshMorphWeights>()
        .register_type::<GltfExtras>()
        .register_type::<GltfSceneExtras>()
        .register_type::<GltfSceneName>()
        .register_type::<GltfMeshExtras>()
        .register_type::<GltfMeshName>()
        .register_type::<GltfMaterialExtras>()
        .register_type::<GltfMaterialName>();
}
