//! Where colliders and bodies are in the world: products of the `Transform`s above them. `GlobalTransform`s are from
//! the last frame, so they are not used.

use crate::plugin::components::RigidBodyDisabled;
use crate::state::LocalPose;
use crate::types::body::RigidBody;
use bevy::ecs::query::QueryData;
use bevy::math::{DAffine3, DMat3, DQuat, DVec3};
use bevy::platform::collections::HashMap;
use bevy::prelude::*;

/// How much of its size a mesh may be sheared by rounding.
const MAX_SHEAR: f64 = 1.0e-5;

/// An entity of the hierarchy.
#[derive(QueryData)]
pub(crate) struct Node {
    transform: Option<&'static Transform>,
    parent: Option<&'static ChildOf>,
    is_body: Has<RigidBody>,
    disabled: Has<RigidBodyDisabled>,
}

/// What is above a collider.
#[derive(Clone, Copy)]
pub(crate) enum Ancestor {
    /// The collider's body, and the transformation from the collider's parent to the body.
    Body(Entity, DAffine3),
    /// No body. The transformation from its parent to the world.
    World(DAffine3),
    /// A body or entity that is disabled.
    Disabled,
}

/// Where a collider is in its body.
#[derive(Clone, Copy)]
pub(crate) struct Placed {
    pub pose: LocalPose,
    pub scale: Vec3,
    /// Applied to the vertices before the scale, if the mesh is sheared.
    pub shear: Option<DMat3>,
}

/// A pose, and the scale and shear along its axes.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Posed {
    pub position: Vec3,
    pub rotation: Quat,
    /// From coordinates of the entity to the axes of the pose.
    pub stretch: DMat3,
}

/// A body under other entities, as it was read or written last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Nested {
    pub kind: RigidBody,
    pub transform: Transform,
    /// What was above it when `transform` gave the pose.
    pub above: DAffine3,
    pub posed: Posed,
}

/// The bodies under other entities.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct NestedBodies(pub HashMap<Entity, Nested>);

impl NodeItem<'_, '_> {
    fn affine(&self) -> DAffine3 {
        self.transform.map_or(DAffine3::IDENTITY, affine)
    }
}

/// What is above the collider `entity`, which has no `RigidBody` itself.
pub(crate) fn above(entity: Entity, nodes: &Query<Node>) -> Ancestor {
    let parent = nodes.get(entity).ok().and_then(|node| node.parent);
    parent.map_or(Ancestor::World(DAffine3::IDENTITY), |parent| {
        from_parent(parent.parent(), nodes)
    })
}

/// What is above a collider with this parent.
pub(crate) fn from_parent(parent: Entity, nodes: &Query<Node>) -> Ancestor {
    let mut product = DAffine3::IDENTITY;
    let mut next = Some(parent);
    while let Some(entity) = next {
        let Ok(node) = nodes.get(entity) else {
            return Ancestor::Disabled;
        };
        if node.is_body {
            return if node.disabled {
                Ancestor::Disabled
            } else {
                Ancestor::Body(entity, product)
            };
        }
        product = node.affine() * product;
        next = node.parent.map(ChildOf::parent);
    }
    Ancestor::World(product)
}

/// The transformation from the parent of `entity` to the world. The functions give the parent and the `Transform` of an
/// entity.
pub(crate) fn world_above(
    entity: Entity,
    parent_of: impl Fn(Entity) -> Option<Entity>,
    transform_of: impl Fn(Entity) -> Option<Transform>,
) -> DAffine3 {
    let mut product = DAffine3::IDENTITY;
    let mut next = parent_of(entity);
    while let Some(parent) = next {
        product = transform_of(parent).map_or(DAffine3::IDENTITY, |transform| affine(&transform)) * product;
        next = parent_of(parent);
    }
    product
}

/// The transformation from the coordinates of `entity` to the world. The functions are the same as in [`world_above`];
/// without a `Transform` an entity is where its parent is.
pub(crate) fn to_world(
    entity: Entity,
    parent_of: impl Fn(Entity) -> Option<Entity>,
    transform_of: impl Fn(Entity) -> Option<Transform>,
) -> DAffine3 {
    let own = transform_of(entity).map_or(DAffine3::IDENTITY, |transform| affine(&transform));
    world_above(entity, parent_of, transform_of) * own
}

