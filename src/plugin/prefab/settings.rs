//! The component, its settings and its event.

use super::error::PrefabError;
use super::make::Making;
use crate::plugin::components::{ColliderToCome, Density, Mass};
use crate::projection::BakeSettings;
use crate::types::body::{CollisionLayers, RigidBody};
use crate::types::material::{Friction, Restitution};
use bevy::ecs::entity::MapEntities;
use bevy::ecs::reflect::ReflectMapEntities;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;

/// Makes a [`MeshCollider`](crate::plugin::components::MeshCollider) for every mesh below its entity: for a whole glTF
/// scene, if it stands beside Bevy's `WorldAssetRoot`.
///
/// ```no_run
/// # use bevy::prelude::*;
/// # use bevy_faceoff::prelude::*;
/// fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
///     let mut cart = commands.spawn((
///         WorldAssetRoot(assets.load("cart.glb#Scene0")),
///         // One body with the shape of all meshes of the scene. Without a `RigidBody` they are static.
///         RigidBody::Dynamic,
///         MeshColliderHierarchy::default()
///             .with_collider_for_name(
///                 "Wheel",
///                 ColliderSettings {
///                     friction: Some(Friction::new(1.0)),
///                     ..default()
///                 },
///             )
///             .without_collider_for_name("Curtain"),
///     ));
///     cart.observe(|ready: On<MeshColliderHierarchyReady>| {
///         info!("{} colliders, {} errors", ready.colliders.len(), ready.errors.len());
///     });
/// }
/// ```
///
/// The colliders are made of the meshes that Bevy has loaded, in the background, once per mesh and settings, however
/// often a scene is spawned, as long as Bevy keeps the mesh. All colliders of a spawned scene appear in the same frame,
/// and [`MeshColliderHierarchyReady`] is triggered. If all meshes are baked already, colliders appear in the frame in
/// which the scene is spawned. Scenes and meshes that are added below later, a `Mesh3d` that is replaced, and a mesh
/// that changes, for example by a hot reload, are followed.
///
/// Settings can be given in the glTF file too, and baked meshes beside it are used: see [`prefab`](super).
///
/// * The primitives of a glTF mesh are one collider on the entity of the first one, because only together they are
///   closed: Blender exports a primitive for each material. Primitives with their own settings are separate colliders.
/// * Entities that have a `MeshCollider` or a `MeshColliderFrom` keep it. So do entities that leave the hierarchy.
/// * Below another `MeshColliderHierarchy`, the other one makes the colliders. The entity itself gets none.
/// * Skinned and morphed meshes collide as they are in the file.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Debug, PartialEq)]
#[require(Making, ColliderToCome)]
pub struct MeshColliderHierarchy {
    /// Settings of all colliders. `None`: no colliders, except where a name or a property of the file asks for one.
    pub default: Option<ColliderSettings>,
    /// Settings by the name of a node, a mesh or an entity with a `Mesh3d`. `None`: no collider.
    pub by_name: HashMap<String, Option<ColliderSettings>>,
}

/// Settings of a collider. What is `None` is left as it is.
#[derive(Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Default, Debug, PartialEq)]
pub struct ColliderSettings {
    /// Makes the node of the collider a body of its own. Colliders of nodes below it are parts of it.
    pub body: Option<RigidBody>,
    /// Mass of that body.
    pub mass: Option<Mass>,
    /// Density of the collider.
    pub density: Option<Density>,
    /// Friction of the collider.
    pub friction: Option<Friction>,
    /// Restitution of the collider.
    pub restitution: Option<Restitution>,
    /// Collision layers of the collider.
    pub layers: Option<CollisionLayers>,
    /// Whether the collider is a [`Sensor`](crate::plugin::components::Sensor).
    pub sensor: Option<bool>,
    /// How to bake the mesh. With `None` a baked mesh or recipe beside the file is used if there is one, and the
    /// default otherwise.
    pub bake: Option<BakeSettings>,
    /// Radius of the rounding, mesh units. It takes the place of that in [`ColliderSettings::bake`]; a baked mesh or
    /// recipe beside the file is then not used.
    pub rounding: Option<f32>,
}

/// Triggered on the entity of a [`MeshColliderHierarchy`] when all its colliders are made or refused: after the scene
/// is spawned, and again after later changes below it. It is triggered too if there is nothing to make.
#[derive(EntityEvent, MapEntities, Reflect, Clone, Debug)]
#[reflect(Event, MapEntities, Debug)]
pub struct MeshColliderHierarchyReady {
    /// The entity with the [`MeshColliderHierarchy`].
    #[entities]
    pub entity: Entity,
    /// The entities that got a new collider.
    #[entities]
    pub colliders: Vec<Entity>,
    /// What is wrong, also in the log.
    #[entities]
    pub errors: Vec<PrefabError>,
}

impl Default for MeshColliderHierarchy {
    /// A collider with default settings for every mesh.
    fn default() -> Self {
        Self::new(ColliderSettings::default())
    }
}

impl MeshColliderHierarchy {
    /// A collider with these settings for every mesh.
    pub fn new(default: ColliderSettings) -> Self {
        Self {
            default: Some(default),
            by_name: HashMap::default(),
        }
    }

    /// No colliders, except where a name or a property of the file asks for one.
    pub fn only_named() -> Self {
        Self {
            default: None,
            by_name: HashMap::default(),
        }
    }

    /// This component with a collider with these settings for nodes, meshes and entities of this name.
    pub fn with_collider_for_name(mut self, name: impl Into<String>, settings: ColliderSettings) -> Self {
        self.by_name.insert(name.into(), Some(settings));
        self
    }

    /// Without colliders for nodes, meshes and entities of this name.
    pub fn without_collider_for_name(mut self, name: impl Into<String>) -> Self {
        self.by_name.insert(name.into(), None);
        self
    }
}

impl ColliderSettings {
    /// How to bake the mesh, with the rounding.
    pub(super) fn bake_settings(&self) -> Option<BakeSettings> {
        match self.rounding {
            Some(rounding) => Some(BakeSettings {
                rounding,
                ..self.bake.unwrap_or_default()
            }),
            None => self.bake,
        }
    }

    /// These settings, completed by the settings of `below` where they are `None`.
    pub(super) fn over(&self, below: &Self) -> Self {
        Self {
            body: self.body.or(below.body),
            mass: self.mass.or(below.mass),
            density: self.density.or(below.density),
            friction: self.friction.or(below.friction),
            restitution: self.restitution.or(below.restitution),
            layers: self.layers.or(below.layers),
            sensor: self.sensor.or(below.sensor),
            bake: self.bake.or(below.bake),
            rounding: self.rounding.or(below.rounding),
        }
    }
}

/// One of the sources of settings.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Layer {
    /// Whether there is a collider. `None`: as in the layer below.
    pub collider: Option<bool>,
    pub settings: ColliderSettings,
}

impl Layer {
    /// The layer of an optional setting in the component.
    pub fn of(settings: &Option<ColliderSettings>) -> Self {
        Self {
            collider: Some(settings.is_some()),
            settings: settings.clone().unwrap_or_default(),
        }
    }

    pub fn over(&self, below: &Self) -> Self {
        Self {
            collider: self.collider.or(below.collider),
            settings: self.settings.over(&below.settings),
        }
    }
}
