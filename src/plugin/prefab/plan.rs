//! Which entities of a hierarchy get a collider, of which meshes and with which settings.

use super::error::{PrefabError, PrefabFault};
use super::extras::{self, ExtrasOwner};
use super::make::{MadeBody, MadeFrom};
use super::scenes::Scenes;
use super::settings::{ColliderSettings, Layer, MeshColliderHierarchy};
use crate::plugin::assets::mesh_bakes::Source;
use crate::plugin::components::MeshCollider;
use crate::plugin::mesh_collider_from::MeshColliderFrom;
use crate::types::body::RigidBody;
use bevy::asset::AssetPath;
use bevy::ecs::query::QueryData;
use bevy::gltf::{GltfExtras, GltfMaterialExtras, GltfMeshExtras, GltfMeshName};
use bevy::platform::collections::HashSet;
use bevy::prelude::*;
use std::task::Poll;

/// An entity of the hierarchy.
#[derive(QueryData)]
pub(super) struct Node {
    children: Option<&'static Children>,
    name: Option<&'static Name>,
    transform: Option<&'static Transform>,
    mesh: Option<&'static Mesh3d>,
    mesh_name: Option<&'static GltfMeshName>,
    extras: Option<&'static GltfExtras>,
    mesh_extras: Option<&'static GltfMeshExtras>,
    material_extras: Option<&'static GltfMaterialExtras>,
    made: Option<&'static MadeFrom>,
    made_body: Has<MadeBody>,
    collider: Option<&'static MeshCollider>,
    will_have_collider: Has<MeshColliderFrom>,
    is_body: Has<RigidBody>,
    is_hierarchy: Has<MeshColliderHierarchy>,
}

/// A collider to make.
#[derive(Clone, Debug)]
pub(super) struct PlannedCollider {
    pub entity: Entity,
    /// The name of its node.
    pub node: String,
    pub made: MadeFrom,
}

/// The colliders to make, and errors.
#[derive(Default)]
pub(super) struct Plan {
    pub colliders: Vec<PlannedCollider>,
    /// Nodes that become bodies.
    pub bodies: Vec<(Entity, ColliderSettings)>,
    /// Entities whose colliders are no longer wanted.
    pub unwanted: Vec<Entity>,
    pub errors: Vec<PrefabError>,
    /// Names of nodes, meshes and entities that have settings.
    pub found: HashSet<String>,
}

/// A mesh of a node, with its settings.
struct Primitive<'a> {
    entity: Entity,
    mesh: &'a Handle<Mesh>,
    settings: ColliderSettings,
}

/// Plans the colliders below `root`. `None` if Bevy has not yet spawned one of the scenes.
pub(super) fn plan(
    root: Entity,
    hierarchy: &MeshColliderHierarchy,
    nodes: &Query<Node>,
    scenes: &Scenes,
) -> Option<Plan> {
    let mut planner = Planner {
        hierarchy,
        nodes,
        file: scenes.file(root),
        at: (root, String::new()),
        plan: Plan::default(),
    };
    // Children whose collider is planned with their parent node.
    let mut planned = HashSet::default();
    let mut open = vec![root];
    while let Some(entity) = open.pop() {
        let Ok(node) = nodes.get(entity) else { continue };
        if entity != root && node.is_hierarchy {
            continue;
        }
        planner.at = (entity, node.name.map_or_else(|| entity.to_string(), Name::to_string));
        match scenes.state(entity) {
            Poll::Pending => return None,
            Poll::Ready(Err(error)) => planner.error(PrefabFault::Scene(error)),
            Poll::Ready(Ok(())) => {}
        }
        if entity != root && !planned.contains(&entity) {
            planner.node(entity, &node, &mut planned);
        }
        open.extend(node.children.into_iter().flatten().rev());
    }
    Some(planner.plan)
}