/// The transformation of a `Transform` in double precision.
pub(crate) fn affine(transform: &Transform) -> DAffine3 {
    let &Transform {
        translation,
        rotation,
        scale,
    } = transform;
    let rotation = rotation.as_dquat();
    // An invalid rotation remains one, and is reported later.
    let rotation = if rotation.length_squared() > 0.0 {
        rotation.normalize()
    } else {
        rotation
    };
    DAffine3::from_scale_rotation_translation(scale.as_dvec3(), rotation, translation.as_dvec3())
}

/// Rotation and stretch of a transformation: the first axis keeps its direction, the second its plane.
pub(crate) fn decompose(matrix: &DMat3) -> (DQuat, DMat3) {
    let x = matrix.x_axis.normalize_or(DVec3::X);
    let y = (matrix.y_axis - x * x.dot(matrix.y_axis)).normalize_or(x.any_orthonormal_vector());
    // A mirrored mesh has a negative scale along its first axis, as in `GlobalTransform`.
    let x = if matrix.determinant() < 0.0 { -x } else { x };
    let axes = DMat3::from_cols(x, y, x.cross(y));
    (DQuat::from_mat3(&axes).normalize(), axes.transpose() * *matrix)
}

/// Whether two transformations scale and shear alike, up to rounding.
fn same_scale(one: &DAffine3, other: &DAffine3) -> bool {
    let [one, other] = [one, other].map(|affine| affine.matrix3.transpose() * affine.matrix3);
    one.abs_diff_eq(other, MAX_SHEAR * one.col(0).length())
}

/// The pose of a collider in its body, from the transformation to the axes of the body.
pub(crate) fn place(to_body: &DAffine3) -> Placed {
    let (rotation, stretch) = decompose(&to_body.matrix3);
    let scale = DVec3::new(stretch.x_axis.x, stretch.y_axis.y, stretch.z_axis.z);
    let sheared = stretch - DMat3::from_diagonal(scale);
    let shear = [0, 1, 2].map(|axis| sheared.col(axis).length() / stretch.col(axis).length());
    let is_sheared = shear.into_iter().any(|shear| shear > MAX_SHEAR);
    let pose = LocalPose {
        translation: to_body.translation,
        rotation,
    };
    if !is_sheared {
        return Placed {
            pose,
            scale: scale.as_vec3(),
            shear: None,
        };
    }
    // A mirrored copy would be inside out.
    let mirror = DVec3::new(stretch.determinant().signum(), 1.0, 1.0);
    Placed {
        pose,
        scale: mirror.as_vec3(),
        shear: Some(DMat3::from_diagonal(mirror) * stretch),
    }
}

impl Posed {
    /// The pose of an entity without a parent.
    pub fn root(transform: &Transform) -> Self {
        Self {
            position: transform.translation,
            rotation: transform.rotation,
            stretch: DMat3::from_diagonal(transform.scale.as_dvec3()),
        }
    }

    fn of(to_world: &DAffine3) -> Self {
        let (rotation, stretch) = decompose(&to_world.matrix3);
        Self {
            position: to_world.translation.as_vec3(),
            rotation: rotation.as_quat(),
            stretch,
        }
    }

    /// From the coordinates of the entity to the axes of the pose.
    pub fn stretched(&self, in_entity: &DAffine3) -> DAffine3 {
        DAffine3::from_mat3(self.stretch) * *in_entity
    }
}

impl NestedBodies {
    /// Takes the bodies of the last step. This step fills the list again.
    pub fn take(&mut self) -> Self {
        std::mem::take(self)
    }

    /// Takes the entries of some bodies, which this step reads again.
    pub fn take_some(&mut self, bodies: &[Entity]) -> Self {
        if self.0.is_empty() {
            return Self::default();
        }
        Self(bodies.iter().filter_map(|body| self.0.remove_entry(body)).collect())
    }

    /// Reads a body under other entities; `before` are the bodies of the last step. A dynamic body keeps its pose in
    /// the world unless its own `Transform` was written. An unchanged pose keeps its bits.
    pub fn read(
        &mut self,
        before: &Self,
        entity: Entity,
        kind: RigidBody,
        transform: &Transform,
        above: DAffine3,
    ) -> Posed {
        let known = before.0.get(&entity).filter(|known| {
            known.transform == *transform && known.kind == kind && (kind == RigidBody::Dynamic || known.above == above)
        });
        let fresh = || Posed::of(&(above * affine(transform)));
        let posed = match known {
            None => fresh(),
            Some(known) if same_scale(&known.above, &above) => known.posed,
            Some(known) => Posed {
                stretch: fresh().stretch,
                ..known.posed
            },
        };
        let nested = Nested {
            kind,
            transform: *transform,
            above: known.map_or(above, |known| known.above),
            posed,
        };
        self.0.insert(entity, nested);
        posed
    }

