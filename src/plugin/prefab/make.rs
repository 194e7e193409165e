//! Makes the colliders of hierarchies, as soon as their meshes are baked.

use super::error::{PrefabError, PrefabFault};
use super::plan::{Node, PlannedCollider, plan};
use super::scene_types;
use super::scenes::Scenes;
use super::settings::{ColliderSettings, MeshColliderHierarchy, MeshColliderHierarchyReady};
use crate::asset::CollisionMesh;
use crate::plugin::assets::MeshBakeError;
use crate::plugin::assets::mesh_bakes::{BakeAssets, MeshBakes, Source};
use crate::plugin::components::{ColliderToCome, MeshCollider, Sensor};
use crate::plugin::sync::named;
use bevy::app::{SceneSpawnerSystems, SpawnScene};
use bevy::asset::AssetPath;
use bevy::platform::collections::HashSet;
use bevy::prelude::*;
use std::task::Poll;

/// Runs [`MeshColliderHierarchy`]. In an app without Bevy's `MeshPlugin` it logs an error for each entity with this
/// component.
pub struct MeshColliderHierarchyPlugin;

impl Plugin for MeshColliderHierarchyPlugin {
    fn build(&self, app: &mut App) {
        let work = (follow, make)
            .chain()
            // A scene gets its colliders in the frame in which it is spawned.
            .after(SceneSpawnerSystems::WorldInstanceSpawn)
            .run_if(any_with_component::<MeshColliderHierarchy>)
            .run_if(resource_exists::<Assets<Mesh>>);
        scene_types::register(app);
        MeshBakes::register(app);
        app.register_type::<MeshColliderHierarchy>()
            .register_type::<MeshColliderHierarchyReady>()
            .register_type::<ColliderSettings>()
            .add_systems(SpawnScene, work)
            .add_systems(Update, report_no_meshes.run_if(not(resource_exists::<Assets<Mesh>>)));
    }
}

/// The work on a hierarchy.
#[derive(Component)]
pub(super) struct Making {
    /// Whether something below has changed since the last plan.
    changed: bool,
    /// Whether all is done.
    done: bool,
    /// Whether it was done before.
    was_ready: bool,
    colliders: Vec<PlannedCollider>,
    bodies: Vec<(Entity, ColliderSettings)>,
    errors: Vec<PrefabError>,
    /// Errors that an event has told.
    told: HashSet<String>,
}

/// What the collider of an entity was made of, or was to be made of if it was refused.
#[derive(Component, Clone, Debug, PartialEq)]
pub(super) struct MadeFrom {
    pub source: Source,
    pub settings: ColliderSettings,
    /// Whether the mesh has changed since then.
    pub stale: bool,
}

/// A node that was made a body.
#[derive(Component)]
pub(super) struct MadeBody;

impl Default for Making {
    fn default() -> Self {
        Self {
            changed: true,
            done: false,
            was_ready: false,
            colliders: Vec::new(),
            bodies: Vec::new(),
            errors: Vec::new(),
            told: HashSet::default(),
        }
    }
}

/// Logs an error for each hierarchy that gets no colliders because the app has no Bevy meshes.
fn report_no_meshes(waiting: Query<(Entity, Option<&Name>), Added<MeshColliderHierarchy>>) {
    for (entity, name) in &waiting {
        error!(
            "{}: its MeshColliderHierarchy has no effect because there is no Assets<Mesh>: add Bevy's MeshPlugin, which is \
             part of DefaultPlugins",
            named(entity, name)
        );
    }
}

/// Finds the hierarchies in which something has changed.
fn follow(
    bakes: Res<MeshBakes>,
    mut hierarchies: Query<(&mut Making, Ref<MeshColliderHierarchy>)>,
    changed: Query<Entity, Or<(Changed<ChildOf>, Changed<Mesh3d>)>>,
    mut made: Query<(Entity, &mut MadeFrom)>,
    parents: Query<&ChildOf>,
) {
    for (mut making, hierarchy) in &mut hierarchies {
        if hierarchy.is_changed() {
            making.changed = true;
        }
    }
    let mut mark = |entity: Entity| {
        for above in parents.iter_ancestors(entity) {
            if let Ok((mut making, _)) = hierarchies.get_mut(above) {
                making.changed = true;
                return;
            }
        }
    };
    changed.iter().for_each(&mut mark);
    if !bakes.changed.is_empty() {
        for (entity, mut made) in &mut made {
            if made.source.ids().any(|id| bakes.changed.contains(&id)) {
                made.stale = true;
                mark(entity);
            }
        }
    }
}