struct Planner<'a, 'w, 's> {
    hierarchy: &'a MeshColliderHierarchy,
    nodes: &'a Query<'w, 's, Node>,
    file: Option<AssetPath<'static>>,
    /// The entity whose colliders are planned, and its name.
    at: (Entity, String),
    plan: Plan,
}

impl Planner<'_, '_, '_> {
    /// Plans the colliders of a node: of its own mesh, or of the primitives of its glTF mesh, which are its children.
    fn node(&mut self, entity: Entity, node: &NodeItem, planned: &mut HashSet<Entity>) {
        let nodes = self.nodes;
        let of_gltf = node.children.into_iter().flatten().copied().filter(|&child| {
            let child = nodes.get(child);
            child.is_ok_and(|child| child.mesh.is_some_and(|mesh| primitive_of(mesh).is_some()) && !child.is_hierarchy)
        });
        let own: Vec<Entity> = match node.mesh {
            Some(_) => vec![entity],
            None => of_gltf.collect(),
        };
        planned.extend(own.iter().copied());

        let owner = ExtrasOwner::Node {
            has_mesh: !own.is_empty(),
        };
        let of_node = self.extras(node.extras.map(|extras| &*extras.value), owner, true);
        let mut body = of_node.clone();
        let mut primitives = Vec::new();
        for (i, primitive) in own.iter().copied().enumerate() {
            let Ok(item) = nodes.get(primitive) else { continue };
            let Some(mesh) = item.mesh else { continue };
            let below = self.mesh_layer(&item, primitive == entity, i == 0);
            let mut layer = of_node.over(&below);
            let names = [item.mesh_name.map(|name| &*name.0), item.name.map(Name::as_str)];
            for name in names.into_iter().chain([node.name.map(Name::as_str)]).flatten() {
                if let Some(settings) = self.named(name) {
                    layer = settings.over(&layer);
                }
            }
            let is_wanted = layer.collider == Some(true);
            // A body and its mass are the node's.
            let settings = &mut layer.settings;
            let of_body = (settings.body.take(), settings.mass.take());
            if is_wanted {
                body.settings.body = of_body.0.or(body.settings.body);
                body.settings.mass = of_body.1.or(body.settings.mass);
            }
            let is_free = item.made.is_some() || !has_collider(&item) && !item.will_have_collider;
            if is_wanted && is_free {
                primitives.push(Primitive {
                    entity: primitive,
                    mesh: &mesh.0,
                    settings: layer.settings,
                });
            } else if item.made.is_some() {
                self.plan.unwanted.push(primitive);
            }
        }
        if let Some(settings) = node.name.and_then(|name| self.named(name)) {
            body = settings.over(&body);
        }
        if body.settings.body.is_some() && !node.is_body && !node.made_body {
            self.plan.bodies.push((entity, body.settings));
        }
        self.colliders(primitives, own.len());
    }

    /// The settings of a mesh, which its node's override.
    fn mesh_layer(&mut self, mesh: &NodeItem, is_node: bool, is_first: bool) -> Layer {
        let of_material = mesh.material_extras.map(|extras| &*extras.value);
        let of_material = self.extras(of_material, ExtrasOwner::Mesh, true);
        let of_mesh = mesh.mesh_extras.map(|extras| &*extras.value);
        // All primitives of a mesh have its extras.
        let of_mesh = self.extras(of_mesh, ExtrasOwner::Mesh, is_first);
        let own = mesh.extras.filter(|_| !is_node).map(|extras| &*extras.value);
        let own = self.extras(own, ExtrasOwner::Mesh, true);
        let default = Layer::of(&self.hierarchy.default);
        own.over(&of_mesh.over(&of_material.over(&default)))
    }

    /// Joins the primitives with the same settings of the same glTF mesh.
    fn colliders(&mut self, primitives: Vec<Primitive>, count: usize) {
        let mut groups: Vec<Vec<Primitive>> = Vec::new();
        for primitive in primitives {
            let mesh = primitive_of(primitive.mesh);
            let belongs = |group: &&mut Vec<Primitive>| {
                let first = &group[0];
                let is_same_mesh = mesh.is_some() && mesh == primitive_of(first.mesh);
                is_same_mesh
                    && first.settings == primitive.settings
                    && group.iter().all(|other| other.mesh != primitive.mesh)
            };
            match groups.iter_mut().find(belongs) {
                Some(group) => group.push(primitive),
                None => groups.push(vec![primitive]),
            }
        }
        for group in groups {
            let (first, others) = (&group[0], &group[1..]);
            let made = |entity: Entity| self.nodes.get(entity).ok().and_then(|item| item.made);
            let unwanted = others
                .iter()
                .map(|other| other.entity)
                .filter(|&other| made(other).is_some());
            self.plan.unwanted.extend(unwanted);
            let bake = first.settings.bake_settings();
            let beside = (group.len() == count && bake.is_none()).then(|| self.beside(first));
            let wanted = MadeFrom {
                source: Source {
                    meshes: group.iter().map(|primitive| primitive.mesh.clone()).collect(),
                    settings: bake,
                    beside: beside.flatten(),
                },
                settings: first.settings.clone(),
                stale: false,
            };
            if made(first.entity) != Some(&wanted) {
                self.plan.colliders.push(PlannedCollider {
                    entity: first.entity,
                    node: self.at.1.clone(),
                    made: wanted,
                });
            }
        }
    }

    /// The path of a baked mesh or recipe beside the file of a glTF mesh, without extension.
    fn beside(&self, primitive: &Primitive) -> Option<AssetPath<'static>> {
        let item = self.nodes.get(primitive.entity).ok()?;
        primitive_of(primitive.mesh)?;
        // A file has the mesh as it is in the glTF file, which Bevy's loader may have turned.
        let is_turned = item.transform.is_some_and(|own| *own != Transform::IDENTITY);
        let file = primitive.mesh.path().filter(|_| !is_turned)?;
        let stem = file.path().file_stem()?.to_string_lossy();
        let name = format!("{}_{}", plain(&stem), plain(&item.mesh_name?.0));
        Some(AssetPath::from_path_buf(file.path().with_file_name(name)).with_source(file.source().clone_owned()))
    }

    /// The settings of a name.
    fn named(&mut self, name: &str) -> Option<Layer> {
        let settings = self.hierarchy.by_name.get(name)?;
        self.plan.found.insert(name.to_owned());
        Some(Layer::of(settings))
    }

    /// The settings in a glTF file.
    fn extras(&mut self, json: Option<&str>, owner: ExtrasOwner, tells: bool) -> Layer {
        let (layer, errors) = json.map(|json| extras::read(json, owner)).unwrap_or_default();
        for error in errors.into_iter().filter(|_| tells) {
            self.error(error.into());
        }
        layer
    }

    fn error(&mut self, fault: PrefabFault) {
        let (entity, node) = self.at.clone();
        self.plan.errors.push(PrefabError {
            entity,
            node,
            file: self.file.clone(),
            fault,
        });
    }
}

/// Whether somebody else has given a collider to this entity. Colliders made here have the default handle, without a
/// mesh, in a saved scene.
fn has_collider(node: &NodeItem) -> bool {
    node.collider.is_some_and(|collider| collider.0 != Handle::default())
}

/// The file and the number of the glTF mesh that this is a primitive of.
fn primitive_of(mesh: &Handle<Mesh>) -> Option<(AssetPath<'_>, u32)> {
    let path = mesh.path()?;
    let (number, primitive) = path.label()?.strip_prefix("Mesh")?.split_once("/Primitive")?;
    primitive.parse::<u32>().ok()?;
    Some((path.without_label(), number.parse().ok()?))
}

/// A name with nothing in it that has a meaning in paths.
fn plain(name: &str) -> String {
    let keep = |c: char| if c.is_alphanumeric() || c == '-' { c } else { '_' };
    name.chars().map(keep).collect()
}