    /// The `Transform` with which a body has this pose in the world. Its scale stays. Remembers both.
    pub fn write(&mut self, entity: Entity, before: &Transform, above: DAffine3, pose: (Vec3, Quat)) -> Transform {
        let (position, rotation) = pose;
        let Some(nested) = self.0.get_mut(&entity) else {
            return *before;
        };
        let moved = (nested.posed.position, nested.posed.rotation) != pose || nested.above != above;
        if moved {
            let down = above.inverse();
            let (turn, _) = decompose(&(down.matrix3 * DMat3::from_quat(rotation.as_dquat().normalize())));
            // A negative scale turns the axes of the pose.
            let (mirror, _) = decompose(&DMat3::from_diagonal(before.scale.as_dvec3()));
            let transform = Transform {
                translation: down.transform_point3(position.as_dvec3()).as_vec3(),
                rotation: (turn * mirror.inverse()).normalize().as_quat(),
                scale: before.scale,
            };
            // Below a flat entity there is no such `Transform`.
            if transform.is_finite() {
                nested.transform = transform;
            }
            nested.above = above;
            (nested.posed.position, nested.posed.rotation) = pose;
        }
        nested.transform
    }

    /// The pose of a body in the world, as it was read or written last.
    pub fn pose(&self, entity: Entity) -> Option<(Vec3, Quat)> {
        self.0
            .get(&entity)
            .map(|nested| (nested.posed.position, nested.posed.rotation))
    }

    /// Scale and shear of a dynamic body along the axes of its pose, as the step uses them.
    #[cfg(any(feature = "debug_gizmos", feature = "debug_panel"))]
    pub fn stretch(&self, entity: Entity) -> Option<DMat3> {
        let nested = self.0.get(&entity)?;
        (nested.kind == RigidBody::Dynamic).then_some(nested.posed.stretch)
    }

    /// Dynamic bodies whose `Transform` is unchanged since the last step, in any order.
    fn kept<'a>(&'a self, transforms: &'a Query<&mut Transform>) -> impl Iterator<Item = Entity> + 'a {
        self.0.iter().filter_map(|(&entity, nested)| {
            let same = transforms.get(entity).is_ok_and(|own| *own == nested.transform);
            (same && nested.kind == RigidBody::Dynamic).then_some(entity)
        })
    }

    /// All of them that exist, those above first.
    pub fn top_down(&self, world: &World) -> Vec<Entity> {
        let mut all: Vec<_> = self.0.keys().copied().collect();
        sort_top_down(
            &mut all,
            |&entity| entity,
            |entity| world.get::<ChildOf>(entity).map(ChildOf::parent),
        );
        all
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// Keeps dynamic bodies in place when what is above them moves between two steps.
pub(crate) fn hold_nested(
    mut step: ResMut<super::Step>,
    mut transforms: Query<&mut Transform>,
    parents: Query<&ChildOf>,
) {
    if step.nested.is_empty() {
        return;
    }
    let mut kept: Vec<_> = step.nested.kept(&transforms).collect();
    sort_top_down(&mut kept, |&entity| entity, parent_in(&parents));
    for entity in kept {
        let above = world_above(entity, parent_in(&parents), |entity| {
            transforms.get(entity).ok().copied()
        });
        if let (Some(pose), Ok(mut transform)) = (step.nested.pose(entity), transforms.get_mut(entity)) {
            let held = step.nested.write(entity, &transform, above, pose);
            transform.set_if_neq(held);
        }
    }
}

/// The function that gives the parent of an entity.
pub(crate) fn parent_in(parents: &Query<&ChildOf>) -> impl Fn(Entity) -> Option<Entity> {
    |entity| parents.get(entity).ok().map(ChildOf::parent)
}

/// Sorts items by the depth of their entities, those above first.
pub(crate) fn sort_top_down<T>(
    items: &mut [T],
    entity_of: impl Fn(&T) -> Entity,
    parent_of: impl Fn(Entity) -> Option<Entity>,
) {
    let depth = |entity| std::iter::successors(Some(entity), |&entity| parent_of(entity)).count();
    items.sort_by_cached_key(|item| {
        let entity = entity_of(item);
        (depth(entity), entity)
    });
}