/// Plans what has changed, and makes the colliders of each plan whose meshes are all baked.
fn make(
    mut commands: Commands,
    mut bakes: ResMut<MeshBakes>,
    mut assets: BakeAssets,
    mut hierarchies: Query<(Entity, &mut Making, &MeshColliderHierarchy)>,
    nodes: Query<Node>,
    made: Query<&MadeFrom>,
    scenes: Scenes,
    // Errors and warnings that are in the log. A scene may be spawned a thousand times.
    mut told: Local<HashSet<String>>,
) {
    for (root, mut making, hierarchy) in &mut hierarchies {
        if making.changed
            && let Some(plan) = plan(root, hierarchy, &nodes, &scenes)
        {
            let is_first = !making.was_ready;
            let file = scenes.file(root);
            for name in hierarchy
                .by_name
                .keys()
                .filter(|&name| is_first && !plan.found.contains(name))
            {
                let file = file.as_ref().map(|file| format!(" of {file}")).unwrap_or_default();
                let warning = format!("no node or mesh{file} has the name {name:?}, which has settings");
                if told.insert(warning.clone()) {
                    warn!("{warning}");
                }
            }
            for &entity in &plan.unwanted {
                commands.entity(entity).try_remove::<(MeshCollider, MadeFrom)>();
            }
            making.changed = false;
            let is_known = |error: &PrefabError| making.told.contains(&error.to_string());
            let makes_nothing = plan.colliders.is_empty() && plan.bodies.is_empty() && plan.unwanted.is_empty();
            making.done = !is_first && makes_nothing && plan.errors.iter().all(is_known);
            (making.colliders, making.bodies, making.errors) = (plan.colliders, plan.bodies, plan.errors);
        }
        if making.changed || making.done {
            continue;
        }
        // All bakes begin before the first one is waited for.
        let results: Vec<_> = making
            .colliders
            .iter()
            .map(|planned| bakes.get(&planned.made.source, &mut assets))
            .collect();
        if results.iter().any(Poll::is_pending) {
            continue;
        }
        making.done = true;
        making.was_ready = true;
        let mut errors = std::mem::take(&mut making.errors);
        let mut colliders = Vec::new();
        for (planned, result) in std::mem::take(&mut making.colliders).into_iter().zip(results) {
            let (Poll::Ready(result), true) = (result, nodes.contains(planned.entity)) else {
                continue;
            };
            match finish(&mut commands, &planned, result, made.get(planned.entity).ok()) {
                Ok(()) => colliders.push(planned.entity),
                Err(error) => errors.push(PrefabError {
                    entity: planned.entity,
                    file: file_of(&planned.made.source),
                    node: planned.node,
                    fault: PrefabFault::Mesh(error),
                }),
            }
        }
        for (node, settings) in std::mem::take(&mut making.bodies) {
            make_body(&mut commands, node, settings);
        }
        for error in &errors {
            let text = error.to_string();
            if told.insert(text.clone()) {
                error!("{text}");
            }
            making.told.insert(text);
        }
        commands.entity(root).try_remove::<ColliderToCome>();
        commands.trigger(MeshColliderHierarchyReady {
            entity: root,
            colliders,
            errors,
        });
    }
}

/// Inserts a collider, or removes the collider of an earlier mesh.
fn finish(
    commands: &mut Commands,
    planned: &PlannedCollider,
    result: Result<Handle<CollisionMesh>, MeshBakeError>,
    before: Option<&MadeFrom>,
) -> Result<(), MeshBakeError> {
    let mut entity = commands.entity(planned.entity);
    entity.try_insert(planned.made.clone());
    let mesh = match result {
        Ok(mesh) => mesh,
        Err(error) => {
            entity.try_remove::<MeshCollider>();
            return Err(error);
        }
    };
    let settings = &planned.made.settings;
    let before = before.map(|before| &before.settings);
    entity.try_insert(MeshCollider(mesh));
    set(&mut entity, settings.density, before.and_then(|b| b.density));
    set(&mut entity, settings.friction, before.and_then(|b| b.friction));
    set(&mut entity, settings.restitution, before.and_then(|b| b.restitution));
    set(&mut entity, settings.layers, before.and_then(|b| b.layers));
    let sensor = |settings: &ColliderSettings| (settings.sensor == Some(true)).then_some(Sensor);
    set(&mut entity, sensor(settings), before.and_then(sensor));
    Ok(())
}

/// Inserts a component, or removes it if it was inserted for earlier settings.
fn set<C: Component + PartialEq>(entity: &mut EntityCommands, value: Option<C>, before: Option<C>) {
    if value == before {
        return;
    }
    match value {
        Some(value) => entity.try_insert(value),
        None => entity.try_remove::<C>(),
    };
}

fn make_body(commands: &mut Commands, node: Entity, settings: ColliderSettings) {
    let Ok(mut entity) = commands.get_entity(node) else {
        return;
    };
    entity.try_insert((settings.body.unwrap_or_default(), MadeBody));
    set(&mut entity, settings.mass, None);
    set(&mut entity, settings.density, None);
    set(&mut entity, settings.friction, None);
    set(&mut entity, settings.restitution, None);
    set(&mut entity, settings.layers, None);
}

fn file_of(source: &Source) -> Option<AssetPath<'static>> {
    let path = source.meshes.first()?.path()?;
    Some(path.without_label().into_owned())
}
