//! What can be wrong with the scene of a [`MeshColliderHierarchy`](super::MeshColliderHierarchy).

use crate::plugin::assets::MeshBakeError;
use bevy::asset::{AssetLoadError, AssetPath};
use bevy::ecs::entity::MapEntities;
use bevy::prelude::*;
use std::fmt;
use std::sync::Arc;
use thiserror::Error;

/// Something in a scene that gives no collider, or not the wanted one.
#[derive(MapEntities, Reflect, Clone, Debug)]
#[reflect(opaque, Clone, Debug)]
pub struct PrefabError {
    /// The entity of the node or mesh, or of the `WorldAssetRoot`.
    #[entities]
    pub entity: Entity,
    /// The name of the node, or else of the entity.
    pub node: String,
    /// The file, if the mesh or scene is from one.
    pub file: Option<AssetPath<'static>>,
    /// What is wrong.
    pub fault: PrefabFault,
}

/// What is wrong in a [`PrefabError`].
#[derive(Clone, Debug, Error)]
pub enum PrefabFault {
    /// The scene could not be loaded, so it has no colliders.
    #[error("the scene is not loaded: {0}")]
    Scene(Arc<AssetLoadError>),
    /// The mesh could not be baked, so it has no collider.
    #[error("it has no collider: {0}")]
    Mesh(#[from] MeshBakeError),
    /// A property in the file has no effect.
    #[error(transparent)]
    Property(#[from] PropertyError),
}

/// Why a property in the `extras` of a glTF file has no effect.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PropertyError {
    /// No property has this name.
    #[error("there is no property {0}; there are {known}", known = super::extras::KNOWN.join(", "))]
    Unknown(String),
    /// The value is not usable.
    #[error("its property {key} is {value}, but must be {expected}")]
    Value {
        /// The name of the property.
        key: String,
        /// The value as it is in the file.
        value: String,
        /// The possible values.
        expected: &'static str,
    },
    /// The property belongs to an object.
    #[error("its property {0} belongs to the object (the node), not to its mesh or material")]
    NotOnNode(String),
    /// The object has neither a mesh nor a body to which the property could apply.
    #[error("its property {0} has no effect, because the object has neither a mesh of its own nor a faceoff_body")]
    NoMesh(String),
    /// The object has no body to which the property could apply.
    #[error("its property {0} has no effect without faceoff_body")]
    NoBody(String),
}

impl fmt::Display for PrefabError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.node)?;
        if let Some(file) = &self.file {
            write!(f, " of {file}")?;
        }
        write!(f, ": {}", self.fault)
    }
}

impl std::error::Error for PrefabError {}
