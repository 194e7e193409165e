//! Colliders below other entities, and where they are.

use super::components::{Surface, SurfaceComponents, SurfaceComponentsItem};
use super::hierarchy::{self, Ancestor, Node, Placed, affine};
use crate::asset::CollisionMesh;
use crate::plugin::components::{ColliderDisabled, MeshCollider, StableKey};
use crate::types::body::RigidBody;
use bevy::ecs::query::QueryData;
use bevy::math::{DAffine3, DMat3};
use bevy::prelude::*;

/// The components of a collider below other entities.
#[derive(QueryData)]
pub(crate) struct ChildComponents {
    entity: Entity,
    mesh: &'static MeshCollider,
    transform: &'static Transform,
    parent: &'static ChildOf,
    key: Option<&'static StableKey>,
    surface: SurfaceComponents,
}

/// Colliders that may be parts of a body above them.
pub(crate) type IsChild = (Without<RigidBody>, Without<ColliderDisabled>);

/// A collider below its body, or a static one below other entities.
pub(crate) struct Child {
    pub collider: Entity,
    /// `None` for a static one.
    pub body: Option<Entity>,
    pub key: Option<StableKey>,
    pub mesh: AssetId<CollisionMesh>,
    pub surface: Surface,
    transform: Transform,
    /// From its parent to the body, or to the world.
    above: DAffine3,
    /// Place of the collider, and the stretch of the body for which it was found.
    placed: Option<(DMat3, Placed)>,
}

/// The colliders below other entities.
#[derive(Default)]
pub(crate) struct ChildColliders {
    /// Ascending by body, then collider.
    children: Vec<Child>,
    /// For each child that the query gives, in its order, the index in `children`.
    order: Vec<u32>,
}

/// A collider below other entities as it is now.
struct CurrentChild<'a, 'w, 's> {
    components: &'a ChildComponentsItem<'w, 's>,
    body: Option<Entity>,
    above: DAffine3,
}

impl CurrentChild<'_, '_, '_> {
    fn entities(&self) -> (Option<Entity>, Entity) {
        (self.body, self.components.entity)
    }
}

impl Child {
    fn new(current: &CurrentChild) -> Self {
        let components = current.components;
        Self {
            collider: components.entity,
            body: current.body,
            key: components.key.copied(),
            mesh: components.mesh.0.id(),
            surface: components.surface.read(),
            transform: *components.transform,
            above: current.above,
            placed: None,
        }
    }

    fn entities(&self) -> (Option<Entity>, Entity) {
        (self.body, self.collider)
    }

    /// Takes what the same collider has now. Its place remains if it has not moved.
    fn update(&mut self, current: &CurrentChild) {
        let components = current.components;
        self.key = components.key.copied();
        self.mesh = components.mesh.0.id();
        self.surface = components.surface.read();
        if self.transform != *components.transform || self.above != current.above {
            (self.transform, self.above, self.placed) = (*components.transform, current.above, None);
        }
    }

    /// Where it is in a body with this stretch, or in the world.
    pub fn place(&mut self, stretch: &DMat3) -> Placed {
        match self.placed {
            Some((known, placed)) if known == *stretch => placed,
            _ => {
                let up = self.above * affine(&self.transform);
                let placed = hierarchy::place(&(DAffine3::from_mat3(*stretch) * up));
                self.placed = Some((*stretch, placed));
                placed
            }
        }
    }
}

impl ChildColliders {
    /// Finds them, and what is above each of them.
    pub fn find(
        &mut self,
        query: &Query<ChildComponents, IsChild>,
        nodes: &Query<Node>,
        mut note: impl FnMut(Entity, &SurfaceComponentsItem),
    ) {
        // Whether all children so far are those of the last step, in the same order.
        let mut is_same = true;
        let mut count = 0;
        for_each(query, nodes, &mut |current| {
            note(current.components.entity, &current.components.surface);
            let known = self.order.get(count).map(|&at| &mut self.children[at as usize]);
            count += 1;
            match known {
                Some(known) if is_same && known.entities() == current.entities() => known.update(current),
                _ => is_same = false,
            }
        });
        if is_same && count == self.children.len() {
            return;
        }
        self.children.clear();
        for_each(query, nodes, &mut |current| self.children.push(Child::new(current)));
        let mut rows: Vec<u32> = (0..self.children.len() as u32).collect();
        rows.sort_unstable_by_key(|&row| self.children[row as usize].entities());
        self.children.sort_unstable_by_key(Child::entities);
        self.order.resize(rows.len(), 0);
        for (at, row) in (0..).zip(rows) {
            self.order[row as usize] = at;
        }
    }

    /// Updates the children with these `indices`, which are parts of bodies, in a step that keeps the children of the
    /// last one. Returns how many still exist; `None` if one is elsewhere. Children of a body that is gone stay as they
    /// were.
    pub fn update(
        &mut self,
        indices: &[u32],
        query: &Query<ChildComponents, IsChild>,
        nodes: &Query<Node>,
        mut note: impl FnMut(Entity, &SurfaceComponentsItem),
    ) -> Option<usize> {
        let mut count = 0;
        for &at in indices {
            let child = &mut self.children[at as usize];
            let Ok(components) = query.get(child.collider) else {
                let has_body = child.body.is_some_and(|body| nodes.contains(body));
                if has_body {
                    return None;
                }
                continue;
            };
            note(child.collider, &components.surface);
            count += 1;
            match hierarchy::from_parent(components.parent.parent(), nodes) {
                Ancestor::Body(body, above) if child.body == Some(body) => child.update(&CurrentChild {
                    components: &components,
                    body: child.body,
                    above,
                }),
                _ => return None,
            }
        }
        Some(count)
    }

    /// Whether a body has colliders below it.
    pub fn are_below(&self, body: Entity) -> bool {
        !self.children.is_empty()
            && self
                .children
                .binary_search_by_key(&Some(body), |child| child.body)
                .is_ok()
    }

    /// All of them, ascending by body, then collider.
    pub fn all(&mut self) -> &mut [Child] {
        &mut self.children
    }
}

/// Calls `visit` with each collider below other entities that is not disabled there.
fn for_each(query: &Query<ChildComponents, IsChild>, nodes: &Query<Node>, visit: &mut impl FnMut(&CurrentChild)) {
    // Siblings follow each other in most worlds.
    let mut last: Option<(Entity, Ancestor)> = None;
    for components in query {
        let parent = components.parent.parent();
        let above = match last {
            Some((known, above)) if known == parent => above,
            _ => hierarchy::from_parent(parent, nodes),
        };
        last = Some((parent, above));
        let (body, above) = match above {
            Ancestor::Body(body, above) => (Some(body), above),
            Ancestor::World(above) => (None, above),
            Ancestor::Disabled => continue,
        };
        visit(&CurrentChild {
            components: &components,
            body,
            above,
        });
    }
}
